// Compiled once for each instruction set, by rasteriser.cpp: included again when HWY_TARGET_TOGGLE changes.
#if defined(HEMI_RASTERISER_VISIBLE_PARTS) == defined(HWY_TARGET_TOGGLE)
#ifdef HEMI_RASTERISER_VISIBLE_PARTS
#undef HEMI_RASTERISER_VISIBLE_PARTS
#else
#define HEMI_RASTERISER_VISIBLE_PARTS
#endif

#include "engine/rasteriser/item_target.ipp"
#include "engine/rasteriser/lanes.ipp"
#include "engine/rasteriser/projection.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace hemi::HWY_NAMESPACE {
namespace {

/// A part of the scene that may be seen.
struct VisiblePart {
    std::uint32_t part; ///< a group of polygons, or a cluster
    std::uint32_t faces;
    std::array<float, 3> centre; ///< of its sphere and box, in the eye's frame
    float radius;
    std::uint32_t distance; ///< of the sphere, in steps of about an eighth
};

/// Parts of the scene whose spheres reach into the pyramids of a hemicube's faces.
class VisibleParts {
public:
    VisibleParts(const RasterScene& scene, const Projection& projection)
        : scene_(scene), projection_(projection) {}

    [[nodiscard]] std::span<const VisiblePart> parts() const { return parts_; }

    /// Those of the projection's eye, by the tests of Projection::faces_of().
    void find() {
        constexpr float slope = 0.70710678f;
        parts_.clear();
        for (std::uint32_t k = 0; k < scene_.spheres[0].size(); k += lanes) {
            std::array<Vec, 3> offset;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                offset[axis] =
                    hn::Sub(hn::Load(floats, &scene_.spheres[axis][k]), set(projection_.high()[axis]));
            }
            std::array<Vec, 3> p;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::array<float, 3>& along = projection_.axes()[axis];
                p[axis] =
                    hn::Add(hn::Add(hn::Mul(set(along[0]), offset[0]), hn::Mul(set(along[1]), offset[1])),
                            hn::Mul(set(along[2]), offset[2]));
            }
            const Vec radius = hn::Load(floats, &scene_.spheres[3][k]);
            const Vec beyond = hn::Neg(radius);
            const Mask above = hn::And(hn::Ge(radius, set(0.0f)), hn::Ge(p[2], beyond));
            if (hn::AllFalse(floats, above)) {
                continue;
            }
            auto faces = hn::Zero(ints);
            for (std::uint32_t face = 0; face < hemicube_faces; ++face) {
                const FaceAxes& axes = face_axes[face];
                const Vec depth = hn::Mul(p[static_cast<std::size_t>(axes.depth)], set(axes.depth_sign));
                const Vec right = p[static_cast<std::size_t>(axes.right)];
                const Vec up = p[static_cast<std::size_t>(axes.up)];
                const Vec below = face == 0 ? hn::Mul(hn::Add(depth, up), set(slope)) : up;
                const Vec nearest = hn::Min(hn::Min(hn::Mul(hn::Sub(depth, hn::Abs(right)), set(slope)),
                                                    hn::Mul(hn::Sub(depth, up), set(slope))),
                                            below);
                const Mask reached = hn::And(above, hn::Ge(nearest, beyond));
                faces = hn::Or(faces, hn::IfThenElseZero(hn::RebindMask(ints, reached),
                                                         hn::Set(ints, std::int32_t{1} << face)));
            }
            alignas(64) Lanes<std::int32_t> faces_of_lane;
            alignas(64) std::array<Lanes<float>, 4> sphere;
            hn::StoreU(faces, ints, faces_of_lane.data());
            for (std::size_t axis = 0; axis < 3; ++axis) {
                hn::StoreU(p[axis], floats, sphere[axis].data());
            }
            hn::StoreU(radius, floats, sphere[3].data());
            for (std::uint32_t bits = bits_of(above); bits != 0; bits &= bits - 1) {
                const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
                if (faces_of_lane[lane] != 0) {
                    parts_.push_back({k + lane,
                                      static_cast<std::uint32_t>(faces_of_lane[lane]),
                                      {sphere[0][lane], sphere[1][lane], sphere[2][lane]},
                                      sphere[3][lane],
                                      0});
                }
            }
        }
    }

    /// Nearest first, about.
    void sort() {
        // Exponents and three bits of the mantissas of distances up to 4, twice the scene's size.
        constexpr std::uint32_t shift = 20;
        constexpr float nearest = 0x1p-32f;
        constexpr float farthest = 4.0f;
        constexpr std::uint32_t first_step = std::bit_cast<std::uint32_t>(nearest) >> shift;
        constexpr std::uint32_t steps = (std::bit_cast<std::uint32_t>(farthest) >> shift) + 1 - first_step;
        std::array<std::uint32_t, steps + 1> begin{};
        for (VisiblePart& part : parts_) {
            const auto [x, y, z] = part.centre;
            const float distance = std::sqrt(x * x + y * y + z * z) - part.radius;
            part.distance =
                (std::bit_cast<std::uint32_t>(std::clamp(distance, nearest, farthest)) >> shift) - first_step;
            ++begin[part.distance + 1];
        }
        for (std::size_t step = 1; step < begin.size(); ++step) {
            begin[step] += begin[step - 1];
        }
        sorted_.resize(parts_.size());
        for (const VisiblePart& part : parts_) {
            sorted_[begin[part.distance]++] = part;
        }
        std::swap(parts_, sorted_);
    }

