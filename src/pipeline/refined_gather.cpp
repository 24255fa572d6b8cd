#include "pipeline/refined_gather.hpp"

#include "display/smooth_surfaces.hpp"
#include "hemi/pipeline/vertex_gather.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace hemi {

namespace {

/// Corners that are one lie nearer to each other than this share of a patch's diagonal.
constexpr double same_corner = 1e-6;

} // namespace

void RefinedGather::gather(const Scene& scene, const PatchMesh& mesh, const FactorSettings& settings,
                           Solution& solution, Observer& observer) {
    const std::uint32_t channels = solution.channels;
    if (!parents_.empty()) {
        std::vector<double> areas(mesh.size(), 0.0); // of the parents, no more than there are patches now
        std::vector<double> means(std::size_t{mesh.size()} * channels, 0.0);
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            areas[parents_[i]] += mesh.areas()[i];
        }
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            for (std::uint32_t c = 0; c < channels; ++c) {
                means[std::size_t{parents_[i]} * channels + c] +=
                    mesh.areas()[i] / areas[parents_[i]] *
                    solution.radiosity[std::size_t{i} * channels + c];
            }
        }
        for (std::size_t value = 0; value < known_.size(); ++value) { // stays no number where it is none
            const std::size_t parent = parents_[value / (std::size_t{4} * channels)];
            known_[value] += static_cast<float>(means[parent * channels + value % channels]);
        }
    }
    old_.assign(std::size_t{mesh.size()} * 4, false);
    for (std::size_t corner = 0; corner * channels < known_.size(); ++corner) {
        old_[corner] = !std::isnan(known_[corner * channels]);
    }
    gather_at_vertices(scene, mesh, settings, Gather::on, solution, observer, &known_);
    parents_.clear();
}

bool RefinedGather::refresh(const Scene& scene, const PatchMesh& mesh, std::span<const std::uint32_t> patches,
                            const FactorSettings& settings, Solution& solution, Observer& observer) {
    const SmoothSurfaces surfaces(mesh);
    std::vector<bool> wanted(surfaces.vertex_count(), false);
    bool any = false;
    for (const std::uint32_t patch : patches) {
        const auto ring = surfaces.corners(patch);
        for (std::uint32_t k = 0; k < ring.size(); ++k) {
            if (old_[std::size_t{patch} * 4 + k]) {
                wanted[ring[k]] = true;
                any = true;
            }
        }
    }
    if (!any) {
        return false;
    }
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const auto ring = surfaces.corners(i);
        for (std::uint32_t k = 0; k < ring.size(); ++k) {
            if (wanted[ring[k]]) {
                const std::size_t corner = std::size_t{i} * 4 + k;
                old_[corner] = false;
                std::fill_n(known_.begin() + static_cast<std::ptrdiff_t>(corner * solution.channels),
                            solution.channels, std::numeric_limits<float>::quiet_NaN());
            }
        }
    }
    gather_at_vertices(scene, mesh, settings, Gather::on, solution, observer, &known_);
    return true;
}

void RefinedGather::split(const PatchMesh& from, const Solution& solution, const PatchMesh& to,
                          std::span<const std::uint32_t> parents) {
    if (known_.empty()) {
        return;
    }
    const std::uint32_t channels = solution.channels;
    std::vector<float> known(std::size_t{to.size()} * 4 * channels, std::numeric_limits<float>::quiet_NaN());
    for (std::uint32_t i = 0; i < to.size(); ++i) {
        const std::uint32_t parent = parents[i];
        const PatchCorners old = from.corners(parent);
        const PatchCorners corners = to.corners(i);
        const double near = same_corner * glm::distance(old.points[0], old.points[2]);
        for (std::size_t k = 0; k < corners.count; ++k) {
            for (std::size_t j = 0; j < old.count; ++j) {
                if (glm::distance(corners.points[k], old.points[j]) > near) {
                    continue;
                }
                for (std::uint32_t c = 0; c < channels; ++c) {
                    known[(std::size_t{i} * 4 + k) * channels + c] =
                        known_[(std::size_t{parent} * 4 + j) * channels + c] -
                        static_cast<float>(solution.radiosity[std::size_t{parent} * channels + c]);
                }
            }
        }
    }
    known_ = std::move(known);
    parents_.assign(parents.begin(), parents.end());
}

} // namespace hemi
