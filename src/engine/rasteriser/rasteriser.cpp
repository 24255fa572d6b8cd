#include "engine/rasteriser/rasteriser.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <tuple>

// One source for all instruction sets: this file is compiled once for each by foreach_target.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/rasteriser/rasteriser.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#include <hwy/foreach_target.h> // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hemi::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using Ids = hn::RebindToUnsigned<Floats>;
using Vec = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;
constexpr Floats floats;
constexpr Ints ints;
constexpr Ids ids_of;
constexpr std::uint32_t lanes = HWY_LANES(float) < 16 ? HWY_LANES(float) : 16;
constexpr std::uint32_t tile_size = TexelTiles::tile_size;
constexpr std::uint32_t cluster_size = RasterScene::cluster_size;

// Fronts are nearer than backs by this, a part of the distance.
constexpr float front_bias = 1.0f + 0x1p-20f;
// Triangles that may cover up to so many texel centres are tested side by side, one in each lane.
constexpr float max_small = 6.0f;
// How far beyond a texel's centre a vertex may lie and still count as at it.
constexpr float centre_slack = 1e-3f;

HWY_INLINE Vec set(float value) {
    return hn::Set(floats, value);
}
/// Bit per lane.
HWY_INLINE std::uint32_t bits_of(Mask mask) {
#if HWY_TARGET == HWY_AVX3
    return static_cast<std::uint32_t>(mask.raw);
#else
    std::array<std::uint8_t, 8> bytes{};
    hn::StoreMaskBits(floats, mask, bytes.data());
    return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8;
#endif
}
/// Twice the area of (a, b, p), a and b relative to p: positive where p lies left of a -> b. Exactly the
/// negative of the same with a and b exchanged, since nothing is fused.
HWY_INLINE Vec edge(Vec ax, Vec ay, Vec bx, Vec by) {
    return hn::Sub(hn::Mul(ax, by), hn::Mul(ay, bx));
}
/// Elements `index` of a table of 64 floats.
HWY_INLINE Vec look_up(const float* table, hn::Vec<Ints> index) {
#if HWY_TARGET == HWY_AVX3
    const __m512 low = _mm512_permutex2var_ps(_mm512_load_ps(table), index.raw, _mm512_load_ps(table + 16));
    const __m512 high =
        _mm512_permutex2var_ps(_mm512_load_ps(table + 32), index.raw, _mm512_load_ps(table + 48));
    return Vec{_mm512_mask_blend_ps(_mm512_test_epi32_mask(index.raw, _mm512_set1_epi32(32)), low, high)};
#else
    return hn::GatherIndex(floats, table, index);
#endif
}
HWY_INLINE hn::Vec<Ints> load_bytes(const std::uint8_t* bytes) {
    return hn::PromoteTo(ints, hn::LoadU(hn::Rebind<std::uint8_t, Ints>(), bytes));
}

