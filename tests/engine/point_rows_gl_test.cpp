#include "hemi/engine/point_rows.hpp"

#include "support/device.hpp"
#include "support/polygon_factors.hpp"
#include "support/scenes.hpp"

#include "engine/clusters/cluster_tree.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/matrix/source_clusters.hpp"
#include "hemi/pipeline/settings.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

struct StoredRow {
    std::vector<std::uint32_t> columns;
    std::vector<float> values;
    double environment = 0.0;
    double blocked = 0.0;

    [[nodiscard]] double sum() const { return RowView{columns, values}.sum(); }
    [[nodiscard]] double at(std::uint32_t j) const {
        const auto found = std::find(columns.begin(), columns.end(), j);
        return found == columns.end()
                   ? 0.0
                   : static_cast<double>(values[static_cast<std::size_t>(found - columns.begin())]);
    }
};

std::vector<StoredRow> rows_of(const PatchMesh& mesh, const std::vector<SurfacePoint>& points,
                               std::uint32_t shadow_rays, std::uint32_t jobs = 1,
                               DirectionMeasure measure = DirectionMeasure::projected_solid_angle,
                               std::uint32_t resolution = 128, std::uint32_t singly = points_ask_singly) {
    FactorSettings settings;
    settings.engine.device = test_device();
    settings.engine.jobs = jobs;
    HemicubeSettings hemicube;
    hemicube.resolution = resolution;
    const auto engine = make_point_visibility_provider(mesh, points, hemicube, settings, measure);
    std::vector<StoredRow> rows(points.size());
    compute_point_rows(*engine, mesh, points, {ExchangeRule::standard, shadow_rays}, Enclosure::automatic, {},
                       [&rows](std::uint32_t index, const RowView& row) {
                           rows[index] = {{row.columns.begin(), row.columns.end()},
                                          {row.values.begin(), row.values.end()},
                                          row.environment,
                                          row.blocked};
                       },
                       {}, {.measure = measure, .singly = singly});
    return rows;
}

/// A square of ground with blocks of several heights all over it.
Scene field_of_blocks(std::uint32_t blocks_a_side) {
    Scene scene = empty_scene();
    const double side = blocks_a_side;
    add_polygon(scene, "ground", {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}}, {8, 8});
    for (std::uint32_t y = 0; y < blocks_a_side; ++y) {
        for (std::uint32_t x = 0; x < blocks_a_side; ++x) {
            const double height = 0.1 + 0.1 * ((7 * x + 5 * y) % 6);
            add_block(scene, "blocks", Vec3(x + 0.3, y + 0.3, 0.0), Vec3(x + 0.7, y + 0.7, height), 1);
        }
    }
    return scene;
}

} // namespace

TEST_CASE("ExchangeAreas::at_point: far and near, it is Lambert's factor", "[engine]") {
    const PatchMesh mesh(room_with_blocks(3));
    const ExchangeAreas areas(mesh);
    const Vec3 normal = glm::normalize(Vec3(0.2, -0.1, 1.0));
    double largest = 0.0;
    double sum = 0.0;
    for (const Vec3& at : {Vec3(0.3, 0.3, 0.1), Vec3(1.1, 0.1, 0.7), Vec3(0.61, 0.52, 0.001)}) {
        for (std::uint32_t j = 0; j < mesh.size(); ++j) {
            const double exact = hemi::point_factor(at, normal, mesh.corners(j).polygon());
            largest = std::max(largest, std::abs(areas.at_point(at, normal, j) - exact));
            sum += exact;
        }
    }
    CHECK(largest < 2e-6);
    CHECK(sum > 3.0); // every point sees at least a room
}

TEST_CASE("ExchangeAreas::at_point: a patch far below, behind or in the plane of an element has none",
          "[engine]") {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    const PatchMesh mesh(scene);
    const ExchangeAreas areas(mesh);
    CHECK(areas.at_point({0.5, 0.5, 40.0}, {0, 0, 1}, 0) == 0.0);
    CHECK(areas.at_point({0.5, 0.5, -40.0}, {0, 0, 1}, 0) == 0.0);
    CHECK(areas.at_point({3.0, 0.5, 0.0}, {1, 0, 0}, 0) == 0.0);
    CHECK(areas.at_point({0.5, 0.5, 40.0}, {0, 0, -1}, 0) ==
          Approx(hemi::point_factor({0.5, 0.5, 40.0}, {0, 0, -1}, mesh.corners(0).polygon())).epsilon(1e-6));
}

