#include "engine/rasteriser/raster_scene.hpp"

#include "engine/hemicube/draw_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace hemi {

namespace {

// Of centres of spheres to floats, and of the tests with them.
constexpr float sphere_rounding = 1e-6f;

std::vector<DrawTriangle> collect_triangles(const DrawList& list,
                                            std::vector<RasterScene::GridPolygon>& grid_polygons) {
    std::vector<DrawTriangle> triangles;
    for (std::uint32_t p = 0; p < list.polygons.size(); ++p) {
        if (list.polygons[p].shows_one_id()) {
            add_triangles(list, p, triangles);
        } else {
            grid_polygons.push_back({.polygon = p});
        }
    }
    return triangles;
}

/// Which of the six directions along the axes a direction is nearest to: 0 to 5.
int main_way(const Vec3& direction) {
    int axis = 0;
    for (const int other : {1, 2}) {
        axis = std::abs(direction[other]) > std::abs(direction[axis]) ? other : axis;
    }
    return 2 * axis + (direction[axis] < 0.0 ? 1 : 0);
}

/// Finds the sides of a polygon: corners where the outline does not turn lie along them.
/// @return where each corner lies on its side, from 0 to 1; empty where there are other than 3 or 4 sides
std::vector<double> find_sides(const DrawList& list, double scale, RasterScene::GridPolygon& drawn) {
    constexpr double least_sine = 1e-3;
    const DrawPolygon& polygon = list.polygons[drawn.polygon];
    const std::uint32_t count = polygon.corner_count;
    const auto corner = [&](std::uint32_t k) -> const Vec3& {
        return list.vertices[list.corners[polygon.first_corner + k % count].vertex];
    };
    std::vector<std::uint32_t> begins;
    for (std::uint32_t k = 0; k < count; ++k) {
        const Vec3 before = glm::normalize(corner(k) - corner(k + count - 1));
        const Vec3 after = glm::normalize(corner(k + 1) - corner(k));
        const double sine = glm::dot(glm::cross(before, after), polygon.normal);
        if (sine <= -least_sine) {
            return {}; // a corner of a neighbour lies inside, by as much as counts as touching
        }
        if (sine >= least_sine) {
            begins.push_back(k);
        }
    }
    if (begins.size() < 3 || begins.size() > drawn.side_begin.size()) {
        return {};
    }
    std::vector<double> along(count, 0.0);
    double bend = 0.0;
    for (std::size_t side = 0; side < begins.size(); ++side) {
        const std::uint32_t end = side + 1 < begins.size() ? begins[side + 1] : begins[0] + count;
        const Vec3& from = corner(begins[side]);
        const Vec3 to_end = corner(end) - from;
        for (std::uint32_t k = begins[side] + 1; k < end; ++k) {
            const Vec3 offset = corner(k) - from;
            const double at = glm::dot(offset, to_end) / glm::dot(to_end, to_end);
            bend = std::max(bend, glm::length(offset - at * to_end));
            along[k % count] = at;
        }
    }
    drawn.sides = static_cast<std::uint32_t>(begins.size());
    std::copy(begins.begin(), begins.end(), drawn.side_begin.begin());
    drawn.bend = static_cast<float>(bend * scale);
    return along;
}

/// Fills the arrays of a RasterScene, cluster by cluster.
class ClusterBuilder {
public:
    explicit ClusterBuilder(RasterScene& scene) : scene_(scene) {}

    void add(std::span<DrawTriangle> triangles) {
        for_each_cluster(
            triangles, RasterScene::cluster_size, place_of,
            [](std::span<const DrawTriangle> some) {
                return vertices_of(some).size() <= RasterScene::cluster_size;
            },
            [this](std::span<const DrawTriangle> some) { add_cluster(some, vertices_of(some)); });
    }

private:
    void add_cluster(std::span<const DrawTriangle> triangles, std::span<const std::uint32_t> vertices) {
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
                scene_.coordinates.split(scene_.list.vertices[vertices[std::min(k, vertices.size() - 1)]]);
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
            const DrawTriangle& triangle = triangles[t];
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
        std::vector<std::uint32_t> polygons;
        for (const DrawTriangle& triangle : triangles) {
            polygons.push_back(triangle.polygon);
        }
        std::sort(polygons.begin(), polygons.end());
        for (auto here = polygons.begin(); here != polygons.end();) {
            const auto next = std::upper_bound(here, polygons.end(), *here);
            cluster.whole =
                cluster.whole && scene_.list.polygons[*here].triangle_count == std::uint32_t(next - here);
            here = next;
        }
        scene_.clusters.push_back(cluster);
    }

    [[nodiscard]] Vec3 raster(std::uint32_t vertex) const {
        return scene_.coordinates.of(scene_.list.vertices[vertex]);
    }

    RasterScene& scene_;
};

} // namespace

