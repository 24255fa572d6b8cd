#include "engine/rasteriser/raster_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace hemi {

namespace {

// Of centres of spheres to floats, and of the tests with them.
constexpr float sphere_rounding = 1e-6f;

/// A triangle of a polygon that shows one draw id.
struct Triangle {
    std::uint32_t polygon;
    std::array<std::uint32_t, 3> vertices; ///< into DrawList::vertices
    Vec3 centre;
};

std::vector<Triangle> collect_triangles(const DrawList& list,
                                        std::vector<RasterScene::GridPolygon>& grid_polygons) {
    std::vector<Triangle> triangles;
    for (std::uint32_t p = 0; p < list.polygons.size(); ++p) {
        const DrawPolygon& polygon = list.polygons[p];
        if (polygon.grid.u * polygon.grid.v > 1 || polygon.split != 0) {
            grid_polygons.push_back({.polygon = p});
            continue;
        }
        for (std::uint32_t t = 0; t < polygon.triangle_count; ++t) {
            Triangle& triangle = triangles.emplace_back(Triangle{p, {}, Vec3(0.0)});
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t corner = list.triangles[polygon.first_triangle + t][k];
                triangle.vertices[k] = list.corners[polygon.first_corner + corner].vertex;
                triangle.centre += list.vertices[triangle.vertices[k]] / 3.0;
            }
        }
    }
    return triangles;
}

/// Sorts things by halves along the longest side of the box of their centres, and calls `take` with every
/// part that `fits`.
/// @param most  things in a part, where it is full: halves are cut so that parts are
/// @param order  (centre, number) of a thing; equal for none
template <class Thing, class Order, class Fits, class Take>
void halve(std::span<Thing> things, std::size_t most, const Order& order, const Fits& fits,
           const Take& take) {
    if (things.empty()) {
        return;
    }
    if (things.size() <= most && fits(things)) {
        take(things);
        return;
    }
    Vec3 lower(std::numeric_limits<double>::infinity());
    Vec3 upper = -lower;
    for (const Thing& thing : things) {
        lower = glm::min(lower, order(thing).first);
        upper = glm::max(upper, order(thing).first);
    }
    const Vec3 extent = upper - lower;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    std::size_t half = things.size() / 2;
    if (things.size() > most) {
        half = std::max(most, (half + most / 2) / most * most);
    }
    half = half < things.size() ? half : things.size() / 2;
    std::nth_element(things.begin(), things.begin() + static_cast<std::ptrdiff_t>(half), things.end(),
                     [&](const Thing& a, const Thing& b) {
                         const auto [centre_a, number_a] = order(a);
                         const auto [centre_b, number_b] = order(b);
                         return std::pair(centre_a[axis], number_a) < std::pair(centre_b[axis], number_b);
                     });
    halve(things.first(half), most, order, fits, take);
    halve(things.subspan(half), most, order, fits, take);
}

/// Whether a polygon has three or four corners, none of them straight.
bool has_no_straight_corner(const DrawList& list, const DrawPolygon& polygon) {
    constexpr double least_sine = 1e-3;
    if (polygon.corner_count > 4) {
        return false;
    }
    const auto corner = [&](std::uint32_t k) {
        return list.vertices[list.corners[polygon.first_corner + k % polygon.corner_count].vertex];
    };
    for (std::uint32_t k = 0; k < polygon.corner_count; ++k) {
        const Vec3 before = glm::normalize(corner(k + 1) - corner(k));
        const Vec3 after = glm::normalize(corner(k + 2) - corner(k + 1));
        if (glm::length(glm::cross(before, after)) < least_sine) {
            return false;
        }
    }
    return true;
}

/// The vertices of some triangles, each once.
std::vector<std::uint32_t> vertices_of(std::span<const Triangle> triangles) {
    std::vector<std::uint32_t> vertices;
    for (const Triangle& triangle : triangles) {
        vertices.insert(vertices.end(), triangle.vertices.begin(), triangle.vertices.end());
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

/// Fills the arrays of a RasterScene, cluster by cluster.
class ClusterBuilder {
public:
    explicit ClusterBuilder(RasterScene& scene) : scene_(scene) {}

    void add(std::span<Triangle> triangles) {
        constexpr std::size_t most = RasterScene::cluster_size;
        halve(
            triangles, most,
            [](const Triangle& triangle) { return std::pair(triangle.centre, triangle.polygon); },
            [](std::span<Triangle> some) { return vertices_of(some).size() <= most; },
            [this](std::span<Triangle> some) { add_cluster(some, vertices_of(some)); });
    }

private:
    void add_cluster(std::span<const Triangle> triangles, std::span<const std::uint32_t> vertices) {
        constexpr std::size_t size = RasterScene::cluster_size;
        const std::size_t first = scene_.clusters.size() * size;
        TriangleCluster cluster;
        cluster.triangles = static_cast<std::uint32_t>(triangles.size());
        cluster.vertices = static_cast<std::uint32_t>(vertices.size());
        std::vector<Vec3> positions;
        for (const std::uint32_t vertex : vertices) {
            positions.push_back(scene_.list.vertices[vertex]);
        }
        scene_.add_bounds(positions);
        for (std::size_t k = 0; k < size; ++k) {
            const auto position =
                scene_.split(scene_.list.vertices[vertices[std::min(k, vertices.size() - 1)]]);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                scene_.vertex_high[axis].push_back(position.high[axis]);
                scene_.vertex_low[axis].push_back(position.low[axis]);
            }
        }
        scene_.corners.resize(3 * (first + size), 0);
        for (auto& part : scene_.plane) {
            part.resize(first + size, 0.0f);
        }
        scene_.front_id.resize(first + size, item_nothing);
        scene_.back_id.resize(first + size, item_nothing);
        scene_.polygon.resize(first + size, 0);
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            const Triangle& triangle = triangles[t];
            const DrawPolygon& polygon = scene_.list.polygons[triangle.polygon];
            for (std::size_t k = 0; k < 3; ++k) {
                const auto at = std::lower_bound(vertices.begin(), vertices.end(), triangle.vertices[k]);
                scene_.corners[3 * first + k * size + t] = static_cast<std::uint8_t>(at - vertices.begin());
                scene_.plane[k][first + t] = static_cast<float>(polygon.normal[static_cast<int>(k)]);
            }
            const Vec3 on_plane = raster(scene_.list.corners[polygon.first_corner].vertex);
            scene_.plane[3][first + t] = static_cast<float>(glm::dot(polygon.normal, on_plane));
            scene_.front_id[first + t] = polygon.front_id;
            scene_.back_id[first + t] = polygon.back_id;
            scene_.polygon[first + t] = triangle.polygon;
        }
        scene_.clusters.push_back(cluster);
    }

    [[nodiscard]] Vec3 raster(std::uint32_t vertex) const {
        return (scene_.list.vertices[vertex] - scene_.origin) * scene_.scale;
    }

    RasterScene& scene_;
};

} // namespace