TEST_CASE("point rows: in a closed room they are exact where nothing hides, and sum to 1",
          "[engine][every-device]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(3.0, 2.0, 1.0), 4);
    const PatchMesh mesh(scene);
    std::vector<SurfacePoint> points;
    std::uint32_t floor = 0;
    for (std::uint32_t s = 0; s < mesh.surfaces().size(); ++s) {
        if (mesh.groups()[mesh.surfaces()[s].group] == "z0") {
            floor = s;
        }
    }
    for (const Vec3& at : {Vec3(1.5, 1.0, 0.0), Vec3(0.01, 0.02, 0.0), Vec3(2.9, 1.0, 0.0)}) {
        points.push_back({at, {0, 0, 1}, floor});
    }
    const auto rows = rows_of(mesh, points, 16);
    for (std::size_t k = 0; k < points.size(); ++k) {
        CHECK(rows[k].sum() == Approx(1.0).margin(1e-6));
        CHECK(rows[k].environment + rows[k].blocked < 1e-4);
        for (std::uint32_t j = 0; j < mesh.size(); ++j) {
            const double exact =
                hemi::point_factor(points[k].position, points[k].normal, mesh.corners(j).polygon());
            REQUIRE(rows[k].at(j) == Approx(exact).margin(1e-5));
        }
    }
}

TEST_CASE("point rows: without walls, what is left is the environment", "[engine][every-device]") {
    const PatchMesh mesh(two_plates(false));
    const std::vector<SurfacePoint> points{{{0.5, 0.5, 0.0}, {0, 0, 1}, 0}};
    const auto rows = rows_of(mesh, points, 16);
    const double wall = rows[0].sum();
    CHECK(wall > 0.1);
    CHECK(rows[0].environment == Approx(1.0 - wall).margin(1e-12));
    CHECK(rows[0].blocked == 0.0);
}

TEST_CASE("point rows: a sheet before a lamp hides its share of it", "[engine][every-device]") {
    // Lamp over x in [-0.1, 0.1]; the sheet half way ends at x = 0.2: from x on the floor it covers the lamp
    // from where the ray through its edge meets the lamp's plane, at 0.4 - x, upwards.
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {{-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0}});
    add_polygon(scene, "lamp", {{-0.1, -0.1, 2}, {-0.1, 0.1, 2}, {0.1, 0.1, 2}, {0.1, -0.1, 2}});
    add_polygon(scene, "sheet", {{0.2, -2, 1}, {0.2, 2, 1}, {2.5, 2, 1}, {2.5, -2, 1}});
    const PatchMesh mesh(scene);
    std::vector<SurfacePoint> points;
    for (double x = 0.2; x < 0.61; x += 0.02) {
        points.push_back({{x, 0.013, 0.0}, {0, 0, 1}, 0});
    }
    const auto error_of = [&](std::uint32_t shadow_rays) {
        const auto rows = rows_of(mesh, points, shadow_rays);
        double squares = 0.0;
        for (std::size_t k = 0; k < points.size(); ++k) {
            const double edge = std::clamp(0.4 - points[k].position.x, -0.1, 0.1);
            const std::vector<Vec3> seen{{-0.1, -0.1, 2}, {-0.1, 0.1, 2}, {edge, 0.1, 2}, {edge, -0.1, 2}};
            const double exact = edge > -0.1 ? hemi::point_factor(points[k].position, {0, 0, 1}, seen) : 0.0;
            const double whole = hemi::point_factor(points[k].position, {0, 0, 1}, mesh.corners(1).polygon());
            squares += std::pow((rows[k].at(1) - exact) / whole, 2.0);
        }
        return std::sqrt(squares / static_cast<double>(points.size()));
    };
    const double by_texels = error_of(0);
    const double by_rays = error_of(64);
    CHECK(by_rays < 0.02);
    CHECK(by_rays < 0.5 * by_texels); // the lamp has some 40 texels
}

