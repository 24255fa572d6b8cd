#include "io/formats/surface_chunk.hpp"

#include <fmt/format.h>

#include <limits>

namespace hemi::io {

namespace {

constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
// Bits of StoredSurface::sides.
constexpr std::uint32_t two_sides = 1;
constexpr std::uint32_t continues_face = 2;
constexpr std::uint32_t joins_two = 4;

Surface scene_surface(const StoredSurface& stored) {
    Surface surface;
    for (std::size_t k = 0; k < stored.vertices.size(); ++k) {
        surface.vertices[k / 3][static_cast<Vec3::length_type>(k % 3)] = stored.vertices[k];
    }
    surface.vertex_count = stored.vertex_count;
    surface.material = stored.material;
    surface.group = stored.group;
    surface.two_sided = (stored.sides & two_sides) != 0;
    surface.continues = (stored.sides & continues_face) != 0;
    surface.joins = (stored.sides & joins_two) != 0;
    surface.patches = Grid{stored.grid_u, stored.grid_v};
    return surface;
}

} // namespace

std::vector<StoredSurface> stored_surfaces(const PatchMesh& mesh) {
    std::vector<StoredSurface> result;
    result.reserve(mesh.surfaces().size());
    for (std::uint32_t s = 0; s < mesh.surfaces().size(); ++s) {
        const Surface& surface = mesh.surfaces()[s];
        const Grid grid = mesh.grid(s);
        const std::uint32_t sides = (surface.two_sided ? two_sides : 0u) |
                                    (surface.continues ? continues_face : 0u) |
                                    (surface.joins ? joins_two : 0u);
        StoredSurface stored{{},    surface.vertex_count, surface.material, surface.group, sides, grid.u,
                             grid.v};
        for (std::size_t k = 0; k < stored.vertices.size(); ++k) {
            const auto axis = static_cast<Vec3::length_type>(k % 3);
            stored.vertices[k] = k / 3 < surface.vertex_count ? surface.vertices[k / 3][axis] : 0.0;
        }
        result.push_back(stored);
    }
    return result;
}

std::vector<Surface> read_surfaces(Payload payload, std::uint64_t count, std::uint64_t patches,
                                   const std::vector<std::vector<GridPart>>& parts) {
    std::vector<Surface> surfaces;
    std::uint64_t found = 0;
    for (const StoredSurface& stored : payload.take_array<StoredSurface>(count)) {
        if (stored.vertex_count < 3 || stored.vertex_count > 4 ||
            stored.sides > (two_sides | continues_face | joins_two)) {
            payload.fail(
                fmt::format("a surface of {} vertices and sides {}", stored.vertex_count, stored.sides));
        }
        const std::size_t of_surface = parts.empty() ? 0 : parts[surfaces.size()].size();
        const std::uint64_t per_side =
            of_surface > 0 ? of_surface : std::uint64_t{stored.grid_u} * stored.grid_v;
        found += per_side <= most ? per_side * ((stored.sides & two_sides) + 1) : most + 1;
        if (found > patches) {
            break;
        }
        surfaces.push_back(scene_surface(stored));
    }
    if (found != patches) {
        payload.fail(fmt::format("the surfaces have not the {} patches that the file speaks of", patches));
    }
    payload.expect_end();
    return surfaces;
}

} // namespace hemi::io
