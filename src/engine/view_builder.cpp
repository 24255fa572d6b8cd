#include "engine/view_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hemi {

namespace {

// Which side of a plane a vertex is on, for the planes that bound the five pyramids.
enum Side : std::uint8_t {
    z_below_x = 1,
    z_below_minus_x = 2,
    z_below_y = 4,
    z_below_minus_y = 8,
    x_below_y = 16,
    x_below_minus_y = 32,
    z_below_0 = 64,
};

/// A face's pyramid: outside if all vertices are on the named side of one plane. `below` counts vertices
/// below the plane as outside, `above` those that are not below.
struct Pyramid {
    std::uint8_t below;
    std::uint8_t above;
};
constexpr std::array<Pyramid, hemicube_faces> pyramids{{
    {z_below_x | z_below_minus_x | z_below_y | z_below_minus_y, 0},
    {x_below_y | x_below_minus_y | z_below_0, z_below_x},       // +x: x >= z, x >= |y|, z >= 0
    {x_below_minus_y | z_below_0, z_below_y | x_below_y},       // +y: y >= z, y >= |x|
    {z_below_0, z_below_minus_x | x_below_y | x_below_minus_y}, // -x
    {x_below_y | z_below_0, z_below_minus_y | x_below_minus_y}, // -y
}};

} // namespace

void ViewBuilder::add(const EyePoint& eye, const EyeFrame& frame, std::uint32_t slot, DrawStream& stream) {
    transform(eye, frame);
    cull(eye);
    const double scale = 1.0 / near_distance(eye);
    for (const Seen& seen : seen_) {
        emit(seen, scale, slot, stream);
    }
}

void ViewBuilder::transform(const EyePoint& eye, const EyeFrame& frame) {
    positions_.resize(list_.vertices.size());
    sides_.resize(list_.vertices.size());
    for (std::size_t v = 0; v < positions_.size(); ++v) {
        const Vec3 offset = list_.vertices[v] - eye.position;
        const double x = glm::dot(offset, frame.x);
        const double y = glm::dot(offset, frame.y);
        const double z = glm::dot(offset, frame.z);
        positions_[v] = Vec3(x, y, z);
        sides_[v] = static_cast<std::uint8_t>((z < x ? z_below_x : 0) | (z < -x ? z_below_minus_x : 0) |
                                              (z < y ? z_below_y : 0) | (z < -y ? z_below_minus_y : 0) |
                                              (x < y ? x_below_y : 0) | (x < -y ? x_below_minus_y : 0) |
                                              (z < 0.0 ? z_below_0 : 0));
    }
}

void ViewBuilder::cull(const EyePoint& eye) {
    seen_.clear();
    const std::uint32_t own = list_.polygon_of_surface[eye.surface];
    for (std::uint32_t p = 0; p < list_.polygons.size(); ++p) {
        const DrawPolygon& polygon = list_.polygons[p];
        const Vec3 to_eye = eye.position - polygon.centre;
        if (p == own || glm::dot(to_eye, eye.normal) > polygon.radius) {
            continue;
        }
        const Vec3& on_plane = list_.vertices[list_.corners[polygon.first_corner].vertex];
        const double height = glm::dot(eye.position - on_plane, polygon.normal);
        if (std::abs(height) <= list_.tolerance) {
            continue; // edge-on
        }
        std::uint8_t all_below = 0xFF;
        std::uint8_t any_below = 0;
        double highest = -std::numeric_limits<double>::infinity();
        for (std::uint32_t c = 0; c < polygon.corner_count; ++c) {
            const std::uint32_t v = list_.corners[polygon.first_corner + c].vertex;
            all_below &= sides_[v];
            any_below |= sides_[v];
            highest = std::max(highest, positions_[v].z);
        }
        if (highest <= list_.tolerance) {
            continue; // on or behind the eye's plane
        }
        std::uint32_t faces = 0;
        for (std::uint32_t face = 0; face < hemicube_faces; ++face) {
            const Pyramid& pyramid = pyramids[face];
            const bool outside = (all_below & pyramid.below) != 0 || (pyramid.above & ~any_below) != 0;
            faces |= outside ? 0u : 1u << face;
        }
        if (faces != 0) {
            seen_.push_back({p, faces, height < 0.0});
        }
    }
}

double ViewBuilder::near_distance(const EyePoint& eye) const {
    // Face depth is at least distance / sqrt(3); half the distance to the nearest drawn polygon is safe.
    double nearest = std::numeric_limits<double>::infinity();
    std::array<Vec3, 3> triangle;
    for (const Seen& seen : seen_) {
        const DrawPolygon& polygon = list_.polygons[seen.polygon];
        if (glm::length(polygon.centre - eye.position) - polygon.radius >= nearest) {
            continue;
        }
        for (std::uint32_t t = 0; t < polygon.triangle_count; ++t) {
            const auto& corners = list_.triangles[polygon.first_triangle + t];
            for (std::size_t k = 0; k < 3; ++k) {
                triangle[k] = list_.vertices[list_.corners[polygon.first_corner + corners[k]].vertex];
            }
            nearest = std::min(nearest, distance_to_polygon(eye.position, triangle));
        }
    }
    // Only a polygon that passes through the eye itself comes nearer than rounding.
    return 0.5 * std::max(nearest, list_.tolerance);
}

void ViewBuilder::emit(const Seen& seen, double scale, std::uint32_t slot, DrawStream& stream) const {
    const DrawPolygon& polygon = list_.polygons[seen.polygon];
    const std::uint32_t first_id = seen.back ? polygon.back_id : polygon.front_id;
    const bool blocked = first_id == item_blocked;
    DrawVertex vertex{};
    vertex.first_id = first_id;
    vertex.grid = blocked ? (1u | 1u << 16) : (polygon.grid.u | polygon.grid.v << 16);
    vertex.twist_u = polygon.twist_u;
    vertex.twist_v = polygon.twist_v;
    const std::uint32_t split = blocked ? 0u : polygon.split << 31;
    std::vector<DrawVertex>& out = blocked                 ? stream.blocked
                                   : polygon.bilinear != 0 ? stream.bilinear
                                                           : stream.affine;
    for (std::uint32_t face = 0; face < hemicube_faces; ++face) {
        if ((seen.faces & (1u << face)) == 0) {
            continue;
        }
        vertex.view = (slot * 8 + face) | split;
        for (std::uint32_t t = 0; t < polygon.triangle_count; ++t) {
            for (const std::uint32_t c : list_.triangles[polygon.first_triangle + t]) {
                const OutlineCorner& corner = list_.corners[polygon.first_corner + c];
                const Vec3& position = positions_[corner.vertex];
                vertex.x = static_cast<float>(position.x * scale);
                vertex.y = static_cast<float>(position.y * scale);
                vertex.z = static_cast<float>(position.z * scale);
                vertex.grid_u = corner.grid_u;
                vertex.grid_v = corner.grid_v;
                out.push_back(vertex);
            }
        }
    }
}

} // namespace hemi
