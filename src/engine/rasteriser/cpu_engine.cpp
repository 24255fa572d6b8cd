#include "engine/rasteriser/cpu_rows.hpp"

#include "hemi/core/interrupt.hpp"
#include "hemi/engine/engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace hemi {

namespace {

/// Rows of consecutive patches, as a thread made them.
struct RowChunk {
    struct Head {
        std::uint32_t patch;
        std::size_t end;       ///< of its entries
        std::size_t joint_end; ///< of what it tells of sets
        double environment;
        double blocked;
    };
    std::vector<Head> heads;
    std::vector<std::uint32_t> columns;
    std::vector<float> values;
    std::vector<std::uint8_t> visibility;
    std::vector<JointVisibility> joint;
    const PatchSets* sets = nullptr;

    void add(std::uint32_t patch, const RawRow& row) {
        columns.insert(columns.end(), row.columns.begin(), row.columns.end());
        values.insert(values.end(), row.values.begin(), row.values.end());
        visibility.insert(visibility.end(), row.visibility.begin(), row.visibility.end());
        joint.insert(joint.end(), row.joint.begin(), row.joint.end());
        sets = row.sets != nullptr ? row.sets : sets;
        heads.push_back({patch, columns.size(), joint.size(), row.environment, row.blocked});
    }
    [[nodiscard]] RawRow row(std::size_t k) const {
        const std::size_t begin = k == 0 ? 0 : heads[k - 1].end;
        const std::size_t count = heads[k].end - begin;
        RawRow row = RowView{std::span(columns).subspan(begin, count),
                             std::span(values).subspan(begin, count),
                             {},
                             heads[k].environment,
                             heads[k].blocked};
        const std::size_t joint_begin = k == 0 ? 0 : heads[k - 1].joint_end;
        row.joint = std::span(joint).subspan(joint_begin, heads[k].joint_end - joint_begin);
        row.sets = sets;
        if (!visibility.empty()) {
            row.visibility = std::span(visibility).subspan(begin, count);
        }
        return row;
    }
};

/// Deals chunks of patches to threads and hands the rows on in order, from the thread that calls.
class RowThreads {
public:
    RowThreads(std::span<const std::uint32_t> patches, std::span<const std::unique_ptr<CpuRows>> makers)
        : patches_(patches),
          chunk_size_(std::clamp<std::size_t>(patches.size() / (8 * makers.size()), 1, 16)),
          chunks_((patches.size() + chunk_size_ - 1) / chunk_size_), ahead_(4 * makers.size()) {
        try {
            for (const auto& maker : makers) {
                threads_.emplace_back([this, &rows = *maker] { work(rows); });
            }
        } catch (...) { // no more threads are to be had: the destructor does not run
            stop();
            throw;
        }
    }
    ~RowThreads() { stop(); }
    RowThreads(const RowThreads&) = delete;
    RowThreads& operator=(const RowThreads&) = delete;

    template <class Sink>
    void deliver(const Sink& sink) {
        while (delivered_ < chunks_) {
            RowChunk chunk;
            {
                std::unique_lock lock(mutex_);
                changed_.wait(lock, [this] { return failure_ || finished_.contains(delivered_); });
                if (failure_) {
                    std::rethrow_exception(failure_);
                }
                chunk = std::move(finished_.extract(delivered_).mapped());
                ++delivered_;
            }
            changed_.notify_all();
            for (std::size_t k = 0; k < chunk.heads.size(); ++k) {
                sink(chunk.heads[k].patch, chunk.row(k));
            }
        }
    }

private:
    void stop() {
        {
            const std::lock_guard lock(mutex_);
            stopped_ = true;
        }
        changed_.notify_all();
    }
    void work(CpuRows& rows) {
        try {
            for (std::size_t index = 0; take(index);) {
                RowChunk chunk;
                const std::size_t first = index * chunk_size_;
                for (const std::uint32_t patch :
                     patches_.subspan(first, std::min(chunk_size_, patches_.size() - first))) {
                    chunk.add(patch, rows.row(patch));
                }
                {
                    const std::lock_guard lock(mutex_);
                    finished_.emplace(index, std::move(chunk));
                }
                changed_.notify_all();
            }
        } catch (...) {
            {
                const std::lock_guard lock(mutex_);
                failure_ = std::current_exception();
            }
            changed_.notify_all();
        }
    }
    /// The next chunk to compute; not so far ahead that finished rows pile up. @return whether there is one
    bool take(std::size_t& index) {
        std::unique_lock lock(mutex_);
        changed_.wait(
            lock, [this] { return stopped_ || failure_ || next_ == chunks_ || next_ < delivered_ + ahead_; });
        if (stopped_ || failure_ || next_ == chunks_) {
            return false;
        }
        index = next_++;
        return true;
    }

    std::span<const std::uint32_t> patches_;
    std::size_t chunk_size_;
    std::size_t chunks_;
    std::size_t ahead_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::size_t next_ = 0;
    std::size_t delivered_ = 0;
    bool stopped_ = false;
    std::map<std::size_t, RowChunk> finished_;
    std::exception_ptr failure_;
    std::vector<std::jthread> threads_; ///< last: they end before what they use
};

class CpuEngine final : public RawRowProvider {
public:
    CpuEngine(std::unique_ptr<const EngineGeometry> geometry, const HemicubeSettings& settings,
              RowQuantity quantity, std::uint32_t threads)
        : geometry_(std::move(geometry)), scene_(geometry_->list) {
        if (settings.joint && quantity == RowQuantity::visibility) {
            sets_.emplace(scene_);
        }
        const std::uint32_t count = threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
        for (std::uint32_t k = 0; k < count; ++k) {
            makers_.push_back(
                std::make_unique<CpuRows>(*geometry_, scene_, settings, quantity, sets_ ? &*sets_ : nullptr));
        }
    }

    [[nodiscard]] std::uint32_t size() const override { return geometry_->eyes.patches(); }
    [[nodiscard]] std::string renderer() const override { return cpu_renderer(); }
    void rows(std::span<const std::uint32_t> patches, const Sink& sink) override {
        const auto deliver = [&](std::uint32_t patch, const RawRow& row) {
            stop_if_interrupted();
            hemicubes_ += geometry_->eyes.of(patch).size();
            sink(patch, row);
        };
        if (makers_.size() == 1 || patches.size() == 1) {
            for (const std::uint32_t patch : patches) {
                deliver(patch, makers_[0]->row(patch));
            }
            return;
        }
        RowThreads(patches, makers_).deliver(deliver);
    }
    [[nodiscard]] std::uint64_t hemicubes() const override { return hemicubes_; }

private:
    std::unique_ptr<const EngineGeometry> geometry_;
    RasterScene scene_;
    std::optional<SideSets> sets_;                 ///< where rows may tell of them
    std::vector<std::unique_ptr<CpuRows>> makers_; ///< one a thread
    std::uint64_t hemicubes_ = 0;
};

constexpr std::string_view cpu_name = "hemi CPU rasteriser";

} // namespace

std::string cpu_renderer() {
    return fmt::format("{} ({})", cpu_name, simd_in_use());
}

std::string renderer_of_rows(std::string_view renderer) {
    return std::string(renderer.starts_with(cpu_name) ? cpu_name : renderer);
}

std::unique_ptr<RawRowProvider> make_cpu_engine(std::unique_ptr<const EngineGeometry> geometry,
                                                const HemicubeSettings& settings, RowQuantity quantity,
                                                std::uint32_t threads) {
    return std::make_unique<CpuEngine>(std::move(geometry), settings, quantity, threads);
}

} // namespace hemi
