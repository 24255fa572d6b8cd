#include "engine/visibility_weighted/coplanar_neighbours.hpp"

#include <algorithm>
#include <cmath>

namespace hemi {

namespace {

/// On the grids of subdivided surfaces, windows of 16 patches and more did not lower the error of V any
/// further: so about as many here.
constexpr std::uint32_t max_run = CoplanarNeighbours::reach;
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
        const double far = max_distance * std::sqrt(mesh.areas()[i]);
        const auto is_neighbour = [&](std::uint32_t j) {
            return glm::dot(mesh.normal(i), mesh.normal(j)) > min_cosine &&
                   glm::distance(mesh.centres()[i], mesh.centres()[j]) < far;
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

} // namespace hemi
