#include "hemi/pipeline/difference.hpp"

#include "support/scenes.hpp"

#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

/// Two squares that face each other, cut into strips along x, with radiosities of their patches.
struct Solved {
    Scene scene = empty_scene();
    Solution solution;

    Solved(std::uint32_t strips, std::vector<double> radiosity) {
        add_polygon(scene, "floor", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {strips, 1});
        add_polygon(scene, "ceiling", {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}});
        solution.radiosity = std::move(radiosity);
        solution.exitance.assign(solution.radiosity.size(), 0.0);
    }
};

SolutionDifference compare(const Solved& a, const Solved& b, Quantity quantity = Quantity::radiosity) {
    const PatchMesh first(a.scene);
    const PatchMesh second(b.scene);
    return compare_solutions({a.scene, first, a.solution}, {b.scene, second, b.solution}, quantity);
}

} // namespace

TEST_CASE("difference: of the same patches, second less first", "[pipeline]") {
    const Solved a(2, {1.0, 4.0, 10.0});
    const SolutionDifference same = compare(a, a);
    CHECK(same.pairing == Pairing::same_patches);
    CHECK(same.difference == std::vector<double>{0.0, 0.0, 0.0});
    CHECK(same.groups[0].rms == 0.0);

    const SolutionDifference found = compare(a, Solved(2, {1.5, 1.0, 11.0}));
    CHECK(found.difference == std::vector<double>{0.5, -3.0, 1.0});
    REQUIRE(found.groups.size() == 3); // floor, ceiling, all
    CHECK(found.groups[0].area == Approx(1.0));
    CHECK(found.groups[0].first == Approx(2.5));
    CHECK(found.groups[0].second == Approx(1.25));
    CHECK(found.groups[0].difference == Approx(-1.25));
    CHECK(found.groups[0].rms == Approx(std::sqrt(0.5 * (0.25 + 9.0))));
    CHECK(found.groups[0].largest == -3.0);
    CHECK(found.groups[1].difference == Approx(1.0));
    CHECK(found.groups[2].area == Approx(2.0));
    CHECK(found.groups[2].difference == Approx(-0.125));
    CHECK(difference_colours(found).map == ColourMap::cool_warm);
    CHECK(difference_colours(found).values == found.difference);
    CHECK(difference_colours(found).range == std::array{-3.0, 3.0});
    Solved lamp = a;
    lamp.solution.exitance = {1.0, 1.0, 0.0}; // differences of lamps are beyond the scale
    CHECK(difference_colours(compare(lamp, Solved(2, {1.5, 1.0, 11.0}))).range == std::array{-1.0, 1.0});
}

TEST_CASE("difference: of other patches, with the one that lies there", "[pipeline]") {
    const Solved coarse(2, {1.0, 4.0, 10.0});
    const Solved fine(4, {1.0, 2.0, 3.0, 5.0, 10.0});
    const SolutionDifference up = compare(fine, coarse);
    CHECK(up.pairing == Pairing::nearest);
    CHECK(up.off == 0);
    CHECK(up.partner == std::vector<std::uint32_t>{0, 0, 1, 1, 2});
    CHECK(up.difference == std::vector<double>{0.0, -1.0, 1.0, -1.0, 0.0});
    CHECK(up.groups[0].difference == Approx(-0.25));

    Solved moved = coarse; // no patch lies on another any more
    for (Surface& surface : moved.scene.surfaces) {
        for (Vec3& vertex : surface.vertices) {
            vertex.z += 0.01;
        }
    }
    const SolutionDifference off = compare(fine, moved);
    CHECK(off.pairing == Pairing::nearest);
    CHECK(off.off == 5);
    CHECK(off.partner == up.partner);
    CHECK(off.farthest == Approx(std::hypot(0.125, 0.01)));
}

TEST_CASE("difference: what has no value on either side is left out, what cannot be compared is refused",
          "[pipeline]") {
    Solved a(2, {1.0, 4.0, 10.0});
    Solved b(2, {2.0, 9.0, 11.0});
    b.solution.back_face_share = {0.0, 1.0, 0.0}; // buried
    const SolutionDifference found = compare(a, b);
    CHECK(std::isnan(found.difference[1]));
    CHECK(found.groups[0].area == Approx(0.5));
    CHECK(found.groups[0].difference == Approx(1.0));
    b.solution.back_face_share = {1.0, 1.0, 0.0};
    CHECK(std::isnan(compare(a, b).groups[0].difference));
    CHECK(compare(a, b).groups[0].area == 0.0);

    CHECK_THROWS_WITH(compare(a, b, Quantity::irradiance),
                      Catch::Contains("the first solution") && Catch::Contains("irradiance"));
    a.solution.irradiance = {1.0, 1.0, 1.0};
    CHECK_THROWS_WITH(compare(a, b, Quantity::irradiance), Catch::Contains("the second solution"));
    b.scene.photometric = true;
    CHECK_THROWS_WITH(compare(a, b), Catch::Contains("lm/m²"));

    Solved other(2, {1.0, 2.0, 3.0});
    other.scene.surfaces.pop_back(); // looks downwards
    other.solution.radiosity.pop_back();
    other.solution.exitance.pop_back();
    CHECK_THROWS_WITH(compare(a, other), Catch::Contains("looks the way"));
}
