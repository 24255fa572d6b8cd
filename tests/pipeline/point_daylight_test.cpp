#include "pipeline/point_daylight.hpp"

#include "engine/clusters/cluster_tree.hpp"
#include "support/scenes.hpp"

#include "hemi/engine/exchange_area.hpp"

#include <catch2/catch.hpp>

#include <cstdint>
#include <optional>
#include <vector>

using namespace hemi;
using namespace hemi::test;

TEST_CASE("PointDaylight: clusters hide as much of the sky as their patches", "[pipeline]") {
    Scene scene = empty_scene();
    add_polygon(scene, "ground", {{0, 0, 0}, {40, 0, 0}, {40, 40, 0}, {0, 40, 0}}, {20, 20});
    for (int k = 0; k < 6; ++k) {
        add_block(scene, "blocks", Vec3(6.0 * k + 1.0, 3.0, 0.0), Vec3(6.0 * k + 4.0, 6.0, 4.0 + k), 8);
    }
    const PatchMesh mesh(scene);
    const ClusterTree tree(mesh);
    const Sky sky{.distribution = SkyDistribution::uniform, .horizontal = {1.0}, .ground = {0.2}};
    const PointDaylight singly(mesh, std::nullopt, sky, UpAxis::z);
    const PointDaylight clustered(mesh, std::nullopt, sky, UpAxis::z, tree.clusters());
    const ExchangeAreas areas(mesh);
    for (const Vec3& at : {Vec3(20.0, 14.0, 0.0), Vec3(20.0, 20.0, 3.0), Vec3(5.0, 30.0, 9.0)}) {
        const Vec3 normal = at.z > 0.0 ? Vec3(0.0, -1.0, 0.0) : Vec3(0.0, 0.0, 1.0);
        std::vector<ClusterTree::Part> parts;
        tree.seen_from(at, normal, 0.5, parts);
        std::vector<std::uint32_t> columns;
        std::vector<float> values;
        std::vector<std::uint32_t> nodes;
        std::vector<float> of_nodes;
        double sum = 0.0;
        for (const ClusterTree::Part& part : parts) {
            double whole = 0.0;
            for (const std::uint32_t j : tree.clusters()->patches(part.node)) {
                const double factor = areas.at_point(at, normal, j);
                columns.push_back(j);
                values.push_back(static_cast<float>(factor));
                whole += factor;
            }
            nodes.push_back(mesh.size() + part.node);
            of_nodes.push_back(static_cast<float>(whole));
            sum += whole;
        }
        CHECK(nodes.size() < columns.size());
        const double environment = 1.0 - sum;
        const auto exact = singly.seen_by(at, normal, {columns, values, {}, environment, 0.0});
        const auto found = clustered.seen_by(at, normal, {nodes, of_nodes, {}, environment, 0.0});
        CHECK(exact.above.share > 0.2);
        CHECK(found.above.share == Approx(exact.above.share).margin(1e-3));
        CHECK(found.above.elevation == Approx(exact.above.elevation).margin(2e-3));
        CHECK(found.below == Approx(exact.below).margin(1e-3));
    }
}
