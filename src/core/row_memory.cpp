#include "hemi/core/row_memory.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <map>
#include <memory_resource>
#include <mutex>
#include <new>
#include <set>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace hemi {

namespace {

/// Memory that lies in a file without a name. The file is mapped to one range of addresses, so that its
/// pieces are one mapping, of which a process may have some ten thousands only. Room that is given back is
/// used again; the file does not shrink.
class FileMemory final : public std::pmr::memory_resource {
public:
    explicit FileMemory(const std::filesystem::path& folder) : folder_(folder) {
        file_ = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
        if (file_ < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) {
            std::string name = (folder / "hemi-rows-XXXXXX").string();
            file_ = mkostemp(name.data(), O_CLOEXEC);
            if (file_ >= 0) {
                unlink(name.c_str());
            }
        }
        if (file_ < 0) {
            throw InputError(fmt::format("{}: no file of rows can be made there: {}", folder.string(),
                                         std::strerror(errno)));
        }
        reserve_addresses();
    }
    ~FileMemory() override {
        munmap(addresses_, addresses_size_);
        close(file_);
    }
    FileMemory(const FileMemory&) = delete;
    FileMemory& operator=(const FileMemory&) = delete;

private:
    /// Of all pieces and their places.
    static constexpr std::size_t granule = 64;
    /// By how much the file grows at least and at most, unless a piece needs more.
    static constexpr std::size_t least_growth = std::size_t{1} << 20;
    static constexpr std::size_t most_growth = std::size_t{1} << 28;

    void* do_allocate(std::size_t bytes, std::size_t /*alignment*/) override {
        const std::lock_guard lock(mutex_);
        const std::size_t size = round_up(bytes, granule);
        auto found = by_size_.lower_bound({size, 0});
        if (found == by_size_.end()) {
            grow(size);
            found = by_size_.lower_bound({size, 0});
        }
        const auto [free_size, place] = *found;
        by_size_.erase(found);
        by_place_.erase(place);
        if (free_size > size) {
            add_free(place + size, free_size - size);
        }
        return addresses_ + place;
    }
    void do_deallocate(void* data, std::size_t bytes, std::size_t /*alignment*/) override {
        const std::lock_guard lock(mutex_);
        add_free(static_cast<std::size_t>(static_cast<std::byte*>(data) - addresses_),
                 round_up(bytes, granule));
    }
    [[nodiscard]] bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
        return this == &other;
    }

    /// As many as can be had, up to 1 TiB, hundred times what a million patches take: more the file cannot
    /// hold.
    void reserve_addresses() {
        addresses_size_ = std::size_t{1} << 41;
        void* data = MAP_FAILED;
        while (data == MAP_FAILED && addresses_size_ > most_growth) {
            addresses_size_ /= 2;
            data =
                mmap(nullptr, addresses_size_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        }
        if (data == MAP_FAILED) {
            close(file_);
            throw std::bad_alloc();
        }
        addresses_ = static_cast<std::byte*>(data);
    }

    /// Adds free room for a piece of that size.
    void grow(std::size_t size) {
        static const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
        std::size_t more = round_up(std::max(size, std::clamp(end_ / 8, least_growth, most_growth)), page);
        const auto make_room = [&] { // room that is only promised would end the process when it is used
            return posix_fallocate(file_, static_cast<off_t>(end_), static_cast<off_t>(more));
        };
        int failed = make_room();
        if (failed != 0) {
            more = round_up(size, page);
            failed = make_room();
        }
        if (failed != 0) {
            throw OutOfMemory(fmt::format("{}: no room for {} more of rows, beside {} that are there: {}",
                                          folder_.string(), memory_text(more), memory_text(end_),
                                          std::strerror(failed)),
                              {"scratch"});
        }
        if (more > addresses_size_ - end_ ||
            mmap(addresses_ + end_, more, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file_,
                 static_cast<off_t>(end_)) == MAP_FAILED) {
            throw std::bad_alloc();
        }
        add_free(end_, more);
        end_ += more;
    }

    /// Free room, as one with that beside it.
    void add_free(std::size_t place, std::size_t size) {
        auto next = by_place_.lower_bound(place);
        if (next != by_place_.end() && next->first == place + size) {
            size += next->second;
            by_size_.erase({next->second, next->first});
            next = by_place_.erase(next);
        }
        if (next != by_place_.begin()) {
            const auto before = std::prev(next);
            if (before->first + before->second == place) {
                place = before->first;
                size += before->second;
                by_size_.erase({before->second, before->first});
                by_place_.erase(before);
            }
        }
        by_place_[place] = size;
        by_size_.insert({size, place});
    }

    static std::size_t round_up(std::size_t size, std::size_t step) {
        return (size + step - 1) / step * step;
    }

    std::filesystem::path folder_;
    int file_ = -1;
    std::byte* addresses_ = nullptr; ///< of the file's beginning
    std::size_t addresses_size_ = 0;
    std::size_t end_ = 0;                                   ///< of the file
    std::map<std::size_t, std::size_t> by_place_;           ///< sizes of free rooms
    std::set<std::pair<std::size_t, std::size_t>> by_size_; ///< their sizes and places
    std::mutex mutex_;
};

/// Of the process; null: there is none. Never taken down, since arrays may outlive all else.
std::atomic<std::pmr::memory_resource*> row_file{nullptr};

} // namespace

void keep_rows_in(const std::filesystem::path& folder) {
    row_file.store(new FileMemory(folder));
}

bool rows_are_in_file() noexcept {
    return row_file.load(std::memory_order_relaxed) != nullptr;
}

std::pmr::memory_resource* row_memory() noexcept {
    std::pmr::memory_resource* const file = row_file.load(std::memory_order_relaxed);
    return file != nullptr ? file : std::pmr::new_delete_resource();
}

} // namespace hemi
