#include "engine/hemicube/draw_list.hpp"

#include "hemi/engine/engine.hpp"

#include "core/welder.hpp"
#include "engine/hemicube/lattice.hpp"
#include "engine/hemicube/outline.hpp"
#include "engine/hemicube/surface_pieces.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace hemi {

namespace {

constexpr std::uint32_t none = 0xFFFFFFFFu;

/// Cell (and half, where cells are split) of a point on a grid.
std::uint32_t cell_of(Grid grid, std::uint32_t split, double u, double v) {
    const auto clamped = [](double value, std::uint32_t cells) {
        return static_cast<std::uint32_t>(std::clamp(std::floor(value), 0.0, static_cast<double>(cells - 1)));
    };
    const std::uint32_t i = clamped(u, grid.u);
    const std::uint32_t j = clamped(v, grid.v);
    const std::uint32_t half = split != 0 && (u - i) + (v - j) > 1.0 ? 1 : 0;
    return ((j * grid.u + i) << split) + half;
}

class DrawListBuilder {
public:
    DrawListBuilder(const PatchMesh& mesh, bool merge_lattices)
        : mesh_(mesh), merge_lattices_(merge_lattices) {}

    DrawList run() {
        add_polygons();
        finish_outlines();
        return std::move(list_);
    }

    std::size_t count() {
        add_polygons();
        return list_.polygons.size();
    }

private:
    void add_polygons() {
        list_.tolerance = mesh_.rounding();
        weld();
        list_.item_of_id = {item_nothing, item_blocked};
        list_.polygons_of_surface.assign(mesh_.surfaces().size(), {});
        if (merge_lattices_) {
            for (const MergedLattice& lattice :
                 find_lattices(mesh_, surface_vertices_, positions_, touching())) {
                add_lattice(lattice);
            }
        }
        for (std::uint32_t s = 0; s < mesh_.surfaces().size(); ++s) {
            if (list_.polygons_of_surface[s].count == 0) {
                add_surface(s);
            }
        }
    }

    void weld() {
        Welder welder(std::max(list_.tolerance, 1e-9 * mesh_.bounds().diagonal()));
        surface_vertices_.reserve(mesh_.surfaces().size());
        for (const Surface& surface : mesh_.surfaces()) {
            std::array<std::uint32_t, 4> vertices{};
            for (std::uint32_t c = 0; c < surface.vertex_count; ++c) {
                vertices[c] = welder.add(surface.vertices[c]);
            }
            surface_vertices_.push_back(vertices);
        }
        for (std::uint32_t s = 0; s < mesh_.surfaces().size(); ++s) {
            for (SurfacePiece& piece : pieces_of(mesh_, s)) {
                std::array<std::uint32_t, 4> vertices{};
                for (std::uint32_t c = 0; c < piece.corners.count; ++c) {
                    vertices[c] = welder.add(piece.corners.points[c]);
                }
                pieces_[s].emplace_back(std::move(piece), vertices);
            }
        }
        positions_ = welder.points();
    }

    [[nodiscard]] TouchingTolerance touching() const { return {mesh_.bounds().diagonal(), list_.tolerance}; }

    static void check_grid(Grid grid) {
        if (grid.u > 65535 || grid.v > 65535) {
            throw InvalidArgument(fmt::format(
                "a surface is cut into {} x {} patches; at most 65535 along an edge", grid.u, grid.v));
        }
    }

    /// Reserves draw ids for one side of a polygon.
    std::uint32_t reserve_ids(Grid grid, std::uint32_t split) {
        const std::size_t first = list_.item_of_id.size();
        const std::size_t cells = (std::size_t{grid.u} * grid.v) << split;
        if (first + cells >= none) {
            throw InvalidArgument("too many patches for 32-bit item ids; choose larger patches");
        }
        list_.item_of_id.resize(first + cells, item_nothing);
        return static_cast<std::uint32_t>(first);
    }

