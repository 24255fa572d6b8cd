#include "hemi/scene/near_surface.hpp"

#include "core/box_tree.hpp"
#include "core/parallel_for.hpp"
#include "scene/convex_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace hemi {

namespace {

struct SamplePoint {
    Vec3 position;
    double border_distance; ///< 0 on the border
};

/// Points of a regular lattice over a patch, its border included.
std::vector<SamplePoint> sample_points(const PatchCorners& corners) {
    const auto& p = corners.points;
    std::vector<SamplePoint> points;
    const auto add = [&](const Vec3& position, bool on_border) {
        double distance = on_border ? 0.0 : std::numeric_limits<double>::infinity();
        for (std::size_t c = 0; c < corners.count && !on_border; ++c) {
            const Vec3 edge = p[(c + 1) % corners.count] - p[c];
            distance = std::min(distance, glm::length(glm::cross(edge, position - p[c])) / glm::length(edge));
        }
        points.push_back({position, distance});
    };
    if (corners.count == 3) {
        constexpr int cuts = 5;
        for (int v = 0; v <= cuts; ++v) {
            for (int u = 0; u + v <= cuts; ++u) {
                const Vec3 along =
                    static_cast<double>(u) * (p[1] - p[0]) + static_cast<double>(v) * (p[2] - p[0]);
                add(p[0] + along / static_cast<double>(cuts), u == 0 || v == 0 || u + v == cuts);
            }
        }
        return points;
    }
    constexpr int cuts = 4;
    for (int v = 0; v <= cuts; ++v) {
        for (int u = 0; u <= cuts; ++u) {
            const double a = static_cast<double>(u) / cuts;
            const double b = static_cast<double>(v) / cuts;
            add((1.0 - b) * ((1.0 - a) * p[0] + a * p[1]) + b * ((1.0 - a) * p[3] + a * p[2]),
                u == 0 || u == cuts || v == 0 || v == cuts);
        }
    }
    return points;
}

/// Gap between a patch and a surface, in patch sizes; nothing if it does not matter.
std::optional<double> gap_between(std::span<const SamplePoint> points, double size,
                                  std::span<const Vec3> polygon, double rounding) {
    double nearest = std::numeric_limits<double>::infinity();
    double nearest_inside = nearest;
    bool meets_border = false;
    bool leans_over = false;
    for (const SamplePoint& point : points) {
        const double distance = distance_to_polygon(point.position, polygon);
        nearest = std::min(nearest, distance);
        if (point.border_distance == 0.0) {
            meets_border = meets_border || distance <= rounding;
        } else {
            nearest_inside = std::min(nearest_inside, distance);
            // What stands upright on the border is as far from an inner point as the border itself.
            leans_over = leans_over || distance < 0.5 * point.border_distance;
        }
    }
    if (meets_border && !leans_over) {
        return std::nullopt;
    }
    const double gap = (meets_border ? nearest_inside : nearest) / size;
    return gap < near_gap ? std::optional(gap) : std::nullopt;
}

} // namespace

std::vector<NearSurface> find_near_surfaces(const PatchMesh& mesh) {
    std::vector<Bounds> boxes;
    for (const Surface& surface : mesh.surfaces()) {
        boxes.push_back(bounds_of(surface.polygon()));
    }
    const BoxTree tree(boxes);
    const double rounding = mesh.rounding();
    std::vector<NearSurface> found(mesh.size());
    parallel_for(mesh.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto patch = static_cast<std::uint32_t>(k);
            const PatchCorners corners = mesh.corners(patch);
            const auto points = sample_points(corners);
            const double size = std::sqrt(mesh.areas()[patch]);
            const Vec3 normal = mesh.normal(patch);
            const Bounds around = bounds_of(corners.polygon(), near_gap * size);
            NearSurface& nearest = found[k];
            nearest = {patch, 0, near_gap};
            tree.overlapping(around, [&](std::uint32_t s) {
                const auto polygon = mesh.surfaces()[s].polygon();
                const bool in_front = std::any_of(polygon.begin(), polygon.end(), [&](const Vec3& vertex) {
                    return glm::dot(vertex - corners.points[0], normal) > rounding;
                });
                if (s == mesh.surface_of()[patch] || !in_front) {
                    return;
                }
                const auto gap = gap_between(points, size, polygon, rounding);
                if (gap && (*gap < nearest.gap || (*gap == nearest.gap && s < nearest.surface))) {
                    nearest.gap = *gap;
                    nearest.surface = s;
                }
            });
        }
    });
    std::erase_if(found, [](const NearSurface& near) { return near.gap >= near_gap; });
    return found;
}

} // namespace hemi
