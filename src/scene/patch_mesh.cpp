#include "hemi/scene/patch_mesh.hpp"

#include "core/fnv1a.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>

namespace hemi {

namespace {

/// Cell of a triangle cut n² ways: strip, position along the strip, and whether it stands upright.
struct TriangleCell {
    std::uint32_t strip;
    std::uint32_t along;
    bool upright;
};

TriangleCell triangle_cell(std::uint32_t n, std::uint32_t local) {
    // Strips of 2(n - strip) - 1 triangles begin at strip·(2n - strip).
    const double root = std::sqrt(static_cast<double>(n) * n - local);
    auto strip = static_cast<std::uint32_t>(std::max(0.0, static_cast<double>(n) - root));
    const auto begin = [n](std::uint32_t s) { return std::uint64_t{s} * (2 * std::uint64_t{n} - s); };
    while (begin(strip + 1) <= local) {
        ++strip;
    }
    while (begin(strip) > local) {
        --strip;
    }
    const auto within = static_cast<std::uint32_t>(local - begin(strip));
    return {strip, within / 2, within % 2 == 0};
}

Vec3 point_on(const Surface& surface, double u, double v) {
    const auto& p = surface.vertices;
    if (surface.vertex_count == 3) {
        return p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]);
    }
    const Vec3 twist = (p[2] - p[1]) - (p[3] - p[0]);
    return p[0] + u * (p[1] - p[0]) + v * (p[3] - p[0]) + (u * v) * twist;
}

/// Exact corners where a grid point is a corner of the surface, so that neighbours share bits.
Vec3 grid_point(const Surface& surface, Grid grid, std::uint32_t iu, std::uint32_t iv) {
    const auto& p = surface.vertices;
    if (iu == 0 && iv == 0) {
        return p[0];
    }
    if (iu == grid.u && iv == 0) {
        return p[1];
    }
    if (surface.vertex_count == 3) {
        if (iu == 0 && iv == grid.v) {
            return p[2];
        }
    } else {
        if (iu == grid.u && iv == grid.v) {
            return p[2];
        }
        if (iu == 0 && iv == grid.v) {
            return p[3];
        }
    }
    return point_on(surface, static_cast<double>(iu) / grid.u, static_cast<double>(iv) / grid.v);
}

PatchCorners front_corners(const Surface& surface, Grid grid, std::uint32_t local) {
    PatchCorners corners;
    if (surface.vertex_count == 3) {
        const TriangleCell cell = triangle_cell(grid.u, local);
        const std::uint32_t i = cell.strip;
        const std::uint32_t j = cell.along;
        corners.count = 3;
        if (cell.upright) {
            corners.points = {grid_point(surface, grid, j, i), grid_point(surface, grid, j + 1, i),
                              grid_point(surface, grid, j, i + 1), Vec3(0.0)};
        } else {
            corners.points = {grid_point(surface, grid, j + 1, i), grid_point(surface, grid, j + 1, i + 1),
                              grid_point(surface, grid, j, i + 1), Vec3(0.0)};
        }
        return corners;
    }
    const std::uint32_t iu = local % grid.u;
    const std::uint32_t iv = local / grid.u;
    corners.points = {grid_point(surface, grid, iu, iv), grid_point(surface, grid, iu + 1, iv),
                      grid_point(surface, grid, iu + 1, iv + 1), grid_point(surface, grid, iu, iv + 1)};
    return corners;
}

/// Number of a cell on a triangle that is cut n² ways, see triangle_cell().
std::uint32_t triangle_local(std::uint32_t n, std::uint32_t strip, std::uint32_t along, bool upright) {
    return strip * (2 * n - strip) + 2 * along + (upright ? 0 : 1);
}

/// Grid that a part is a cell of.
Grid grid_of(Grid cells, const GridPart& part) {
    return {cells.u << part.level_u, cells.v << part.level_v};
}

constexpr std::uint32_t max_grid = 65535;