RasterScene::RasterScene(const DrawList& the_list) : list(the_list), coordinates(the_list) {
    std::vector<DrawTriangle> triangles = collect_triangles(list, grid_polygons);
    add_groups();
    ClusterBuilder(*this).add(triangles);
    constexpr std::size_t most_lanes = 16;
    for (std::size_t k = 0; k < spheres.size(); ++k) {
        spheres[k].resize((parts() + most_lanes - 1) / most_lanes * most_lanes, k < 3 ? 0.0f : -1e6f);
    }
}

/// Sorts the grid polygons into groups, and fills in what depends on that.
void RasterScene::add_groups() {
    // In large scenes what looks the same way stands together, as in clusters of sources: they take in whole
    // groups then.
    constexpr std::size_t least_apart = 1024;
    if (grid_polygons.size() < least_apart) {
        add_groups(grid_polygons);
        return;
    }
    const auto way = [this](const GridPolygon& drawn) {
        return main_way(list.polygons[drawn.polygon].normal);
    };
    std::stable_sort(grid_polygons.begin(), grid_polygons.end(),
                     [&way](const GridPolygon& a, const GridPolygon& b) { return way(a) < way(b); });
    for (auto here = grid_polygons.begin(); here != grid_polygons.end();) {
        const auto next =
            std::find_if(here, grid_polygons.end(), [&way, first = way(*here)](const GridPolygon& drawn) {
                return way(drawn) != first;
            });
        add_groups(std::span(here, next));
        here = next;
    }
}

void RasterScene::add_groups(std::span<GridPolygon> polygons) {
    for_each_cluster(
        polygons, group_size,
        [this](const GridPolygon& drawn) {
            return std::pair(list.polygons[drawn.polygon].centre, drawn.polygon);
        },
        [](std::span<const GridPolygon> /*some*/) { return true; },
        [this](std::span<GridPolygon> some) {
            groups.push_back({static_cast<std::uint32_t>(some.data() - grid_polygons.data()),
                              static_cast<std::uint32_t>(some.size())});
            std::vector<Vec3> vertices;
            for (GridPolygon& drawn : some) {
                const DrawPolygon& outline = list.polygons[drawn.polygon];
                drawn.centre = coordinates.split(outline.centre).high;
                drawn.radius =
                    static_cast<float>(outline.radius * coordinates.scale * 1.0001) + sphere_rounding;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    drawn.plane[axis] = static_cast<float>(outline.normal[static_cast<int>(axis)]);
                }
                const Vec3& on_plane = list.vertices[list.corners[outline.first_corner].vertex];
                drawn.plane[3] = static_cast<float>(glm::dot(outline.normal, coordinates.of(on_plane)));
                drawn.first_corner = static_cast<std::uint32_t>(corner_high[0].size());
                drawn.corner_count = outline.corner_count;
                drawn.corner_slots = (outline.corner_count + corner_slots - 1) / corner_slots * corner_slots;
                std::vector<double> along = find_sides(list, coordinates.scale, drawn);
                along.resize(drawn.corner_slots);
                corner_along.insert(corner_along.end(), along.begin(), along.end());
                grid_maps.push_back(make_grid_map(list, drawn.polygon));
                for (std::uint32_t k = 0; k < drawn.corner_slots; ++k) {
                    const std::uint32_t corner = outline.first_corner + std::min(k, outline.corner_count - 1);
                    const Vec3& vertex = list.vertices[list.corners[corner].vertex];
                    vertices.push_back(vertex);
                    const SplitPosition position = coordinates.split(vertex);
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        corner_high[axis].push_back(position.high[axis]);
                        corner_low[axis].push_back(position.low[axis]);
                    }
                }
            }
            add_bounds(vertices);
        });
}

std::vector<std::uint32_t> RasterScene::polygons_of(std::uint32_t part) const {
    std::vector<std::uint32_t> polygons;
    if (part < groups.size()) {
        for (std::uint32_t k = 0; k < groups[part].count; ++k) {
            polygons.push_back(grid_polygons[groups[part].first + k].polygon);
        }
    } else {
        const std::size_t cluster = part - groups.size();
        for (std::uint32_t t = 0; t < clusters[cluster].triangles; ++t) {
            polygons.push_back(polygon[cluster * cluster_size + t]);
        }
    }
    std::sort(polygons.begin(), polygons.end());
    polygons.erase(std::unique(polygons.begin(), polygons.end()), polygons.end());
    return polygons;
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
    const auto at = coordinates.split(centre).high;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        spheres[axis].push_back(at[axis]);
    }
    spheres[3].push_back(static_cast<float>(radius * coordinates.scale * 1.0001) + sphere_rounding);
    std::array<float, 3>& extent = extents.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<int>(axis);
        extent[axis] =
            static_cast<float>(0.5 * (upper[k] - lower[k]) * coordinates.scale * 1.0001) + sphere_rounding;
    }
}

} // namespace hemi
