#include "engine/clusters/cluster_tree.hpp"
#include "support/device.hpp"
#include "support/scenes.hpp"

#include "hemi/core/error.hpp"
#include "hemi/engine/clustered_rows.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/engine/visibility_weighted.hpp"
#include "hemi/matrix/expansion.hpp"
#include "hemi/matrix/product.hpp"
#include "hemi/matrix/repair.hpp"
#include "hemi/pipeline/daylight.hpp"
#include "hemi/pipeline/diagnosis.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/radiosity.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

/// A closed room with a block in the air.
Scene room_with_floating_block(std::uint32_t cells) {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.2, 1.0, 0.8), cells);
    add_block(scene, "block", Vec3(0.3, 0.2, 0.25), Vec3(0.7, 0.6, 0.5), cells / 2);
    return scene;
}

FormFactorMatrix clustered(const PatchMesh& mesh, const ClusterSettings& settings = {},
                           Enclosure enclosure = Enclosure::automatic) {
    const HemicubeSettings hemicube{.resolution = 64, .eye_points = 4};
    const auto engine = make_visibility_engine(mesh, hemicube, {test_device(), 2, find_worker_program()});
    return compute_clustered(*engine, mesh, all_patches(mesh.size()), settings, enclosure);
}

FormFactorMatrix in_pairs(const PatchMesh& mesh, const HemicubeSettings& hemicube,
                          std::uint32_t shadow_rays) {
    const auto engine = make_visibility_engine(mesh, hemicube, {test_device(), 2, find_worker_program()});
    FormFactorMatrix rows = compute_visibility_weighted(
        *engine, mesh, all_patches(mesh.size()), {ExchangeRule::standard, shadow_rays}, Enclosure::automatic);
    (void)repair(rows, mesh.areas(), Repair::closure);
    return rows;
}

/// A light that changes smoothly over the scene, and with the direction of a patch.
std::vector<double> smooth_light(const PatchMesh& mesh) {
    std::vector<double> light;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        light.push_back(2.0 + mesh.centres()[i].x + 0.5 * mesh.centres()[i].y + 0.3 * mesh.normal(i).z);
    }
    return light;
}

/// Rows of clusters that outlast a run.
class Keeper : public ClusteredRowKeeper {
public:
    void resume(const std::shared_ptr<const SourceClusters>& clusters, std::span<const std::uint32_t> wanted,
                const EachRow& each) override {
        for (const auto& [block, hides] : blocks) {
            FormFactorMatrix rows(clusters->size(), clusters);
            rows.set_block(block);
            for (std::uint32_t local = 0; local < block.rows(); ++local) {
                const std::uint32_t patch = block.first_row + local;
                if (block.known[local] != 0 && std::binary_search(wanted.begin(), wanted.end(), patch)) {
                    each(patch, rows.row(patch), hides[local] != 0);
                }
            }
        }
    }
    void keep(const RowBlock& rows, std::span<const std::uint8_t> hides) override {
        blocks.emplace_back(rows, std::vector<std::uint8_t>(hides.begin(), hides.end()));
    }
    [[nodiscard]] std::size_t rows() const {
        std::size_t count = 0;
        for (const auto& [block, _] : blocks) {
            count += static_cast<std::size_t>(std::count(block.known.begin(), block.known.end(), 1));
        }
        return count;
    }

    std::vector<std::pair<RowBlock, std::vector<std::uint8_t>>> blocks;
};

void check_same_rows(const FormFactorMatrix& a, const FormFactorMatrix& b) {
    REQUIRE(a.blocks().size() == b.blocks().size());
    for (std::size_t k = 0; k < a.blocks().size(); ++k) {
        const RowBlock one = a.block(k);
        const RowBlock other = b.block(k);
        CHECK(one.known == other.known);
        CHECK(one.begin == other.begin);
        CHECK(one.columns == other.columns);
        CHECK(one.values == other.values);
        CHECK(one.visibility == other.visibility);
        CHECK(one.environment == other.environment);
        CHECK(one.blocked == other.blocked);
    }
}

std::vector<double> gathered(const FormFactorMatrix& factors, const std::vector<double>& light) {
    std::vector<double> result(factors.size());
    multiply(factors, light, 1, result);
    return result;
}

/// Rms difference over the rms of `expected`.
double relative_rms(const std::vector<double>& values, const std::vector<double>& expected) {
    double errors = 0.0;
    double all = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        errors += (values[i] - expected[i]) * (values[i] - expected[i]);
        all += expected[i] * expected[i];
    }
    return std::sqrt(errors / all);
}

} // namespace

