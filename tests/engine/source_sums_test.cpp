#include "engine/clusters/source_sums.hpp"
#include "support/scenes.hpp"

#include "hemi/engine/exchange_area.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

/// Small triangles about the origin, which look at it more or less.
PatchMesh cave(std::uint32_t count) {
    Scene scene = empty_scene();
    for (std::uint32_t k = 0; k < count; ++k) {
        const double height = 1.0 - (2.0 * k + 1.0) / count;
        const double angle = 2.39996 * k; // the golden one
        const double width = std::sqrt(1.0 - height * height);
        const Vec3 out(width * std::cos(angle), width * std::sin(angle), height);
        const Vec3 normal = glm::normalize(Vec3(0.2 * std::sin(5.0 * k), 0.2 * std::cos(3.0 * k), 0.0) - out);
        const Vec3 right = glm::normalize(glm::cross(normal, Vec3(0.6, 0.64, 0.48)));
        const Vec3 up = glm::cross(normal, right);
        const Vec3 middle = (1.0 + 0.1 * std::sin(7.0 * height)) * out;
        const double size = 0.8 / std::sqrt(static_cast<double>(count));
        add_polygon(scene, "cave", {middle - size * right, middle + size * right, middle + size * up});
    }
    return PatchMesh(scene);
}

/// All patches in two sets, every other one in each.
PatchSets two_sets(std::uint32_t patches) {
    PatchSets sets;
    for (const std::uint32_t first : {0U, 1U}) {
        sets.first.push_back(static_cast<std::uint32_t>(sets.patches.size()));
        for (std::uint32_t j = first; j < patches; j += 2) {
            sets.patches.push_back(j);
        }
    }
    sets.first.push_back(patches);
    sets.first_members.assign(3, 0);
    return sets;
}

} // namespace

TEST_CASE("source sums: every patch that is told of is in one source, and gives what it does alone",
          "[engine]") {
    const auto patches = GENERATE(1U, 2U, 15U, 16U, 17U, 33U, 500U, 3000U);
    const auto kind = GENERATE(0, 1, 2);    // a patch, a point, a sphere
    const auto by_sets = GENERATE(0, 1, 2); // none, one of two, both
    CAPTURE(patches, kind, by_sets);
    const PatchMesh mesh = cave(patches);
    const ClusterTree tree(mesh);
    const ExchangeAreas exchange(mesh);
    const PatchSets sets = two_sets(patches);
    const SetPlaces places(sets, tree, mesh);

    RowReceiver receiver{.at = Vec3(0.1, -0.05, 0.0), .normal = Vec3(0, 0, 1)};
    std::vector<ClusterTree::Part> parts;
    if (kind == 0) {
        receiver = {.at = mesh.centres()[0],
                    .normal = mesh.normal(0),
                    .radius = tree.radius_of(0),
                    .patch = 0,
                    .area = mesh.areas()[0]};
        tree.seen_from(0, 0.5, parts);
    } else {
        receiver.normal = kind == 1 ? receiver.normal : std::nullopt;
        tree.seen_from(receiver.at, receiver.normal, 0.5, parts);
    }
    const auto factor = [&](std::uint32_t j) {
        return kind == 0   ? exchange(0, j) / mesh.areas()[0]
               : kind == 1 ? exchange.at_point(receiver.at, *receiver.normal, j)
                           : exchange.solid_angle_at(receiver.at, j) / (4.0 * std::numbers::pi);
    };

    constexpr double visibility = 0.75;
    const SeenShare share{visibility, 8.0, false};
    SourceSums sums(mesh, tree, exchange);
    for (int row = 0; row < 2; ++row) { // the second time what the first one left is in the way
        sums.start(receiver, parts, false);
        for (std::uint32_t j = 0; j < patches; ++j) {
            if (by_sets == 0 || (by_sets == 1 && j % 2 == 1)) {
                sums.add_patch(j, share);
            }
        }
        for (std::uint32_t set = 0; set < static_cast<std::uint32_t>(by_sets); ++set) {
            sums.add_set(places, set, share);
        }
        sums.finish();
    }

    std::vector<int> sources(patches, 0);
    double sum = 0.0;
    for (const Source& source : sums.near()) {
        ++sources[source.column];
        CHECK(source.unoccluded == Approx(factor(source.column)));
        CHECK(source.visibility == Approx(visibility));
        sum += source.unoccluded;
    }
    for (const Source& source : sums.far()) {
        for (const std::uint32_t j : tree.clusters()->patches(source.column - patches)) {
            ++sources[j];
        }
        CHECK(source.visibility == Approx(visibility));
        CHECK_FALSE(source.clear);
        sum += source.unoccluded;
    }
    double expected = 0.0;
    double left_out = 0.0; // of clusters whose middles are below the horizon
    for (std::uint32_t j = 0; j < patches; ++j) {
        const double alone = factor(j);
        INFO("patch " << j << ": " << alone);
        CHECK(sources[j] <= 1);
        left_out += sources[j] == 0 ? alone : 0.0;
        expected += alone;
    }
    CHECK(left_out <= (sums.far().empty() ? 0.0 : 1e-4 * expected));
    CHECK(sum == Approx(expected).epsilon(0.02));
    CHECK((patches < 500 || !sums.far().empty()));
    CHECK_FALSE(sums.hides());
}