TEST_CASE("point rows: of spheres they are the exact solid angles of what is seen",
          "[engine][every-device]") {
    Scene room = empty_scene();
    add_room(room, Vec3(0.0), Vec3(3.0, 2.0, 1.0), 4);
    const PatchMesh mesh(room);
    const std::vector<SurfacePoint> points{{{1.4, 0.9, 0.6}, {}, no_surface},
                                           {{0.1, 1.9, 0.2}, {}, no_surface}};
    const auto rows = rows_of(mesh, points, 16, 1, DirectionMeasure::solid_angle);
    for (std::size_t k = 0; k < points.size(); ++k) {
        CHECK(rows[k].sum() == Approx(1.0).margin(1e-6));
        for (std::uint32_t j = 0; j < mesh.size(); ++j) {
            const PatchCorners corners = mesh.corners(j);
            REQUIRE(rows[k].at(j) ==
                    Approx(solid_angle(points[k].position, corners.polygon()) / (4.0 * std::numbers::pi))
                        .margin(1e-6));
        }
    }
    // A wall across the horizon, of which a sheet leaves the lower part, from below the horizon to above it.
    Scene scene = empty_scene();
    add_polygon(scene, "wall", {{2, -1, -1}, {2, -1, 1}, {2, 1, 1}, {2, 1, -1}});
    add_polygon(scene, "sheet", {{1, -3, 0.15}, {1, -3, 3}, {1, 3, 3}, {1, 3, 0.15}});
    const PatchMesh hidden(scene);
    const std::vector<Vec3> seen{{2, -1, -1}, {2, -1, 0.3}, {2, 1, 0.3}, {2, 1, -1}};
    for (const std::uint32_t shadow_rays : {0u, 64u}) {
        const auto row =
            rows_of(hidden, {{Vec3(0.0), {}, no_surface}}, shadow_rays, 1, DirectionMeasure::solid_angle)[0];
        CHECK(row.at(0) == Approx(solid_angle(Vec3(0.0), seen) / (4.0 * std::numbers::pi)).epsilon(0.01));
        const PatchCorners sheet = hidden.corners(1);
        CHECK(row.at(1) ==
              Approx(solid_angle(Vec3(0.0), sheet.polygon()) / (4.0 * std::numbers::pi)).epsilon(1e-6));
        CHECK(row.environment == Approx(1.0 - row.sum()).margin(1e-9));
    }
}

TEST_CASE("point rows: patches far away give about the same light by clusters as one by one",
          "[engine][every-device]") {
    const DirectionMeasure measure =
        GENERATE(DirectionMeasure::projected_solid_angle, DirectionMeasure::solid_angle);
    Scene scene = field_of_blocks(30);
    if (measure == DirectionMeasure::solid_angle) {
        scene = field_of_blocks(15);
        scene.symmetry.emplace().mirrors = {{0, 0.0}, {1, 0.0}};
    }
    const PatchMesh mesh(scene);
    std::vector<SurfacePoint> points;
    std::vector<double> light;
    for (std::uint32_t j = 0; j < mesh.size(); ++j) {
        const Vec3& at = mesh.centres()[j];
        light.push_back(1.0 + 0.8 * std::sin(at.x) * std::cos(2.0 * at.y) + 0.5 * mesh.normal(j).z);
        if (j % 149 == 0 || (j < 64 && j % 3 == 0)) {
            points.push_back({at + 0.02 * mesh.normal(j), mesh.normal(j), no_surface});
        }
    }
    const auto finely = rows_of(mesh, points, 0, 1, measure, 256);
    const auto singly = rows_of(mesh, points, 0, 1, measure, 32);
    const auto by_parts = rows_of(mesh, points, 0, 1, measure, 32, 0);
    const auto gathered = [&](const StoredRow& row) {
        double sum = row.environment;
        for (std::size_t entry = 0; entry < row.columns.size(); ++entry) {
            sum += static_cast<double>(row.values[entry]) * light[row.columns[entry]];
        }
        return sum;
    };
    double all = 0.0;
    double error_singly = 0.0;
    double error_by_parts = 0.0;
    double change = 0.0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        REQUIRE(by_parts[k].sum() + by_parts[k].environment + by_parts[k].blocked ==
                Approx(1.0).margin(1e-6));
        REQUIRE(std::is_sorted(by_parts[k].columns.begin(), by_parts[k].columns.end()));
        all += std::pow(gathered(finely[k]), 2.0);
        error_singly += std::pow(gathered(singly[k]) - gathered(finely[k]), 2.0);
        error_by_parts += std::pow(gathered(by_parts[k]) - gathered(finely[k]), 2.0);
        change += std::pow(gathered(singly[k]) - gathered(by_parts[k]), 2.0);
    }
    CHECK(std::sqrt(change / all) < (measure == DirectionMeasure::solid_angle ? 2e-3 : 3e-4));
    CHECK(std::sqrt(error_by_parts) < 1.03 * std::sqrt(error_singly));
}

