#pragma once

#include "engine/draw_list.hpp"
#include "engine/eye.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Vertex of a triangle in one view (one face of one hemicube of a batch), as the shaders read it.
struct DrawVertex {
    float x, y, z; ///< in the eye's frame; the unit is the near distance
    float grid_u, grid_v;
    float twist_u, twist_v;
    std::uint32_t first_id;
    std::uint32_t grid; ///< u | v << 16
    std::uint32_t view; ///< slot·8 + face, | split << 31
};

/// Vertices of one batch, three a triangle.
struct DrawStream {
    std::vector<DrawVertex> affine;   ///< patches on parallelograms and triangles
    std::vector<DrawVertex> bilinear; ///< patches on general quadrilaterals
    std::vector<DrawVertex> blocked;  ///< back faces; at equal depth a front wins

    void clear() {
        affine.clear();
        bilinear.clear();
        blocked.clear();
    }
};

/// Turns the draw list into what one eye sees: culls polygons on or behind the eye's plane, edge-on polygons
/// and those outside a face's pyramid; tells fronts from backs; moves the rest into the eye's frame in double
/// precision before it becomes float; scales so that the near plane at distance 1 cuts nothing.
class ViewBuilder {
public:
    explicit ViewBuilder(const DrawList& list) : list_(list) {}

    /// Appends the views of `eye`, the slot-th hemicube of the batch.
    void add(const EyePoint& eye, const EyeFrame& frame, std::uint32_t slot, DrawStream& stream);

private:
    struct Seen {
        std::uint32_t polygon;
        std::uint32_t faces; ///< bit per face
        bool back;
    };
    void transform(const EyePoint& eye, const EyeFrame& frame);
    void cull(const EyePoint& eye);
    [[nodiscard]] double near_distance(const EyePoint& eye) const;
    void emit(const Seen& seen, double scale, std::uint32_t slot, DrawStream& stream) const;

    const DrawList& list_;
    std::vector<Vec3> positions_;     ///< vertices in the eye's frame
    std::vector<std::uint8_t> sides_; ///< per vertex, which side of the faces' bounding planes
    std::vector<Seen> seen_;
};

} // namespace hemi
