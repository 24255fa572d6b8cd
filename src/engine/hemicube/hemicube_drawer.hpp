#pragma once

#include "engine/hemicube/eye.hpp"
#include "engine/hemicube/view_builder.hpp"

#include <cstdint>
#include <string>

namespace hemi {

/// Where hemicubes are drawn: one column of squares of texels, each a hemicube's block of 3·resolution rows.
struct Atlas {
    std::uint32_t resolution;
    std::uint32_t slots; ///< hemicubes
    float grain;         ///< what the rasteriser snaps vertices to, texels
};

/// Draws the draw ids (see draw_list.hpp) of batches of hemicubes. Needs its context current.
///
/// Not drawn: the eye's own polygon, polygons edge-on to the eye and what lies on or behind its plane. Fronts
/// win ties in depth with backs, also within what snapping vertices may move them.
class HemicubeDrawer {
public:
    HemicubeDrawer() = default;
    HemicubeDrawer(const HemicubeDrawer&) = delete;
    HemicubeDrawer& operator=(const HemicubeDrawer&) = delete;
    virtual ~HemicubeDrawer() = default;

    /// Adds the slot-th hemicube of the batch.
    /// @param fronts  gets the views from the front, where the drawer knows them; may be null
    virtual void add(const EyePoint& eye, const EyeFrame& frame, std::uint32_t slot, FrontViews* fronts) = 0;
    /// Whether the batch should end although there are slots left.
    [[nodiscard]] virtual bool full() const { return false; }
    /// Draws the batch into the framebuffer that is bound, with reversed depth that culls back faces of the
    /// screen and takes clockwise ones for front faces; the next batch is empty.
    virtual void draw() = 0;
};

} // namespace hemi
