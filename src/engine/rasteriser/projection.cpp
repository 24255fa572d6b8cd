#include "engine/rasteriser/projection.hpp"

#include <algorithm>
#include <cmath>

namespace hemi {

namespace {

std::array<int, 4> box_of_projected(std::span<const FaceVertex> outline, float last_x, float last_y) {
    constexpr float slack = 0.01f;
    float left = last_x + 1.0f;
    float right = -1.0f;
    float low = last_y + 1.0f;
    float high = -1.0f;
    for (const FaceVertex& v : outline) {
        left = std::min(left, v.x);
        right = std::max(right, v.x);
        low = std::min(low, v.y);
        high = std::max(high, v.y);
    }
    return {static_cast<int>(std::max(0.0f, std::ceil(left - slack))),
            static_cast<int>(std::min(last_x, std::floor(right + slack))),
            static_cast<int>(std::max(0.0f, std::ceil(low - slack))),
            static_cast<int>(std::min(last_y, std::floor(high + slack)))};
}

} // namespace

void Projection::set(const EyePoint& eye, const EyeFrame& frame) {
    eye_ = &eye;
    frame_ = &frame;
    const auto split = scene_.coordinates.split(eye.position);
    high_ = split.high;
    low_ = split.low;
    const std::array<const Vec3*, 3> axes{&frame.x, &frame.y, &frame.z};
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            axes_[k][axis] = static_cast<float>((*axes[k])[static_cast<int>(axis)]);
        }
    }
}

std::uint32_t Projection::faces_of(const std::array<float, 3>& centre, float radius) const {
    constexpr float slope = 0.70710678f;
    std::array<float, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) {
        p[k] = axes_[k][0] * (centre[0] - high_[0]) + axes_[k][1] * (centre[1] - high_[1]) +
               axes_[k][2] * (centre[2] - high_[2]);
    }
    if (p[2] < -radius) {
        return 0;
    }
    std::uint32_t faces = 0;
    for (std::uint32_t face = 0; face < hemicube_faces; ++face) {
        const FaceAxes& axes = face_axes[face];
        const float depth = p[static_cast<std::size_t>(axes.depth)] * axes.depth_sign;
        const float right = p[static_cast<std::size_t>(axes.right)];
        const float up = p[static_cast<std::size_t>(axes.up)];
        const float below = face == 0 ? (depth + up) * slope : up;
        const float nearest =
            std::min(std::min((depth - std::abs(right)) * slope, (depth - up) * slope), below);
        faces |= (nearest >= -radius ? 1u : 0u) << face;
    }
    return faces;
}

FaceVertex Projection::on_face(int face, const std::array<float, 3>& at) const {
    const FaceAxes& axes = face_axes[static_cast<std::size_t>(face)];
    FaceVertex vertex;
    const float right = at[static_cast<std::size_t>(axes.right)] * axes.right_sign;
    const float up = at[static_cast<std::size_t>(axes.up)];
    const float depth = at[static_cast<std::size_t>(axes.depth)] * axes.depth_sign;
    const float offset_x = half_ - 0.5f;
    const float offset_y = face == 0 ? half_ - 0.5f : -0.5f;
    const float inverse = 1.0f / depth;
    vertex.x = (right * inverse) * half_ + offset_x;
    vertex.y = (up * inverse) * half_ + offset_y;
    vertex.hx = right * half_ + offset_x * depth;
    vertex.hy = up * half_ + offset_y * depth;
    vertex.hw = depth;
    vertex.projects = depth > 0.0f && std::abs(vertex.x) < guard_ && std::abs(vertex.y) < guard_;
    return vertex;
}

std::array<float, 3> Projection::corner(std::size_t slot) const {
    std::array<float, 3> offset{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        offset[axis] =
            (scene_.corner_high[axis][slot] - high_[axis]) + (scene_.corner_low[axis][slot] - low_[axis]);
    }
    std::array<float, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        at[axis] = (axes_[axis][0] * offset[0] + axes_[axis][1] * offset[1]) + axes_[axis][2] * offset[2];
    }
    return at;
}

Vec3 Projection::in_frame(const Vec3& v) const {
    return {glm::dot(v, frame_->x), glm::dot(v, frame_->y), glm::dot(v, frame_->z)};
}