/// Axes of a face in the eye's frame, as face_direction(): which coordinate with which sign.
struct FaceAxes {
    int right, depth;
    float right_sign, depth_sign;
    int up;
};
constexpr std::array<FaceAxes, hemicube_faces> face_axes{{{0, 2, 1.0f, 1.0f, 1},
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
/// An edge of a polygon that is drawn alone.
struct FaceEdge {
    float ax, ay, aw, bx, by, bw;
    bool in; ///< whether points on it count as inside: in one of the two polygons that share it
};
/// c + x·i + y·j at texel (i, j) of a face.
struct Affine {
    double c = 0.0, x = 0.0, y = 0.0;

    [[nodiscard]] double at(double i, double j) const { return c + x * i + y * j; }
};
/// What the texels of a polygon show.
struct Shown {
    std::uint32_t first_id = 0;
    bool cells = false; ///< ids by cell, as the shaders derive them
    Affine u, v;        ///< times 1 / depth; relative to base cells
    float base_u = 0.0f, base_v = 0.0f;
    float grid_u = 1.0f, grid_v = 1.0f;
    bool split = false;
    bool bilinear = false;
    float twist_u = 0.0f, twist_v = 0.0f;
};

template <class T>
using Lanes = std::array<T, lanes>;

/// Triangles that may cover few texels, collected until they fill all lanes several times.
struct SmallTriangles {
    static constexpr std::uint32_t capacity = 256;
    static constexpr std::uint32_t space = capacity + 2 * 16;
    using Column = std::array<float, space>;

    std::array<Column, 3> x, y, z;
    Column left, right, low, high; ///< box in texels
    std::array<std::uint32_t, space> id;
    std::array<std::uint32_t, space> face_first; ///< first texel of the face
    std::uint32_t count = 0;
};

class SimdRasteriser final : public Rasteriser {
public:
    SimdRasteriser(const RasterScene& scene, const TexelTiles& tiles)
        : scene_(scene), tiles_(tiles), ids_(tiles.size()), depth_(tiles.size()),
          texels_(static_cast<float>(tiles.resolution())), half_(0.5f * texels_), guard_(4.0f * texels_),
          across_(tiles.across()), padded_(tiles.resolution() % 8 != 0) {
        for (std::uint32_t k = 0; k < tile_size; ++k) {
            tile_x_[k] = static_cast<float>(k % 4);
            tile_y_[k] = static_cast<float>(k / 4);
        }
        tolerance_ = scene.list.tolerance;
        near_plane_ = static_cast<float>(tolerance_ * scene.scale) + 2e-6f;
    }

    void draw(const EyePoint& eye, const EyeFrame& frame, const TileWeights* weights,
              Coverage* coverage) override {
        begin(eye, frame);
        weights_ = weights;
        coverage_ = coverage;
        if (coverage != nullptr) {
            draw_all<true>();
        } else {
            draw_all<false>();
        }
    }

    [[nodiscard]] std::span<const std::uint32_t> ids() const override { return ids_; }

private:
    struct Candidate {
        std::uint32_t cluster;
        std::uint32_t faces;
    };

    void begin(const EyePoint& eye, const EyeFrame& frame) {
        eye_ = &eye;
        frame_ = &frame;
        own_polygon_ = scene_.list.polygon_of_surface[eye.surface];
        const auto split = scene_.split(eye.position);
        eye_high_ = split.high;
        eye_low_ = split.low;
        const std::array<const Vec3*, 3> axes{&frame.x, &frame.y, &frame.z};
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                axes_[k][axis] = static_cast<float>((*axes[k])[static_cast<int>(axis)]);
            }
        }
        std::fill(ids_.begin(), ids_.end(), item_nothing);
        std::fill(depth_.begin(), depth_.end(), 0.0f);
        small_.count = 0;
    }

    template <bool covering>
    void draw_all() {
        for (const RasterScene::GridPolygon& polygon : scene_.grid_polygons) {
            draw_grid_polygon<covering>(polygon);
        }
        find_candidates();
        for (const Candidate& candidate : candidates_) {
            draw_cluster<covering>(candidate);
        }
        flush<covering>(small_.count);
    }

    /// Clusters that reach into the faces' pyramids.
    void find_candidates() {
        candidates_.clear();
        const float slope = std::sqrt(0.5f);
        for (std::uint32_t c = 0; c < scene_.clusters.size(); ++c) {
            const TriangleCluster& cluster = scene_.clusters[c];
            std::array<float, 3> offset{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                offset[axis] = cluster.centre[axis] - eye_high_[axis];
            }
            std::array<float, 3> p{};
            for (std::size_t k = 0; k < 3; ++k) {
                p[k] = axes_[k][0] * offset[0] + axes_[k][1] * offset[1] + axes_[k][2] * offset[2];
            }
            const float radius = cluster.radius;
            if (p[2] < -radius) {
                continue;
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
            if (faces != 0) {
                candidates_.push_back({c, faces});
            }
        }
    }

    /// Positions of vertices in the eye's frame. The same arithmetic as in_eye_frame().
    void transform(std::size_t first, std::uint32_t count) {
        const std::array<Vec, 3> high{set(eye_high_[0]), set(eye_high_[1]), set(eye_high_[2])};
        const std::array<Vec, 3> low{set(eye_low_[0]), set(eye_low_[1]), set(eye_low_[2])};
        for (std::uint32_t k = 0; k < count; k += lanes) {
            std::array<Vec, 3> offset;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                offset[axis] =
                    hn::Add(hn::Sub(hn::Load(floats, &scene_.vertex_high[axis][first + k]), high[axis]),
                            hn::Sub(hn::Load(floats, &scene_.vertex_low[axis][first + k]), low[axis]));
            }
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const Vec at = hn::Add(
                    hn::Add(hn::Mul(set(axes_[axis][0]), offset[0]), hn::Mul(set(axes_[axis][1]), offset[1])),
                    hn::Mul(set(axes_[axis][2]), offset[2]));
                hn::Store(at, floats, &local_[axis][k]);
            }
        }
    }
    [[nodiscard]] std::array<float, 3> in_eye_frame(const Vec3& position) const {
        const auto split = scene_.split(position);
        std::array<float, 3> offset{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            offset[axis] = (split.high[axis] - eye_high_[axis]) + (split.low[axis] - eye_low_[axis]);
        }
        std::array<float, 3> at{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            at[axis] = (axes_[axis][0] * offset[0] + axes_[axis][1] * offset[1]) + axes_[axis][2] * offset[2];
        }
        return at;
    }
    /// As the vertices of clusters.
    [[nodiscard]] FaceVertex on_face(int face, const std::array<float, 3>& at) const {
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

    template <bool covering>
    void draw_cluster(const Candidate& candidate) {
        const TriangleCluster& cluster = scene_.clusters[candidate.cluster];
        const std::size_t first = std::size_t{candidate.cluster} * cluster_size;
        transform(first, cluster.vertices);
        find_sides(first, cluster.triangles);
        for (std::uint32_t faces = candidate.faces; faces != 0; faces &= faces - 1) {
            draw_cluster_on<covering>(std::countr_zero(faces), first, cluster);
        }
    }

    /// Which side of its plane every triangle of a cluster shows: side_ > 0 the front, < 0 the back, 0 where
    /// the triangle is not drawn.
    void find_sides(std::size_t first, std::uint32_t count) {
        const Vec ex = set(eye_high_[0]);
        const Vec ey = set(eye_high_[1]);
        const Vec ez = set(eye_high_[2]);
        for (std::uint32_t t = 0; t < count; t += lanes) {
            const Vec height =
                hn::Sub(hn::Add(hn::Add(hn::Mul(hn::Load(floats, &scene_.plane[0][first + t]), ex),
                                        hn::Mul(hn::Load(floats, &scene_.plane[1][first + t]), ey)),
                                hn::Mul(hn::Load(floats, &scene_.plane[2][first + t]), ez)),
                        hn::Load(floats, &scene_.plane[3][first + t]));
            hn::Store(height, floats, &side_[t]);
            const Mask close =
                hn::And(hn::Lt(hn::Abs(height), set(near_plane_)), hn::FirstN(floats, count - t));
            for (std::uint32_t bits = bits_of(close); bits != 0; bits &= bits - 1) {
                const std::uint32_t k = t + static_cast<std::uint32_t>(std::countr_zero(bits));
                const double exact = height_above(scene_.polygon[first + k]);
                side_[k] = scene_.polygon[first + k] == own_polygon_ || std::abs(exact) <= tolerance_ ? 0.0f
                           : exact > 0.0                                                              ? 1.0f
                                                                                                      : -1.0f;
            }
        }
    }
    /// Height of the eye above a polygon's plane.
    [[nodiscard]] double height_above(std::uint32_t polygon) const {
        const DrawPolygon& drawn = scene_.list.polygons[polygon];
        const Vec3& on_plane = scene_.list.vertices[scene_.list.corners[drawn.first_corner].vertex];
        return glm::dot(eye_->position - on_plane, drawn.normal);
    }

    template <bool covering>
    void draw_cluster_on(int face, std::size_t first, const TriangleCluster& cluster) {
        const FaceAxes& axes = face_axes[static_cast<std::size_t>(face)];
        const float height = face == 0 ? texels_ : half_;
        const float* const along_right = local_[static_cast<std::size_t>(axes.right)].data();
        const float* const along_up = local_[static_cast<std::size_t>(axes.up)].data();
        const float* const along_depth = local_[static_cast<std::size_t>(axes.depth)].data();
        const Vec offset_x = set(half_ - 0.5f);
        const Vec offset_y = set(face == 0 ? half_ - 0.5f : -0.5f);
        const Vec half = set(half_);
        const Vec guard = set(guard_);
        Vec left = set(1e30f);
        Vec right = set(-1e30f);
        Vec low = left;
        Vec high = right;
        bool all_project = true;
        for (std::uint32_t k = 0; k < cluster.vertices; k += lanes) {
            const Vec depth = hn::Mul(hn::Load(floats, along_depth + k), set(axes.depth_sign));
            const Vec inverse = hn::Div(set(1.0f), depth);
            const Vec x = hn::Add(
                hn::Mul(hn::Mul(hn::Mul(hn::Load(floats, along_right + k), set(axes.right_sign)), inverse),
                        half),
                offset_x);
            const Vec y = hn::Add(hn::Mul(hn::Mul(hn::Load(floats, along_up + k), inverse), half), offset_y);
            hn::Store(x, floats, &x_[k]);
            hn::Store(y, floats, &y_[k]);
            hn::Store(inverse, floats, &inverse_[k]);
            const Mask projects = hn::And(hn::Gt(depth, set(0.0f)),
                                          hn::And(hn::Lt(hn::Abs(x), guard), hn::Lt(hn::Abs(y), guard)));
            hn::Store(hn::IfThenElseZero(projects, set(1.0f)), floats, &projects_[k]);
            if (!hn::AllTrue(floats, projects)) {
                all_project = false;
            }
            left = hn::Min(left, x);
            right = hn::Max(right, x);
            low = hn::Min(low, y);
            high = hn::Max(high, y);
        }
        const float last_x = texels_ - 1.0f;
        const float last_y = height - 1.0f;
        if (all_project) {
            const float x0 = hn::GetLane(hn::MinOfLanes(floats, left));
            const float x1 = hn::GetLane(hn::MaxOfLanes(floats, right));
            const float y0 = hn::GetLane(hn::MinOfLanes(floats, low));
            const float y1 = hn::GetLane(hn::MaxOfLanes(floats, high));
            if (x0 > last_x + centre_slack || x1 < -centre_slack || y0 > last_y + centre_slack ||
                y1 < -centre_slack) {
                return;
            }
        }
        if (!all_project) {
            find_outside(face, cluster.vertices);
        }
        const std::uint8_t* const corner = &scene_.corners[3 * first];
        for (std::uint32_t t = 0; t < cluster.triangles; t += lanes) {
            const auto c0 = load_bytes(corner + t);
            const auto c1 = load_bytes(corner + cluster_size + t);
            const auto c2 = load_bytes(corner + 2 * cluster_size + t);
            const Vec side = hn::Load(floats, &side_[t]);
            const Mask front = hn::Gt(side, set(0.0f));
            Mask drawn = hn::And(hn::FirstN(floats, cluster.triangles - t), hn::Ne(side, set(0.0f)));
            if (!all_project) {
                const auto outside =
                    hn::And(look_up(outside_.data(), c0),
                            hn::And(look_up(outside_.data(), c1), look_up(outside_.data(), c2)));
                drawn = hn::And(drawn,
                                hn::RebindMask(floats, hn::Eq(hn::BitCast(ints, outside), hn::Zero(ints))));
                const Mask project =
                    hn::Gt(hn::Min(look_up(projects_.data(), c0),
                                   hn::Min(look_up(projects_.data(), c1), look_up(projects_.data(), c2))),
                           set(0.5f));
                for (std::uint32_t bits = bits_of(hn::AndNot(project, drawn)); bits != 0; bits &= bits - 1) {
                    draw_alone<covering>(face, first, t + static_cast<std::uint32_t>(std::countr_zero(bits)));
                }
                drawn = hn::And(drawn, project);
            }
            const Vec x0 = look_up(x_.data(), c0);
            const Vec xa = look_up(x_.data(), c1);
            const Vec xb = look_up(x_.data(), c2);
            const Vec y0 = look_up(y_.data(), c0);
            const Vec ya = look_up(y_.data(), c1);
            const Vec yb = look_up(y_.data(), c2);
            const Vec slack = set(centre_slack);
            const Vec box_left = hn::Max(hn::Ceil(hn::Sub(hn::Min(x0, hn::Min(xa, xb)), slack)), set(0.0f));
            const Vec box_right =
                hn::Min(hn::Floor(hn::Add(hn::Max(x0, hn::Max(xa, xb)), slack)), set(last_x));
            const Vec box_low = hn::Max(hn::Ceil(hn::Sub(hn::Min(y0, hn::Min(ya, yb)), slack)), set(0.0f));
            const Vec box_high =
                hn::Min(hn::Floor(hn::Add(hn::Max(y0, hn::Max(ya, yb)), slack)), set(last_y));
            drawn = hn::And(drawn, hn::And(hn::Ge(box_right, box_left), hn::Ge(box_high, box_low)));
            if (hn::AllFalse(floats, drawn)) {
                continue;
            }
            // Counter-clockwise on the face: fronts are clockwise.
            const Vec x1 = hn::IfThenElse(front, xb, xa);
            const Vec x2 = hn::IfThenElse(front, xa, xb);
            const Vec y1 = hn::IfThenElse(front, yb, ya);
            const Vec y2 = hn::IfThenElse(front, ya, yb);
            const Vec bias = hn::IfThenElse(front, set(front_bias), set(1.0f));
            const Vec z0 = hn::Mul(look_up(inverse_.data(), c0), bias);
            const Vec za = hn::Mul(look_up(inverse_.data(), c1), bias);
            const Vec zb = hn::Mul(look_up(inverse_.data(), c2), bias);
            const Vec z1 = hn::IfThenElse(front, zb, za);
            const Vec z2 = hn::IfThenElse(front, za, zb);
            const auto front_ids = hn::RebindMask(ids_of, front);
            const auto id = hn::IfThenElse(front_ids, hn::Load(ids_of, &scene_.front_id[first + t]),
                                           hn::Load(ids_of, &scene_.back_id[first + t]));
            const Vec count = hn::Mul(hn::Add(hn::Sub(box_right, box_left), set(1.0f)),
                                      hn::Add(hn::Sub(box_high, box_low), set(1.0f)));
            const Mask large = hn::And(drawn, hn::Gt(count, set(max_small)));
            std::uint32_t large_bits = bits_of(large);
            if (large_bits != 0) {
                alignas(64) std::array<Lanes<float>, 13> part;
                alignas(64) Lanes<std::uint32_t> part_id;
                const std::array<Vec, 13> values{x0, x1, x2,       y0,        y1,      y2,      z0,
                                                 z1, z2, box_left, box_right, box_low, box_high};
                for (std::size_t k = 0; k < values.size(); ++k) {
                    hn::StoreU(values[k], floats, part[k].data());
                }
                hn::StoreU(id, ids_of, part_id.data());
                for (; large_bits != 0; large_bits &= large_bits - 1) {
                    const auto k = static_cast<std::size_t>(std::countr_zero(large_bits));
                    draw_large<covering>(
                        face, {part[0][k], part[1][k], part[2][k]}, {part[3][k], part[4][k], part[5][k]},
                        {part[6][k], part[7][k], part[8][k]}, part_id[k],
                        static_cast<std::uint32_t>(part[9][k]), static_cast<std::uint32_t>(part[10][k]),
                        static_cast<std::uint32_t>(part[11][k]), static_cast<std::uint32_t>(part[12][k]));
                }
            }
            const Mask small = hn::AndNot(large, drawn);
            const auto queue = [&](Vec value, SmallTriangles::Column& column) {
                hn::StoreU(hn::Compress(value, small), floats, column.data() + small_.count);
            };
            queue(x0, small_.x[0]);
            queue(x1, small_.x[1]);
            queue(x2, small_.x[2]);
            queue(y0, small_.y[0]);
            queue(y1, small_.y[1]);
            queue(y2, small_.y[2]);
            queue(z0, small_.z[0]);
            queue(z1, small_.z[1]);
            queue(z2, small_.z[2]);
            queue(box_left, small_.left);
            queue(box_right, small_.right);
            queue(box_low, small_.low);
            queue(box_high, small_.high);
            hn::StoreU(hn::Compress(id, hn::RebindMask(ids_of, small)), ids_of,
                       small_.id.data() + small_.count);
            const auto queued = static_cast<std::uint32_t>(hn::CountTrue(floats, small));
            std::fill_n(small_.face_first.begin() + small_.count, queued, tiles_.first(face));
            small_.count += queued;
            if (small_.count >= SmallTriangles::capacity) {
                const std::uint32_t whole = small_.count / lanes * lanes;
                flush<covering>(whole);
            }
        }
    }

    /// Which sides of a face vertices lie beyond: a bit per side in outside_. Half a texel of slack is more
    /// than any rounding.
    void find_outside(int face, std::uint32_t count) {
        const FaceAxes& axes = face_axes[static_cast<std::size_t>(face)];
        const float offset_y = face == 0 ? half_ - 0.5f : -0.5f;
        const Vec half = set(half_);
        const auto bit = [](Mask mask, std::int32_t value) {
            return hn::IfThenElseZero(hn::RebindMask(ints, mask), hn::Set(ints, value));
        };
        for (std::uint32_t k = 0; k < count; k += lanes) {
            const Vec depth = hn::Mul(hn::Load(floats, &local_[static_cast<std::size_t>(axes.depth)][k]),
                                      set(axes.depth_sign));
            const Vec x = hn::Mul(hn::Mul(hn::Load(floats, &local_[static_cast<std::size_t>(axes.right)][k]),
                                          set(axes.right_sign)),
                                  half);
            const Vec y = hn::Mul(hn::Load(floats, &local_[static_cast<std::size_t>(axes.up)][k]), half);
            const auto beyond = [&](Vec value, float limit) {
                return hn::Gt(value, hn::Mul(depth, set(limit)));
            };
            const auto outside =
                hn::Or(hn::Or(bit(beyond(x, half_ + 0.5f), 1), bit(beyond(hn::Neg(x), half_ + 0.5f), 2)),
                       hn::Or(bit(beyond(y, half_ + 0.5f), 4), bit(beyond(hn::Neg(y), offset_y + 1.0f), 8)));
            hn::Store(hn::BitCast(floats, outside), floats, &outside_[k]);
        }
    }

    /// Draws the first `count` queued triangles; those that are left move to the front.
    template <bool covering>
    void flush(std::uint32_t count) {
        SmallTriangles& q = small_;
        const auto across = hn::Set(ints, static_cast<std::int32_t>(across_));
        const auto three = hn::Set(ints, 3);
        for (std::uint32_t k = 0; k < count; k += lanes) {
            const Vec x0 = hn::LoadU(floats, &q.x[0][k]);
            const Vec x1 = hn::LoadU(floats, &q.x[1][k]);
            const Vec x2 = hn::LoadU(floats, &q.x[2][k]);
            const Vec y0 = hn::LoadU(floats, &q.y[0][k]);
            const Vec y1 = hn::LoadU(floats, &q.y[1][k]);
            const Vec y2 = hn::LoadU(floats, &q.y[2][k]);
            const Vec z0 = hn::LoadU(floats, &q.z[0][k]);
            const Vec z1 = hn::LoadU(floats, &q.z[1][k]);
            const Vec z2 = hn::LoadU(floats, &q.z[2][k]);
            const Vec left = hn::LoadU(floats, &q.left[k]);
            const Vec right = hn::LoadU(floats, &q.right[k]);
            const Vec high = hn::LoadU(floats, &q.high[k]);
            const auto face_first = hn::LoadU(ints, reinterpret_cast<const std::int32_t*>(&q.face_first[k]));
            Vec px = left;
            Vec py = hn::LoadU(floats, &q.low[k]);
            Mask active = hn::FirstN(floats, count - k);
            do {
                const Vec ax = hn::Sub(x0, px);
                const Vec ay = hn::Sub(y0, py);
                const Vec bx = hn::Sub(x1, px);
                const Vec by = hn::Sub(y1, py);
                const Vec cx = hn::Sub(x2, px);
                const Vec cy = hn::Sub(y2, py);
                const Vec e2 = edge(ax, ay, bx, by);
                const Vec e0 = edge(bx, by, cx, cy);
                const Vec e1 = edge(cx, cy, ax, ay);
                const Vec least = hn::Min(e0, hn::Min(e1, e2));
                const Vec zero = set(0.0f);
                Mask inside = hn::And(active, hn::Ge(least, zero));
                if (HWY_UNLIKELY(!hn::AllFalse(floats, hn::And(inside, hn::Eq(least, zero))))) {
                    const auto on_edge_in = [zero](Vec e, Vec fx, Vec fy, Vec tx, Vec ty) {
                        const Mask in = hn::Or(hn::Gt(ty, fy), hn::And(hn::Eq(ty, fy), hn::Gt(tx, fx)));
                        return hn::Or(hn::Ne(e, zero), in);
                    };
                    inside = hn::And(inside, hn::And(on_edge_in(e2, x0, y0, x1, y1),
                                                     hn::And(on_edge_in(e0, x1, y1, x2, y2),
                                                             on_edge_in(e1, x2, y2, x0, y0))));
                }
                std::uint32_t bits = bits_of(inside);
                if (bits != 0) {
                    const Vec z = hn::Div(hn::Add(hn::Add(hn::Mul(e0, z0), hn::Mul(e1, z1)), hn::Mul(e2, z2)),
                                          hn::Add(hn::Add(e0, e1), e2));
                    const auto ix = hn::ConvertTo(ints, px);
                    const auto iy = hn::ConvertTo(ints, py);
                    const auto tile = hn::Add(hn::Mul(hn::ShiftRight<2>(iy), across), hn::ShiftRight<2>(ix));
                    const auto at =
                        hn::Add(hn::Add(face_first, hn::ShiftLeft<4>(tile)),
                                hn::Add(hn::ShiftLeft<2>(hn::And(iy, three)), hn::And(ix, three)));
                    alignas(64) Lanes<float> depth;
                    alignas(64) Lanes<std::int32_t> texel;
                    hn::StoreU(z, floats, depth.data());
                    hn::StoreU(at, ints, texel.data());
                    for (; bits != 0; bits &= bits - 1) {
                        const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
                        put<covering>(static_cast<std::uint32_t>(texel[lane]), depth[lane], q.id[k + lane]);
                    }
                }
                px = hn::Add(px, set(1.0f));
                const Mask wrap = hn::Gt(px, right);
                px = hn::IfThenElse(wrap, left, px);
                py = hn::IfThenElse(wrap, hn::Add(py, set(1.0f)), py);
                active = hn::And(active, hn::Le(py, high));
            } while (!hn::AllFalse(floats, active));
        }
        const std::uint32_t rest = q.count - count;
        const auto move = [count, rest](auto& column) {
            std::copy_n(column.begin() + count, rest, column.begin());
        };
        for (std::size_t k = 0; k < 3; ++k) {
            move(q.x[k]);
            move(q.y[k]);
            move(q.z[k]);
        }
        move(q.left);
        move(q.right);
        move(q.low);
        move(q.high);
        move(q.id);
        move(q.face_first);
        q.count = rest;
    }

    template <bool covering>
    HWY_INLINE void put(std::uint32_t texel, float depth, std::uint32_t id) {
        if constexpr (covering) {
            if (id != item_blocked) {
                TexelTally& covered = coverage_->of_id[id];
                if (covered == 0) {
                    coverage_->single_ids.push_back(id);
                }
                covered += weights_->texel[texel];
            }
        }
        float& nearest = depth_[texel];
        if (depth > nearest || (depth == nearest && id < ids_[texel])) {
            nearest = depth;
            ids_[texel] = id;
        }
    }

    /// Takes the lanes `inside` of a part of a tile.
    /// @param at  the part's first texel
    HWY_INLINE void put_lanes(std::uint32_t at, Mask inside, Vec z, hn::Vec<Ids> id) {
        const Vec nearest = hn::Load(floats, &depth_[at]);
        const auto shown = hn::Load(ids_of, &ids_[at]);
        const Mask equal_first =
            hn::And(hn::Eq(z, nearest),
                    hn::RebindMask(floats, hn::Lt(hn::BitCast(ints, id), hn::BitCast(ints, shown))));
        const Mask taken = hn::And(inside, hn::Or(hn::Gt(z, nearest), equal_first));
        hn::Store(hn::IfThenElse(taken, z, nearest), floats, &depth_[at]);
        hn::Store(hn::IfThenElse(hn::RebindMask(ids_of, taken), id, shown), ids_of, &ids_[at]);
    }

    /// Weights and number of the texels that a polygon of one cell covers. Weights cannot overflow: those of
    /// a hemicube sum to less than 2^32.
    struct Covered {
        hn::Vec<Ids> weights;
        std::uint32_t texels;
    };
    /// @param at  first texel of a part of a tile
    HWY_INLINE void cover(std::uint32_t at, Mask inside, Covered& covered) const {
        covered.weights =
            hn::Add(covered.weights, hn::IfThenElseZero(hn::RebindMask(ids_of, inside),
                                                        hn::LoadU(ids_of, &weights_->weight[at])));
        covered.texels += static_cast<std::uint32_t>(hn::CountTrue(floats, inside));
    }
    void add_covered(std::uint32_t id, const Covered& sum) {
        if (id == item_blocked || sum.texels == 0) {
            return;
        }
        TexelTally& covered = coverage_->of_id[id];
        if (covered == 0) {
            coverage_->single_ids.push_back(id);
        }
        covered += TexelTally{hn::GetLane(hn::SumOfLanes(ids_of, sum.weights))} << 32 | sum.texels;
    }
    /// Without the texels that are none, beyond the upper and right edge of a face.
    HWY_INLINE Mask on_face_only(Mask inside, int face, Vec px, Vec py) const {
        if (!padded_) {
            return inside;
        }
        const float height = face == 0 ? texels_ : half_;
        return hn::And(inside, hn::And(hn::Lt(px, set(texels_)), hn::Lt(py, set(height))));
    }

    /// A triangle tile by tile.
    template <bool covering>
    void draw_large(int face, const std::array<float, 3>& x, const std::array<float, 3>& y,
                    const std::array<float, 3>& z, std::uint32_t id, std::uint32_t left, std::uint32_t right,
                    std::uint32_t low, std::uint32_t high) {
        const std::array<Vec, 3> vx{set(x[0]), set(x[1]), set(x[2])};
        const std::array<Vec, 3> vy{set(y[0]), set(y[1]), set(y[2])};
        const std::array<Vec, 3> vz{set(z[0]), set(z[1]), set(z[2])};
        const auto ids = hn::Set(ids_of, id);
        const Vec zero = set(0.0f);
        Covered covered{hn::Zero(ids_of), 0};
        for (std::uint32_t ty = low / 4; ty <= high / 4; ++ty) {
            std::uint32_t at = tiles_.first(face) + (ty * across_ + left / 4) * tile_size;
            for (std::uint32_t tx = left / 4; tx <= right / 4; ++tx, at += tile_size) {
                for (std::uint32_t k = 0; k < tile_size; k += lanes) {
                    const Vec px = hn::Add(hn::Load(floats, &tile_x_[k]), set(static_cast<float>(4 * tx)));
                    const Vec py = hn::Add(hn::Load(floats, &tile_y_[k]), set(static_cast<float>(4 * ty)));
                    const Vec ax = hn::Sub(vx[0], px);
                    const Vec ay = hn::Sub(vy[0], py);
                    const Vec bx = hn::Sub(vx[1], px);
                    const Vec by = hn::Sub(vy[1], py);
                    const Vec cx = hn::Sub(vx[2], px);
                    const Vec cy = hn::Sub(vy[2], py);
                    const Vec e2 = edge(ax, ay, bx, by);
                    const Vec e0 = edge(bx, by, cx, cy);
                    const Vec e1 = edge(cx, cy, ax, ay);
                    const Vec least = hn::Min(e0, hn::Min(e1, e2));
                    Mask inside = hn::Ge(least, zero);
                    if (HWY_UNLIKELY(!hn::AllFalse(floats, hn::And(inside, hn::Eq(least, zero))))) {
                        const auto on_edge_in = [&](Vec e, std::size_t from, std::size_t to) {
                            const bool in = y[to] > y[from] || (y[to] == y[from] && x[to] > x[from]);
                            return in ? hn::Ge(e, zero) : hn::Gt(e, zero);
                        };
                        inside = hn::And(on_edge_in(e2, 0, 1),
                                         hn::And(on_edge_in(e0, 1, 2), on_edge_in(e1, 2, 0)));
                    }
                    const Vec depth =
                        hn::Div(hn::Add(hn::Add(hn::Mul(e0, vz[0]), hn::Mul(e1, vz[1])), hn::Mul(e2, vz[2])),
                                hn::Add(hn::Add(e0, e1), e2));
                    if constexpr (covering) {
                        inside = on_face_only(inside, face, px, py);
                        cover(at + k, inside, covered);
                    }
                    put_lanes(at + k, inside, depth, ids);
                }
            }
        }
        if constexpr (covering) {
            add_covered(id, covered);
        }
    }

    /// A triangle of a cluster of which some vertex does not project.
    template <bool covering>
    void draw_alone(int face, std::size_t first, std::uint32_t triangle) {
        std::array<FaceVertex, 3> outline;
        std::array<Vec3, 3> corners;
        float highest = -1.0f;
        const bool front = side_[triangle] > 0.0f;
        for (std::size_t k = 0; k < 3; ++k) {
            // Counter-clockwise on the face: fronts are clockwise.
            const std::size_t corner = front ? 2 - k : k;
            const std::size_t vertex = scene_.corners[3 * first + corner * cluster_size + triangle];
            const std::array<float, 3> at{local_[0][vertex], local_[1][vertex], local_[2][vertex]};
            highest = std::max(highest, at[2]);
            outline[k] = on_face(face, at);
            corners[k] = Vec3(at[0], at[1], at[2]);
        }
        if (highest <= static_cast<float>(tolerance_ * scene_.scale)) {
            return; // on or behind the eye's plane
        }
        const Vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double height = glm::dot(normal, corners[0]);
        if (height == 0.0) {
            return; // edge-on to the last bit
        }
        Shown shown;
        shown.first_id = front ? scene_.front_id[first + triangle] : scene_.back_id[first + triangle];
        draw_outline<covering>(face, outline, on_texels(face, normal, 1.0 / height), shown, front);
    }

    [[nodiscard]] Vec3 in_frame(const Vec3& v) const {
        return {glm::dot(v, frame_->x), glm::dot(v, frame_->y), glm::dot(v, frame_->z)};
    }
    /// factor · (local · direction) of the direction through texel (i, j), in the eye's frame.
    [[nodiscard]] Affine on_texels(int face, const Vec3& local, double factor) const {
        const Vec3 depth = face_direction(face, 0.0, 0.0);
        const Vec3 right = face_direction(face, 1.0, 0.0) - depth;
        const Vec3 up = face_direction(face, 0.0, 1.0) - depth;
        const auto half = static_cast<double>(half_);
        const double per_x = glm::dot(local, right) * factor / half;
        const double per_y = glm::dot(local, up) * factor / half;
        const double offset_y = face == 0 ? half - 0.5 : -0.5;
        return {glm::dot(local, depth) * factor - per_x * (half - 0.5) - per_y * offset_y, per_x, per_y};
    }

    template <bool covering>
    void draw_grid_polygon(const RasterScene::GridPolygon& drawn) {
        const DrawList& list = scene_.list;
        const std::uint32_t index = drawn.polygon;
        const DrawPolygon& polygon = list.polygons[index];
        if (index == own_polygon_ ||
            glm::dot(eye_->position - polygon.centre, eye_->normal) > polygon.radius) {
            return;
        }
        const double height = height_above(index);
        if (std::abs(height) <= tolerance_) {
            return; // edge-on
        }
        const bool front = height > 0.0;
        bool drawn_once = false;
        corners_.clear();
        float highest = -1.0f;
        for (std::uint32_t k = 0; k < polygon.corner_count; ++k) {
            corners_.push_back(in_eye_frame(list.vertices[list.corners[polygon.first_corner + k].vertex]));
            highest = std::max(highest, corners_.back()[2]);
        }
        if (highest <= static_cast<float>(tolerance_ * scene_.scale)) {
            return; // on or behind the eye's plane
        }
        for (int face = 0; face < hemicube_faces; ++face) {
            Shown shown;
            Affine inverse;
            bool ready = false;
            // An outline with corners along its edges is drawn triangle by triangle: a short edge says little
            // about points far along its line.
            const bool whole = polygon.corner_count <= 4;
            const std::uint32_t pieces = whole ? 1 : polygon.triangle_count;
            for (std::uint32_t piece = 0; piece < pieces; ++piece) {
                std::array<FaceVertex, 4> outline;
                const std::uint32_t count = whole ? polygon.corner_count : 3;
                for (std::uint32_t k = 0; k < count; ++k) {
                    const std::uint32_t corner =
                        whole ? k : list.triangles[polygon.first_triangle + piece][k];
                    outline[front ? count - 1 - k : k] = on_face(face, corners_[corner]);
                }
                if (outside(face, std::span(outline).first(count))) {
                    continue;
                }
                if (!ready) {
                    inverse = on_texels(face, in_frame(polygon.normal), -1.0 / (height * scene_.scale));
                    shown = shown_cells(face, drawn, front, inverse);
                    ready = true;
                }
                draw_outline<covering>(face, std::span(outline).first(count), inverse, shown, front);
                drawn_once = true;
            }
        }
        if (covering && drawn_once && (front || polygon.back_id != item_blocked)) {
            coverage_->sides.push_back({index, !front});
        }
    }

    /// Whether all vertices are beyond one side of a face.
    [[nodiscard]] bool outside(int face, std::span<const FaceVertex> outline) const {
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

    [[nodiscard]] Shown shown_cells(int face, const RasterScene::GridPolygon& drawn, bool front,
                                    const Affine& inverse) const {
        const DrawPolygon& polygon = scene_.list.polygons[drawn.polygon];
        Shown shown;
        shown.first_id = front ? polygon.front_id : polygon.back_id;
        shown.cells = shown.first_id != item_blocked;
        if (!shown.cells) {
            return shown;
        }
        const GridMap& map = drawn.map;
        const Vec3 offset = eye_->position - map.origin;
        // u at the eye and its change along a ray; both over depth.
        const auto over_depth = [&](const Vec3& gradient, double at_origin) {
            const double at_eye = at_origin + glm::dot(offset, gradient);
            const Affine along = on_texels(face, in_frame(gradient), 1.0 / scene_.scale);
            return Affine{at_eye * inverse.c + along.c, at_eye * inverse.x + along.x,
                          at_eye * inverse.y + along.y};
        };
        shown.u = over_depth(map.gradient_u, map.u);
        shown.v = over_depth(map.gradient_v, map.v);
        shown.grid_u = static_cast<float>(polygon.grid.u);
        shown.grid_v = static_cast<float>(polygon.grid.v);
        shown.split = polygon.split != 0;
        shown.bilinear = polygon.bilinear != 0;
        shown.twist_u = polygon.twist_u;
        shown.twist_v = polygon.twist_v;
        return shown;
    }

    /// A convex outline, counter-clockwise on the face, tile by tile. Vertices may lie anywhere: an edge is
    /// tested in texels where both its ends project, as in clusters, else homogeneously.
    template <bool covering>
    void draw_outline(int face, std::span<const FaceVertex> outline, const Affine& inverse, Shown& shown,
                      bool front) {
        std::array<FaceEdge, 4> edges;
        for (std::size_t k = 0; k < outline.size(); ++k) {
            const FaceVertex& a = outline[k];
            const FaceVertex& b = outline[k + 1 < outline.size() ? k + 1 : 0];
            if (a.projects && b.projects) {
                edges[k] = {a.x, a.y, 1.0f, b.x, b.y, 1.0f, b.y > a.y || (b.y == a.y && b.x > a.x)};
            } else {
                const bool in = std::tuple(b.hy, b.hx, b.hw) > std::tuple(a.hy, a.hx, a.hw);
                edges[k] = {a.hx, a.hy, a.hw, b.hx, b.hy, b.hw, in};
            }
        }
        const auto box = box_of(face, outline);
        if (box[0] > box[1] || box[2] > box[3]) {
            return;
        }
        const std::span<const FaceEdge> used = std::span(edges).first(outline.size());
        if (shown.cells) {
            move_base(inverse, shown, box);
        }
        const Vec zero = set(0.0f);
        const float bias = front ? front_bias : 1.0f;
        Covered covered{hn::Zero(ids_of), 0};
        for (std::uint32_t ty = static_cast<std::uint32_t>(box[2]) / 4;
             ty <= static_cast<std::uint32_t>(box[3]) / 4; ++ty) {
            std::uint32_t tx = static_cast<std::uint32_t>(box[0]) / 4;
            std::uint32_t at = tiles_.first(face) + (ty * across_ + tx) * tile_size;
            for (; tx <= static_cast<std::uint32_t>(box[1]) / 4; ++tx, at += tile_size) {
                const double x = 4.0 * tx;
                const double y = 4.0 * ty;
                for (std::uint32_t k = 0; k < tile_size; k += lanes) {
                    const Vec in_x = hn::Load(floats, &tile_x_[k]);
                    const Vec in_y = hn::Load(floats, &tile_y_[k]);
                    const Vec px = hn::Add(in_x, set(static_cast<float>(x)));
                    const Vec py = hn::Add(in_y, set(static_cast<float>(y)));
                    Mask inside = hn::FirstN(floats, lanes);
                    for (const FaceEdge& e : used) {
                        const Vec value = edge(hn::Sub(set(e.ax), hn::Mul(px, set(e.aw))),
                                               hn::Sub(set(e.ay), hn::Mul(py, set(e.aw))),
                                               hn::Sub(set(e.bx), hn::Mul(px, set(e.bw))),
                                               hn::Sub(set(e.by), hn::Mul(py, set(e.bw))));
                        inside = hn::And(inside, e.in ? hn::Ge(value, zero) : hn::Gt(value, zero));
                    }
                    if (hn::AllFalse(floats, inside)) {
                        continue;
                    }
                    const auto affine = [&](const Affine& f) {
                        return hn::Add(set(static_cast<float>(f.at(x, y))),
                                       hn::Add(hn::Mul(in_x, set(static_cast<float>(f.x))),
                                               hn::Mul(in_y, set(static_cast<float>(f.y)))));
                    };
                    const Vec z = affine(inverse);
                    inside = hn::And(inside, hn::Gt(z, zero));
                    const Vec depth = hn::Mul(z, set(bias));
                    if constexpr (covering) {
                        inside = on_face_only(inside, face, px, py);
                    }
                    if (!shown.cells) {
                        if constexpr (covering) {
                            cover(at + k, inside, covered);
                        }
                        put_lanes(at + k, inside, depth, hn::Set(ids_of, shown.first_id));
                        continue;
                    }
                    const auto id = cell_ids(shown, hn::Div(affine(shown.u), z), hn::Div(affine(shown.v), z));
                    if constexpr (covering) {
                        alignas(64) Lanes<std::uint32_t> id_of_lane;
                        hn::StoreU(id, ids_of, id_of_lane.data());
                        for (std::uint32_t bits = bits_of(inside); bits != 0; bits &= bits - 1) {
                            const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
                            coverage_->of_id[id_of_lane[lane]] += weights_->texel[at + k + lane];
                        }
                    }
                    put_lanes(at + k, inside, depth, id);
                }
            }
        }
        if (covering && !shown.cells) {
            add_covered(shown.first_id, covered);
        }
    }

    /// Draw ids of points on the grid, as the shaders derive them. u and v are relative to the base cell.
    [[nodiscard]] HWY_INLINE hn::Vec<Ids> cell_ids(const Shown& shown, Vec u, Vec v) const {
        const Vec zero = set(0.0f);
        const Vec one = set(1.0f);
        const Vec grid_u = set(shown.grid_u);
        const Vec grid_v = set(shown.grid_v);
        Vec cell_u;
        Vec cell_v;
        Vec rest = zero;
        if (shown.bilinear) {
            const Vec twist_u = set(shown.twist_u);
            const Vec twist_v = set(shown.twist_v);
            const Vec across = hn::Sub(hn::Add(one, hn::Mul(u, twist_v)), hn::Mul(v, twist_u));
            const Vec root = hn::Sqrt(
                hn::Max(hn::Add(hn::Mul(across, across), hn::Mul(hn::Mul(set(4.0f), twist_u), v)), zero));
            const Vec at_v = hn::Div(hn::Mul(set(2.0f), v), hn::Add(across, root));
            const Vec at_u = hn::Div(u, hn::Add(one, hn::Mul(at_v, twist_u)));
            cell_u = hn::Min(hn::Floor(hn::Max(hn::Mul(at_u, grid_u), zero)), hn::Sub(grid_u, one));
            cell_v = hn::Min(hn::Floor(hn::Max(hn::Mul(at_v, grid_v), zero)), hn::Sub(grid_v, one));
        } else {
            // Cells relative to the base, so that their borders are as sharp as floats near 0 are.
            const Vec least_u = set(-shown.base_u);
            const Vec least_v = set(-shown.base_v);
            const Vec last_u = hn::Sub(hn::Add(least_u, grid_u), one);
            const Vec last_v = hn::Sub(hn::Add(least_v, grid_v), one);
            const Vec floor_u = hn::Min(hn::Max(hn::Floor(u), least_u), last_u);
            const Vec floor_v = hn::Min(hn::Max(hn::Floor(v), least_v), last_v);
            if (shown.split) {
                const auto clamped = [&](Vec value, Vec least, Vec last) {
                    return hn::Min(hn::Max(value, least), hn::Add(last, one));
                };
                rest = hn::Add(hn::Sub(clamped(u, least_u, last_u), floor_u),
                               hn::Sub(clamped(v, least_v, last_v), floor_v));
            }
            cell_u = hn::Sub(floor_u, least_u);
            cell_v = hn::Sub(floor_v, least_v);
        }
        const auto i = hn::ConvertTo(ints, cell_u);
        const auto j = hn::ConvertTo(ints, cell_v);
        auto cell = hn::Add(hn::Mul(j, hn::Set(ints, static_cast<std::int32_t>(shown.grid_u))), i);
        if (shown.split) {
            const auto second = hn::RebindMask(ints, hn::Gt(rest, one));
            cell = hn::Add(hn::ShiftLeft<1>(cell), hn::IfThenElseZero(second, hn::Set(ints, 1)));
        }
        return hn::Add(hn::BitCast(ids_of, cell), hn::Set(ids_of, shown.first_id));
    }

    /// Counts cells from the one at the nearest corner of the box, where they are largest on the face.
    static void move_base(const Affine& inverse, Shown& shown, const std::array<int, 4>& box) {
        if (shown.bilinear) {
            return;
        }
        double x = 0.0;
        double y = 0.0;
        double nearest = -1.0;
        for (const int i : {box[0], box[1]}) {
            for (const int j : {box[2], box[3]}) {
                if (inverse.at(i, j) > nearest) {
                    nearest = inverse.at(i, j);
                    x = i;
                    y = j;
                }
            }
        }
        if (!(nearest > 0.0)) {
            return;
        }
        const auto move = [&](Affine& f, float& base, float grid) {
            // `f` may have been moved for another piece of the polygon.
            const double at = f.at(x, y) / nearest;
            const double cell =
                std::floor(std::clamp(at + static_cast<double>(base), 0.0, static_cast<double>(grid)));
            const double step = cell - static_cast<double>(base);
            f.c -= step * inverse.c;
            f.x -= step * inverse.x;
            f.y -= step * inverse.y;
            base = static_cast<float>(cell);
        };
        move(shown.u, shown.base_u, shown.grid_u);
        move(shown.v, shown.base_v, shown.grid_v);
    }

    /// Texels left, right, low and high that an outline may cover.
    [[nodiscard]] std::array<int, 4> box_of(int face, std::span<const FaceVertex> outline) const {
        const double last_x = static_cast<double>(texels_) - 1.0;
        const double last_y = static_cast<double>(face == 0 ? texels_ : half_) - 1.0;
        // Clipped to the face and half a texel round it, in homogeneous coordinates.
        struct Point {
            double x, y, w;
        };
        std::array<Point, 12> from{};
        std::array<Point, 12> to{};
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

    const RasterScene& scene_;
    TexelTiles tiles_;
    CacheLineVector<std::uint32_t> ids_;
    CacheLineVector<float> depth_; ///< 1 / depth; 0: nothing
    float texels_;                 ///< of a face's edge
    float half_;
    float guard_; ///< a vertex projects where it is nearer than this, in texels
    std::uint32_t across_;
    bool padded_; ///< some tiles have texels that are none
    double tolerance_;
    float near_plane_; ///< eyes nearer to a plane are looked at in double precision

    alignas(64) std::array<float, tile_size> tile_x_{};
    alignas(64) std::array<float, tile_size> tile_y_{};
    alignas(64) std::array<std::array<float, cluster_size>, 3> local_{}; ///< in the eye's frame
    alignas(64) std::array<float, cluster_size> x_{};
    alignas(64) std::array<float, cluster_size> y_{};
    alignas(64) std::array<float, cluster_size> inverse_{};
    alignas(64) std::array<float, cluster_size> projects_{};
    alignas(64) std::array<float, cluster_size> outside_{}; ///< bits
    alignas(64) std::array<float, cluster_size> side_{};

    const EyePoint* eye_ = nullptr;
    const EyeFrame* frame_ = nullptr;
    const TileWeights* weights_ = nullptr;
    Coverage* coverage_ = nullptr;
    std::uint32_t own_polygon_ = 0;
    std::array<float, 3> eye_high_{};
    std::array<float, 3> eye_low_{};
    std::array<std::array<float, 3>, 3> axes_{};
    std::vector<Candidate> candidates_;
    std::vector<std::array<float, 3>> corners_;
    SmallTriangles small_{};
};

std::unique_ptr<Rasteriser> make(const RasterScene& scene, const TexelTiles& tiles) {
    return std::make_unique<SimdRasteriser>(scene, tiles);
}

} // namespace
} // namespace hemi::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hemi {