private:
    const RasterScene& scene_;
    const Projection& projection_;
    std::vector<VisiblePart> parts_;
    std::vector<VisiblePart> sorted_;
};

/// Whether parts of the scene are tested against what was drawn before them: where that pays, which the first
/// hemicubes of every period tell. It changes no texel.
class OcclusionSwitch {
public:
    [[nodiscard]] bool is_on() const { return pays_ || hemicube_ < tried; }
    /// Of a part that was tested.
    void count(bool hidden) {
        ++parts_;
        hidden_ += hidden ? 1 : 0;
    }
    void next_hemicube() {
        ++hemicube_;
        if (hemicube_ == tried) {
            pays_ = least_share * hidden_ > parts_;
        } else if (hemicube_ == period) {
            *this = OcclusionSwitch();
        }
    }

private:
    static constexpr std::uint32_t tried = 8;
    static constexpr std::uint32_t period = 256;
    static constexpr std::uint64_t least_share = 10; ///< one hidden part in so many pays for the tests

    std::uint32_t hemicube_ = 0; ///< of the period
    std::uint64_t parts_ = 0;
    std::uint64_t hidden_ = 0;
    bool pays_ = false;
};

/// Points in the eye's frame: x, y and z, padded to a multiple of point_lanes by repeated ones.
struct FramePoints {
    using Tag = hn::CappedTag<float, RasterScene::corner_slots>;
    static constexpr std::uint32_t lanes =
        HWY_LANES(float) < RasterScene::corner_slots ? HWY_LANES(float) : RasterScene::corner_slots;

    std::array<CacheLineVector<float>, 3> at;
    std::uint32_t count = 0;

    void resize(std::uint32_t padded) {
        count = padded;
        for (CacheLineVector<float>& along : at) {
            along.resize(std::max<std::size_t>(along.size(), padded));
        }
    }

    /// The corners of a box along the axes of the scene.
    /// @param centre  in the eye's frame
    void set_box(const Projection& projection, const std::array<float, 3>& centre,
                 const std::array<float, 3>& extent) {
        constexpr Tag tag;
        alignas(64) static constexpr float signs[3][RasterScene::corner_slots] = {
            {-1, 1, -1, 1, -1, 1, -1, 1}, {-1, -1, 1, 1, -1, -1, 1, 1}, {-1, -1, -1, -1, 1, 1, 1, 1}};
        resize(RasterScene::corner_slots);
        for (std::uint32_t k = 0; k < count; k += lanes) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                auto sum = hn::Set(tag, centre[axis]);
                for (std::size_t along = 0; along < 3; ++along) {
                    sum = hn::Add(sum, hn::Mul(hn::Load(tag, &signs[along][k]),
                                               hn::Set(tag, projection.axes()[axis][along] * extent[along])));
                }
                hn::Store(sum, tag, &at[axis][k]);
            }
        }
    }

    /// Corners of a grid polygon. The same arithmetic as for clusters.
    void set_corners(const RasterScene& scene, const Projection& projection,
                     const RasterScene::GridPolygon& polygon) {
        constexpr Tag tag;
        resize(polygon.corner_slots);
        for (std::uint32_t k = 0; k < count; k += lanes) {
            std::array<hn::Vec<Tag>, 3> offset;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::size_t from = polygon.first_corner + k;
                offset[axis] = hn::Add(hn::Sub(hn::Load(tag, &scene.corner_high[axis][from]),
                                               hn::Set(tag, projection.high()[axis])),
                                       hn::Sub(hn::Load(tag, &scene.corner_low[axis][from]),
                                               hn::Set(tag, projection.low()[axis])));
            }
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::array<float, 3>& along = projection.axes()[axis];
                hn::Store(hn::Add(hn::Add(hn::Mul(hn::Set(tag, along[0]), offset[0]),
                                          hn::Mul(hn::Set(tag, along[1]), offset[1])),
                                  hn::Mul(hn::Set(tag, along[2]), offset[2])),
                          tag, &at[axis][k]);
            }
        }
    }

    [[nodiscard]] std::array<float, 3> point(std::uint32_t k) const { return {at[0][k], at[1][k], at[2][k]}; }
    /// Of all points, along the eye's normal.
    [[nodiscard]] float highest() const {
        constexpr Tag tag;
        auto most = hn::Load(tag, at[2].data());
        for (std::uint32_t k = lanes; k < count; k += lanes) {
            most = hn::Max(most, hn::Load(tag, &at[2][k]));
        }
        return hn::GetLane(hn::MaxOfLanes(tag, most));
    }
};