/// The parts that a part is cut into.
std::vector<GridPart> cut_part(bool triangle, Grid cells, const GridPart& part, bool across_u,
                               bool across_v) {
    const Grid grid = grid_of(cells, part);
    const GridPart finer{part.level_u + (across_u ? 1 : 0), part.level_v + (across_v ? 1 : 0), 0};
    if ((across_u && grid.u > max_grid / 2) || (across_v && grid.v > max_grid / 2)) {
        throw InvalidArgument(
            fmt::format("a surface would be cut more than {} ways along an edge", max_grid));
    }
    std::vector<GridPart> parts;
    const auto add = [&parts, finer](std::uint32_t cell) {
        parts.push_back({finer.level_u, finer.level_v, cell});
    };
    if (triangle) {
        const TriangleCell cell = triangle_cell(grid.u, part.cell);
        const std::uint32_t n = 2 * grid.u;
        const std::uint32_t i = 2 * cell.strip;
        const std::uint32_t j = 2 * cell.along;
        if (cell.upright) {
            add(triangle_local(n, i, j, true));
            add(triangle_local(n, i, j, false));
            add(triangle_local(n, i, j + 1, true));
            add(triangle_local(n, i + 1, j, true));
        } else {
            add(triangle_local(n, i, j + 1, false));
            add(triangle_local(n, i + 1, j, false));
            add(triangle_local(n, i + 1, j + 1, true));
            add(triangle_local(n, i + 1, j + 1, false));
        }
        return parts;
    }
    const std::uint32_t width = across_u ? 2 : 1;
    const std::uint32_t height = across_v ? 2 : 1;
    const std::uint32_t u = part.cell % grid.u * width;
    const std::uint32_t v = part.cell / grid.u * height;
    for (std::uint32_t b = 0; b < height; ++b) {
        for (std::uint32_t a = 0; a < width; ++a) {
            add((v + b) * grid.u * width + u + a);
        }
    }
    return parts;
}

/// Means of opposite edges of a quadrilateral, along u and along v.
std::array<double, 2> lengths(const PatchCorners& corners) {
    const auto& p = corners.points;
    return {glm::distance(p[0], p[1]) + glm::distance(p[3], p[2]),
            glm::distance(p[0], p[3]) + glm::distance(p[1], p[2])};
}

/// All cells of a grid, as parts.
std::vector<GridPart> whole_cells(Grid grid) {
    std::vector<GridPart> parts;
    for (std::uint32_t cell = 0; cell < grid.u * grid.v; ++cell) {
        parts.push_back({0, 0, cell});
    }
    return parts;
}

/// Levels of the grid that all parts are whole cells of.
GridPart finest(std::span<const GridPart> parts) {
    GridPart finest;
    for (const GridPart& part : parts) {
        finest.level_u = std::max(finest.level_u, part.level_u);
        finest.level_v = std::max(finest.level_v, part.level_v);
    }
    return finest;
}

/// Cells that this grid may have, so that it can be seen whether parts fill it.
constexpr std::uint64_t most_cells = std::uint64_t{1} << 28;

/// How many cells a finer grid has, or one more than there may be.
std::uint64_t cells_of(Grid cells, const GridPart& levels) {
    const std::uint64_t u = std::uint64_t{cells.u} << std::min(levels.level_u, 28u);
    const std::uint64_t v = std::uint64_t{cells.v} << std::min(levels.level_v, 28u);
    return u > most_cells || v > most_cells ? most_cells + 1 : std::min(u * v, most_cells + 1);
}