    /// Adds a lattice as one polygon, unless its patches do not fill the cells one to one.
    void add_lattice(const MergedLattice& lattice) {
        check_grid(lattice.cells);
        const std::uint32_t split = lattice.split ? 1 : 0;
        const Vec3& origin = positions_[lattice.vertices[0]];
        const Vec3 u = positions_[lattice.vertices[1]] - origin;
        const Vec3 v = positions_[lattice.vertices[3]] - origin;
        const Vec3 cross = glm::cross(u, v);
        const double squared = glm::dot(cross, cross);
        const Vec3 to_u = glm::cross(v, cross) * (lattice.cells.u / squared);
        const Vec3 to_v = glm::cross(cross, u) * (lattice.cells.v / squared);

        const bool two_sided = mesh_.surfaces()[lattice.surfaces[0]].two_sided;
        const std::size_t ids_before = list_.item_of_id.size();
        DrawPolygon polygon;
        polygon.grid = lattice.cells;
        polygon.split = split;
        polygon.front_id = reserve_ids(lattice.cells, split);
        polygon.back_id = two_sided ? reserve_ids(lattice.cells, split) : item_blocked;
        std::size_t filled = 0;
        for (const std::uint32_t s : lattice.surfaces) {
            const std::uint32_t per_side = mesh_.patches_per_side(s);
            for (std::uint32_t local = 0; local < per_side; ++local) {
                const std::uint32_t patch = mesh_.first_patch(s) + local;
                const Vec3 offset = mesh_.centres()[patch] - origin;
                const std::uint32_t cell =
                    cell_of(lattice.cells, split, glm::dot(offset, to_u), glm::dot(offset, to_v));
                filled += list_.item_of_id[polygon.front_id + cell] == item_nothing ? 1 : 0;
                list_.item_of_id[polygon.front_id + cell] = item_first_patch + patch;
                if (two_sided) {
                    list_.item_of_id[polygon.back_id + cell] = item_first_patch + patch + per_side;
                }
            }
        }
        if (filled != (std::size_t{lattice.cells.u} * lattice.cells.v) << split) {
            list_.item_of_id.resize(ids_before);
            return;
        }
        const auto gu = static_cast<double>(lattice.cells.u);
        const auto gv = static_cast<double>(lattice.cells.v);
        for (const std::uint32_t s : lattice.surfaces) {
            list_.polygons_of_surface[s] = {static_cast<std::uint32_t>(list_.polygons.size()), 1};
        }
        outlines_.push_back({{lattice.vertices[0], 0.0, 0.0},
                             {lattice.vertices[1], gu, 0.0},
                             {lattice.vertices[2], gu, gv},
                             {lattice.vertices[3], 0.0, gv}});
        polygon.normal = cross / std::sqrt(squared);
        list_.polygons.push_back(polygon);
    }

    void add_surface(std::uint32_t s) {
        const auto first = static_cast<std::uint32_t>(list_.polygons.size());
        const auto pieces = pieces_.find(s);
        if (pieces == pieces_.end()) {
            const Surface& surface = mesh_.surfaces()[s];
            add_piece(s, {{surface.vertices, surface.vertex_count}, mesh_.grid(s), {}}, surface_vertices_[s]);
        } else {
            for (const auto& [piece, vertices] : pieces->second) {
                add_piece(s, piece, vertices);
            }
        }
        list_.polygons_of_surface[s] = {first, static_cast<std::uint32_t>(list_.polygons.size()) - first};
    }