/// What may be seen of something.
struct Sight {
    std::uint32_t faces;     ///< on which something of it may be seen
    bool covers_any = false; ///< whether it may cover texels at all; of faces on which nothing is seen

    /// Whether others cover all texels that it covers.
    [[nodiscard]] bool is_hidden() const { return faces == 0 && covers_any; }
};
/// What may be seen of the convex hull of some points, behind all that was drawn so far.
/// @param faces  the only ones that matter
/// @param slack  texels that rounding may move points by
inline Sight sight_of(std::uint32_t faces, const FramePoints& points,
                      const Projection& projection, const ItemTarget& target, float slack) {
    constexpr FramePoints::Tag tag;
    constexpr float rounding = 1e-5f; // of 1 / depth, with the bias of fronts
    bool covers_any = false;
    for (std::uint32_t left = faces; left != 0; left &= left - 1) {
        const int face = std::countr_zero(left);
        const FaceAxes& axes = face_axes[static_cast<std::size_t>(face)];
        auto nearest = hn::Set(tag, 1e30f);
        auto x_low = nearest;
        auto y_low = nearest;
        auto x_high = hn::Set(tag, -1e30f);
        auto y_high = x_high;
        for (std::uint32_t k = 0; k < points.count; k += FramePoints::lanes) {
            const auto along = [&](int axis) {
                return hn::Load(tag, &points.at[static_cast<std::size_t>(axis)][k]);
            };
            const auto depth = hn::Mul(along(axes.depth), hn::Set(tag, axes.depth_sign));
            const auto scale = hn::Div(hn::Set(tag, projection.half()), depth);
            const auto x = hn::Mul(hn::Mul(along(axes.right), hn::Set(tag, axes.right_sign)), scale);
            const auto y = hn::Mul(along(axes.up), scale);
            nearest = hn::Min(nearest, depth);
            x_low = hn::Min(x_low, x);
            x_high = hn::Max(x_high, x);
            y_low = hn::Min(y_low, y);
            y_high = hn::Max(y_high, y);
        }
        const float depth = hn::GetLane(hn::MinOfLanes(tag, nearest));
        if (!(depth > 0.0f)) {
            continue; // reaches behind the eye
        }
        const auto texels = [slack](float low, float high, float offset, float last) {
            return std::pair(static_cast<int>(std::clamp(std::ceil(low + offset - slack), 0.0f, last + 1.0f)),
                             static_cast<int>(std::clamp(std::floor(high + offset + slack), -1.0f, last)));
        };
        const auto [x0, x1] =
            texels(hn::GetLane(hn::MinOfLanes(tag, x_low)), hn::GetLane(hn::MaxOfLanes(tag, x_high)),
                   projection.half() - 0.5f, projection.texels() - 1.0f);
        const auto [y0, y1] =
            texels(hn::GetLane(hn::MinOfLanes(tag, y_low)), hn::GetLane(hn::MaxOfLanes(tag, y_high)),
                   projection.offset_y(face), projection.height(face) - 1.0f);
        const bool covers = x0 <= x1 && y0 <= y1;
        if (!covers || target.hides(face, {x0, x1, y0, y1}, (1.0f + rounding) / depth)) {
            faces &= ~(1u << face);
            covers_any = covers_any || covers;
        }
    }
    return {faces, covers_any};
}

} // namespace
} // namespace hemi::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
