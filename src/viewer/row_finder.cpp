#include "viewer/row_finder.hpp"

#include "engine/gathering.hpp"
#include "hemi/pipeline/cost.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/preview.hpp"

#include "hemi/core/error.hpp"

#include <span>
#include <utility>

namespace hemi::viewer {

/// Hears of the work on the finder's thread, and passes it on to the window's.
class RowFinder::Listener : public WorkObserver {
public:
    Listener(RowFinder& finder, const std::stop_token& stop)
        : WorkObserver(finder.progress_, stop, finder.observer_.get(), finder.changed_), finder_(finder) {}

    void show_preview(const std::vector<double>& radiosity) {
        shown_ = radiosity;
        {
            const std::lock_guard lock(finder_.mutex_);
            finder_.preview_ = radiosity;
        }
        tell();
    }

    void row(std::uint32_t patch, const RowView& row) override { gather(patch, row); }
    void row(std::uint32_t patch, const VisibilityRow& row) override {
        if (row.joint.empty()) { // else single patches do not tell what comes together
            gather(patch, row);
        }
    }

private:
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
    return thread_.get_stop_token().stop_requested() ? "stopping" : progress_.text(share);
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
    progress_.plan(factor_phases(*mesh_, settings_));
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
