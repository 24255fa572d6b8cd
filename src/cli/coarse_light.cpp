#include "cli/coarse_light.hpp"

#include "cli/repair_rows.hpp"
#include "cli/solution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace hemi::cli {

namespace {

/// Scenes of fewer patches are solved before one has looked.
constexpr std::uint32_t large = 4000;
constexpr double coarse_patches = 1000.0;
/// It must be so many times fewer patches.
constexpr std::uint32_t least_gain = 3;

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

std::optional<std::vector<double>> coarse_light(const LoadedScene& loaded, const RowOptions& rows,
                                                const SolverSettings& solver, const Terminal& terminal) {
    const auto areas = loaded.mesh.areas();
    if (loaded.mesh.size() < large || rows.method != "hemicube") {
        return std::nullopt;
    }
    Subdivision subdivision;
    subdivision.patch_size = std::sqrt(std::accumulate(areas.begin(), areas.end(), 0.0) / coarse_patches);
    LoadedScene coarse{loaded.scene, PatchMesh(loaded.scene, subdivision), {}, 0.0};
    if (coarse.mesh.size() > loaded.mesh.size() / least_gain) {
        return std::nullopt;
    }
    for (std::uint32_t i = 0; i < coarse.mesh.size(); ++i) {
        coarse.group_of.push_back(coarse.mesh.group(i));
    }
    RowOptions quick = rows;
    quick.preset = "fast";
    quick.eye_points.reset();
    quick.resolution.reset();
    quick.jobs = 1; // quicker than starting workers
    Rows found = compute_rows(coarse, reflecting_patches(coarse), quick, terminal);
    settle_contacts(found.file);
    (void)repair_rows(found.file, quick.repair);
    SolverSettings rough = solver;
    rough.tolerance = std::max(rough.tolerance, 1e-3);
    const Solution solution = solve_scene(coarse, found.file.factors, rough, false, terminal);
    const std::vector<std::uint32_t> nearest = nearest_patches(loaded.mesh, coarse.mesh);
    std::vector<double> radiosity;
    radiosity.reserve(std::size_t{loaded.mesh.size()} * solution.channels);
    for (const std::uint32_t j : nearest) {
        for (std::uint32_t c = 0; c < solution.channels; ++c) {
            radiosity.push_back(solution.radiosity[std::size_t{j} * solution.channels + c]);
        }
    }
    return radiosity;
}

} // namespace hemi::cli
