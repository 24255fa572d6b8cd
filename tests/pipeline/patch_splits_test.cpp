#include "pipeline/patch_splits.hpp"

#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

Scene floor(double length, double width, Grid grid, bool two_sided = false) {
    Scene scene = empty_scene();
    add_polygon(scene, "floor",
                {Vec3(0, 0, 0), Vec3(length, 0, 0), Vec3(length, width, 0), Vec3(0, width, 0)}, grid);
    scene.surfaces[0].two_sided = two_sided;
    return scene;
}

/// Cuts of a patch where the light is so, with the bend that it has there; "u", "v", "uv".
std::string cut_of(const PatchMesh& mesh, std::uint32_t patch,
                   const std::function<double(double, double)>& light) {
    std::vector<float> corners(std::size_t{mesh.size()} * 4);
    double bend = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchCorners own = mesh.corners(i);
        for (std::size_t k = 0; k < own.count; ++k) {
            const double value = light(own.points[k].x, own.points[k].y);
            corners[std::size_t{i} * 4 + k] = static_cast<float>(value);
            bend += i == patch ? value / own.count : 0.0;
        }
    }
    const PatchCorners own = mesh.corners(patch);
    constexpr int cells = 64;
    for (int k = 0; k < cells * cells; ++k) {
        const double u = (k % cells + 0.5) / cells;
        const double v = (k / cells + 0.5) / cells;
        const Vec3 point = own.points[0] + u * (own.points[1] - own.points[0]) +
                           v * (own.points[own.count - 1] - own.points[0]);
        bend -= light(point.x, point.y) / (cells * cells);
    }
    const PatchSplit split = PatchSplits(mesh).across_bend(patch, corners, 1, 0, bend);
    REQUIRE(split.patch == patch);
    return std::string(split.along_u ? "u" : "") + (split.along_v ? "v" : "");
}

} // namespace

TEST_CASE("patch splits: across the way in which the light bends", "[pipeline]") {
    const PatchMesh square(floor(4, 4, {4, 4}, true));
    for (const std::uint32_t patch : {0U, 3U, 5U, 15U, 16U, 22U, 30U}) { // corners, the middle, the back
        INFO("patch " << patch);
        CHECK(cut_of(square, patch, [](double x, double) { return x * x; }) == "u");
        CHECK(cut_of(square, patch, [](double, double y) { return 9.0 - y * y; }) == "v");
        CHECK(cut_of(square, patch, [](double x, double y) { return x * x + 0.8 * y * y; }) == "uv");
        CHECK(cut_of(square, patch, [](double x, double y) { return x * x - 0.8 * y * y; }) == "uv");
        CHECK(cut_of(square, patch, [](double x, double y) { return x * x - 0.3 * y * y; }) == "uv");
        CHECK(cut_of(square, patch, [](double x, double y) { return 0.2 * x * x - y * y + 3 * x; }) == "v");
    }
    // The edge of a shadow within a patch: the light bends one way on its one side and back on the other.
    CHECK(cut_of(square, 5, [](double x, double) { return x < 1.5 ? 0.0 : 1.0; }) == "u");
    CHECK(cut_of(square, 5, [](double, double y) { return y < 1.5 ? 0.0 : 1.0; }) == "v");
    // Beside smaller patches, which have the vertices that are asked for, and larger ones, which do not.
    const PatchMesh uneven = square.split(std::vector<std::uint32_t>{5, 6, 9, 10}, Cut::in_four).mesh;
    for (std::uint32_t i = 0; i < uneven.size(); ++i) {
        CHECK(cut_of(uneven, i, [](double x, double) { return x * x; }) == "u");
        CHECK(cut_of(uneven, i, [](double, double y) { return y * y; }) == "v");
    }
}

TEST_CASE("patch splits: strips are cut lengthwise where the light changes across them", "[pipeline]") {
    const PatchMesh strip(floor(8, 0.5, {4, 1})); // nothing beside its long edges
    const auto across = [](double, double y) { return 1.0 + 5.0 * y * y; };
    CHECK(cut_of(strip, 1, across) == "v");
    CHECK(cut_of(strip, 0, [](double x, double) { return x * x; }) == "u");
    // Alone it tells nothing of the way: by its shape.
    const PatchMesh alone(floor(8, 0.5, {1, 1}));
    CHECK(cut_of(alone, 0, across) == "u");
    // No needles.
    const PatchMesh slender(floor(8, 0.2, {4, 1}));
    CHECK(cut_of(slender, 1, across) == "uv");
}

