#include "engine/rasteriser/rasteriser.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

// One source for all instruction sets: this file is compiled once for each by foreach_target.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/rasteriser/rasteriser.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>

// Must come after foreach_target.h.
#include "engine/rasteriser/item_target.ipp"
#include "engine/rasteriser/visible_parts.ipp"

HWY_BEFORE_NAMESPACE();
namespace hemi::HWY_NAMESPACE {
namespace {

// Triangles that may cover up to so many texel centres are tested side by side, one in each lane.
constexpr float max_small = 6.0f;

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
        : scene_(scene), projection_(scene, tiles.resolution()), target_(tiles), parts_(scene, projection_),
          texels_(projection_.texels()), half_(projection_.half()), guard_(projection_.guard()),
          slack_(std::max(1e-3f, 2e-6f * texels_)), tolerance_(scene.list.tolerance),
          near_plane_(static_cast<float>(tolerance_ * scene.coordinates.scale) + 2e-6f) {}

    void draw(const EyePoint& eye, const EyeFrame& frame, const TileWeights* weights,
              Coverage* coverage) override {
        projection_.set(eye, frame);
        target_.clear(weights, coverage);
        own_ = scene_.list.polygons_at(eye.surface);
        small_.count = 0;
        if (coverage != nullptr) {
            draw_all<true>();
        } else {
            draw_all<false>();
        }
    }

    [[nodiscard]] std::span<const std::uint32_t> ids() const override { return target_.ids(); }

private:
    template <bool covering>
    void draw_all() {
        parts_.find();
        // What is hidden counts where coverage is wanted, unless that may be told of all of it.
        const bool occlusion = covering ? target_.coverage()->skip_hidden : occlusion_.is_on();
        if (occlusion) {
            parts_.sort();
        }
        for (const VisiblePart& part : parts_.parts()) {
            std::uint32_t faces = part.faces;
            if (occlusion && (!covering || scene_.is_whole(part.part))) {
                points_.set_box(projection_, part.centre, scene_.extents[part.part]);
                const Sight sight = sight_of(faces, points_, projection_, target_, slack_);
                if (covering && sight.is_hidden()) {
                    target_.coverage()->hidden_parts.push_back(part.part);
                }
                faces = faces_to_draw<covering>(faces, sight);
                occlusion_.count(faces == 0);
            }
            if (faces == 0) {
                continue;
            }
            if (part.part < scene_.groups.size()) {
                draw_group<covering>(scene_.groups[part.part], faces, occlusion);
            } else {
                draw_cluster<covering>(part.part - static_cast<std::uint32_t>(scene_.groups.size()), faces);
            }
        }
        flush<covering>(small_.count);
        occlusion_.next_hemicube();
        if constexpr (covering) {
            target_.count_hidden();
        }
    }

    /// Faces on which something is drawn. Its texels are counted on all, hidden or not, unless it is hidden
    /// on all.
    template <bool covering>
    static std::uint32_t faces_to_draw(std::uint32_t faces, const Sight& sight) {
        return covering && sight.faces != 0 ? faces : sight.faces;
    }