/// Whether parts fill the cells of a surface, and none of it twice.
bool fill(bool triangle, Grid cells, std::span<const GridPart> parts) {
    const GridPart levels = finest(parts);
    const std::uint64_t fine_u = std::uint64_t{cells.u} << std::min(levels.level_u, 32u);
    const std::uint64_t fine_v = std::uint64_t{cells.v} << std::min(levels.level_v, 32u);
    if (fine_u > max_grid || fine_v > max_grid || fine_u * fine_v > most_cells) {
        return false;
    }
    const std::uint64_t halves = triangle ? 2 : 1; // a square cell is two triangles
    std::vector<bool> filled(fine_u * fine_v * halves, false);
    std::uint64_t count = 0;
    const auto mark = [&](std::uint64_t u, std::uint64_t v, std::uint64_t half) {
        const std::uint64_t at = (v * fine_u + u) * halves + half;
        const bool free = !filled[at];
        filled[at] = true;
        ++count;
        return free;
    };
    for (const GridPart& part : parts) {
        const Grid grid = grid_of(cells, part);
        if ((triangle && part.level_u != part.level_v) || part.cell >= grid.u * grid.v) {
            return false;
        }
        const std::uint32_t width = 1u << (levels.level_u - part.level_u);
        const std::uint32_t height = 1u << (levels.level_v - part.level_v);
        const TriangleCell cell = triangle ? triangle_cell(grid.u, part.cell)
                                           : TriangleCell{part.cell / grid.u, part.cell % grid.u, true};
        for (std::uint32_t v = 0; v < height; ++v) {
            for (std::uint32_t u = 0; u < width; ++u) {
                for (std::uint32_t half = 0; half < halves; ++half) {
                    // The upright triangle is the lower half of its square.
                    if ((!triangle || (u + v + half < width) == cell.upright) &&
                        !mark(std::uint64_t{cell.along} * width + u, std::uint64_t{cell.strip} * height + v,
                              half)) {
                        return false;
                    }
                }
            }
        }
    }
    return count == (triangle ? fine_u * fine_u : fine_u * fine_v);
}

std::uint32_t cells_along(double length, double patch_size) {
    // A hair of slack, so that an edge of exactly n patch sizes is not cut n + 1 ways by rounding.
    const double cells = std::ceil(length / patch_size * (1.0 - 1e-9));
    if (!(cells < 1e6)) {
        throw InvalidArgument(
            fmt::format("patch size {} cuts an edge of length {} into {:.3g} pieces; at most 1e6", patch_size,
                        length, cells));
    }
    return std::max(1u, static_cast<std::uint32_t>(cells));
}

Grid choose_grid(const Surface& surface, const Scene& scene, const Subdivision& subdivision) {
    if (subdivision.patch_size) {
        return grid_for_size(surface, *subdivision.patch_size);
    }
    if (subdivision.patches_per_face) {
        std::uint32_t k = 1;
        while (std::uint64_t{k} * k < *subdivision.patches_per_face) {
            ++k;
        }
        return {k, k};
    }
    if (surface.patches) {
        return *surface.patches;
    }
    if (scene.patch_size) {
        return grid_for_size(surface, *scene.patch_size);
    }
    return {1, 1};
}

void add_point(Fnv1a& hash, const Vec3& point) {
    for (int axis = 0; axis < 3; ++axis) {
        hash.add(std::bit_cast<std::uint64_t>(point[axis] + 0.0)); // +0.0: -0 and 0 are the same place
    }
}

} // namespace

Grid grid_for_size(const Surface& surface, double patch_size) {
    const auto& p = surface.vertices;
    if (surface.vertex_count == 3) {
        const double longest =
            std::max({glm::length(p[1] - p[0]), glm::length(p[2] - p[1]), glm::length(p[0] - p[2])});
        const std::uint32_t n = cells_along(longest, patch_size);
        return {n, n};
    }
    return {cells_along(std::max(glm::length(p[1] - p[0]), glm::length(p[2] - p[3])), patch_size),
            cells_along(std::max(glm::length(p[2] - p[1]), glm::length(p[3] - p[0])), patch_size)};
}

double mean_patch_size(const PatchMesh& mesh) {
    double sum = 0.0;
    double area = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchCorners corners = mesh.corners(i);
        double longest = 0.0;
        for (std::uint32_t k = 0; k < corners.count; ++k) {
            longest =
                std::max(longest, glm::distance(corners.points[k], corners.points[(k + 1) % corners.count]));
        }
        sum += mesh.areas()[i] * longest;
        area += mesh.areas()[i];
    }
    return sum / area;
}

