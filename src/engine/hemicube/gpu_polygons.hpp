#pragma once

#include "engine/hemicube/draw_list.hpp"
#include "engine/hemicube/eye.hpp"
#include "engine/hemicube/hemicube_drawer.hpp"
#include "engine/hemicube/raster_coordinates.hpp"
#include "gl/objects.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

struct PolygonVertex;

/// Triangles that lie near one another: culled together.
struct CulledCluster {
    std::array<float, 3> centre{}, extent{}; ///< box, in raster coordinates: half edges
    std::uint32_t first_vertex = 0;          ///< into the vertex buffer
    std::uint32_t vertices = 0;
};

/// One face of one hemicube as the shaders read it: block View of hemicube.vert. Padded to what every
/// driver's offsets of uniform buffers are multiples of.
struct alignas(256) FaceView {
    std::array<float, 3> right{};
    float unused0 = 0.0f;
    std::array<float, 3> up{};
    float unused1 = 0.0f;
    std::array<float, 3> depth{};
    float unused2 = 0.0f;
    std::array<float, 3> eye_high{};
    float unused3 = 0.0f;
    std::array<float, 3> eye_low{};
    std::uint32_t own_polygon = 0;
    std::uint32_t own_count = 0;
    std::uint32_t first_row = 0;
    float texel = 0.0f;
    float near = 0.0f;
    float tolerance = 0.0f;
    float grain = 0.0f;
};

/// Draws polygons that the GPU transforms, clips and numbers: for hardware, which does that faster than the
/// CPU. Positions are there in raster coordinates as sums of two floats, planes in double precision. Memory
/// there: 84 bytes a triangle, 64 a polygon and 64 more if it has cells.
class GpuPolygons final : public HemicubeDrawer {
public:
    /// @param list           must outlive this.
    /// @param count_covered  whether fragments count what covers texels: ItemBuffers::begin() binds what for.
    /// @throws GlError if the scene is larger than the driver's buffers.
    GpuPolygons(const DrawList& list, const Atlas& atlas, bool count_covered);

    void add(const EyePoint& eye, const EyeFrame& frame, std::uint32_t slot, FrontViews* fronts) override;
    void draw() override;

private:
    void upload(std::span<const PolygonVertex> vertices);
    void cull(const EyeFrame& frame, const SplitPosition& eye);
    void add_ranges(int face);

    const DrawList& list_;
    Atlas atlas_;
    RasterCoordinates coordinates_;
    std::vector<CulledCluster> clusters_;
    std::vector<std::uint8_t> faces_of_; ///< per cluster, bit per face: those that it may show on
    gl::Program program_;
    gl::VertexArray layout_;
    gl::Buffer vertices_;
    gl::Buffer polygons_;
    gl::Buffer grid_maps_;
    gl::Buffer view_block_;
    // Of the batch: for each face of each hemicube, hemicube by hemicube, ranges of the vertex buffer.
    std::vector<FaceView> views_;
    std::vector<std::size_t> range_end_; ///< of every view
    std::vector<GLint> first_;           ///< vertex of every range
    std::vector<GLsizei> count_;         ///< vertices of every range
};

} // namespace hemi