TEST_CASE("patch splits: what lies behind a partition says nothing", "[pipeline]") {
    const PatchMesh mesh(floor(4, 4, {4, 4}, true));
    // Bright on the one side of x = 2, dark on the other, as gathered corners have it there.
    std::vector<float> corners;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchCorners own = mesh.corners(i);
        for (const Vec3& point : own.polygon()) {
            const double light = mesh.centres()[i].x < 2.0 ? 9.0 : 1.0;
            corners.push_back(static_cast<float>(light + 0.1 * point.y * point.y));
        }
    }
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchSplit split = PatchSplits(mesh).across_bend(i, corners, 1, 0, 0.1 / 6.0);
        INFO("patch " << i);
        CHECK_FALSE(split.along_u);
        CHECK(split.along_v);
    }
}

TEST_CASE("patch splits: of triangles in four", "[pipeline]") {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 1, 0)}, {2, 2});
    const PatchMesh mesh(scene);
    CHECK(cut_of(mesh, 1, [](double x, double) { return x * x; }) == "uv");
    std::vector<PatchSplit> splits{PatchSplits(mesh).across_bend(1, std::vector<float>(16), 1, 0, 1.0)};
    PatchSplits(mesh).grade(splits);
    CHECK(splits.size() == 1);
    CHECK(mesh.split(splits).mesh.size() == mesh.size() + 3);
    CHECK(mesh.split(std::vector<PatchSplit>{{1, true, false}}).mesh.size() == mesh.size() + 3);
}

TEST_CASE("patch splits: beside what is cut again and again, others are cut along, and not to needles",
          "[pipeline]") {
    PatchMesh mesh(floor(2, 1, {2, 1}));
    for (int round = 0; round < 6; ++round) {
        std::vector<PatchSplit> splits;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) { // at the lower edge on the left, across it
            if (mesh.centres()[i].x < 1.0 && mesh.corners(i).points[0].y == 0.0) {
                splits.push_back({i, false, true});
            }
        }
        const std::size_t wanted = splits.size();
        PatchSplits(mesh).grade(splits);
        CHECK(std::is_sorted(splits.begin(), splits.end(),
                             [](const PatchSplit& a, const PatchSplit& b) { return a.patch < b.patch; }));
        if (round == 0) {
            CHECK(splits.size() == wanted);
        }
        if (round == 1) { // its neighbour is two steps behind: along the common edge alone
            REQUIRE(splits.size() == wanted + 1);
            const auto other = std::find_if(splits.begin(), splits.end(), [&mesh](const PatchSplit& split) {
                return mesh.centres()[split.patch].x > 1.0;
            });
            REQUIRE(other != splits.end());
            CHECK_FALSE(other->along_u);
            CHECK(other->along_v);
        }
        mesh = mesh.split(splits).mesh;
    }
    double slender = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (mesh.centres()[i].x > 1.0) { // on the left only what was asked for
            const Vec3 size = mesh.corners(i).points[2] - mesh.corners(i).points[0];
            slender = std::max(slender, size.x / size.y);
        }
    }
    CHECK(slender == Approx(16.0));
}

TEST_CASE("patch splits: edges that meet differ by a factor of two at most", "[pipeline]") {
    std::mt19937 random(7);
    PatchMesh mesh(floor(4, 3, {2, 3}, true));
    for (int round = 0; round < 9; ++round) {
        std::vector<PatchSplit> splits;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            if (random() % 4 == 0) {
                const auto ways = random() % 3;
                splits.push_back({i, ways != 0, ways != 1});
            }
        }
        const std::vector<PatchSplit> wanted = splits;
        PatchSplits(mesh).grade(splits);
        for (const PatchSplit& split : wanted) {
            const auto found = std::find_if(splits.begin(), splits.end(), [&split](const PatchSplit& other) {
                return other.patch == split.patch;
            });
            REQUIRE(found != splits.end());
            CHECK((found->along_u || !split.along_u));
            CHECK((found->along_v || !split.along_v));
        }
        mesh = mesh.split(splits).mesh;
    }
    REQUIRE(mesh.size() > 300);
    const std::uint32_t count = mesh.patches_per_side(0);
    double longest = 0.0; // edge over another that it shares a piece with
    const auto lower = [&mesh](std::uint32_t i) { return mesh.corners(i).points[0]; };
    const auto upper = [&mesh](std::uint32_t i) { return mesh.corners(i).points[2]; };
    for (std::uint32_t i = 0; i < count; ++i) {
        for (std::uint32_t j = 0; j < count; ++j) {
            for (const int way : {0, 1}) {
                const bool beside =
                    upper(i)[1 - way] == lower(j)[1 - way] || lower(i)[1 - way] == upper(j)[1 - way];
                if (beside && lower(i)[way] < upper(j)[way] - 1e-9 && lower(j)[way] < upper(i)[way] - 1e-9) {
                    longest =
                        std::max(longest, (upper(i)[way] - lower(i)[way]) / (upper(j)[way] - lower(j)[way]));
                }
            }
        }
    }
    CHECK(longest == Approx(2.0));
}