RasterScene::RasterScene(const DrawList& the_list) : list(the_list) {
    Vec3 lower(std::numeric_limits<double>::infinity());
    Vec3 upper = -lower;
    for (const Vec3& vertex : list.vertices) {
        lower = glm::min(lower, vertex);
        upper = glm::max(upper, vertex);
    }
    if (!list.vertices.empty()) {
        origin = 0.5 * (lower + upper);
        const double largest = 0.5 * std::max({upper.x - lower.x, upper.y - lower.y, upper.z - lower.z});
        scale = largest > 0.0 ? std::ldexp(1.0, -std::ilogb(largest) - 1) : 1.0;
    }
    std::vector<Triangle> triangles = collect_triangles(list, grid_polygons);
    add_groups();
    ClusterBuilder(*this).add(triangles);
    constexpr std::size_t most_lanes = 16;
    for (std::size_t k = 0; k < spheres.size(); ++k) {
        spheres[k].resize((parts() + most_lanes - 1) / most_lanes * most_lanes, k < 3 ? 0.0f : -1e6f);
    }
}

/// Sorts the grid polygons into groups, and fills in what depends on that.
void RasterScene::add_groups() {
    halve(
        std::span(grid_polygons), group_size,
        [this](const GridPolygon& drawn) {
            return std::pair(list.polygons[drawn.polygon].centre, drawn.polygon);
        },
        [](std::span<GridPolygon> /*some*/) { return true; },
        [this](std::span<GridPolygon> some) {
            groups.push_back({static_cast<std::uint32_t>(some.data() - grid_polygons.data()),
                              static_cast<std::uint32_t>(some.size())});
            std::vector<Vec3> vertices;
            for (GridPolygon& drawn : some) {
                const DrawPolygon& outline = list.polygons[drawn.polygon];
                drawn.centre = split(outline.centre).high;
                drawn.radius = static_cast<float>(outline.radius * scale * 1.0001) + sphere_rounding;
                drawn.whole = has_no_straight_corner(list, outline);
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    drawn.plane[axis] = static_cast<float>(outline.normal[static_cast<int>(axis)]);
                }
                const Vec3& on_plane = list.vertices[list.corners[outline.first_corner].vertex];
                drawn.plane[3] = static_cast<float>(glm::dot(outline.normal, (on_plane - origin) * scale));
                drawn.first_corner = static_cast<std::uint32_t>(corner_high[0].size());
                drawn.corner_count = outline.corner_count;
                drawn.corner_slots = (outline.corner_count + corner_slots - 1) / corner_slots * corner_slots;
                grid_maps.push_back(make_grid_map(list, drawn.polygon));
                for (std::uint32_t k = 0; k < drawn.corner_slots; ++k) {
                    const std::uint32_t corner = outline.first_corner + std::min(k, outline.corner_count - 1);
                    const Vec3& vertex = list.vertices[list.corners[corner].vertex];
                    vertices.push_back(vertex);
                    const SplitPosition position = split(vertex);
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        corner_high[axis].push_back(position.high[axis]);
                        corner_low[axis].push_back(position.low[axis]);
                    }
                }
            }
            add_bounds(vertices);
        });
}

void RasterScene::add_bounds(std::span<const Vec3> vertices) {
    Vec3 lower(std::numeric_limits<double>::infinity());
    Vec3 upper = -lower;
    for (const Vec3& vertex : vertices) {
        lower = glm::min(lower, vertex);
        upper = glm::max(upper, vertex);
    }
    const Vec3 centre = 0.5 * (lower + upper);
    double radius = 0.0;
    for (const Vec3& vertex : vertices) {
        radius = std::max(radius, glm::length(vertex - centre));
    }
    const auto at = split(centre).high;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        spheres[axis].push_back(at[axis]);
    }
    spheres[3].push_back(static_cast<float>(radius * scale * 1.0001) + sphere_rounding);
    std::array<float, 3>& extent = extents.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<int>(axis);
        extent[axis] = static_cast<float>(0.5 * (upper[k] - lower[k]) * scale * 1.0001) + sphere_rounding;
    }
}

RasterScene::SplitPosition RasterScene::split(const Vec3& position) const {
    const Vec3 raster = (position - origin) * scale;
    SplitPosition result{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double value = raster[static_cast<int>(axis)];
        result.high[axis] = static_cast<float>(value);
        result.low[axis] = static_cast<float>(value - static_cast<double>(result.high[axis]));
    }
    return result;
}

} // namespace hemi
