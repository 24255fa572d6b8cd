#pragma once

#include "engine/hemicube/draw_list.hpp"
#include "engine/hemicube/eye.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Vertex of a triangle in one view (one face of one hemicube of a batch), as the shaders read it: clip
/// coordinates in the atlas (z is 1, the near distance), and what gives the draw id (see draw_list.hpp).
struct DrawVertex {
    float x, y, w;
    float grid_u, grid_v;
    float twist_u, twist_v;
    std::uint32_t first_id;
    std::uint32_t grid; ///< u | v << 16
    std::uint32_t split;
};

/// Vertices of one batch, three a triangle.
struct DrawStream {
    std::vector<DrawVertex> affine;   ///< patches on parallelograms and triangles
    std::vector<DrawVertex> bilinear; ///< patches on general quadrilaterals
    std::vector<DrawVertex> blocked;  ///< back faces; at equal depth a front wins

    [[nodiscard]] std::size_t size() const { return affine.size() + bilinear.size() + blocked.size(); }
    void clear() {
        affine.clear();
        bilinear.clear();
        blocked.clear();
    }
};

/// Where the polygons that an eye sees from the front fall on the faces of its hemicube, hidden or not.
struct FrontViews {
    struct View {
        std::uint32_t polygon;
        std::uint32_t face;
        bool back; ///< the back of a two-sided one
        std::uint32_t first_point;
        std::uint32_t point_count;
    };
    struct Point {
        double right, up; ///< on the face, at depth 1
    };
    std::vector<View> views;
    std::vector<Point> points; ///< corners of convex polygons, clockwise on the face

    void clear() {
        views.clear();
        points.clear();
    }
};

/// Turns the draw list into what one eye sees, and clips it to the faces.
///
/// Culls polygons on or behind the eye's plane, edge-on polygons and those outside a face's pyramid; tells
/// fronts from backs; moves the rest into the eye's frame in double precision before it becomes float; scales
/// so that the near plane at distance 1 cuts nothing. Polygons are clipped here rather than by OpenGL:
/// neighbours then get the same bits where a face cuts their common edge, so no crack opens; and software
/// OpenGL takes its short path, which is several times as fast for many polygons.
class ViewBuilder {
public:
    /// @param list   must outlive this.
    /// @param slots  hemicubes in the atlas: a column of 3·resolution rows each.
    ViewBuilder(const DrawList& list, std::uint32_t slots);

    /// Appends the views of `eye`, the slot-th hemicube of the batch.
    /// @param fronts  gets the views from the front; may be null.
    void add(const EyePoint& eye, const EyeFrame& frame, std::uint32_t slot, DrawStream& stream,
             FrontViews* fronts = nullptr);

private:
    struct Seen {
        std::uint32_t polygon;
        std::uint32_t faces; ///< bit per face
        bool back;
    };
    /// A corner in a face's frame (right, up, depth) and on its polygon's grid.
    struct FaceVertex {
        double right, up, depth;
        double grid_u, grid_v;
    };
    void transform(const EyePoint& eye, const EyeFrame& frame);
    void cull(const EyePoint& eye);
    [[nodiscard]] double near_distance(const EyePoint& eye) const;
    void emit(const Seen& seen, double scale, std::uint32_t slot, DrawStream& stream, FrontViews* fronts);
    void record(const Seen& seen, int face, FrontViews& fronts) const;
    /// Clips the polygon in clipped_ to a face's pyramid.
    void clip(int face);

    const DrawList& list_;
    std::uint32_t slots_;
    std::vector<Vec3> positions_;     ///< vertices in the eye's frame
    std::vector<std::uint8_t> sides_; ///< per vertex, which side of the faces' bounding planes
    std::vector<Seen> seen_;
    std::vector<FaceVertex> clipped_;
    std::vector<FaceVertex> scratch_;
};

} // namespace hemi
