#include "engine/visibility_weighted/coplanar_neighbours.hpp"

#include <algorithm>
#include <cmath>

namespace hemi {

namespace {

/// Patches either way in the mesh's order. On the grids of subdivided surfaces, windows of 16 patches and
/// more did not lower the error of V any further: so about as many here.
constexpr std::uint32_t max_run = 8;
/// Cosine of the angle between the normals of neighbours: up to 37 degrees, so that finely cut curved
/// surfaces have neighbours, and the sides of a box have not. Chosen, not fitted.
constexpr double min_cosine = 0.8;
/// Largest distance between the centres of neighbours, in sizes (root of the area) of the patch: a run of 8
/// goes about 8 sizes far along a strip, less where the mesh's order winds; files also list faces that lie
/// far apart one after the other, and those are no neighbours. Chosen, not fitted.
constexpr double max_distance = 6.0;

} // namespace

CoplanarNeighbours::CoplanarNeighbours(const PatchMesh& mesh) : first_(mesh.size()), end_(mesh.size()) {
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const double reach = max_distance * std::sqrt(mesh.areas()[i]);
        const auto is_neighbour = [&](std::uint32_t j) {
            return glm::dot(mesh.normal(i), mesh.normal(j)) > min_cosine &&
                   glm::distance(mesh.centres()[i], mesh.centres()[j]) < reach;
        };
        std::uint32_t first = i;
        while (first > 0 && i - first < max_run && is_neighbour(first - 1)) {
            --first;
        }
        std::uint32_t end = i + 1;
        while (end < mesh.size() && end - i <= max_run && is_neighbour(end)) {
            ++end;
        }
        first_[i] = first;
        end_[i] = end;
    }
}

VisibilitySample CoplanarNeighbours::stand_in(std::span<const VisibilitySample> row, std::uint32_t j) const {
    const std::uint32_t reach = std::max(j - first_[j], end_[j] - 1 - j);
    for (std::uint32_t k = 1; k <= reach; ++k) {
        const VisibilitySample before = j >= first_[j] + k ? row[j - k] : VisibilitySample();
        const VisibilitySample after = j + k < end_[j] ? row[j + k] : VisibilitySample();
        if (before.known() || after.known()) {
            const double weight = (before.known() ? 1.0 : 0.0) + (after.known() ? 1.0 : 0.0);
            const double share =
                ((before.known() ? before.share() : 0.0) + (after.known() ? after.share() : 0.0)) / weight;
            return {static_cast<float>(share), 1};
        }
    }
    return {};
}

} // namespace hemi