PatchMesh::PatchMesh(const Scene& scene, const Subdivision& subdivision) {
    validate(scene);
    if (subdivision.patch_size &&
        !(*subdivision.patch_size > 0.0 && std::isfinite(*subdivision.patch_size))) {
        throw InvalidArgument(
            fmt::format("patch size {}; must be a positive length", *subdivision.patch_size));
    }
    surfaces_ = scene.surfaces;
    groups_ = scene.groups;
    symmetry_ = scene.symmetry;
    bounds_ = scene.bounds();

    grids_.reserve(surfaces_.size());
    for (const Surface& surface : surfaces_) {
        grids_.push_back(choose_grid(surface, scene, subdivision));
    }
    parts_ = subdivision.parts;
    check_parts();
    measure();
}

void PatchMesh::check_parts() const {
    if (!parts_.empty() && parts_.size() != surfaces_.size()) {
        throw InvalidArgument(
            fmt::format("parts of {} surfaces; the scene has {}", parts_.size(), surfaces_.size()));
    }
    std::uint64_t cells = 0; // of all surfaces: a small file must not ask for much work
    for (std::uint32_t s = 0; s < parts_.size(); ++s) {
        if (parts_[s].empty()) {
            continue;
        }
        cells += cells_of(grids_[s], finest(parts_[s]));
        if (cells > most_cells || !fill(surfaces_[s].vertex_count == 3, grids_[s], parts_[s])) {
            throw InvalidArgument(fmt::format("the parts of surface {} (group \"{}\") do not fill it", s,
                                              groups_[surfaces_[s].group]));
        }
    }
}

PatchMesh PatchMesh::cut(const PatchCuts& cuts) const {
    if (cuts.grids.size() != surfaces_.size()) {
        throw InvalidArgument(
            fmt::format("cuts of {} surfaces; the mesh has {}", cuts.grids.size(), surfaces_.size()));
    }
    for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
        const Grid grid = cuts.grids[s];
        if (grid.u == 0 || grid.v == 0 || (surfaces_[s].vertex_count == 3 && grid.u != grid.v)) {
            throw InvalidArgument(fmt::format("surface {} cannot be cut into {} x {}", s, grid.u, grid.v));
        }
    }
    PatchMesh mesh;
    mesh.surfaces_ = surfaces_;
    mesh.groups_ = groups_;
    mesh.symmetry_ = symmetry_;
    mesh.bounds_ = bounds_;
    mesh.grids_ = cuts.grids;
    mesh.parts_ = cuts.parts;
    mesh.check_parts();
    mesh.measure();
    return mesh;
}

void PatchMesh::measure() {
    std::uint64_t count = 0;
    first_patch_.reserve(surfaces_.size() + 1);
    for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
        first_patch_.push_back(static_cast<std::uint32_t>(count));
        const Grid grid = grids_[s];
        const std::uint64_t most = std::uint64_t{1} << 31;
        const std::uint64_t per_side = parts(s).empty() ? std::uint64_t{grid.u} * grid.v : parts(s).size();
        if (per_side < most) {
            count += per_side * (surfaces_[s].two_sided ? 2 : 1);
        }
        if (per_side >= most || count >= most) {
            throw InvalidArgument(
                fmt::format("surface {} (group \"{}\"), cut into {} x {}, brings the scene to {} "
                            "patches or more; choose larger patches",
                            s, groups_[surfaces_[s].group], grid.u, grid.v, most));
        }
    }
    first_patch_.push_back(static_cast<std::uint32_t>(count));

    areas_.reserve(count);
    centres_.reserve(count);
    surface_of_.reserve(count);
    surface_normals_.reserve(surfaces_.size());
    for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
        surface_normals_.push_back(glm::normalize(area_vector(surfaces_[s].polygon())));
        const std::uint32_t per_side = patches_per_side(s);
        for (std::uint32_t local = 0; local < per_side; ++local) {
            const PatchCorners corners = local_corners(s, local);
            areas_.push_back(glm::length(area_vector(corners.polygon())));
            centres_.push_back(area_centroid(corners.polygon()));
            surface_of_.push_back(s);
        }
        if (surfaces_[s].two_sided) {
            for (std::uint32_t local = 0; local < per_side; ++local) {
                areas_.push_back(areas_[first_patch_[s] + local]);
                centres_.push_back(centres_[first_patch_[s] + local]);
                surface_of_.push_back(s);
            }
        }
    }
}

