#include "support/scenes.hpp"

#include "hemi/engine/clustered_rows.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/matrix/product.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

/// A ground with rows of blocks, which hide most of each other.
Scene blocks_on_ground(std::uint32_t along, std::uint32_t cells, double width = 1.0) {
    Scene scene = empty_scene();
    const double side = 2.0 * along;
    add_polygon(scene, "ground",
                {Vec3(0.0), Vec3(side, 0.0, 0.0), Vec3(side, side, 0.0), Vec3(0.0, side, 0.0)},
                {4 * along, 4 * along});
    for (std::uint32_t x = 0; x < along; ++x) {
        for (std::uint32_t y = 0; y < along; ++y) {
            const Vec3 low(0.5 + 2.0 * x, 0.5 + 2.0 * y, 0.01);
            const double height = 1.0 + 0.37 * ((x * 7 + y * 3) % 5);
            add_block(scene, "block", low, low + Vec3(width, width, height), cells);
        }
    }
    return scene;
}

HemicubeSettings settings_of(bool joint) {
    return {.resolution = 64, .joint = joint};
}

struct Seen {
    double share;
    bool clear;
    bool joint;
};
/// What a row tells of every patch.
std::map<std::uint32_t, Seen> expanded(const VisibilityRow& row) {
    std::map<std::uint32_t, Seen> seen;
    const auto add = [&seen](std::uint32_t patch, float share, std::uint8_t texels, bool joint) {
        const bool is_new =
            seen.try_emplace(patch, static_cast<double>(share), texels == visibility_clear, joint).second;
        REQUIRE(is_new);
    };
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        add(row.columns[k], row.shares[k], row.texels[k], false);
    }
    for (const JointVisibility& joint : row.joint) {
        for (const std::uint32_t patch : row.sets->patches_of(joint.set)) {
            add(patch, joint.share, joint.texels, true);
        }
        for (const std::uint32_t member : row.sets->members_of(joint.set)) {
            for (const std::uint32_t patch : row.sets->patches_of(member)) {
                add(patch, joint.share, joint.texels, true);
            }
        }
    }
    return seen;
}

} // namespace

TEST_CASE("Joint visibility: what is told of many patches is what is told of each", "[engine]") {
    std::size_t all_pooled = 0;
    for (const Scene& scene : {blocks_on_ground(5, 4), blocks_on_ground(12, 1, 1.9), room_with_blocks(8)}) {
        const PatchMesh mesh(scene);
        const auto single = make_visibility_engine(mesh, settings_of(false), {cpu_device, 1, {}});
        const auto joint = make_visibility_engine(mesh, settings_of(true), {cpu_device, 1, {}});
        std::vector<std::uint32_t> patches;
        for (std::uint32_t i = 0; i < mesh.size(); i += 1 + mesh.size() / 40) {
            patches.push_back(i);
        }
        std::vector<std::map<std::uint32_t, Seen>> expected;
        std::vector<std::pair<double, double>> leaving;
        single->rows(patches, [&](std::uint32_t /*patch*/, const VisibilityRow& row) {
            CHECK(row.joint.empty());
            expected.push_back(expanded(row));
            leaving.emplace_back(row.environment, row.blocked);
        });
        std::size_t k = 0;
        std::size_t hidden = 0;
        std::size_t pooled = 0;
        std::size_t told_together = 0;
        joint->rows(patches, [&](std::uint32_t patch, const VisibilityRow& row) {
            INFO("patch " << patch);
            CHECK(row.environment == leaving[k].first);
            CHECK(row.blocked == leaving[k].second);
            const std::map<std::uint32_t, Seen> seen = expanded(row);
            for (const auto& [column, of_one] : expected[k]) {
                INFO("sees " << column);
                const auto found = seen.find(column);
                REQUIRE(found != seen.end());
                if (!found->second.joint || found->second.clear || found->second.share == 0.0) {
                    REQUIRE(found->second.share == of_one.share);
                } else { // pooled over the side instead of its neighbours
                    ++pooled;
                    REQUIRE(found->second.share < 1.0);
                }
                REQUIRE(found->second.clear == of_one.clear);
            }
            for (const auto& [column, of_many] : seen) {
                // What covers no texel is told of only where it is hidden.
                if (!expected[k].contains(column)) {
                    REQUIRE(of_many.share == 0.0);
                }
                hidden += of_many.joint && of_many.share == 0.0 ? 1 : 0;
                told_together += of_many.joint ? 1 : 0;
            }
            ++k;
        });
        REQUIRE(k == patches.size());
        CHECK(hidden > 0);
        all_pooled += pooled;
        CHECK(told_together > hidden);
    }
    CHECK(all_pooled > 0);
}

