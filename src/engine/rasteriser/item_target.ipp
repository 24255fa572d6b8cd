// Compiled once for each instruction set, by rasteriser.cpp: included again when HWY_TARGET_TOGGLE changes.
#if defined(HEMI_RASTERISER_ITEM_TARGET) == defined(HWY_TARGET_TOGGLE)
#ifdef HEMI_RASTERISER_ITEM_TARGET
#undef HEMI_RASTERISER_ITEM_TARGET
#else
#define HEMI_RASTERISER_ITEM_TARGET
#endif

#include "engine/rasteriser/face_outline.hpp"
#include "engine/rasteriser/lanes.ipp"
#include "engine/rasteriser/rasteriser.hpp"
#include "engine/rasteriser/shown_cells.hpp"
#include "engine/rasteriser/side_corners.hpp"

#include <algorithm>
#include <bit>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace hemi::HWY_NAMESPACE {
namespace {

// Fronts are nearer than backs by this, a part of the distance.
constexpr float front_bias = 1.0f + 0x1p-20f;

/// Ids and depths of a hemicube's texels, and what is drawn into them without clusters.
class ItemTarget {
public:
    explicit ItemTarget(const TexelTiles& tiles)
        : tiles_(tiles), ids_(tiles.size()), depth_(tiles.size()),
          texels_(static_cast<float>(tiles.resolution())), half_(0.5f * texels_), across_(tiles.across()),
          padded_(tiles.resolution() % 8 != 0) {
        for (std::uint32_t k = 0; k < tile_size; ++k) {
            const std::uint32_t row = k / 4;
            tile_x_[k] = static_cast<float>(k % 4);
            tile_y_[k] = static_cast<float>(row);
        }
    }

    void clear(const TileWeights* weights, Coverage* coverage) {
        weights_ = weights;
        coverage_ = coverage;
        cells_.clear();
        std::fill(ids_.begin(), ids_.end(), item_nothing);
        std::fill(depth_.begin(), depth_.end(), 0.0f);
    }
    [[nodiscard]] std::span<const std::uint32_t> ids() const { return ids_; }
    [[nodiscard]] const TexelTiles& tiles() const { return tiles_; }
    [[nodiscard]] Coverage* coverage() const { return coverage_; }

