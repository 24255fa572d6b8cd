#include "engine/rasteriser/face_outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace hemi {

namespace {

// Texels. Edges are tested to 1/1000 texel.
constexpr double margin = 0.01;
constexpr double last_in_tile = 3.0;
constexpr double tile_width = 4.0;

} // namespace

FaceEdge make_edge(const FaceVertex& a, const FaceVertex& b) {
    FaceEdge e = a.projects ? FaceEdge{a.x, a.y, 1.0f, 0.0f, 0.0f, 0.0f, false}
                            : FaceEdge{a.hx, a.hy, a.hw, 0.0f, 0.0f, 0.0f, false};
    std::tie(e.bx, e.by, e.bw) = b.projects ? std::tuple(b.x, b.y, 1.0f) : std::tuple(b.hx, b.hy, b.hw);
    e.in = std::tie(e.by, e.bx, e.bw) > std::tie(e.ay, e.ax, e.aw);
    return e;
}

FaceOutline::FaceOutline(std::span<const FaceVertex> outline, const std::array<int, 4>& box,
                         float near_corners)
    : count_(static_cast<std::uint32_t>(outline.size())), columns_{static_cast<std::uint32_t>(box[0]) / 4,
                                                                   static_cast<std::uint32_t>(box[1]) / 4},
      rows_{static_cast<std::uint32_t>(box[2]) / 4, static_cast<std::uint32_t>(box[3]) / 4} {
    for (std::size_t k = 0; k < outline.size(); ++k) {
        const FaceVertex& a = outline[k];
        const FaceVertex& b = outline[k + 1 < outline.size() ? k + 1 : 0];
        const FaceEdge e = make_edge(a, b);
        edges_[k] = e;
        // The product of the differences, as a function of the point.
        const double ax = static_cast<double>(e.ax);
        const double ay = static_cast<double>(e.ay);
        const double aw = static_cast<double>(e.aw);
        const double bx = static_cast<double>(e.bx);
        const double by = static_cast<double>(e.by);
        const double bw = static_cast<double>(e.bw);
        const double x = ay * bw - aw * by;
        const double y = aw * bx - ax * bw;
        const double length = std::sqrt(x * x + y * y);
        const double scale =
            (std::abs(ax) + std::abs(ay)) * std::abs(bw) + (std::abs(bx) + std::abs(by)) * std::abs(aw);
        const double at_origin = ax * by - ay * bx;
        // A line at infinity, as of an edge in the eye's plane, is near no texel.
        const double reach = box[1] + box[3] + 2.0;
        const bool far = std::abs(at_origin) >
                         std::max(2.0 * reach * length, 1e-4 * (std::abs(ax * by) + std::abs(ay * bx)));
        near_[k] = far ? 0.0f : std::numeric_limits<float>::infinity();
        if (length > 1e-4 * scale) {
            near_[k] = static_cast<float>(static_cast<double>(near_corners) * length);
            lines_[k] = {x / length, y / length, at_origin / length, length / x, true};
        }
    }
}

FaceOutline::Span FaceOutline::row(std::uint32_t tile_row) const {
    const double low = tile_width * tile_row;
    const double high = low + last_in_tile;
    const double before = -1.0;
    const double beyond = columns_[1] + 1.0;
    double begin = columns_[0];
    double end = columns_[1];
    double inner_begin = begin;
    double inner_end = end;
    for (const Line& line : std::span(lines_).first(count_)) {
        if (!line.known) {
            inner_end = before;
            continue;
        }
        const double most = std::max(line.up * low, line.up * high) + line.offset;
        const double least = std::min(line.up * low, line.up * high) + line.offset;
        if (line.to_right > 0.0) {
            const double outer = (-margin - most) * line.inverse;
            const double inner = (margin - least) * line.inverse;
            begin = std::max(begin, std::ceil((outer - last_in_tile) / tile_width));
            inner_begin = std::max(inner_begin, std::ceil(inner / tile_width));
        } else if (line.to_right < 0.0) {
            const double outer = (-margin - most) * line.inverse;
            const double inner = (margin - least) * line.inverse;
            end = std::min(end, std::floor(outer / tile_width));
            inner_end = std::min(inner_end, std::floor((inner - last_in_tile) / tile_width));
        } else {
            end = most < -margin ? before : end;
            inner_end = least < margin ? before : inner_end;
        }
    }
    if (!(begin <= end)) {
        return {0, 0, 0, 0};
    }
    const auto tile = [beyond](double at) { return static_cast<std::uint32_t>(std::clamp(at, 0.0, beyond)); };
    const bool has_inner = inner_begin <= inner_end;
    return {tile(begin), tile(end) + 1, has_inner ? tile(inner_begin) : 0,
            has_inner ? tile(inner_end) + 1 : 0};
}

} // namespace hemi
