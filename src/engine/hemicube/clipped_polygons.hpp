#pragma once

#include "engine/hemicube/hemicube_drawer.hpp"
#include "engine/hemicube/view_builder.hpp"
#include "gl/objects.hpp"

#include <cstdint>

namespace hemi {

/// Draws polygons that the CPU transforms and clips, by ViewBuilder: for software OpenGL, whose own clipping
/// is several times as slow.
class ClippedPolygons final : public HemicubeDrawer {
public:
    /// @param list  must outlive this.
    ClippedPolygons(const DrawList& list, const Atlas& atlas);

    void add(const EyePoint& eye, const EyeFrame& frame, std::uint32_t slot, FrontViews* fronts) override;
    [[nodiscard]] bool full() const override;
    void draw() override;

private:
    Atlas atlas_;
    ViewBuilder views_;
    DrawStream stream_;
    gl::Program affine_;
    gl::Program bilinear_;
    gl::VertexArray layout_;
    gl::Buffer vertices_;
};

} // namespace hemi