    /// Whether everything in a box of texels is nearer than `nearest`, 1 / depth.
    /// @param box  left, right, low and high
    [[nodiscard]] bool hides(int face, const std::array<int, 4>& box, float nearest) const {
        const Vec limit = set(nearest);
        const auto tile = [&box](std::size_t side) { return static_cast<std::uint32_t>(box[side]) / 4; };
        for (std::uint32_t ty = tile(2); ty <= tile(3); ++ty) {
            std::uint32_t at = tiles_.first(face) + (ty * across_ + tile(0)) * tile_size;
            for (std::uint32_t tx = tile(0); tx <= tile(1); ++tx, at += tile_size) {
                for (std::uint32_t k = 0; k < tile_size; k += lanes) {
                    if (!hn::AllTrue(floats, hn::Gt(hn::Load(floats, &depth_[at + k]), limit))) {
                        return false;
                    }
                }
            }
        }
        return true;
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
                        inside = on_face_only(inside, face, 4.0 * tx, 4.0 * ty, hn::Load(floats, &tile_x_[k]),
                                              hn::Load(floats, &tile_y_[k]));
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

    /// A convex outline tile by tile.
    /// @param inverse  1 / depth of its plane
    /// @param nearest  the largest 1 / depth of its vertices: rounding beyond it is cut off
    /// @param corners  along its sides
    template <bool covering>
    void draw_outline(int face, const FaceOutline& outline, const SideCorners& corners, const Affine& inverse,
                      float nearest, const Shown& shown, bool front) {
        const float bias = front ? front_bias : 1.0f;
        Covered covered{hn::Zero(ids_of), 0};
        for_tiles(face, outline, corners,
                  [&](std::uint32_t at, double x, double y, Vec in_x, Vec in_y, Mask inside) {
                      const Vec z = affine(inverse, x, y, in_x, in_y);
                      inside = hn::And(inside, hn::Gt(z, set(0.0f)));
                      const Vec depth = hn::Mul(hn::Min(z, set(nearest)), set(bias));
                      if (shown.cells) {
                          put_lanes(at, inside, depth, ids_at(shown, z, x, y, in_x, in_y));
                          return;
                      }
                      if constexpr (covering) {
                          inside = on_face_only(inside, face, x, y, in_x, in_y);
                          cover(at, inside, covered);
                      }
                      put_lanes(at, inside, depth, hn::Set(ids_of, shown.first_id));
                  });
        if constexpr (covering) {
            if (shown.cells) {
                cells_.push_back({face, outline, corners, inverse, shown});
            } else {
                add_covered(shown.first_id, covered);
            }
        }
    }

    /// Counts, when everything is drawn, what is hidden of the polygons of several cells.
    void count_hidden() {
        for (const DrawnCells& drawn : cells_) {
            const Shown& shown = drawn.shown;
            const auto first = hn::Set(ids_of, shown.first_id);
            const auto count = hn::Set(ids_of, shown.id_count);
            for_tiles(drawn.face, drawn.outline, drawn.corners,
                      [&](std::uint32_t at, double x, double y, Vec in_x, Vec in_y, Mask inside) {
                          const auto id = hn::Load(ids_of, &ids_[at]);
                          const auto others =
                              hn::RebindMask(floats, hn::Not(hn::Lt(hn::Sub(id, first), count)));
                          inside = hn::And(inside, others);
                          if (HWY_LIKELY(hn::AllFalse(floats, inside))) {
                              return;
                          }
                          const Vec z = affine(drawn.inverse, x, y, in_x, in_y);
                          inside = on_face_only(hn::And(inside, hn::Gt(z, set(0.0f))), drawn.face, x, y, in_x,
                                                in_y);
                          alignas(64) Lanes<std::uint32_t> id_of_lane;
                          hn::StoreU(ids_at(shown, z, x, y, in_x, in_y), ids_of, id_of_lane.data());
                          for (std::uint32_t bits = bits_of(inside); bits != 0; bits &= bits - 1) {
                              const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
                              coverage_->of_id[id_of_lane[lane]] += weights_->texel[at + lane];
                          }
                      });
        }
        cells_.clear();
    }

private:
    /// What is needed to see again which texels an outline covers.
    struct DrawnCells {
        int face;
        FaceOutline outline;
        SideCorners corners;
        Affine inverse;
        Shown shown;
    };

    /// Calls `visit(at, x, y, in_x, in_y, inside)` for the parts of tiles of which an outline covers a texel:
    /// first texel, place of the tile on the face, places of the lanes in the tile, lanes that it covers.
    template <class Visit>
    HWY_INLINE void for_tiles(int face, const FaceOutline& outline, const SideCorners& corners,
                              const Visit& visit) const {
        const Vec zero = set(0.0f);
        const std::span<const FaceEdge> edges = outline.edges();
        const bool bent = corners.any();
        for (std::uint32_t ty = outline.first_row(); ty <= outline.last_row(); ++ty) {
            const FaceOutline::Span span = outline.row(ty);
            std::uint32_t at = tiles_.first(face) + (ty * across_ + span.begin) * tile_size;
            for (std::uint32_t tx = span.begin; tx < span.end; ++tx, at += tile_size) {
                const double x = 4.0 * tx;
                const double y = 4.0 * ty;
                const bool whole = tx >= span.inner_begin && tx < span.inner_end;
                for (std::uint32_t k = 0; k < tile_size; k += lanes) {
                    const Vec in_x = hn::Load(floats, &tile_x_[k]);
                    const Vec in_y = hn::Load(floats, &tile_y_[k]);
                    Mask inside = hn::FirstN(floats, lanes);
                    if (!whole) {
                        const Vec px = hn::Add(in_x, set(static_cast<float>(x)));
                        const Vec py = hn::Add(in_y, set(static_cast<float>(y)));
                        Mask near = hn::Lt(zero, zero);
                        for (std::size_t i = 0; i < edges.size(); ++i) {
                            const FaceEdge& e = edges[i];
                            const Vec value = edge(hn::Sub(set(e.ax), hn::Mul(px, set(e.aw))),
                                                   hn::Sub(set(e.ay), hn::Mul(py, set(e.aw))),
                                                   hn::Sub(set(e.bx), hn::Mul(px, set(e.bw))),
                                                   hn::Sub(set(e.by), hn::Mul(py, set(e.bw))));
                            if (bent) {
                                const Vec margin = set(outline.near()[i]);
                                near = hn::Or(near, hn::Lt(hn::Abs(value), margin));
                                inside = hn::And(inside, hn::Gt(value, hn::Neg(margin)));
                            } else {
                                inside = hn::And(inside, e.in ? hn::Ge(value, zero) : hn::Gt(value, zero));
                            }
                        }
                        near = hn::And(near, inside);
                        if (HWY_UNLIKELY(!hn::AllFalse(floats, near))) {
                            inside = hn::Or(hn::AndNot(near, inside),
                                            inside_of_corners(near, face, outline, corners, px, py));
                        }
                        if (hn::AllFalse(floats, inside)) {
                            continue;
                        }
                    }
                    visit(at + k, x, y, in_x, in_y, inside);
                }
            }
        }
    }

    /// Lanes, of those near an edge, that are inside.
    static Mask inside_of_corners(Mask near, int face, const FaceOutline& outline, const SideCorners& corners,
                                  Vec px, Vec py) {
        alignas(64) Lanes<float> x;
        alignas(64) Lanes<float> y;
        alignas(64) Lanes<float> inside{};
        hn::StoreU(px, floats, x.data());
        hn::StoreU(py, floats, y.data());
        for (std::uint32_t bits = bits_of(near); bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
            inside[lane] = corners.contain(face, outline, x[lane], y[lane]) ? 1.0f : 0.0f;
        }
        return hn::Gt(hn::LoadU(floats, inside.data()), set(0.0f));
    }

    /// f at the lanes of the tile at (x, y).
    static HWY_INLINE Vec affine(const Affine& f, double x, double y, Vec in_x, Vec in_y) {
        return hn::Add(set(static_cast<float>(f.at(x, y))),
                       hn::Add(hn::Mul(in_x, set(static_cast<float>(f.x))),
                               hn::Mul(in_y, set(static_cast<float>(f.y)))));
    }
    [[nodiscard]] HWY_INLINE hn::Vec<Ids> ids_at(const Shown& shown, Vec z, double x, double y, Vec in_x,
                                                 Vec in_y) const {
        const Vec depth = hn::Div(set(1.0f), z);
        return cell_ids(shown, hn::Mul(affine(shown.u, x, y, in_x, in_y), depth),
                        hn::Mul(affine(shown.v, x, y, in_x, in_y), depth));
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
    /// Without padding, beyond the upper and right edge of a face.
    HWY_INLINE Mask on_face_only(Mask inside, int face, double x, double y, Vec in_x, Vec in_y) const {
        if (!padded_) {
            return inside;
        }
        const double height = static_cast<double>(face == 0 ? texels_ : half_);
        return hn::And(inside,
                       hn::And(hn::Lt(in_x, set(static_cast<float>(static_cast<double>(texels_) - x))),
                               hn::Lt(in_y, set(static_cast<float>(height - y)))));
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

    TexelTiles tiles_;
    CacheLineVector<std::uint32_t> ids_;
    CacheLineVector<float> depth_; ///< 1 / depth; 0: nothing
    float texels_;
    float half_;
    std::uint32_t across_;
    bool padded_; ///< some tiles have padding
    const TileWeights* weights_ = nullptr;
    Coverage* coverage_ = nullptr;
    std::vector<DrawnCells> cells_; ///< of the hemicube, where coverage is wanted
    alignas(64) std::array<float, tile_size> tile_x_{};
    alignas(64) std::array<float, tile_size> tile_y_{};
};

} // namespace
} // namespace hemi::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
