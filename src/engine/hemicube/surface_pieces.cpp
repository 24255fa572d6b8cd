#include "engine/hemicube/surface_pieces.hpp"

#include <array>
#include <map>
#include <utility>

namespace hemi {

namespace {

/// Patches of one size that no piece has yet: by row and column of their grid.
using Cells = std::map<std::array<std::uint32_t, 2>, std::uint32_t>;

/// Takes the largest rectangle from the first cell on, first along its row, out of the cells.
SurfacePiece take_rectangle(const PatchMesh& mesh, std::uint32_t surface, Cells& cells) {
    const auto [row, column] = cells.begin()->first;
    const auto row_is_free = [&](std::uint32_t v, std::uint32_t width) {
        for (std::uint32_t u = 0; u < width; ++u) {
            if (!cells.contains({v, column + u})) {
                return false;
            }
        }
        return true;
    };
    SurfacePiece piece;
    while (cells.contains({row, column + piece.grid.u})) {
        ++piece.grid.u;
    }
    while (row_is_free(row + piece.grid.v, piece.grid.u)) {
        ++piece.grid.v;
    }
    for (std::uint32_t v = 0; v < piece.grid.v; ++v) {
        for (std::uint32_t u = 0; u < piece.grid.u; ++u) {
            piece.patches.push_back(cells.extract({row + v, column + u}).mapped());
        }
    }
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
            pieces.push_back(take_rectangle(mesh, surface, cells));
        }
    }
    return pieces;
}

} // namespace hemi