namespace {

/// An instruction set that this file is compiled for.
struct Implementation {
    std::int64_t target;
    std::string_view name;
    std::unique_ptr<Rasteriser> (*make)(const RasterScene&, const TexelTiles&);
};

constexpr std::string_view name_of(std::int64_t target) {
    return target == HWY_AVX3   ? "avx512"
           : target == HWY_AVX2 ? "avx2"
           : target == HWY_SSE4 ? "sse4"
                                : "scalar";
}

// Best first.
constexpr Implementation implementations[] = {
#if HWY_TARGETS & HWY_AVX3
    {HWY_AVX3, name_of(HWY_AVX3), &N_AVX3::make},
#endif
#if HWY_TARGETS & HWY_AVX2
    {HWY_AVX2, name_of(HWY_AVX2), &N_AVX2::make},
#endif
#if HWY_TARGETS & HWY_SSE4
    {HWY_SSE4, name_of(HWY_SSE4), &N_SSE4::make},
#endif
    {HWY_STATIC_TARGET, name_of(HWY_STATIC_TARGET), &HWY_STATIC_DISPATCH(make)},
};

const Implementation& choose() {
    const std::int64_t supported = hwy::SupportedTargets() | HWY_STATIC_TARGET;
    const char* const wanted = std::getenv("HEMI_SIMD");
    std::string there;
    for (const Implementation& one : implementations) {
        if ((one.target & supported) == 0) {
            continue;
        }
        if (wanted == nullptr || *wanted == '\0' || one.name == wanted) {
            return one;
        }
        there += fmt::format("{}{}", there.empty() ? "" : ", ", one.name);
    }
    throw InvalidArgument(fmt::format("HEMI_SIMD={}: this processor has {}", wanted, there));
}

} // namespace

std::unique_ptr<Rasteriser> make_rasteriser(const RasterScene& scene, const TexelTiles& tiles) {
    return choose().make(scene, tiles);
}

std::string simd_in_use() {
    return std::string(choose().name);
}

} // namespace hemi
#endif // HWY_ONCE