TEST_CASE("every receiver sees every patch once, and what is near is so both ways") {
    const PatchMesh mesh(room_with_blocks(12));
    const ClusterTree tree(mesh);
    const auto nodes = tree.clusters()->nodes();
    std::vector<std::vector<std::uint8_t>> near(mesh.size(), std::vector<std::uint8_t>(mesh.size()));
    std::size_t far_parts = 0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        std::uint32_t next = 0;
        std::vector<ClusterTree::Part> parts;
        tree.seen_from(i, 0.5, parts);
        for (const ClusterTree::Part& part : parts) {
            REQUIRE(nodes[part.node].begin == next);
            next = nodes[part.node].end;
            far_parts += part.far ? 1 : 0;
            for (const std::uint32_t j : tree.clusters()->patches(part.node)) {
                near[i][j] = part.far ? 0 : 1;
            }
        }
        REQUIRE(next == mesh.size());
        REQUIRE(near[i][i] == 1);
    }
    CHECK(far_parts > mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        for (std::uint32_t j = 0; j < i; ++j) {
            REQUIRE(near[i][j] == near[j][i]);
        }
    }
}

TEST_CASE("clusters look one way, and their spheres hold their patches") {
    const PatchMesh mesh(tapered_box(6));
    const ClusterTree tree(mesh);
    for (std::uint32_t k = 0; k < tree.clusters()->nodes().size(); ++k) {
        const ClusterShape& shape = tree.shape(k);
        for (const std::uint32_t i : tree.clusters()->patches(k)) {
            const PatchCorners corners = mesh.corners(i);
            for (const Vec3& corner : corners.polygon()) {
                REQUIRE(glm::distance(corner, shape.centre) <= shape.radius * (1.0 + 1e-12));
            }
            REQUIRE(glm::dot(mesh.normal(i), shape.axis) >= std::cos(shape.cone) - 1e-12);
        }
    }
}

TEST_CASE("points that stand for a cluster stay in its sphere, also for a sliver beside a large patch") {
    Scene scene = empty_scene();
    add_polygon(scene, "large", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    add_polygon(scene, "sliver", {{1, 0, 0}, {1.0001, 0, 0}, {1.0001, 1, 0}, {1, 1, 0}});
    const PatchMesh mesh(scene);
    const ClusterTree tree(mesh);
    const ClusterMoments& whole = tree.moments(0);
    const ClusterStrata strata = tree.strata(0);
    REQUIRE(strata.count == 2);
    CHECK(whole.spread > 1.0);
    for (std::uint32_t s = 0; s < strata.count; ++s) {
        const double offset = glm::length(tree.moments(strata.nodes[s]).centre - whole.centre);
        CHECK(whole.spread * offset <= 1.000001 * tree.shape(0).radius); // 41 without
    }
}

TEST_CASE("lamps stand in clusters of their own", "[slow]") {
    const PatchMesh mesh(room_with_floating_block(16));
    std::vector<std::uint8_t> lamps(mesh.size(), 0);
    std::vector<double> light(mesh.size(), 0.1);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const Vec3 centre = mesh.centres()[i];
        if (mesh.normal(i).z < -0.9 && std::abs(centre.x - 0.8) < 0.2 && std::abs(centre.y - 0.7) < 0.1) {
            lamps[i] = 1;
            light[i] = 20.0;
        }
    }
    const ClusterTree tree(mesh, lamps);
    for (std::uint32_t k = 0; k < tree.clusters()->nodes().size(); ++k) {
        const auto patches = tree.clusters()->patches(k);
        const auto count =
            std::count_if(patches.begin(), patches.end(), [&](std::uint32_t i) { return lamps[i] != 0; });
        CHECK((count == 0 || count == std::ptrdiff_t(patches.size()) || !tree.shape(k).one_direction));
    }
    const std::vector<double> truth =
        gathered(in_pairs(mesh, {.resolution = 64, .eye_points = 4}, 16), light);
    ClusterSettings settings;
    settings.opening = cluster_opening(3e-3);
    const double mixed = relative_rms(gathered(clustered(mesh, settings), light), truth);
    settings.apart = lamps;
    const double apart = relative_rms(gathered(clustered(mesh, settings), light), truth);
    CAPTURE(mixed, apart);
    CHECK(apart < 0.5 * mixed);
    settings.apart.pop_back();
    CHECK_THROWS_AS(clustered(mesh, settings), InvalidArgument);
}

