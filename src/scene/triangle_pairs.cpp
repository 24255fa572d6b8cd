#include "hemi/scene/triangle_pairs.hpp"

#include <cmath>
#include <optional>

namespace hemi {

namespace {

/// Corners of a quadrilateral that turn less than this (its sine) are no corners to cut patches from.
constexpr double least_turn = 0.1;

bool has_corners(const Surface& quadrilateral) {
    const auto& p = quadrilateral.vertices;
    const Vec3 normal = glm::normalize(area_vector(quadrilateral.polygon()));
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3 in = p[k] - p[(k + 3) % 4];
        const Vec3 out = p[(k + 1) % 4] - p[k];
        if (!(glm::dot(glm::cross(in, out), normal) > least_turn * glm::length(in) * glm::length(out))) {
            return false;
        }
    }
    return true;
}

bool alike(const Surface& a, const Surface& b) {
    return a.vertex_count == 3 && b.vertex_count == 3 && a.group == b.group && a.material == b.material &&
           a.heat == b.heat && a.two_sided == b.two_sided;
}

/// The quadrilateral whose halves two triangles are.
std::optional<Surface> joined(const Surface& first, const Surface& second) {
    if (!alike(first, second)) {
        return std::nullopt;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t m = 0; m < 3; ++m) {
            if (first.vertices[k] != second.vertices[(m + 1) % 3] ||
                first.vertices[(k + 1) % 3] != second.vertices[m]) {
                continue;
            }
            Surface whole = first;
            whole.vertex_count = 4;
            whole.joins = true;
            for (std::size_t corner = 0, at = 0; corner < 3; ++corner) {
                whole.vertices[at++] = first.vertices[corner];
                if (corner == k) {
                    whole.vertices[at++] = second.vertices[(m + 2) % 3];
                }
            }
            return !polygon_defect(whole.polygon()) && has_corners(whole) ? std::optional(whole)
                                                                          : std::nullopt;
        }
    }
    return std::nullopt;
}

std::uint64_t cells(const Surface& surface, double patch_size) {
    const Grid grid = grid_for_size(surface, patch_size);
    return std::uint64_t{grid.u} * grid.v;
}

} // namespace

void join_triangle_pairs(Scene& scene, const Subdivision& subdivision) {
    const std::optional<double> size = subdivision.patch_size         ? subdivision.patch_size
                                       : subdivision.patches_per_face ? std::nullopt
                                                                      : scene.patch_size;
    if (!size || !(*size > 0.0)) { // which a mesh refuses
        return;
    }
    const std::vector<Surface>& all = scene.surfaces;
    const auto is_cut = [&](std::size_t s) { // by the size; pieces of a face are no triangles of the file
        const bool in_pieces = all[s].continues || (s + 1 < all.size() && all[s + 1].continues);
        return all[s].vertex_count == 3 && !in_pieces && (subdivision.patch_size || !all[s].patches);
    };
    std::vector<Surface> kept;
    kept.reserve(all.size());
    for (std::size_t s = 0; s < all.size(); ++s) {
        if (s + 1 < all.size() && is_cut(s) && is_cut(s + 1)) {
            const std::uint64_t halves = cells(all[s], *size) + cells(all[s + 1], *size);
            const std::optional<Surface> whole = halves > 2 ? joined(all[s], all[s + 1]) : std::nullopt;
            if (whole && cells(*whole, *size) < halves) {
                kept.push_back(*whole);
                ++s;
                continue;
            }
        }
        kept.push_back(all[s]);
    }
    scene.surfaces = std::move(kept);
}

} // namespace hemi