namespace {

/// Rms difference, relative, of a light that rows of clusters gather with and without joint visibility.
double joint_difference(const PatchMesh& mesh, HemicubeSettings hemicube) {
    std::vector<double> light(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        light[i] = 1.0 + std::cos(mesh.centres()[i].x) * mesh.normal(i).x + mesh.normal(i).z;
    }
    std::vector<std::vector<double>> gathered;
    for (const bool joint : {false, true}) {
        hemicube.joint = joint;
        const auto engine = make_visibility_engine(mesh, hemicube, {cpu_device, joint ? 2u : 1u, {}});
        const FormFactorMatrix rows =
            compute_clustered(*engine, mesh, all_patches(mesh.size()), {}, Enclosure::open);
        gathered.emplace_back(mesh.size());
        multiply(rows, light, 1, gathered.back());
    }
    double differences = 0.0;
    double all = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        differences += std::pow(gathered[1][i] - gathered[0][i], 2.0);
        all += std::pow(gathered[0][i], 2.0);
    }
    return std::sqrt(differences / all);
}

} // namespace

TEST_CASE("Joint visibility: rows of clusters gather the same light", "[engine]") {
    const double difference = joint_difference(PatchMesh(blocks_on_ground(5, 4)), settings_of(true));
    CHECK(difference > 0.0);
    CHECK(difference < 2e-3);
}

TEST_CASE("Joint visibility: rows of several eye points may come first, and tell of every patch",
          "[engine]") {
    Scene scene = empty_scene();
    const auto add_square = [&scene](const char* group, double z, std::uint32_t cells) {
        add_polygon(scene, group,
                    {Vec3(0.0, 0.0, z), Vec3(1.0, 0.0, z), Vec3(1.0, 1.0, z), Vec3(0.0, 1.0, z)},
                    {cells, cells});
    };
    add_square("floor", 0.0, 20);
    add_square("carpet", 0.002, 1);
    add_block(scene, "block", Vec3(1.5, 0.0, 0.0), Vec3(2.0, 1.0, 1.0), 5);
    add_block(scene, "behind", Vec3(2.5, 0.2, 0.0), Vec3(3.0, 0.8, 0.5), 5);
    HemicubeSettings hemicube = settings_of(true);
    hemicube.near_eye_points = 4;
    CHECK(joint_difference(PatchMesh(scene), hemicube) < 2e-3);
}

TEST_CASE("Joint visibility: the same of any number of threads and any instruction set", "[engine]") {
    const PatchMesh mesh(blocks_on_ground(5, 4));
    std::vector<std::uint32_t> patches; // some of every surface
    for (std::uint32_t patch = 0; patch < mesh.size(); patch += 3) {
        patches.push_back(patch);
    }
    std::vector<std::vector<std::uint32_t>> told;
    for (const auto& [threads, simd] : {std::pair(1u, ""), std::pair(2u, ""), std::pair(1u, "scalar")}) {
        ::setenv("HEMI_SIMD", simd, 1);
        const auto engine = make_visibility_engine(mesh, settings_of(true), {cpu_device, threads, {}});
        std::vector<std::uint32_t>& all = told.emplace_back();
        engine->rows(patches, [&all](std::uint32_t /*patch*/, const VisibilityRow& row) {
            for (const JointVisibility& joint : row.joint) {
                all.push_back(joint.set);
                all.push_back(std::bit_cast<std::uint32_t>(joint.share));
                all.push_back(joint.texels);
            }
        });
    }
    ::unsetenv("HEMI_SIMD");
    CHECK(!told[0].empty());
    CHECK(told[0] == told[1]);
    CHECK(told[0] == told[2]);
}
