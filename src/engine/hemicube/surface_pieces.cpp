#include "engine/hemicube/surface_pieces.hpp"

#include "scene/rectangles.hpp"

#include <array>
#include <map>
#include <utility>

namespace hemi {

namespace {

/// Takes the next rectangle of patches out of the cells.
SurfacePiece take_piece(const PatchMesh& mesh, std::uint32_t surface, Cells& cells) {
    Rectangle rectangle = take_rectangle(cells);
    SurfacePiece piece;
    piece.grid = {rectangle.columns, rectangle.rows};
    piece.patches = std::move(rectangle.cells);
    const auto corners_of = [&](std::uint32_t u, std::uint32_t v) {
        return mesh.part_corners(surface, mesh.parts(surface)[piece.patches[v * piece.grid.u + u]]).points;
    };
    const std::uint32_t last_u = piece.grid.u - 1;
    const std::uint32_t last_v = piece.grid.v - 1;
    piece.corners.points = {corners_of(0, 0)[0], corners_of(last_u, 0)[1], corners_of(last_u, last_v)[2],
                            corners_of(0, last_v)[3]};
    return piece;
}

} // namespace

std::vector<SurfacePiece> pieces_of(const PatchMesh& mesh, std::uint32_t surface) {
    std::vector<SurfacePiece> pieces;
    const auto parts = mesh.parts(surface);
    const bool triangle = mesh.surfaces()[surface].vertex_count == 3;
    std::map<std::array<std::uint32_t, 2>, Cells> by_level;
    for (std::uint32_t k = 0; k < parts.size(); ++k) {
        if (triangle) {
            pieces.push_back({mesh.part_corners(surface, parts[k]), {1, 1}, {k}});
            continue;
        }
        const std::uint32_t width = mesh.grid(surface).u << parts[k].level_u;
        by_level[{parts[k].level_u, parts[k].level_v}][{parts[k].cell / width, parts[k].cell % width}] = k;
    }
    for (auto& [level, cells] : by_level) {
        while (!cells.empty()) {
            pieces.push_back(take_piece(mesh, surface, cells));
        }
    }
    return pieces;
}

} // namespace hemi