    /// Positions of vertices in the eye's frame. The same arithmetic as FramePoints::set_corners().
    void transform(std::size_t first, std::uint32_t count) {
        const std::array<Vec, 3> high{set(projection_.high()[0]), set(projection_.high()[1]),
                                      set(projection_.high()[2])};
        const std::array<Vec, 3> low{set(projection_.low()[0]), set(projection_.low()[1]),
                                     set(projection_.low()[2])};
        for (std::uint32_t k = 0; k < count; k += lanes) {
            std::array<Vec, 3> offset;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                offset[axis] =
                    hn::Add(hn::Sub(hn::Load(floats, &scene_.vertex_high[axis][first + k]), high[axis]),
                            hn::Sub(hn::Load(floats, &scene_.vertex_low[axis][first + k]), low[axis]));
            }
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const Vec at = hn::Add(hn::Add(hn::Mul(set(projection_.axes()[axis][0]), offset[0]),
                                               hn::Mul(set(projection_.axes()[axis][1]), offset[1])),
                                       hn::Mul(set(projection_.axes()[axis][2]), offset[2]));
                hn::Store(at, floats, &local_[axis][k]);
            }
        }
    }
    template <bool covering>
    void draw_cluster(std::uint32_t index, std::uint32_t faces) {
        const TriangleCluster& cluster = scene_.clusters[index];
        const std::size_t first = std::size_t{index} * cluster_size;
        transform(first, cluster.vertices);
        find_sides(first, cluster.triangles);
        for (; faces != 0; faces &= faces - 1) {
            draw_cluster_on<covering>(std::countr_zero(faces), first, cluster);
        }
    }

    /// Which side of its plane every triangle of a cluster shows: side_ > 0 the front, < 0 the back, 0 where
    /// the triangle is not drawn.
    void find_sides(std::size_t first, std::uint32_t count) {
        const Vec ex = set(projection_.high()[0]);
        const Vec ey = set(projection_.high()[1]);
        const Vec ez = set(projection_.high()[2]);
        for (std::uint32_t t = 0; t < count; t += lanes) {
            const Vec height =
                hn::Sub(hn::Add(hn::Add(hn::Mul(hn::Load(floats, &scene_.plane[0][first + t]), ex),
                                        hn::Mul(hn::Load(floats, &scene_.plane[1][first + t]), ey)),
                                hn::Mul(hn::Load(floats, &scene_.plane[2][first + t]), ez)),
                        hn::Load(floats, &scene_.plane[3][first + t]));
            const Mask own = hn::RebindMask(
                floats,
                hn::Lt(hn::Sub(hn::Load(ids_of, &scene_.polygon[first + t]), hn::Set(ids_of, own_.first)),
                       hn::Set(ids_of, own_.count)));
            hn::Store(hn::IfThenZeroElse(own, height), floats, &side_[t]);
            const Mask close = hn::AndNot(
                own, hn::And(hn::Lt(hn::Abs(height), set(near_plane_)), hn::FirstN(floats, count - t)));
            for (std::uint32_t bits = bits_of(close); bits != 0; bits &= bits - 1) {
                const std::uint32_t k = t + static_cast<std::uint32_t>(std::countr_zero(bits));
                const double exact = projection_.height_above(scene_.polygon[first + k]);
                side_[k] = std::abs(exact) <= tolerance_ ? 0.0f : exact > 0.0 ? 1.0f : -1.0f;
            }
        }
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
            if (x0 > last_x + slack_ || x1 < -slack_ || y0 > last_y + slack_ || y1 < -slack_) {
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
            const Vec slack = set(slack_);
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
                    target_.draw_large<covering>(
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
            std::fill_n(small_.face_first.begin() + small_.count, queued, target_.tiles().first(face));
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
        const auto across = hn::Set(ints, static_cast<std::int32_t>(target_.tiles().across()));
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
                        target_.put<covering>(static_cast<std::uint32_t>(texel[lane]), depth[lane],
                                              q.id[k + lane]);
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
            outline[k] = projection_.on_face(face, at);
            corners[k] = Vec3(at[0], at[1], at[2]);
        }
        if (highest <= static_cast<float>(tolerance_ * scene_.coordinates.scale)) {
            return; // on or behind the eye's plane
        }
        const Vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double height = glm::dot(normal, corners[0]);
        if (height == 0.0) {
            return; // edge-on to the last bit
        }
        Shown shown;
        shown.first_id = front ? scene_.front_id[first + triangle] : scene_.back_id[first + triangle];
        const std::array<int, 4> box = projection_.box_of(face, outline);
        if (box[0] <= box[1] && box[2] <= box[3]) {
            target_.draw_outline<covering>(face, FaceOutline(outline, box), SideCorners(),
                                           projection_.on_texels(face, normal, 1.0 / height),
                                           nearest_of(outline), shown, front);
        }
    }

    /// The largest 1 / depth of an outline's vertices; infinity where it reaches behind the eye.
    static float nearest_of(std::span<const FaceVertex> outline) {
        float least = outline[0].hw;
        for (const FaceVertex& vertex : outline) {
            least = std::min(least, vertex.hw);
        }
        return least > 0.0f ? 1.0f / least : std::numeric_limits<float>::infinity();
    }

    template <bool covering>
    void draw_group(const RasterScene::PolygonGroup& group, std::uint32_t faces, bool occlusion) {
        for (std::uint32_t k = 0; k < group.count; ++k) {
            draw_grid_polygon<covering>(group.first + k, faces, occlusion);
        }
    }

    /// @param grid         of RasterScene::grid_polygons
    /// @param group_faces  the only faces that matter
    template <bool covering>
    void draw_grid_polygon(std::uint32_t grid, std::uint32_t group_faces, bool occlusion) {
        const RasterScene::GridPolygon& drawn = scene_.grid_polygons[grid];
        if (own_.holds(drawn.polygon)) {
            return;
        }
        std::uint32_t faces = group_faces & projection_.faces_of(drawn.centre, drawn.radius);
        if (faces == 0) {
            return;
        }
        points_.set_corners(scene_, projection_, drawn);
        if (points_.highest() <= static_cast<float>(tolerance_ * scene_.coordinates.scale)) {
            return; // on or behind the eye's plane
        }
        const std::array<float, 3>& eye = projection_.high();
        const float about =
            (drawn.plane[0] * eye[0] + drawn.plane[1] * eye[1]) + drawn.plane[2] * eye[2] - drawn.plane[3];
        auto height = static_cast<double>(about);
        if (std::abs(about) < near_plane_) {
            height = projection_.height_above(drawn.polygon);
            if (std::abs(height) <= tolerance_) {
                return; // edge-on
            }
        }
        const bool front = height > 0.0;
        bool drawn_once = false;
        if (occlusion) {
            const Sight sight = sight_of(faces, points_, projection_, target_, slack_);
            if (covering && sight.is_hidden()) {
                target_.coverage()->hidden_sides.push_back({drawn.polygon, !front});
            }
            faces = faces_to_draw<covering>(faces, sight);
            if (faces == 0) {
                return;
            }
        }
        SideCorners corners;
        std::uint32_t sides = drawn.sides;
        float margin = 0.0f;
        if (sides != 0) {
            corners = SideCorners(scene_, projection_, grid, front);
            margin = corners.margin();
            if (margin == std::numeric_limits<float>::infinity()) {
                corners = SideCorners();
                margin = 0.0f;
                sides = 0;
            }
        }
        for (std::uint32_t left = faces; left != 0; left &= left - 1) {
            const int face = std::countr_zero(left);
            Shown shown;
            Affine inverse;
            bool ready = false;
            const DrawList& list = scene_.list;
            const std::uint32_t pieces = sides != 0 ? 1 : list.polygons[drawn.polygon].triangle_count;
            for (std::uint32_t piece = 0; piece < pieces; ++piece) {
                std::array<FaceVertex, 4> outline;
                const std::uint32_t count = sides != 0 ? sides : 3;
                for (std::uint32_t k = 0; k < count; ++k) {
                    const std::uint32_t corner =
                        sides != 0 ? drawn.side_begin[k]
                                   : list.triangles[list.polygons[drawn.polygon].first_triangle + piece][k];
                    outline[front ? count - 1 - k : k] = projection_.on_face(face, points_.point(corner));
                }
                const std::span<const FaceVertex> vertices = std::span(outline).first(count);
                if (projection_.outside(face, vertices)) {
                    continue;
                }
                const std::array<int, 4> box = projection_.box_of(face, vertices);
                const float nearest = nearest_of(vertices);
                drawn_once = true;
                if (box[0] > box[1] || box[2] > box[3]) {
                    continue;
                }
                if (!ready) {
                    const Vec3& normal = list.polygons[drawn.polygon].normal;
                    height = projection_.height_above(drawn.polygon);
                    inverse = projection_.on_texels(face, projection_.in_frame(normal),
                                                    -1.0 / (height * scene_.coordinates.scale));
                    shown = shown_cells(scene_, projection_, face, grid, front, inverse);
                    ready = true;
                }
                if (shown.cells) {
                    move_base(inverse, shown, box);
                }
                target_.draw_outline<covering>(face, FaceOutline(vertices, box, margin), corners, inverse,
                                               nearest, shown, front);
            }
        }
        if (covering && drawn_once &&
            (front || scene_.list.polygons[drawn.polygon].back_id != item_blocked)) {
            target_.coverage()->sides.push_back({drawn.polygon, !front});
        }
    }

    const RasterScene& scene_;
    Projection projection_;
    ItemTarget target_;
    VisibleParts parts_;
    OcclusionSwitch occlusion_;
    float texels_; ///< of a face's edge, and half of it; vertices project where they are nearer than guard_
    float half_;
    float guard_;
    float slack_; ///< how far beyond a texel's centre a vertex may lie and still count as at it
    double tolerance_;
    float near_plane_; ///< eyes nearer to a plane are looked at in double precision

    // Of the cluster that is being drawn; by vertex unless said.
    alignas(64) std::array<std::array<float, cluster_size>, 3> local_{}; ///< in the eye's frame
    alignas(64) std::array<float, cluster_size> x_{};
    alignas(64) std::array<float, cluster_size> y_{};
    alignas(64) std::array<float, cluster_size> inverse_{};
    alignas(64) std::array<float, cluster_size> projects_{};
    alignas(64) std::array<float, cluster_size> outside_{}; ///< bits
    alignas(64) std::array<float, cluster_size> side_{};    ///< by triangle

    PolygonRange own_;   ///< that the eye lies on
    FramePoints points_; ///< of what is being culled or drawn
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
