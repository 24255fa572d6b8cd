#pragma once

#include "engine/rasteriser/projection.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace hemi {

/// An edge of an outline, from a to b: either end in texels (w = 1) where it projects, else homogeneous.
struct FaceEdge {
    float ax, ay, aw, bx, by, bw;
    bool in; ///< whether points on it count as inside: in one of the two polygons that share it
};
/// The edge from a to b.
[[nodiscard]] FaceEdge make_edge(const FaceVertex& a, const FaceVertex& b);

/// A convex polygon on a face, counter-clockwise, and the tiles that it covers.
///
/// Vertices may lie anywhere. Where both ends of an edge project, it is tested by the arithmetic of clusters.
class FaceOutline {
public:
    FaceOutline() = default;
    /// @param outline  3 or 4 vertices
    /// @param box      left, right, low and high texel that it may cover
    /// @param near_corners  SideCorners::margin()
    FaceOutline(std::span<const FaceVertex> outline, const std::array<int, 4>& box,
                float near_corners = 0.0f);

    [[nodiscard]] std::span<const FaceEdge> edges() const { return std::span(edges_).first(count_); }

    /// Of every edge the product of differences that is the margin's distance from it.
    [[nodiscard]] std::span<const float> near() const { return std::span(near_).first(count_); }

    /// First and last row of tiles.
    [[nodiscard]] std::uint32_t first_row() const { return rows_[0]; }
    [[nodiscard]] std::uint32_t last_row() const { return rows_[1]; }

    /// Tiles of a row that the outline may cover, [begin, end), and those that it covers whole, [inner_begin,
    /// inner_end); by distances from the edges, with a margin above all rounding.
    struct Span {
        std::uint32_t begin, end, inner_begin, inner_end;
    };
    [[nodiscard]] Span row(std::uint32_t tile_row) const;

private:
    /// Distance from an edge's line, positive inside: x·to_right + y·up + offset texels.
    struct Line {
        double to_right = 0.0, up = 0.0, offset = 0.0;
        double inverse = 0.0; ///< 1 / to_right
        bool known = false;   ///< false: the line is too short or too far to say anything
    };

    std::array<FaceEdge, 4> edges_{};
    std::array<Line, 4> lines_{};
    std::array<float, 4> near_{};
    std::uint32_t count_ = 0;
    std::array<std::uint32_t, 2> columns_{}; ///< first and last tile
    std::array<std::uint32_t, 2> rows_{};
};

} // namespace hemi