PatchCorners PatchMesh::part_corners(std::uint32_t s, const GridPart& part) const {
    return front_corners(surfaces_[s], grid_of(grids_[s], part), part.cell);
}

PatchCorners PatchMesh::local_corners(std::uint32_t s, std::uint32_t local) const {
    return parts(s).empty() ? front_corners(surfaces_[s], grids_[s], local)
                            : part_corners(s, parts(s)[local]);
}

PatchSplit PatchMesh::split_by_shape(std::uint32_t patch) const {
    const PatchCorners own = corners(patch); // of a back patch in reverse: the same lengths
    const auto [u, v] = lengths(own);
    return {patch, own.count == 3 || u > 0.51 * v, own.count == 3 || v > 0.51 * u};
}

SplitMesh PatchMesh::split(std::span<const std::uint32_t> patches, Cut how) const {
    std::vector<PatchSplit> splits;
    for (const std::uint32_t patch : patches) {
        splits.push_back(how == Cut::in_four ? PatchSplit{patch} : split_by_shape(patch));
    }
    return split(splits);
}

SplitMesh PatchMesh::split(std::span<const PatchSplit> splits) const {
    std::vector<std::map<std::uint32_t, PatchSplit>> wanted(surfaces_.size());
    for (const PatchSplit& split : splits) {
        const std::uint32_t s = surface_of_[split.patch];
        const std::uint32_t local = (split.patch - first_patch_[s]) % patches_per_side(s);
        PatchSplit& both_sides = wanted[s].try_emplace(local, PatchSplit{local, false, false}).first->second;
        both_sides.along_u = both_sides.along_u || split.along_u;
        both_sides.along_v = both_sides.along_v || split.along_v;
    }
    std::vector<std::uint32_t> parents;
    PatchMesh mesh;
    mesh.surfaces_ = surfaces_;
    mesh.groups_ = groups_;
    mesh.symmetry_ = symmetry_;
    mesh.bounds_ = bounds_;
    mesh.grids_ = grids_;
    mesh.parts_.resize(surfaces_.size());
    std::uint64_t cells = 0; // as the constructor counts them
    for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
        const bool triangle = surfaces_[s].vertex_count == 3;
        const std::vector<GridPart> old =
            parts(s).empty() ? whole_cells(grids_[s]) : std::vector(parts(s).begin(), parts(s).end());
        std::vector<std::pair<GridPart, std::uint32_t>> parts; // and whose they are
        for (std::uint32_t local = 0; local < old.size(); ++local) {
            const auto split = wanted[s].find(local);
            if (split == wanted[s].end()) {
                parts.emplace_back(old[local], local);
                continue;
            }
            for (const GridPart& part :
                 cut_part(triangle, grids_[s], old[local], triangle || split->second.along_u,
                          triangle || split->second.along_v)) {
                parts.emplace_back(part, local);
            }
        }
        std::vector<GridPart> all;
        for (const auto& part : parts) {
            all.push_back(part.first);
        }
        const Grid fine = grid_of(grids_[s], finest(all));
        const bool even = std::all_of(all.begin(), all.end(), [&all](const GridPart& part) {
            return part.level_u == all[0].level_u && part.level_v == all[0].level_v;
        });
        cells += even ? 0 : cells_of(grids_[s], finest(all));
        if (cells > most_cells) {
            throw InvalidArgument(fmt::format("surface {} (group \"{}\") would be cut into {} x {}", s,
                                              groups_[surfaces_[s].group], fine.u, fine.v));
        }
        // Parts of one size are the cells of a finer grid.
        if (even) {
            mesh.grids_[s] = fine;
            std::sort(parts.begin(), parts.end(),
                      [](const auto& a, const auto& b) { return a.first.cell < b.first.cell; });
        } else {
            mesh.parts_[s] = std::move(all);
        }
        for (std::uint32_t side = 0; side < (surfaces_[s].two_sided ? 2u : 1u); ++side) {
            for (const auto& part : parts) {
                parents.push_back(first_patch_[s] + side * patches_per_side(s) + part.second);
            }
        }
    }
    if (std::all_of(mesh.parts_.begin(), mesh.parts_.end(), [](const auto& of) { return of.empty(); })) {
        mesh.parts_.clear();
    }
    mesh.measure();
    return {std::move(mesh), std::move(parents)};
}

