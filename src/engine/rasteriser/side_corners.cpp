#include "engine/rasteriser/side_corners.hpp"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hemi {

namespace {

constexpr double most_margin = 0.009; // below that of FaceOutline::row()

} // namespace

SideCorners::SideCorners(const RasterScene& scene, const Projection& projection, std::uint32_t grid,
                         bool front) {
    if (scene.grid_polygons[grid].sides < scene.grid_polygons[grid].corner_count) {
        scene_ = &scene;
        projection_ = &projection;
        grid_ = grid;
        front_ = front;
    }
}

std::uint32_t SideCorners::end_of(std::uint32_t side) const {
    const RasterScene::GridPolygon& drawn = polygon();
    return side + 1 < drawn.sides ? drawn.side_begin[side + 1] : drawn.side_begin[0] + drawn.corner_count;
}

std::size_t SideCorners::slot(std::uint32_t corner) const {
    const RasterScene::GridPolygon& drawn = polygon();
    return std::size_t{drawn.first_corner} + corner % drawn.corner_count;
}

float SideCorners::margin() const {
    if (!any()) {
        return 0.0f;
    }
    // A texel shows nothing nearer than the line's distance over sqrt(3): there a length is seen under less
    // than 3.2 times half() over that distance texels.
    constexpr double rounding = 3e-7; // of positions in the eye's frame
    const double on_face = 4e-6 * static_cast<double>(projection_->texels());
    const RasterScene::GridPolygon& drawn = polygon();
    const double seen =
        3.2 * static_cast<double>(projection_->half()) * (static_cast<double>(drawn.bend) + rounding);
    double nearest = std::numeric_limits<double>::infinity(); // squared
    for (std::uint32_t side = 0; side < drawn.sides; ++side) {
        if (end_of(side) == drawn.side_begin[side] + 1) {
            continue;
        }
        const std::array<float, 3> a = projection_->corner(slot(drawn.side_begin[side]));
        const std::array<float, 3> b = projection_->corner(slot(end_of(side)));
        const Vec3 from(a[0], a[1], a[2]);
        const Vec3 along = Vec3(b[0], b[1], b[2]) - from;
        const Vec3 cross = glm::cross(from, along);
        nearest = std::min(nearest, glm::dot(cross, cross) / glm::dot(along, along));
    }
    const double margin = seen / std::sqrt(nearest) + on_face;
    return margin < most_margin ? static_cast<float>(margin) : std::numeric_limits<float>::infinity();
}

bool SideCorners::contain(int face, const FaceOutline& outline, float x, float y) const {
    const auto product = [x, y](const FaceEdge& e) {
        return (e.ax - x * e.aw) * (e.by - y * e.bw) - (e.ay - y * e.aw) * (e.bx - x * e.bw);
    };
    for (std::size_t k = 0; k < outline.edges().size(); ++k) {
        FaceEdge e = outline.edges()[k];
        float value = product(e);
        if (std::abs(value) < outline.near()[k]) {
            e = part_at(face, k, x, y);
            value = product(e);
        }
        if (!(e.in ? value >= 0.0f : value > 0.0f)) {
            return false;
        }
    }
    return true;
}

FaceEdge SideCorners::part_at(int face, std::size_t edge, float x, float y) const {
    const RasterScene::GridPolygon& drawn = polygon();
    const auto of_outline = static_cast<std::uint32_t>(edge);
    // Outlines are counter-clockwise on the face: fronts run backwards.
    const std::uint32_t side = front_ ? (2 * drawn.sides - 2 - of_outline) % drawn.sides : of_outline;
    const std::uint32_t begin = drawn.side_begin[side];
    const std::uint32_t end = end_of(side);
    const auto on_face = [&](std::uint32_t corner) {
        return projection_->on_face(face, projection_->corner(slot(corner)));
    };
    // The texel is (1 - along) a + along b, in homogeneous coordinates, and something across the side.
    const FaceVertex a = on_face(begin);
    const FaceVertex b = on_face(end);
    const auto from_texel = [x, y](const FaceVertex& v) {
        const auto w = static_cast<double>(v.hw);
        return glm::dvec2(static_cast<double>(v.hx) - static_cast<double>(x) * w,
                          static_cast<double>(v.hy) - static_cast<double>(y) * w);
    };
    const glm::dvec2 to_a = from_texel(a);
    const glm::dvec2 across = to_a - from_texel(b);
    const double along = glm::dot(to_a, across) / glm::dot(across, across);
    std::uint32_t next = begin + 1;
    while (next < end && scene_->corner_along[slot(next)] < along) {
        ++next;
    }
    const FaceVertex from = on_face(next - 1);
    const FaceVertex to = on_face(next);
    return front_ ? make_edge(to, from) : make_edge(from, to);
}

} // namespace hemi
