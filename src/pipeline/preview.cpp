#include "hemi/pipeline/preview.hpp"

#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/radiosity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace hemi {

namespace {

// Scenes of fewer patches are solved before one has looked.
constexpr std::uint32_t min_patches = 4000;
constexpr double coarse_patches = 1000.0;
// The coarse scene must have so many times fewer patches.
constexpr std::uint32_t min_gain = 3;
constexpr double coarse_tolerance = 1e-3;

/// All progress is the preview's.
class PreviewObserver : public Observer {
public:
    explicit PreviewObserver(Observer& observer) : observer_(observer) {}

    bool progress(Phase, std::size_t done, std::size_t total) override {
        return observer_.progress(Phase::preview, done, total);
    }
    void warning(std::string_view message, std::string_view setting) override {
        observer_.warning(message, setting);
    }

private:
    Observer& observer_;
};

/// For every patch the one of `coarse` that lies nearest on the same side of the same surface.
std::vector<std::uint32_t> nearest_patches(const PatchMesh& fine, const PatchMesh& coarse) {
    std::vector<std::uint32_t> nearest(fine.size());
    for (std::uint32_t i = 0; i < fine.size(); ++i) {
        const std::uint32_t s = fine.surface_of()[i];
        const std::uint32_t count = coarse.patches_per_side(s);
        const std::uint32_t first = coarse.first_patch(s) + (fine.is_back(i) ? count : 0);
        double least = std::numeric_limits<double>::infinity();
        for (std::uint32_t j = first; j < first + count; ++j) {
            const Vec3 way = fine.centres()[i] - coarse.centres()[j];
            const double square = glm::dot(way, way);
            if (square < least) {
                least = square;
                nearest[i] = j;
            }
        }
    }
    return nearest;
}

} // namespace

std::optional<std::vector<double>> coarse_preview(const Scene& scene, const PatchMesh& mesh,
                                                  const FactorSettings& settings,
                                                  const SolverSettings& solver, Observer& observer) {
    if (mesh.size() < min_patches || settings.method != Method::hemicube) {
        return std::nullopt;
    }
    const auto areas = mesh.areas();
    Subdivision subdivision;
    subdivision.patch_size = std::sqrt(std::accumulate(areas.begin(), areas.end(), 0.0) / coarse_patches);
    const PatchMesh coarse(scene, subdivision);
    if (coarse.size() > mesh.size() / min_gain) {
        return std::nullopt;
    }
    PreviewObserver preview(observer);
    FactorSettings quick = settings;
    quick.preset = Preset::fast;
    quick.eye_points.reset();
    quick.resolution.reset();
    quick.estimate_error = false;
    quick.engine.jobs = 1; // quicker than starting workers
    FormFactors factors =
        compute_raw_form_factors(scene, coarse, reflecting_patches(scene, coarse), quick, preview);
    prepare_form_factors(factors, quick.repair, preview);
    SolverSettings rough = solver;
    rough.tolerance = std::max(rough.tolerance, coarse_tolerance);
    const Solution solution = solve_radiosity(scene, coarse, factors, rough, preview, false);
    std::vector<double> radiosity;
    radiosity.reserve(std::size_t{mesh.size()} * solution.channels);
    for (const std::uint32_t j : nearest_patches(mesh, coarse)) {
        const auto first = solution.radiosity.begin() + std::ptrdiff_t{j} * solution.channels;
        radiosity.insert(radiosity.end(), first, first + solution.channels);
    }
    return radiosity;
}

} // namespace hemi
