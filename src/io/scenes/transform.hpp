#pragma once

#include "hemi/core/geometry.hpp"

#include <array>

namespace hemi::io {

/// How a mesh is placed in a scene: scaled along its axes, rotated about x, then y, then z, then moved.
struct Transform {
    Vec3 scale{1.0};
    Vec3 degrees{0.0};
    Vec3 translate{0.0};

    /// Whether it turns fronts into backs, unless the order of vertices is reversed.
    [[nodiscard]] bool mirrors() const { return scale.x * scale.y * scale.z < 0.0; }
};

/// A transform made ready for many points.
class Placement {
public:
    explicit Placement(const Transform& transform);
    [[nodiscard]] Vec3 operator()(const Vec3& point) const;

private:
    std::array<Vec3, 3> columns_;
    Vec3 translate_;
};

} // namespace hemi::io