Affine Projection::on_texels(int face, const Vec3& local, double factor) const {
    const Vec3 depth = face_direction(face, 0.0, 0.0);
    const Vec3 right = face_direction(face, 1.0, 0.0) - depth;
    const Vec3 up = face_direction(face, 0.0, 1.0) - depth;
    const auto half = static_cast<double>(half_);
    const double per_x = glm::dot(local, right) * factor / half;
    const double per_y = glm::dot(local, up) * factor / half;
    const double offset_y = face == 0 ? half - 0.5 : -0.5;
    return {glm::dot(local, depth) * factor - per_x * (half - 0.5) - per_y * offset_y, per_x, per_y};
}

double Projection::height_above(std::uint32_t polygon) const {
    const DrawPolygon& drawn = scene_.list.polygons[polygon];
    const Vec3& on_plane = scene_.list.vertices[scene_.list.corners[drawn.first_corner].vertex];
    return glm::dot(eye_->position - on_plane, drawn.normal);
}

bool Projection::outside(int face, std::span<const FaceVertex> outline) const {
    const float last_x = texels_ - 1.0f;
    const float last_y = (face == 0 ? texels_ : half_) - 1.0f;
    bool left = true;
    bool right = true;
    bool low = true;
    bool high = true;
    for (const FaceVertex& v : outline) {
        // Half a texel of slack is more than any rounding.
        left = left && v.hx < -0.5f * v.hw;
        right = right && v.hx > (last_x + 0.5f) * v.hw;
        low = low && v.hy < -0.5f * v.hw;
        high = high && v.hy > (last_y + 0.5f) * v.hw;
    }
    return left || right || low || high;
}

std::array<int, 4> Projection::box_of(int face, std::span<const FaceVertex> outline) const {
    const double last_x = static_cast<double>(texels_) - 1.0;
    const double last_y = static_cast<double>(face == 0 ? texels_ : half_) - 1.0;
    if (std::all_of(outline.begin(), outline.end(), [](const FaceVertex& v) { return v.projects; })) {
        return box_of_projected(outline, static_cast<float>(last_x), static_cast<float>(last_y));
    }
    // Clipped to the face and half a texel round it, in homogeneous coordinates.
    struct Point {
        double x, y, w;
    };
    std::array<Point, 20> from{};
    std::array<Point, 20> to{};
    std::size_t count = 0;
    for (const FaceVertex& v : outline) {
        from[count++] = {static_cast<double>(v.hx), static_cast<double>(v.hy), static_cast<double>(v.hw)};
    }
    for (int side = 0; side < 4; ++side) {
        const auto distance = [&](const Point& p) {
            switch (side) {
            case 0:
                return p.x + 0.5 * p.w;
            case 1:
                return (last_x + 0.5) * p.w - p.x;
            case 2:
                return p.y + 0.5 * p.w;
            default:
                return (last_y + 0.5) * p.w - p.y;
            }
        };
        std::size_t kept = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const Point& a = from[k];
            const Point& b = from[k + 1 < count ? k + 1 : 0];
            const double d_a = distance(a);
            const double d_b = distance(b);
            if (d_a >= 0.0) {
                to[kept++] = a;
            }
            if ((d_a >= 0.0) != (d_b >= 0.0)) {
                const double t = d_a / (d_a - d_b);
                to[kept++] = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.w + t * (b.w - a.w)};
            }
        }
        count = kept;
        std::swap(from, to);
    }
    double left = last_x + 1.0;
    double right = -1.0;
    double low = last_y + 1.0;
    double high = -1.0;
    for (std::size_t k = 0; k < count; ++k) {
        const Point& p = from[k];
        if (!(p.w > 0.0)) { // at the eye itself
            return {0, static_cast<int>(last_x), 0, static_cast<int>(last_y)};
        }
        left = std::min(left, p.x / p.w);
        right = std::max(right, p.x / p.w);
        low = std::min(low, p.y / p.w);
        high = std::max(high, p.y / p.w);
    }
    constexpr double slack = 0.01;
    return {static_cast<int>(std::max(0.0, std::ceil(left - slack))),
            static_cast<int>(std::min(last_x, std::floor(right + slack))),
            static_cast<int>(std::max(0.0, std::ceil(low - slack))),
            static_cast<int>(std::min(last_y, std::floor(high + slack)))};
}

} // namespace hemi
