#include "hemi/scene/patch_mesh.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
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

class Fnv1a {
public:
    void add(std::uint64_t value) {
        for (int byte = 0; byte < 8; ++byte) {
            hash_ = (hash_ ^ (value & 0xFFu)) * 0x100000001B3u;
            value >>= 8;
        }
    }
    void add(const Vec3& point) {
        for (int axis = 0; axis < 3; ++axis) {
            add(std::bit_cast<std::uint64_t>(point[axis] + 0.0)); // +0.0: -0 and 0 are the same place
        }
    }
    [[nodiscard]] std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 0xCBF29CE484222325u;
};

} // namespace

PatchMesh::PatchMesh(const Scene& scene, const Subdivision& subdivision) {
    validate(scene);
    if (subdivision.patch_size &&
        !(*subdivision.patch_size > 0.0 && std::isfinite(*subdivision.patch_size))) {
        throw InvalidArgument(
            fmt::format("patch size {}; must be a positive length", *subdivision.patch_size));
    }
    surfaces_ = scene.surfaces;
    groups_ = scene.groups;
    bounds_ = scene.bounds();

    std::uint64_t count = 0;
    grids_.reserve(surfaces_.size());
    first_patch_.reserve(surfaces_.size() + 1);
    for (const Surface& surface : surfaces_) {
        const Grid grid = choose_grid(surface, scene, subdivision);
        grids_.push_back(grid);
        first_patch_.push_back(static_cast<std::uint32_t>(count));
        const std::uint64_t most = std::uint64_t{1} << 31;
        const std::uint64_t per_side = std::uint64_t{grid.u} * grid.v;
        if (per_side < most) {
            count += per_side * (surface.two_sided ? 2 : 1);
        }
        if (per_side >= most || count >= most) {
            throw InvalidArgument(
                fmt::format("surface {} (group \"{}\"), cut into {} x {}, brings the scene to {} "
                            "patches or more; choose larger patches",
                            first_patch_.size() - 1, groups_[surface.group], grid.u, grid.v, most));
        }
    }
    first_patch_.push_back(static_cast<std::uint32_t>(count));

    areas_.reserve(count);
    centres_.reserve(count);
    surface_of_.reserve(count);
    surface_normals_.reserve(surfaces_.size());
    for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
        const Surface& surface = surfaces_[s];
        surface_normals_.push_back(glm::normalize(area_vector(surface.polygon())));
        const std::uint32_t per_side = patches_per_side(s);
        for (std::uint32_t local = 0; local < per_side; ++local) {
            const PatchCorners corners = front_corners(surface, grids_[s], local);
            areas_.push_back(glm::length(area_vector(corners.polygon())));
            centres_.push_back(area_centroid(corners.polygon()));
            surface_of_.push_back(s);
        }
        if (surface.two_sided) {
            for (std::uint32_t local = 0; local < per_side; ++local) {
                areas_.push_back(areas_[first_patch_[s] + local]);
                centres_.push_back(centres_[first_patch_[s] + local]);
                surface_of_.push_back(s);
            }
        }
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
    return grids_[s].u * grids_[s].v;
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
    PatchCorners corners = front_corners(surfaces_[s], grids_[s], local % per_side);
    if (local >= per_side) {
        std::reverse(corners.points.begin(), corners.points.begin() + corners.count);
    }
    return corners;
}

std::array<double, 2> PatchMesh::grid_coordinates(std::uint32_t patch) const {
    const std::uint32_t s = surface_of_[patch];
    const std::uint32_t local = (patch - first_patch_[s]) % patches_per_side(s);
    if (surfaces_[s].vertex_count == 3) {
        const TriangleCell cell = triangle_cell(grids_[s].u, local);
        const double third = cell.upright ? 1.0 / 3.0 : 2.0 / 3.0;
        return {cell.along + third, cell.strip + third};
    }
    const std::uint32_t row = local / grids_[s].u;
    return {local % grids_[s].u + 0.5, row + 0.5};
}

std::uint64_t PatchMesh::geometry_hash() const {
    Fnv1a hash;
    hash.add(surfaces_.size());
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
        const Surface& surface = surfaces_[s];
        hash.add((std::uint64_t{surface.vertex_count} << 1) | (surface.two_sided ? 1u : 0u));
        hash.add((std::uint64_t{grids_[s].u} << 32) | grids_[s].v);
        for (const Vec3& vertex : surface.polygon()) {
            hash.add(vertex);
        }
    }
    return hash.value();
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