TEST_CASE("clusters change the gathered light by less than they may, and need fewer entries", "[slow]") {
    const PatchMesh mesh(room_with_floating_block(16));
    const std::vector<double> light = smooth_light(mesh);
    const std::vector<double> truth =
        gathered(in_pairs(mesh, {.resolution = 128, .eye_points = 9, .near_eye_points = 36}, 64), light);
    const FormFactorMatrix pairs = in_pairs(mesh, {.resolution = 64, .eye_points = 4}, 0);
    REQUIRE(relative_rms(gathered(pairs, light), truth) < 1e-4);
    std::vector<std::uint64_t> entries;
    for (const double error : {1e-2, 2e-3, 3e-4}) {
        ClusterSettings settings;
        settings.opening = cluster_opening(error);
        const FormFactorMatrix rows = clustered(mesh, settings);
        entries.push_back(rows.entries());
        CHECK(relative_rms(gathered(rows, light), truth) < error);
        CHECK(row_sums(rows).balance_error_max < 1e-6);
    }
    CHECK(entries[0] < entries[1]);
    CHECK(entries[1] < entries[2]);
    CHECK(entries[0] < pairs.entries() / 3);
}

TEST_CASE("a far plate of more patches than a hemicube has texels for them receives what it should") {
    // Two squares, the upper one tilted: row sums are exact factors, which patches without a texel share in.
    Scene scene = empty_scene();
    add_polygon(scene, "low",
                {{-0.05, -0.05, 0.0}, {0.05, -0.05, 0.0}, {0.05, 0.05, 0.0}, {-0.05, 0.05, 0.0}}, {1, 1});
    add_polygon(scene, "high", {{-1.0, 1.0, 4.0}, {1.0, 1.0, 4.0}, {1.0, -1.0, 5.0}, {-1.0, -1.0, 5.0}},
                {96, 96});
    const PatchMesh mesh(scene);
    const HemicubeSettings hemicube{.resolution = 16, .eye_points = 1};
    const auto engine = make_visibility_engine(mesh, hemicube, {test_device(), 2, find_worker_program()});
    const std::vector<std::uint32_t> low{0};
    const FormFactorMatrix rows = compute_clustered(*engine, mesh, low, {}, Enclosure::open);
    const ExchangeAreas exchange(mesh);
    double expected = 0.0;
    for (std::uint32_t j = 1; j < mesh.size(); ++j) {
        expected += exchange(0, j) / mesh.areas()[0];
    }
    REQUIRE(expected > 0.04);
    CHECK(rows.row(0).columns.size() < 40);
    CHECK(rows.row(0).sum() == Approx(expected).epsilon(1e-3));
}

TEST_CASE("the sky behind clusters is what it is behind their patches") {
    Scene scene = empty_scene();
    add_polygon(scene, "street", {{0, 0, 0}, {2, 0, 0}, {2, 6, 0}, {0, 6, 0}}, {12, 12});
    add_polygon(scene, "west", {{0, 0, -1}, {0, 0, 3}, {0, 6, 3}, {0, 6, -1}}, {24, 24});
    add_polygon(scene, "east", {{2, 6, -1}, {2, 6, 2}, {2, 0, 2}, {2, 0, -1}}, {24, 24});
    scene.sky = Sky{SkyDistribution::overcast, {1.0}, {0.3}};
    const PatchMesh mesh(scene);
    const std::vector<double> pairs =
        direct_irradiance(scene, mesh, in_pairs(mesh, {.resolution = 64, .eye_points = 4}, 0));
    ClusterSettings settings;
    settings.opening = cluster_opening(1e-3);
    const FormFactorMatrix rows = clustered(mesh, settings);
    REQUIRE(rows.entries() < 150u * mesh.size());
    CHECK(relative_rms(direct_irradiance(scene, mesh, rows), pairs) < 1e-3);
}

TEST_CASE("rows balance where pairs near each other cannot take what is missing") {
    // Narrow gaps between blocks: few pairs, most of them partly hidden.
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.2, 1.0, 0.8), 10);
    for (int k = 0; k < 4; ++k) {
        const double x = 0.2 + 0.21 * k;
        add_block(scene, "block", Vec3(x, 0.2, 0.02), Vec3(x + 0.19, 0.8, 0.4), 6);
    }
    const PatchMesh mesh(scene);
    const HemicubeSettings hemicube{.resolution = 32, .eye_points = 1};
    const auto engine = make_visibility_engine(mesh, hemicube, {test_device(), 2, find_worker_program()});
    ClusterSettings settings;
    settings.opening = 0.5;
    const FormFactorMatrix rows =
        compute_clustered(*engine, mesh, all_patches(mesh.size()), settings, Enclosure::automatic);
    CHECK(row_sums(rows).environment_max == 0.0);
    CHECK(row_sums(rows).balance_error_max < 1e-6);
}

