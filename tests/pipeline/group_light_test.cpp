#include "hemi/pipeline/group_light.hpp"

#include "hemi/core/error.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hemi;

namespace {

/// Two patches of group a (areas 1 and 3), one of group b (area 2), two channels.
struct Known {
    PatchMesh mesh;
    PatchValues values;
    Solution solution;
};
Known known() {
    Scene scene = test::empty_scene();
    scene.groups = {"a", "b"};
    const auto add = [&scene](double x, double width, std::uint32_t group) {
        Surface surface;
        surface.vertices = {Vec3{x, 0, 0}, Vec3{x + width, 0, 0}, Vec3{x + width, 1, 0}, Vec3{x, 1, 0}};
        surface.vertex_count = 4;
        surface.group = group;
        scene.surfaces.push_back(surface);
    };
    add(0.0, 1.0, 0);
    add(10.0, 3.0, 0);
    add(20.0, 2.0, 1);
    Known result{PatchMesh(scene), {}, {}};
    result.values.channels = 2;
    result.values.reflectance = {0.5, 0.25, 0.5, 0.5, 0.0, 0.5};
    result.solution.channels = 2;
    result.solution.exitance = {1, 0, 0, 0, 0, 0};
    result.solution.radiosity = {2, 1, 4, 2, 0, 3};
    return result;
}

} // namespace

TEST_CASE("group_light: means are by area, powers are sums, channels count by their weights", "[pipeline]") {
    const Known at = known();
    const std::vector<GroupLight> plain = group_light(at.mesh, at.values, at.solution);
    REQUIRE(plain.size() == 3);
    CHECK(plain[0].area == Approx(4.0));
    CHECK(plain[0].exitance == Approx(1.0 / 4.0));
    // Irradiances (2 - 1) / 0.5 and 1 / 0.25 of the first patch, 4 / 0.5 and 2 / 0.5 of the second.
    CHECK(plain[0].received == Approx(1.0 * (2 + 4) + 3.0 * (8 + 4)));
    CHECK(plain[0].irradiance == Approx(42.0 / 4.0));
    CHECK(plain[0].leaving == Approx(1.0 * 3 + 3.0 * 6));
    CHECK(plain[0].radiosity == Approx(21.0 / 4.0));
    CHECK(plain[0].least == Approx(3.0));
    CHECK(plain[0].most == Approx(6.0));

    const std::vector<GroupLight> weighted =
        group_light(at.mesh, at.values, at.solution, std::vector<double>{0.25, 0.75});
    CHECK(weighted[0].leaving == Approx(1.0 * (0.5 + 0.75) + 3.0 * (1.0 + 1.5)));
    CHECK(weighted[2].area == Approx(6.0));
    CHECK(weighted[2].leaving == Approx(weighted[0].leaving + weighted[1].leaving));
    CHECK(weighted[2].least == Approx(1.25));
    CHECK(weighted[2].most == Approx(2.5));
}

TEST_CASE("group_light: what arrives where nothing is reflected is known only if it was found",
          "[pipeline]") {
    Known at = known();
    const std::vector<GroupLight> unknown = group_light(at.mesh, at.values, at.solution);
    CHECK(std::isnan(unknown[1].irradiance)); // black in the first channel
    CHECK(std::isnan(unknown[1].received));
    CHECK(std::isnan(unknown[2].irradiance));
    CHECK(unknown[1].radiosity == Approx(3.0));
    at.solution.irradiance = {2, 4, 8, 4, 5, 6};
    const std::vector<GroupLight> found = group_light(at.mesh, at.values, at.solution);
    CHECK(found[1].irradiance == Approx(11.0));
    CHECK(found[1].received == Approx(22.0));
    CHECK(found[2].received == Approx(64.0));
}

TEST_CASE("group_light: values of another mesh are refused", "[pipeline]") {
    Known at = known();
    CHECK_THROWS_AS(group_light(at.mesh, at.values, at.solution, std::vector<double>{1.0}), InvalidArgument);
    at.solution.radiosity.pop_back();
    CHECK_THROWS_AS(group_light(at.mesh, at.values, at.solution), InvalidArgument);
}