WholeFaces PatchMesh::whole_faces() const {
    const auto is_alike = [this](std::uint32_t s, std::uint32_t first) {
        const Surface& one = surfaces_[first];
        const Surface& other = surfaces_[s];
        return patches_per_side(s) == 1 && other.two_sided == one.two_sided && other.group == one.group &&
               other.material == one.material && other.heat == one.heat;
    };
    const auto end_of_face = [&](std::uint32_t first) {
        std::uint32_t end = first + 1;
        bool alike = !surfaces_[first].continues && patches_per_side(first) == 1;
        for (; alike && end < surfaces_.size() && surfaces_[end].continues; ++end) {
            alike = is_alike(end, first);
        }
        return alike ? end : first + 1;
    };
    PatchMesh mesh;
    mesh.groups_ = groups_;
    mesh.symmetry_ = symmetry_;
    mesh.bounds_ = bounds_;
    std::vector<std::uint32_t> first_of; // of the faces' surfaces
    for (std::uint32_t s = 0; s < surfaces_.size(); s = end_of_face(s)) {
        first_of.push_back(s);
        mesh.surfaces_.push_back(surfaces_[s]);
        mesh.grids_.push_back(grids_[s]);
        if (!parts_.empty()) {
            mesh.parts_.push_back(parts_[s]);
        }
    }
    mesh.measure();
    first_of.push_back(static_cast<std::uint32_t>(surfaces_.size()));
    std::vector<std::uint32_t> patch_of;
    patch_of.reserve(size());
    for (std::uint32_t face = 0; face + 1 < first_of.size(); ++face) {
        for (std::uint32_t s = first_of[face]; s < first_of[face + 1]; ++s) {
            for (std::uint32_t i = first_patch(s); i < first_patch(s + 1); ++i) {
                patch_of.push_back(mesh.first_patch(face) + i - first_patch(s));
            }
        }
        if (first_of[face + 1] - first_of[face] > 1) {
            mesh.measure_face(face, *this, first_of[face], first_of[face + 1]);
        }
    }
    return {std::move(mesh), std::move(patch_of)};
}

void PatchMesh::measure_face(std::uint32_t face, const PatchMesh& pieces, std::uint32_t first,
                             std::uint32_t end) {
    double area = 0.0;
    Vec3 centre(0.0);
    Vec3 normal(0.0);
    for (std::uint32_t s = first; s < end; ++s) {
        const std::uint32_t piece = pieces.first_patch(s);
        area += pieces.areas()[piece];
        centre += pieces.areas()[piece] * pieces.centres()[piece];
        normal += pieces.areas()[piece] * pieces.surface_normal(s);
    }
    for (std::uint32_t i = first_patch(face); i < first_patch(face + 1); ++i) {
        areas_[i] = area;
        centres_[i] = centre / area;
    }
    if (glm::length(normal) > 0.0) { // else that of the first piece
        surface_normals_[face] = glm::normalize(normal);
    }
}

double PatchMesh::rounding() const {
    double magnitude = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        magnitude = std::max(magnitude, std::abs(bounds_.lower[axis]));
        magnitude = std::max(magnitude, std::abs(bounds_.upper[axis]));
    }
    return std::max(1e-12 * bounds_.diagonal(), 16.0 * std::numeric_limits<double>::epsilon() * magnitude);
}

std::uint32_t PatchMesh::patches_per_side(std::uint32_t s) const {
    return parts(s).empty() ? grids_[s].u * grids_[s].v : static_cast<std::uint32_t>(parts(s).size());
}

bool PatchMesh::is_back(std::uint32_t patch) const {
    const std::uint32_t s = surface_of_[patch];
    return patch - first_patch_[s] >= patches_per_side(s);
}

Vec3 PatchMesh::normal(std::uint32_t patch) const {
    const Vec3& front = surface_normals_[surface_of_[patch]];
    return is_back(patch) ? -front : front;
}

