#include "cli/program.hpp"
#include "support/occluded_reference.hpp"
#include "support/scene_file.hpp"
#include "support/scenes.hpp"

#include "hemi/io/factor_file.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

using namespace hemi;
using namespace hemi::test;
using cli_test::Directory;
using cli_test::Outcome;
using cli_test::run_hemi;
using cli_test::Words;

namespace {

struct Computed {
    FormFactorMatrix factors{0};
    double seconds = 0.0; ///< for the factors
};

/// All factors of a scene by a preset of the program.
Computed compute(const Scene& scene, const std::string& preset, const std::vector<std::string>& more = {}) {
    const Directory directory;
    const std::string file = directory.path("a.hff");
    std::vector<std::string> arguments{"factors",  directory.write("scene.json", scene_json(scene)),
                                       "--preset", preset,
                                       "--device", "osmesa",
                                       "-o",       file,
                                       "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = run_hemi(arguments);
    INFO(run.err);
    REQUIRE(run.status == 0);
    return {io::read_hff(file).factors, run.json()["seconds"]["factors"]};
}

RowErrors compare(const FormFactorMatrix& factors, const OccludedReference& reference,
                  const std::vector<std::uint32_t>& patches) {
    RowErrors errors;
    for (const std::uint32_t i : patches) {
        errors.add(i, factors.row(i), reference.row(i));
    }
    return errors;
}

std::string told(const std::string& preset, const RowErrors& errors, double seconds) {
    return preset + ": rms " + std::to_string(1e6 * errors.rms) + "e-6, max " +
           std::to_string(1e6 * errors.max) + "e-6 (" + std::to_string(errors.worst_i) + " to " +
           std::to_string(errors.worst_j) + "), " + std::to_string(seconds) + " s";
}

std::vector<std::uint32_t> floor_patches(const PatchMesh& mesh) {
    std::vector<std::uint32_t> patches;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (mesh.groups()[mesh.group(i)] == "z0") {
            patches.push_back(i);
        }
    }
    return patches;
}

} // namespace

TEST_CASE("hybrid: the unit cube of 24 x 24 patches a face", "[engine][gl][slow]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0), 24);
    scene.enclosure = Enclosure::closed;
    const PatchMesh mesh(scene);
    const OccludedReference reference(mesh, {}, 1);
    const Computed computed = compute(scene, "default");
    // Every kind of pair: patches at corners, at edges and inside of two walls.
    std::vector<std::uint32_t> patches{0, 1, 23, 24, 25, 300, 575, 2 * 576, 2 * 576 + 11, 2 * 576 + 288};
    const auto spread = sampled_patches(mesh, 14);
    patches.insert(patches.end(), spread.begin(), spread.end());
    const RowErrors errors = compare(computed.factors, reference, patches);
    INFO(told("default", errors, computed.seconds));
    CHECK(errors.max <= 1e-5);
    CHECK(errors.rms <= 2e-7);
}

TEST_CASE("hybrid: a room with two turned boxes, 1,110 patches", "[engine][gl]") {
    const Scene scene = coarse_room_with_turned_boxes();
    const PatchMesh mesh(scene);
    const OccludedReference reference(mesh, {"first", "second"}, 20);
    const auto patches = sampled_patches(mesh, 40);
    const Computed fair = compute(scene, "default");
    const RowErrors default_errors = compare(fair.factors, reference, patches);
    const Computed best = compute(scene, "exact");
    const RowErrors exact_errors = compare(best.factors, reference, patches);
    INFO(told("default", default_errors, fair.seconds) << "; " << told("exact", exact_errors, best.seconds));
    CHECK(default_errors.rms <= 2e-5);
    CHECK(default_errors.max <= 1e-3);
    CHECK(exact_errors.rms <= 5e-6);
}

TEST_CASE("hybrid: a room with two turned boxes, 5,790 patches", "[engine][gl][slow]") {
    const Scene scene = fine_room_with_turned_boxes();
    const PatchMesh mesh(scene);
    const OccludedReference reference(mesh, {"first", "second"}, 14);
    const auto patches = sampled_patches(mesh, 32);
    const Computed fair = compute(scene, "default");
    const RowErrors default_errors = compare(fair.factors, reference, patches);
    const Computed best = compute(scene, "exact");
    const RowErrors exact_errors = compare(best.factors, reference, patches);
    const Computed without = compute(scene, "default", {"--shadow-rays", "0"});
    const RowErrors errors_without = compare(without.factors, reference, patches);
    INFO(told("default", default_errors, fair.seconds)
         << "; " << told("exact", exact_errors, best.seconds) << "; "
         << told("no rays", errors_without, without.seconds));
    CHECK(default_errors.rms <= 8e-6);
    CHECK(default_errors.rms <= 0.8 * errors_without.rms); // what shadow rays are for
    CHECK(exact_errors.rms <= 3e-6);
}

