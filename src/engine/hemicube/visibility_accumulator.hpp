#pragma once

#include "engine/hemicube/draw_list.hpp"
#include "engine/hemicube/eye.hpp"
#include "engine/hemicube/grid_map.hpp"
#include "engine/hemicube/view_builder.hpp"
#include "engine/rasteriser/rasteriser.hpp"
#include "engine/rasteriser/side_sets.hpp"
#include "hemi/engine/delta_form_factors.hpp"
#include "hemi/engine/visibility_provider.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Makes rows of visibility: V = visible / (visible + hidden) delta form factors, on the same texels. What is
/// visible is in the item buffers; what a polygon's front covers but others hide is known from the coverage
/// that the CPU rasteriser or the GPU counts, or found by scanning the spans of its outline. Memory: 16 bytes
/// a draw id and 16 a cell of the largest polygon.
class VisibilityAccumulator {
public:
    /// @param list  must outlive this.
    VisibilityAccumulator(const DrawList& list, std::uint32_t patches);

    /// Adds what is visible in one hemicube of OpenGL.
    /// @param ids  3·resolution rows of `resolution` draw ids
    void add(const std::uint32_t* ids, const DeltaFormFactors& weights);
    /// Adds what is hidden in it.
    /// @param views  what the eye would see if nothing hid it
    void add_hidden(const std::uint32_t* ids, const DeltaFormFactors& weights, const FrontViews& views,
                    const EyePoint& eye, const EyeFrame& frame);
    /// The row so far, and starts the next one. The view is valid until the next call.
    [[nodiscard]] VisibilityRow take();
    /// The row of hemicubes of which add() added what is visible.
    /// @param covered  for each draw id the texels that it covers, hidden or not, in all of them
    [[nodiscard]] VisibilityRow take(std::span<const TexelTally> covered);

    /// Adds one hemicube of the CPU rasteriser, whose coverage is taken with the row.
    /// @param ids  in the order of TexelTiles
    void add_tiles(std::span<const std::uint32_t> ids, const TileWeights& weights);
    /// The row of hemicubes that add_tiles() added. The coverage is empty afterwards.
    /// @param sets  sides and parts of which it tells as a whole, in VisibilityRow::joint; null: of every
    ///   patch by itself. Must live as long as the view.
    [[nodiscard]] VisibilityRow take(Coverage& coverage, const SideSets* sets = nullptr);

private:
    using Tally = TexelTally;
    using Side = Coverage::Side; ///< one side of a polygon that some eye of the row saw

    void add_hidden(const std::uint32_t* ids, const DeltaFormFactors& weights, const FrontViews& views,
                    const FrontViews::View& view, const EyePoint& eye, const EyeFrame& frame);
    void spans(std::span<const FrontViews::Point> outline, std::uint32_t face, std::uint32_t resolution);
    void note_side(const Side& side);
    void take_single(std::uint32_t id, Tally covered);
    void pool(const Side& side);
    void pool_cells(const DrawPolygon& polygon, std::uint32_t first_id);
    void add_joint(std::uint32_t set, float share, std::uint32_t texels);
    void add_hidden_sets(Coverage& coverage);
    void set(std::uint32_t id, Tally visible, Tally hidden);

    const DrawList& list_;
    std::uint32_t patches_;
    /// draw id -> item, nothing for ids that stand for the same patch as a lower one: on the rim of a cut
    /// triangle rounding reaches cells outside it.
    std::vector<std::uint32_t> item_of_id_;
    struct Double {
        std::uint32_t id;
        std::uint32_t first;
    };
    std::vector<Double> doubles_; ///< those ids and the lower ones, ascending
    std::vector<GridMap> maps_;   ///< per polygon; made when views are added
    std::vector<Tally> visible_;  ///< per draw id
    std::vector<Tally> hidden_;
    std::vector<std::uint8_t> side_seen_; ///< bit 0: front, bit 1: back, per polygon
    std::vector<Side> sides_;
    std::uint32_t total_ = 0;
    struct Span {
        double left, right;
    };
    std::int32_t first_span_ = 0; ///< rows of the face that spans_ has
    std::vector<Span> spans_;
    std::vector<Tally> visible_table_; ///< sums over [0, u) x [0, v) cells
    std::vector<Tally> hidden_table_;
    std::vector<float> share_;           ///< per patch
    std::vector<std::uint8_t> evidence_; ///< per patch, 0: none
    std::vector<std::uint32_t> columns_;
    std::vector<float> shares_;
    std::vector<std::uint8_t> texels_;
    const SideSets* sets_ = nullptr; ///< that the row being taken tells of
    std::vector<JointVisibility> joint_;
};

} // namespace hemi
