#pragma once

#include "hemi/core/geometry.hpp"

#include <embree3/rtcore.h>

#include <array>
#include <span>

namespace hemi {

/// Polygons for Embree to meet: primitive k of the scene is polygon k.
///
/// They are moved to the origin and scaled so that their bounds' diagonal is 2 before they become float.
class EmbreeScene {
public:
    /// Three or four corners; a triangle's last two are equal.
    using Quad = std::array<Vec3, 4>;
    [[nodiscard]] static Quad quad(std::span<const Vec3> polygon);

    /// @param bounds  of the polygons
    /// @param flags  of Embree's scene
    /// @throws Error if Embree cannot be set up, OutOfMemory if it has no memory for the polygons.
    EmbreeScene(const Bounds& bounds, std::span<const Quad> polygons, RTCSceneFlags flags);
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;
    ~EmbreeScene();

    [[nodiscard]] RTCScene handle() const noexcept { return scene_; }
    /// Lengths in the scene's own coordinates over lengths in the units of the bounds.
    [[nodiscard]] double scale() const noexcept { return scale_; }
    /// The ray from `origin` (in the units of the bounds) over `direction` times 0 to `far` (in the scene's
    /// own).
    [[nodiscard]] RTCRay ray(const Vec3& origin, const Vec3& direction, float far) const;

private:
    Vec3 centre_;
    double scale_;
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
};

} // namespace hemi