TEST_CASE("pairs near each other are reciprocal, also where far ones are in clusters") {
    const PatchMesh mesh(room_with_blocks(12));
    ClusterSettings settings;
    settings.opening = 0.5;
    const FormFactorMatrix rows = clustered(mesh, settings);
    std::size_t compared = 0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const RowView row = rows.row(i);
        for (std::size_t k = 0; k < row.columns.size() && row.columns[k] < mesh.size(); ++k) {
            const std::uint32_t j = row.columns[k];
            const RowView other = rows.row(j);
            const auto back = std::lower_bound(other.columns.begin(), other.columns.end(), i);
            REQUIRE(back != other.columns.end());
            REQUIRE(*back == i);
            const double there = mesh.areas()[i] * static_cast<double>(row.values[k]);
            const double here =
                mesh.areas()[j] *
                static_cast<double>(other.values[static_cast<std::size_t>(back - other.columns.begin())]);
            REQUIRE(there == Approx(here).epsilon(1e-6));
            ++compared;
        }
    }
    CHECK(compared > mesh.size());
}

TEST_CASE("a furnace is as hot everywhere by rows of clusters") {
    Scene scene = room_with_floating_block(12);
    scene.materials[0].reflectance = {0.9};
    scene.materials[0].exitance = {0.1};
    const PatchMesh mesh(scene);
    FactorSettings settings;
    settings.clusters = Clusters::on;
    settings.cluster_error = 5e-3;
    settings.engine.device = test_device();
    FormFactors factors = compute_form_factors(scene, mesh, settings);
    REQUIRE(factors.matrix.clusters() != nullptr);
    prepare_form_factors(factors);
    SolverSettings exact;
    exact.tolerance = 1e-10;
    const Solution solution = solve_radiosity(scene, mesh, factors, exact);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        REQUIRE(solution.radiosity[i] == Approx(1.0).epsilon(1e-5));
    }
    REQUIRE(solution.error);
    CHECK(solution.error->rms < 0.01);
}

TEST_CASE("the printed error of radiosity counts what clusters do", "[slow]") {
    Scene scene = room_with_blocks(16);
    scene.materials[0].reflectance = {0.5};
    scene.materials.push_back({"lamp", {0.0}, {1.0}});
    scene.surfaces[0].material = 1;
    const PatchMesh mesh(scene);
    FactorSettings settings;
    settings.engine.device = test_device();
    FormFactors pairs = compute_form_factors(scene, mesh, settings);
    prepare_form_factors(pairs);
    const Solution expected = solve_radiosity(scene, mesh, pairs);
    settings.clusters = Clusters::on;
    double before = expected.error->rms;
    for (const double error : {1e-3, 2e-2}) {
        settings.cluster_error = error;
        FormFactors rows = compute_form_factors(scene, mesh, settings);
        prepare_form_factors(rows);
        const Solution solution = solve_radiosity(scene, mesh, rows);
        std::vector<double> reflected;
        std::vector<double> reflected_expected;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const double weight = std::sqrt(mesh.areas()[i]);
            reflected.push_back(weight * (solution.radiosity[i] - solution.exitance[i]));
            reflected_expected.push_back(weight * (expected.radiosity[i] - expected.exitance[i]));
        }
        const double difference = relative_rms(reflected, reflected_expected);
        CHECK(difference < 2.0 * solution.error->rms);
        CHECK(solution.error->rms > before);
        before = solution.error->rms;
    }
}

