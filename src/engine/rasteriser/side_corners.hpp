#pragma once

#include "engine/rasteriser/face_outline.hpp"
#include "engine/rasteriser/projection.hpp"
#include "engine/rasteriser/raster_scene.hpp"

#include <cstddef>
#include <cstdint>

namespace hemi {

/// Corners along the sides of a grid polygon that is drawn as one outline.
///
/// Where neighbours end along a side, the side bends by rounding. Away from it that moves no texel; texels
/// near it are tested against the part of the side that they lie at, as in the neighbour there, so that each
/// is in exactly one of the two.
class SideCorners {
public:
    SideCorners() = default; ///< of a polygon without such corners

    /// @param scene, projection  must outlive this
    /// @param grid               of RasterScene::grid_polygons, one with sides
    SideCorners(const RasterScene& scene, const Projection& projection, std::uint32_t grid, bool front);

    /// Whether there are any.
    [[nodiscard]] bool any() const { return scene_ != nullptr; }

    /// Texels further than this from a side, in texels, are decided right by its ends; infinity where the eye
    /// is so near to a side's line that nothing can be said.
    [[nodiscard]] float margin() const;

    /// Whether a texel is inside of all sides.
    /// @param outline  of the polygon on the face
    [[nodiscard]] bool contain(int face, const FaceOutline& outline, float x, float y) const;

private:
    /// The part of an outline's edge, between two corners, that a texel lies at.
    [[nodiscard]] FaceEdge part_at(int face, std::size_t edge, float x, float y) const;
    [[nodiscard]] const RasterScene::GridPolygon& polygon() const { return scene_->grid_polygons[grid_]; }
    /// The first corner after a side's begin and the last one's next, from 0; beyond the corners' number they
    /// begin again.
    [[nodiscard]] std::uint32_t end_of(std::uint32_t side) const;
    [[nodiscard]] std::size_t slot(std::uint32_t corner) const;

    const RasterScene* scene_ = nullptr;
    const Projection* projection_ = nullptr;
    std::uint32_t grid_ = 0;
    bool front_ = false;
};

} // namespace hemi
