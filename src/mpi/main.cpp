/// The program `hemi-mpi`: hemi by many processes that MPI starts. No other source knows MPI.
#include "cli/run_program.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/core/ranks.hpp"

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <thread>
#include <utility>
#include <vector>

namespace {

using Bytes = std::vector<std::byte>;

/// The ranks of MPI_COMM_WORLD. MPI itself ends all of them when one dies.
class MpiRanks final : public hemi::Ranks {
public:
    MpiRanks(int* argc, char*** argv) {
        int provided = 0;
        MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
        MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
        MPI_Comm_size(MPI_COMM_WORLD, &size_);
        MPI_Comm_dup(MPI_COMM_WORLD, &meeting_);
        MPI_Comm machine = MPI_COMM_NULL;
        MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine);
        MPI_Comm_size(machine, &on_machine_);
        MPI_Comm_free(&machine);
    }
    MpiRanks(const MpiRanks&) = delete;
    MpiRanks& operator=(const MpiRanks&) = delete;

    [[nodiscard]] std::uint32_t rank() const noexcept override { return static_cast<std::uint32_t>(rank_); }
    [[nodiscard]] std::uint32_t size() const noexcept override { return static_cast<std::uint32_t>(size_); }
    [[nodiscard]] std::uint32_t on_machine() const noexcept override {
        return static_cast<std::uint32_t>(on_machine_);
    }

    [[nodiscard]] std::vector<Bytes> gather(std::span<const std::byte> own) override {
        own_size_ = own.size();
        sizes_.resize(size());
        MPI_Iallgather(&own_size_, 1, MPI_UINT64_T, sizes_.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD,
                       &gathering_);
        wait(gathering_); // for the slowest: what follows is quick
        std::uint64_t all = 0;
        for (const std::uint64_t one : sizes_) {
            all += one;
        }
        return all <= at_once ? gather_together(own, sizes_, all) : gather_one_by_one(own, sizes_);
    }

    [[nodiscard]] bool meet() noexcept override {
        failed_alone_ = !meet(false);
        return !failed_alone_;
    }

    /// Ends the program: all ranks, where the others still count on this one.
    [[nodiscard]] int end(int status) {
        if (failed_alone_) {
            MPI_Abort(MPI_COMM_WORLD, status);
        }
        (void)meet(true);                     // the first rank may still be writing
        if (gathering_ != MPI_REQUEST_NULL) { // interrupted, maybe each at another place
            MPI_Abort(MPI_COMM_WORLD, status);
        }
        MPI_Finalize();
        return status;
    }

private:
    /// Waits without keeping others, such as threads of other ranks, from their work.
    static void wait(MPI_Request& request) {
        using Clock = std::chrono::steady_clock;
        constexpr auto short_wait = std::chrono::microseconds(200);
        const Clock::time_point begin = Clock::now();
        for (int done = 0;;) {
            MPI_Test(&request, &done, MPI_STATUS_IGNORE);
            if (done != 0) {
                return;
            }
            hemi::stop_if_interrupted();
            if (Clock::now() - begin < short_wait) {
                std::this_thread::yield();
            } else {
                std::this_thread::sleep_for(short_wait / 4);
            }
        }
    }

    // MPI counts by int.
    static constexpr std::uint64_t at_once = std::uint64_t{1} << 30;

    [[nodiscard]] std::vector<Bytes> gather_together(std::span<const std::byte> own,
                                                     std::span<const std::uint64_t> sizes,
                                                     std::uint64_t all) const {
        std::vector<int> counts;
        std::vector<int> begin;
        int next = 0;
        for (const std::uint64_t bytes : sizes) {
            counts.push_back(static_cast<int>(bytes));
            begin.push_back(next);
            next += static_cast<int>(bytes);
        }
        Bytes together(all);
        MPI_Allgatherv(own.data(), static_cast<int>(own.size()), MPI_BYTE, together.data(), counts.data(),
                       begin.data(), MPI_BYTE, MPI_COMM_WORLD);
        std::vector<Bytes> result;
        for (std::size_t r = 0; r < sizes.size(); ++r) {
            const auto first = together.begin() + begin[r];
            result.emplace_back(first, first + counts[r]);
        }
        return result;
    }

    [[nodiscard]] std::vector<Bytes> gather_one_by_one(std::span<const std::byte> own,
                                                       std::span<const std::uint64_t> sizes) const {
        std::vector<Bytes> result;
        for (int r = 0; r < size_; ++r) {
            Bytes bytes(sizes[static_cast<std::size_t>(r)]);
            if (r == rank_) {
                bytes.assign(own.begin(), own.end());
            }
            for (std::uint64_t done = 0; done < bytes.size(); done += at_once) {
                const std::uint64_t part = std::min(at_once, bytes.size() - done);
                MPI_Bcast(bytes.data() + done, static_cast<int>(part), MPI_BYTE, r, MPI_COMM_WORLD);
            }
            result.push_back(std::move(bytes));
        }
        return result;
    }

    static bool is_interrupted() noexcept {
        try {
            hemi::stop_if_interrupted();
            return false;
        } catch (const hemi::Cancelled&) {
            return true;
        }
    }

    /// @param patient  waits as long as it takes
    [[nodiscard]] bool meet(bool patient) noexcept {
        using Clock = std::chrono::steady_clock;
        const auto patience = std::chrono::seconds(is_interrupted() ? 1 : 20);
        if (request_ == MPI_REQUEST_NULL && !met_) {
            MPI_Ibarrier(meeting_, &request_);
        }
        const Clock::time_point begin = Clock::now();
        while (!met_ && (patient || Clock::now() - begin < patience)) {
            int done = 0;
            MPI_Test(&request_, &done, MPI_STATUS_IGNORE);
            met_ = done != 0;
            if (!met_) { // whoever waits leaves the processor to others
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
            }
        }
        return met_;
    }

    int rank_ = 0;
    int size_ = 1;
    int on_machine_ = 1;
    // Of a gathering under way, which may still be when an interrupt ends the work.
    std::uint64_t own_size_ = 0;
    std::vector<std::uint64_t> sizes_;
    MPI_Request gathering_ = MPI_REQUEST_NULL;
    MPI_Comm meeting_ = MPI_COMM_NULL; ///< of those that end, whatever the others are waiting for
    MPI_Request request_ = MPI_REQUEST_NULL;
    bool met_ = false;
    bool failed_alone_ = false;
};

} // namespace

int main(int argc, char** argv) {
    MpiRanks ranks(&argc, &argv);
    if (ranks.size() > 1) {
        hemi::set_ranks(&ranks);
    }
    if (ranks.rank() > 0 && std::freopen("/dev/null", "w", stdout) == nullptr) {
        return ranks.end(1);
    }
    return ranks.end(hemi::cli::run_program(argc, argv));
}