TEST_CASE("hybrid: triangles cut into patches behind a sphere", "[engine][gl]") {
    Scene scene = read_case("10_concentric_spheres.obj");
    for (Surface& surface : scene.surfaces) {
        surface.patches = Grid{2, 2};
    }
    scene.materials.resize(1);
    const PatchMesh mesh(scene);
    const OccludedReference reference(mesh, {"inner"}, 10);
    const Computed computed = compute(scene, "exact");
    const RowErrors errors = compare(computed.factors, reference, sampled_patches(mesh, 30));
    INFO(told("exact", errors, computed.seconds));
    CHECK(errors.rms <= 1.2e-5);
}

TEST_CASE("hybrid: the shared cases of 16 patches a face", "[engine][gl][slow]") {
    const std::set<std::string> occluded{"occluded_corner", "concentric_spheres"};
    for (const ExactCase& exact : exact_cases()) {
        const bool hidden = occluded.contains(exact.name);
        struct Limit {
            const char* preset;
            double error;
        };
        for (const Limit& limit :
             {Limit{"default", hidden ? 3e-4 : 1e-4}, Limit{"exact", hidden ? 3e-5 : 1e-6}}) {
            const Outcome run =
                run_hemi({"factors", data_path("cases/" + exact.file), "--patches-per-face", "16", "--preset",
                          limit.preset, "--device", "osmesa", "--by-group", "--json", "-q"});
            INFO(exact.name << ", " << limit.preset << ": " << run.err);
            REQUIRE(run.status == 0);
            const auto table = run.json();
            const auto index = [&table](const std::string& name) {
                const auto& groups = table["groups"];
                return static_cast<std::size_t>(std::find(groups.begin(), groups.end(), name) -
                                                groups.begin());
            };
            for (const auto& pair : exact.pairs) {
                const double factor = table["factors"][index(pair.from)][index(pair.to)];
                INFO(pair.from << " to " << pair.to << ": " << factor << " for " << pair.factor);
                CHECK(std::abs(factor - pair.factor) <= limit.error);
                if (!hidden && pair.factor > 0.0) { // a factor of 3e-7 has digits of its own
                    CHECK(factor == Approx(pair.factor).epsilon(1e-3));
                }
            }
        }
    }
}

TEST_CASE("hybrid: a patch half under a block keeps what its other half sees", "[engine][gl]") {
    struct Limit {
        const char* preset;
        double row, element;
    };
    for (const Limit& limit : {Limit{"default", 0.04, 3e-3}, Limit{"exact", 0.02, 1.2e-3}}) {
        for (const double covered : {0.1, 0.4, 0.6, 0.9}) {
            const StraddledRoom room = straddled_room(covered);
            const PatchMesh whole(room.whole);
            const PatchMesh cut(room.cut);
            const auto parent = parents(whole, cut);
            const OccludedReference reference(cut, {"block"}, 24);
            const Computed computed = compute(room.whole, limit.preset);
            for (const std::uint32_t i : floor_patches(whole)) {
                const RowView row = computed.factors.row(i);
                // The blocked share is that of the eye points; the sum comes of F0 and is closer.
                CHECK(row.sum() + row.environment + row.blocked == Approx(1.0).margin(0.1).epsilon(0));
                const auto expected = straddled_row(whole, cut, parent, reference, i);
                RowErrors errors;
                errors.add(i, row, expected);
                const double sum = std::accumulate(expected.begin(), expected.end(), 0.0);
                INFO(limit.preset << ", covered " << covered << ", patch " << i << " at "
                                  << whole.centres()[i].x << " " << whole.centres()[i].y << ": sum "
                                  << row.sum() << " for " << sum << "; " << told("", errors, 0.0));
                CHECK(std::abs(row.sum() - sum) <= limit.row);
                CHECK(errors.max <= limit.element);
                if (sum == 0.0) { // all of it covered
                    CHECK(row.sum() <= 1e-4);
                }
            }
        }
    }
}

TEST_CASE("hybrid: a sheet close above a patch", "[engine][gl]") {
    struct Limit {
        const char* preset;
        double element;
    };
    for (const Limit& limit : {Limit{"default", 4e-3}, Limit{"exact", 2.5e-3}}) {
        for (const double gap : {0.05, 0.1, 0.25, 0.5}) {
            const Scene scene = room_with_sheet(gap);
            const PatchMesh mesh(scene);
            const OccludedReference reference(mesh, {"sheet"}, 32);
            const Computed computed = compute(scene, limit.preset);
            auto patches = sampled_patches(mesh, 12);
            const auto floor = floor_patches(mesh);
            patches.insert(patches.end(), floor.begin(), floor.end());
            const RowErrors errors = compare(computed.factors, reference, patches);
            INFO("gap " << gap << ", " << told(limit.preset, errors, computed.seconds));
            CHECK(errors.max <= limit.element);
        }
    }
}
