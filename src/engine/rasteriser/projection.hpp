#pragma once

#include "engine/hemicube/eye.hpp"
#include "engine/rasteriser/raster_scene.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace hemi {

/// Axes of a face in the eye's frame, as face_direction(): which coordinate with which sign.
struct FaceAxes {
    int right, depth;
    float right_sign, depth_sign;
    int up;
};
inline constexpr std::array<FaceAxes, hemicube_faces> face_axes{{{0, 2, 1.0f, 1.0f, 1},
                                                                 {1, 0, 1.0f, 1.0f, 2},
                                                                 {0, 1, -1.0f, 1.0f, 2},
                                                                 {1, 0, -1.0f, -1.0f, 2},
                                                                 {0, 1, 1.0f, -1.0f, 2}}};

/// A vertex on a face.
struct FaceVertex {
    float x = 0.0f, y = 0.0f;              ///< in texels, where `projects`
    float hx = 0.0f, hy = 0.0f, hw = 0.0f; ///< homogeneous: x = hx / hw
    bool projects = false;
};
/// c + x·i + y·j at texel (i, j) of a face.
struct Affine {
    double c = 0.0, x = 0.0, y = 0.0;

    [[nodiscard]] double at(double i, double j) const { return c + x * i + y * j; }
};

/// How one eye sees positions: in its own frame, and on the faces of its hemicube. Raster coordinates and
/// floats, with the same arithmetic as the SIMD code for clusters, so that shared vertices are the same bits.
class Projection {
public:
    Projection(const RasterScene& scene, std::uint32_t resolution)
        : scene_(scene), texels_(static_cast<float>(resolution)), half_(0.5f * texels_),
          guard_(4.0f * texels_) {}

    /// Both must live until the next call.
    void set(const EyePoint& eye, const EyeFrame& frame);

    [[nodiscard]] const EyePoint& eye() const { return *eye_; }
    /// The eye as two floats, and the axes of its frame.
    [[nodiscard]] const std::array<float, 3>& high() const { return high_; }
    [[nodiscard]] const std::array<float, 3>& low() const { return low_; }
    [[nodiscard]] const std::array<std::array<float, 3>, 3>& axes() const { return axes_; }
    /// Of a face's edge, and half of it, in texels.
    [[nodiscard]] float texels() const { return texels_; }
    [[nodiscard]] float half() const { return half_; }
    /// Vertices project where they are nearer than this, in texels: further out floats are too coarse.
    [[nodiscard]] float guard() const { return guard_; }
    [[nodiscard]] float height(int face) const { return face == 0 ? texels_ : half_; }
    /// What is added to up / depth times half() to count rows from the first texel's centre.
    [[nodiscard]] float offset_y(int face) const { return face == 0 ? half_ - 0.5f : -0.5f; }

    /// Faces whose pyramids a sphere in raster coordinates reaches into: bit per face.
    [[nodiscard]] std::uint32_t faces_of(const std::array<float, 3>& centre, float radius) const;
    /// @param at  in the eye's frame
    [[nodiscard]] FaceVertex on_face(int face, const std::array<float, 3>& at) const;
    /// A corner of a grid polygon, in the eye's frame.
    /// @param slot  of RasterScene::corner_high
    [[nodiscard]] std::array<float, 3> corner(std::size_t slot) const;
    /// A direction in the eye's frame.
    [[nodiscard]] Vec3 in_frame(const Vec3& v) const;
    /// factor · (local · direction) of the direction through texel (i, j).
    /// @param local  in the eye's frame
    [[nodiscard]] Affine on_texels(int face, const Vec3& local, double factor) const;
    /// Height of the eye above a polygon's plane, in scene units.
    [[nodiscard]] double height_above(std::uint32_t polygon) const;
    /// Whether all vertices of an outline are beyond one side of a face.
    [[nodiscard]] bool outside(int face, std::span<const FaceVertex> outline) const;
    /// Texels left, right, low and high that an outline may cover; left > right or low > high: none.
    [[nodiscard]] std::array<int, 4> box_of(int face, std::span<const FaceVertex> outline) const;

private:
    const RasterScene& scene_;
    float texels_;
    float half_;
    float guard_;
    const EyePoint* eye_ = nullptr;
    const EyeFrame* frame_ = nullptr;
    std::array<float, 3> high_{};
    std::array<float, 3> low_{};
    std::array<std::array<float, 3>, 3> axes_{};
};

} // namespace hemi