TEST_CASE("point rows: clusters give about the same light as patches, and lamps far away as exactly",
          "[engine][every-device]") {
    const PatchMesh mesh(field_of_blocks(24));
    std::vector<SurfacePoint> points;
    std::vector<double> light;
    for (std::uint32_t j = 0; j < mesh.size(); ++j) {
        const Vec3& at = mesh.centres()[j];
        const bool lamp = j % 241 == 7;
        light.push_back((lamp ? 300.0 : 1.0) + 0.8 * std::sin(at.x) * std::cos(2.0 * at.y));
        if (j % 149 == 0 || (j < 64 && j % 3 == 0)) {
            points.push_back({at + 0.02 * mesh.normal(j), mesh.normal(j), no_surface});
        }
    }
    const ClusterTree tree(mesh);
    std::vector<double> all = light;
    all.resize(mesh.size() + tree.clusters()->nodes().size());
    tree.clusters()->fill(all, 1);
    FactorSettings settings;
    settings.engine.device = test_device();
    settings.engine.jobs = 1;
    std::size_t entries = 0; // of all rows of the last gather
    const auto gather = [&](std::uint32_t resolution, const PointRowOptions& options) {
        HemicubeSettings hemicube;
        hemicube.resolution = resolution;
        hemicube.joint = options.singly == 0;
        const auto engine = make_point_visibility_provider(mesh, points, hemicube, settings);
        std::vector<double> gathered(points.size());
        entries = 0;
        compute_point_rows(
            *engine, mesh, points, {ExchangeRule::standard, 16}, Enclosure::automatic, light,
            [&](std::uint32_t index, const RowView& row) {
                REQUIRE(row.sum() + row.environment + row.blocked == Approx(1.0).margin(1e-6));
                REQUIRE(std::is_sorted(row.columns.begin(), row.columns.end()));
                double sum = row.environment;
                for (std::size_t entry = 0; entry < row.columns.size(); ++entry) {
                    sum += static_cast<double>(row.values[entry]) * all[row.columns[entry]];
                }
                gathered[index] = sum;
                entries += row.columns.size();
            },
            {}, options);
        return gathered;
    };
    const std::vector<double> truth = gather(512, {});
    const auto error = [&](const std::vector<double>& gathered) {
        double squares = 0.0;
        double whole = 0.0;
        for (std::size_t k = 0; k < gathered.size(); ++k) {
            squares += std::pow(gathered[k] - truth[k], 2.0);
            whole += truth[k] * truth[k];
        }
        return std::sqrt(squares / whole);
    };
    const double singly = error(gather(128, {}));
    const std::size_t entries_singly = entries;
    const double in_clusters = error(gather(128, {.singly = 0, .clusters = &tree}));
    CHECK(10 * entries < 9 * entries_singly);
    const double shared_out = error(gather(128, {.singly = 0}));
    CAPTURE(singly, in_clusters, shared_out);
    CHECK(in_clusters < std::max(2.0 * singly, 2e-3));
    CHECK(shared_out < std::max(2.0 * singly, 2e-3));
    const PatchMesh other(two_plates(false));
    const ClusterTree of_other(other);
    CHECK_THROWS_AS(gather(32, {.clusters = &of_other}), InvalidArgument);
}

TEST_CASE("point rows: the same bits by one and by two jobs", "[engine][every-device]") {
    const PatchMesh mesh(room_with_blocks(4));
    std::vector<SurfacePoint> points;
    for (std::uint32_t i = 0; i < 200; ++i) {
        const std::uint32_t patch = i * (mesh.size() - 1) / 199;
        points.push_back({mesh.centres()[patch], mesh.normal(patch), mesh.surface_of()[patch]});
    }
    const std::uint32_t singly = GENERATE(0u, points_ask_singly);
    const auto measure = DirectionMeasure::projected_solid_angle;
    const auto one = rows_of(mesh, points, 16, 1, measure, 128, singly);
    const auto two = rows_of(mesh, points, 16, 2, measure, 128, singly);
    for (std::size_t k = 0; k < points.size(); ++k) {
        REQUIRE(one[k].columns == two[k].columns);
        REQUIRE(one[k].values == two[k].values);
        REQUIRE(one[k].environment == two[k].environment);
    }
}

TEST_CASE("point rows: points and weights that do not fit are refused", "[engine]") {
    const PatchMesh mesh(two_plates(false));
    FactorSettings settings;
    settings.engine.device = "cpu";
    const std::vector<SurfacePoint> nowhere{{{0, 0, 0}, {0, 0, 1}, 7}};
    CHECK_THROWS_AS(make_point_visibility_provider(mesh, nowhere, {}, settings), InvalidArgument);
    const std::vector<SurfacePoint> points{{{0.5, 0.5, 0.0}, {0, 0, 1}, 0}};
    const auto engine = make_point_visibility_provider(mesh, points, {}, settings);
    const std::vector<double> weights(7, 1.0);
    CHECK_THROWS_AS(compute_point_rows(*engine, mesh, points, {}, Enclosure::automatic, weights,
                                       [](std::uint32_t, const RowView&) {}),
                    InvalidArgument);
}