    void add_piece(std::uint32_t s, const SurfacePiece& piece, const std::array<std::uint32_t, 4>& vertices) {
        DrawPolygon polygon;
        polygon.grid = piece.grid;
        polygon.normal = mesh_.surface_normal(s);
        check_grid(polygon.grid);
        const auto gu = static_cast<double>(polygon.grid.u);
        const auto gv = static_cast<double>(polygon.grid.v);
        const bool one_patch = polygon.grid.u * polygon.grid.v == 1;
        Outline outline;
        std::uint32_t start = 0; // corner that the polygon's grid begins at
        if (piece.corners.count == 3) {
            polygon.split = one_patch ? 0 : 1;
            outline = {{vertices[0], 0.0, 0.0}, {vertices[1], gu, 0.0}, {vertices[2], 0.0, gv}};
        } else if (one_patch || is_parallelogram(piece.corners)) {
            outline = {{vertices[0], 0.0, 0.0},
                       {vertices[1], gu, 0.0},
                       {vertices[2], gu, gv},
                       {vertices[3], 0.0, gv}};
        } else {
            start = sharpest_corner(piece.corners);
            const auto far_corner = frame_coordinates(piece.corners, start);
            polygon.bilinear = 1;
            polygon.twist_u = static_cast<float>(far_corner[0] - 1.0);
            polygon.twist_v = static_cast<float>(far_corner[1] - 1.0);
            if (start % 2 == 1) {
                polygon.grid = {polygon.grid.v, polygon.grid.u};
            }
            outline = {{vertices[start], 0.0, 0.0},
                       {vertices[(start + 1) % 4], 1.0, 0.0},
                       {vertices[(start + 2) % 4], far_corner[0], far_corner[1]},
                       {vertices[(start + 3) % 4], 0.0, 1.0}};
        }
        polygon.front_id = reserve_ids(polygon.grid, polygon.split);
        fill_ids(s, piece, polygon, polygon.front_id, 0, start);
        if (mesh_.surfaces()[s].two_sided) {
            polygon.back_id = reserve_ids(polygon.grid, polygon.split);
            fill_ids(s, piece, polygon, polygon.back_id, mesh_.patches_per_side(s), start);
        }
        list_.polygons.push_back(polygon);
        outlines_.push_back(std::move(outline));
    }

    static bool is_parallelogram(const PatchCorners& corners) {
        const auto& p = corners.points;
        const double edge = std::min(glm::length(p[1] - p[0]), glm::length(p[3] - p[0]));
        return glm::length(p[0] - p[1] + p[2] - p[3]) <= 1e-6 * edge;
    }

    /// The corner whose edges span the largest area: the best frame for the grid. Another one may be
    /// straight.
    static std::uint32_t sharpest_corner(const PatchCorners& corners) {
        const auto& p = corners.points;
        std::uint32_t best = 0;
        double largest = -1.0;
        for (std::uint32_t c = 0; c < 4; ++c) {
            const double area = glm::length(glm::cross(p[(c + 1) % 4] - p[c], p[(c + 3) % 4] - p[c]));
            if (area > largest) {
                largest = area;
                best = c;
            }
        }
        return best;
    }

    /// The corner opposite to `start` in the frame of `start` and its two neighbours.
    static std::array<double, 2> frame_coordinates(const PatchCorners& corners, std::uint32_t start) {
        const auto& p = corners.points;
        const Vec3 u = p[(start + 1) % 4] - p[start];
        const Vec3 v = p[(start + 3) % 4] - p[start];
        const Vec3 cross = glm::cross(u, v);
        const Vec3 far_corner = p[(start + 2) % 4] - p[start];
        const double squared = glm::dot(cross, cross);
        return {glm::dot(glm::cross(far_corner, v), cross) / squared,
                glm::dot(glm::cross(u, far_corner), cross) / squared};
    }

    /// Cell of the surface's patch (i, j) on a grid that begins at corner `start`.
    static std::uint32_t turned_cell(Grid surface_grid, std::uint32_t i, std::uint32_t j,
                                     std::uint32_t start) {
        const std::uint32_t last_i = surface_grid.u - 1;
        const std::uint32_t last_j = surface_grid.v - 1;
        switch (start) {
        case 0:
            return j * surface_grid.u + i;
        case 1:
            return (last_i - i) * surface_grid.v + j;
        case 2:
            return (last_j - j) * surface_grid.u + (last_i - i);
        default:
            return i * surface_grid.v + (last_j - j);
        }
    }

