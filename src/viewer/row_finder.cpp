#include "viewer/row_finder.hpp"

#include "engine/gathering.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/preview.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <chrono>
#include <span>
#include <utility>

namespace hemi::viewer {

/// Hears of the work on the finder's thread, and passes it on to the window's.
class RowFinder::Listener : public Observer {
public:
    Listener(RowFinder& finder, const std::stop_token& stop) : finder_(finder), stop_(stop) {}

    bool progress(Phase phase, std::size_t done, std::size_t total) override {
        constexpr std::chrono::milliseconds interval{100};
        const Clock::time_point now = Clock::now();
        const std::string title(to_word(phase));
        const bool counts =
            phase != Phase::radiosity && phase != Phase::preview && phase != Phase::error_estimate;
        bool tell = now - told_ >= interval;
        {
            const std::lock_guard lock(finder_.mutex_);
            if (finder_.progress_.title != title) {
                began_ = now;
                tell = true;
            }
            finder_.progress_ = {title, counts ? "rows" : "", done, total,
                                 std::chrono::duration<double>(now - began_).count()};
        }
        if (tell) {
            told_ = now;
            finder_.changed_();
        }
        return !stop_.stop_requested();
    }

    void warning(std::string_view message, std::string_view setting) override {
        if (finder_.observer_) {
            finder_.observer_->warning(message, setting);
        }
    }
    void note(std::string_view message) override {
        if (finder_.observer_) {
            finder_.observer_->note(message);
        }
    }
    void detail(std::string_view message) override {
        if (finder_.observer_) {
            finder_.observer_->detail(message);
        }
    }

    /// What the light will be about; rows that come now sharpen it.
    void show_preview(const std::vector<double>& radiosity) {
        shown_ = radiosity;
        {
            const std::lock_guard lock(finder_.mutex_);
            finder_.preview_ = radiosity;
        }
        finder_.changed_();
    }

    void row(std::uint32_t patch, const RowView& row) override { gather(patch, row); }
    void row(std::uint32_t patch, const VisibilityRow& row) override { gather(patch, row); }

private:
    using Clock = std::chrono::steady_clock;

    /// Gives the row's own patch what it has of the light that is shown: that of the preview, or of the
    /// lamps.
    template <class Row>
    void gather(std::uint32_t patch, const Row& row) {
        const Scene& scene = *finder_.scene_;
        const PatchMesh& mesh = *finder_.mesh_;
        const std::size_t channels = scene.channels.size();
        if (!gathering_) {
            exitance_ = patch_values(mesh, scene.materials, &Material::exitance);
            reflectance_ = patch_values(mesh, scene.materials, &Material::reflectance);
            light_.resize(channels);
            gathering_.emplace(mesh, static_cast<std::uint32_t>(channels),
                               shown_.empty() ? exitance_ : std::move(shown_), scene.environment);
        }
        gathering_->gather(patch, row, light_);
        for (std::size_t c = 0; c < channels; ++c) {
            const std::size_t at = patch * channels + c;
            light_[c] = exitance_[at] + reflectance_[at] * light_[c];
        }
        // Shown together with the progress.
        const std::lock_guard lock(finder_.mutex_);
        GatheredLight& gathered = finder_.gathered_;
        gathered.patches.push_back(patch);
        gathered.radiosity.insert(gathered.radiosity.end(), light_.begin(), light_.end());
        gathered.blocked.push_back(row.blocked);
    }

    RowFinder& finder_;
    const std::stop_token& stop_;
    Clock::time_point began_;
    Clock::time_point told_;
    std::vector<double> shown_;
    std::vector<double> exitance_;
    std::vector<double> reflectance_;
    std::vector<double> light_; ///< of one patch
    std::optional<Gathering> gathering_;
};

RowFinder::RowFinder(const ViewerInput& input, std::shared_ptr<FactorCache> cache,
                     std::function<void()> changed)
    : scene_(input.scene), mesh_(input.mesh), settings_(*input.factor_settings), solver_(input.solver),
      observer_(input.observer), cache_(std::move(cache)), changed_(std::move(changed)),
      thread_([this](const std::stop_token& stop) { work(stop); }) {}

RowFinder::~RowFinder() = default;

std::string RowFinder::status(double& share) const {
    if (thread_.get_stop_token().stop_requested()) {
        return "stopping";
    }
    const std::lock_guard lock(mutex_);
    const Progress& now = progress_;
    share = now.total > 0 ? static_cast<double>(now.done) / static_cast<double>(now.total) : 0.0;
    std::string text = now.title.empty() ? "starting" : now.title;
    if (!now.unit.empty() && now.seconds > 0.5) {
        text += fmt::format(", {:.0f} {}/s", static_cast<double>(now.done) / now.seconds, now.unit);
    }
    return text;
}

void RowFinder::cancel() {
    thread_.request_stop();
}

bool RowFinder::finished() const {
    const std::lock_guard lock(mutex_);
    return finished_;
}

std::optional<std::vector<double>> RowFinder::take_preview() {
    const std::lock_guard lock(mutex_);
    return std::exchange(preview_, std::nullopt);
}

GatheredLight RowFinder::take_gathered() {
    const std::lock_guard lock(mutex_);
    return std::exchange(gathered_, {});
}

std::shared_ptr<const FormFactors> RowFinder::take() {
    const std::lock_guard lock(mutex_);
    if (problem_) {
        std::rethrow_exception(std::exchange(problem_, nullptr));
    }
    return std::exchange(result_, nullptr);
}

std::shared_ptr<const FormFactors> RowFinder::find(Listener& listener) {
    if (auto known = cache_->find(*scene_, *mesh_)) {
        return known;
    }
    if (const auto preview = coarse_preview(*scene_, *mesh_, settings_, solver_, listener)) {
        listener.show_preview(*preview);
    }
    // Of all patches, so that every one can be picked, and may begin to reflect.
    auto factors =
        std::make_shared<const FormFactors>(compute_form_factors(*scene_, *mesh_, settings_, listener));
    cache_->keep(factors);
    return factors;
}

void RowFinder::work(const std::stop_token& stop) {
    Listener listener(*this, stop);
    std::shared_ptr<const FormFactors> found;
    std::exception_ptr problem;
    try {
        found = find(listener);
    } catch (const Cancelled&) { // as was asked for
    } catch (...) {
        problem = std::current_exception();
    }
    {
        const std::lock_guard lock(mutex_);
        result_ = std::move(found);
        problem_ = std::move(problem); // the last hold on it on this thread
        finished_ = true;
    }
    changed_();
}

} // namespace hemi::viewer