TEST_CASE("rows of clusters that were kept are not computed again, and count as memory") {
    const PatchMesh mesh(room_with_floating_block(10));
    const HemicubeSettings hemicube{.resolution = 32, .eye_points = 1, .joint = true};
    // The CPU rasteriser draws single rows as it draws all.
    const auto engine = make_visibility_engine(mesh, hemicube, {"cpu", 2, find_worker_program()});
    const auto patches = all_patches(mesh.size());
    REQUIRE(mesh.size() > 600);
    const auto compute = [&](std::span<const std::uint32_t> of, const ClusterSettings& settings,
                             const Progress& progress, ClusteredRowKeeper* keeper) {
        return compute_clustered(*engine, mesh, of, settings, Enclosure::automatic, progress, keeper);
    };
    const FormFactorMatrix whole = compute(patches, {}, {}, nullptr);
    Keeper keeper;
    CHECK_THROWS_AS(compute(
                        patches, {}, [](std::size_t done, std::size_t) { return done < 600; }, &keeper),
                    Cancelled);
    const std::size_t kept = keeper.rows();
    REQUIRE(kept >= 256);
    REQUIRE(kept < 600);

    ClusterSettings little;
    little.max_memory = 1000;
    const std::uint64_t before = engine->hemicubes();
    CHECK_THROWS_AS(compute(patches, little, {}, &keeper), OutOfMemory);
    CHECK(engine->hemicubes() == before);

    // Other patches of the same blocks.
    std::vector<std::uint32_t> odd;
    for (std::uint32_t i = 1; i < mesh.size(); i += 2) {
        odd.push_back(i);
    }
    Keeper of_odd;
    check_same_rows(compute(odd, {}, {}, &of_odd), compute(odd, {}, {}, nullptr));
    CHECK(of_odd.rows() == odd.size());

    std::size_t last = 0;
    const auto count = [&last](std::size_t done, std::size_t total) {
        CHECK(done == last + 1);
        CHECK(done <= total);
        last = done;
        return true;
    };
    check_same_rows(compute(patches, {}, count, &of_odd), whole);
    CHECK(last == mesh.size());
    check_same_rows(compute(patches, {}, {}, &keeper), whole);
    for (Keeper* const complete : {&keeper, &of_odd}) {
        CHECK(complete->rows() == mesh.size());
        const std::uint64_t drawn = engine->hemicubes();
        check_same_rows(compute(patches, {}, {}, complete), whole);
        CHECK(engine->hemicubes() == drawn);
    }
}

TEST_CASE("what is found in rows of clusters is what single patches tell") {
    Scene scene = room_with_floating_block(8);
    add_block(scene, "outside", Vec3(9.0, 0.2, 0.2), Vec3(9.2, 0.4, 0.4), 2);
    const PatchMesh mesh(scene);
    FormFactors factors;
    factors.areas.assign(mesh.areas().begin(), mesh.areas().end());
    factors.groups = mesh.groups();
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        factors.group_of.push_back(mesh.group(i));
    }
    factors.matrix = clustered(mesh, {.opening = 0.5});
    const Diagnosis of_clusters = diagnose(factors, &mesh, 1e-4);
    factors.matrix = expand_clusters(factors.matrix, ~std::uint64_t{0});
    const Diagnosis of_patches = diagnose(factors, &mesh, 1e-4);
    const auto patches = [](const std::vector<PatchFinding>& findings) {
        std::vector<std::uint32_t> found;
        for (const PatchFinding& finding : findings) {
            found.push_back(finding.patch);
        }
        return found;
    };
    CHECK(of_patches.outside.size() > 16); // of 24: some texels at edges of the room see into it
    CHECK(patches(of_clusters.outside) == patches(of_patches.outside));
    CHECK(patches(of_clusters.leaks) == patches(of_patches.leaks));
    CHECK(patches(of_clusters.never_visible) == patches(of_patches.never_visible));
    CHECK(patches(of_clusters.buried) == patches(of_patches.buried));
    CHECK(of_clusters.turned == of_patches.turned);
}

TEST_CASE("rows of clusters stop where they are told to, and within the memory") {
    const PatchMesh mesh(room_with_blocks(8));
    const HemicubeSettings hemicube{.resolution = 32, .eye_points = 1};
    const auto engine = make_visibility_engine(mesh, hemicube, {test_device(), 1, find_worker_program()});
    const auto patches = all_patches(mesh.size());
    CHECK_THROWS_AS(compute_clustered(*engine, mesh, patches, {}, Enclosure::automatic,
                                      [](std::size_t done, std::size_t) { return done < 10; }),
                    Cancelled);
    ClusterSettings little;
    little.max_memory = 1000;
    CHECK_THROWS_AS(compute_clustered(*engine, mesh, patches, little, Enclosure::automatic), OutOfMemory);
    ClusterSettings none;
    none.opening = 0.0;
    CHECK_THROWS_AS(compute_clustered(*engine, mesh, patches, none, Enclosure::automatic), InvalidArgument);

    const std::vector<std::uint32_t> some{3, 5, 200};
    const FormFactorMatrix rows = compute_clustered(*engine, mesh, some, {}, Enclosure::automatic);
    CHECK(rows.known(5));
    CHECK_FALSE(rows.known(6));
    CHECK(rows.row(5).sum() == Approx(1.0 - rows.row(5).blocked).epsilon(0.02));
}