    void fill_ids(std::uint32_t s, const SurfacePiece& piece, const DrawPolygon& polygon,
                  std::uint32_t first_id, std::uint32_t offset, std::uint32_t start) {
        const std::uint32_t first_item = item_first_patch + mesh_.first_patch(s) + offset;
        const std::uint32_t cells = piece.grid.u * piece.grid.v;
        const auto item_of = [&](std::uint32_t cell) {
            return first_item + (piece.patches.empty() ? cell : piece.patches[cell]);
        };
        if (polygon.split == 0) {
            for (std::uint32_t cell = 0; cell < cells; ++cell) {
                const std::uint32_t turned =
                    turned_cell(piece.grid, cell % piece.grid.u, cell / piece.grid.u, start);
                list_.item_of_id[first_id + turned] = item_of(cell);
            }
            return;
        }
        for (std::uint32_t cell = 0; cell < cells; ++cell) {
            const auto at = mesh_.grid_coordinates(mesh_.first_patch(s) + cell); // of a whole surface
            list_.item_of_id[first_id + cell_of(polygon.grid, 1, at[0], at[1])] = item_of(cell);
        }
        // Rounding along the hypotenuse overflows into the cells' other halves and beyond: they stand for
        // the triangle next to them.
        const std::uint32_t n = polygon.grid.u;
        for (std::uint32_t j = 0; j < n; ++j) {
            for (std::uint32_t i = 0; i < n; ++i) {
                for (std::uint32_t half = 0; half < 2; ++half) {
                    if (i + j + half < n) {
                        continue;
                    }
                    const std::uint32_t excess = i + j - (n - 1);
                    const std::uint32_t back_i = std::min(i, (excess + 1) / 2);
                    const std::uint32_t back_j = std::min(j, excess - back_i);
                    const std::uint32_t inside = ((j - back_j) * n + (i + back_j - excess)) * 2;
                    list_.item_of_id[first_id + (j * n + i) * 2 + half] = list_.item_of_id[first_id + inside];
                }
            }
        }
    }

    void finish_outlines() {
        insert_touching_vertices(outlines_, positions_, touching());
        std::vector<std::uint32_t> compact(positions_.size(), none);
        for (std::size_t p = 0; p < outlines_.size(); ++p) {
            DrawPolygon& polygon = list_.polygons[p];
            polygon.first_corner = static_cast<std::uint32_t>(list_.corners.size());
            polygon.corner_count = static_cast<std::uint32_t>(outlines_[p].size());
            Bounds bounds;
            for (const OutlinePoint& point : outlines_[p]) {
                if (compact[point.vertex] == none) {
                    compact[point.vertex] = static_cast<std::uint32_t>(list_.vertices.size());
                    list_.vertices.push_back(positions_[point.vertex]);
                }
                list_.corners.push_back(
                    {compact[point.vertex], static_cast<float>(point.u), static_cast<float>(point.v)});
                bounds.add(positions_[point.vertex]);
            }
            polygon.centre = bounds.centre();
            for (const OutlinePoint& point : outlines_[p]) {
                polygon.radius =
                    std::max(polygon.radius, glm::length(positions_[point.vertex] - polygon.centre));
            }
            const auto triangles = triangulate(outlines_[p]);
            polygon.first_triangle = static_cast<std::uint32_t>(list_.triangles.size());
            polygon.triangle_count = static_cast<std::uint32_t>(triangles.size());
            list_.triangles.insert(list_.triangles.end(), triangles.begin(), triangles.end());
        }
    }

    const PatchMesh& mesh_;
    bool merge_lattices_;
    DrawList list_;
    std::vector<std::array<std::uint32_t, 4>> surface_vertices_;
    /// Of surfaces whose patches differ in size, with their welded corners.
    std::map<std::uint32_t, std::vector<std::pair<SurfacePiece, std::array<std::uint32_t, 4>>>> pieces_;
    std::vector<Vec3> positions_;
    std::vector<Outline> outlines_;
};

} // namespace

DrawList make_draw_list(const PatchMesh& mesh, bool merge_lattices) {
    return DrawListBuilder(mesh, merge_lattices).run();
}

std::size_t count_draw_polygons(const PatchMesh& mesh, bool merge_lattices) {
    return DrawListBuilder(mesh, merge_lattices).count();
}

} // namespace hemi
