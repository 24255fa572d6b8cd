#pragma once

#include "engine/hemicube/eye.hpp"
#include "engine/rasteriser/raster_scene.hpp"
#include "engine/rasteriser/texel_tiles.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hemi {

/// What covers texel centres though it may be hidden there, of sides that have patches, summed over the
/// hemicubes of a row: weights and numbers of texels.
struct Coverage {
    explicit Coverage(std::size_t draw_ids) : of_id(draw_ids, 0) {}

    /// An element a draw id: of a polygon of one cell all texels that it covers, seen or hidden; of a cell of
    /// another polygon the hidden ones only.
    std::vector<TexelTally> of_id;
    std::vector<std::uint32_t> single_ids; ///< those of polygons of one cell that are not 0, each once
    /// A side of a polygon of several cells that was drawn.
    struct Side {
        std::uint32_t polygon;
        bool back;
    };
    std::vector<Side> sides; ///< once a hemicube

    /// Whether parts and polygons that are hidden as a whole need not be drawn: they stand below, and nothing
    /// else is known of them.
    bool skip_hidden = false;
    std::vector<std::uint32_t> hidden_parts; ///< of the RasterScene
    std::vector<Side> hidden_sides;          ///< those towards the eye, of polygons
};

/// Fills the item buffers of one hemicube after another on the calling thread, by SIMD instructions.
///
/// A texel shows the polygon that its centre lies in and that is nearest there. Edges that polygons share are
/// tested by the same arithmetic in both, so that a texel's centre is in exactly one of them; centres further
/// than 1/1000 texel from an edge are decided right (up to a resolution of 1024). Fronts are drawn nearer by
/// 1e-6 of their distance than backs; at equal depth the lower draw id shows. The ids are the same for every
/// instruction set: no fused operations, no estimates, no order of drawing matters.
class Rasteriser {
public:
    virtual ~Rasteriser() = default;

    /// Draws what an eye sees, as ViewBuilder does: without the eye's own polygon, polygons edge-on and
    /// those on or behind its plane.
    /// @param weights   of the texels, for `coverage`
    /// @param coverage  what is added to; may be null
    virtual void draw(const EyePoint& eye, const EyeFrame& frame, const TileWeights* weights,
                      Coverage* coverage) = 0;

    /// Draw ids of the last hemicube, in the order of TexelTiles.
    [[nodiscard]] virtual std::span<const std::uint32_t> ids() const = 0;
};

/// A rasteriser of the best instruction set that this processor has, or of the one that the environment
/// variable HEMI_SIMD names.
/// @param scene  must outlive it
/// @throws InvalidArgument where HEMI_SIMD names none, or one that is not there
[[nodiscard]] std::unique_ptr<Rasteriser> make_rasteriser(const RasterScene& scene, const TexelTiles& tiles);

/// The instruction set that make_rasteriser() takes: scalar, sse4, avx2 or avx512.
/// @throws InvalidArgument as make_rasteriser()
[[nodiscard]] std::string simd_in_use();

} // namespace hemi