PatchCorners PatchMesh::corners(std::uint32_t patch) const {
    const std::uint32_t s = surface_of_[patch];
    const std::uint32_t per_side = patches_per_side(s);
    const std::uint32_t local = patch - first_patch_[s];
    PatchCorners corners = local_corners(s, local % per_side);
    if (local >= per_side) {
        std::reverse(corners.points.begin(), corners.points.begin() + corners.count);
    }
    return corners;
}

std::array<double, 2> PatchMesh::grid_coordinates(std::uint32_t patch) const {
    const std::uint32_t s = surface_of_[patch];
    const std::uint32_t local = (patch - first_patch_[s]) % patches_per_side(s);
    const GridPart part = parts(s).empty() ? GridPart{0, 0, local} : parts(s)[local];
    const Grid grid = grid_of(grids_[s], part);
    double u = part.cell % grid.u + 0.5;
    double v = part.cell / grid.u + 0.5;
    if (surfaces_[s].vertex_count == 3) {
        const TriangleCell cell = triangle_cell(grid.u, part.cell);
        const double third = cell.upright ? 1.0 / 3.0 : 2.0 / 3.0;
        u = cell.along + third;
        v = cell.strip + third;
    }
    return {std::ldexp(u, -static_cast<int>(part.level_u)), std::ldexp(v, -static_cast<int>(part.level_v))};
}

std::uint64_t PatchMesh::geometry_hash() const {
    Fnv1a hash;
    hash.add(surfaces_.size());
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
        const Surface& surface = surfaces_[s];
        hash.add((std::uint64_t{surface.vertex_count} << 1) | (surface.two_sided ? 1u : 0u));
        hash.add((std::uint64_t{grids_[s].u} << 32) | grids_[s].v);
        for (const Vec3& vertex : surface.polygon()) {
            add_point(hash, vertex);
        }
        for (const GridPart& part : parts(static_cast<std::uint32_t>(s))) {
            hash.add((std::uint64_t{part.level_u} << 40) | (std::uint64_t{part.level_v} << 32) | part.cell);
        }
    }
    if (symmetry_) {
        hash.add(symmetry_->mirrors.size());
        for (const MirrorPlane& plane : symmetry_->mirrors) {
            hash.add(static_cast<std::uint64_t>(plane.axis));
            add_point(hash, Vec3(plane.offset, 0.0, 0.0));
        }
        hash.add(symmetry_->rotation ? symmetry_->rotation->folds : 0u);
        hash.add(symmetry_->rotation ? static_cast<std::uint64_t>(symmetry_->rotation->axis) : 0u);
        for (const Vec3& period : symmetry_->periods) {
            add_point(hash, period);
        }
        hash.add(symmetry_->periods.empty() ? 0u : symmetry_->images);
    }
    return hash.value();
}

void adopt_mesh(Scene& scene, Subdivision& subdivision, const PatchMesh& mesh) {
    scene.surfaces.assign(mesh.surfaces().begin(), mesh.surfaces().end());
    for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
        scene.surfaces[s].patches = mesh.grid(s);
    }
    subdivision = {{}, {}, mesh.parts()};
}

std::vector<double> patch_values(const PatchMesh& mesh, std::span<const Material> materials,
                                 std::vector<double> Material::*property) {
    std::vector<double> values;
    values.reserve(mesh.size() * (materials.empty() ? 0 : (materials[0].*property).size()));
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::vector<double>& of_material = materials[mesh.material(i)].*property;
        values.insert(values.end(), of_material.begin(), of_material.end());
    }
    return values;
}

std::vector<double> emissivities(const PatchMesh& mesh, std::span<const Material> materials) {
    std::vector<double> of_material;
    for (const Material& material : materials) {
        const std::vector<double>& reflectance = material.reflectance;
        const double sum = std::accumulate(reflectance.begin(), reflectance.end(), 0.0);
        of_material.push_back(1.0 - sum / static_cast<double>(reflectance.size()));
    }
    std::vector<double> values;
    values.reserve(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        values.push_back(of_material[mesh.material(i)]);
    }
    return values;
}

} // namespace hemi
