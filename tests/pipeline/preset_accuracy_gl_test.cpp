#include "support/accuracy_row.hpp"
#include "support/occluded_reference.hpp"
#include "support/scenes.hpp"

#include "hemi/core/stopwatch.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

using namespace hemi;
using namespace hemi::test;

namespace {

struct Computed {
    FormFactorMatrix factors{0};
    double seconds = 0.0; ///< for the factors
};

/// Raw factors of a scene by a preset as it ships.
Computed compute(const Scene& scene, Preset preset, std::string_view device = "osmesa",
                 std::optional<std::uint32_t> shadow_rays = {}) {
    const PatchMesh mesh(scene);
    FactorSettings settings;
    settings.preset = preset;
    settings.shadow_rays = shadow_rays;
    settings.estimate_error = false;
    settings.engine.device = device;
    const Stopwatch watch;
    FormFactors factors = compute_raw_form_factors(scene, mesh, all_patches(mesh.size()), settings);
    return {std::move(factors.matrix), watch.seconds()};
}

RowErrors compare(const FormFactorMatrix& factors, const OccludedReference& reference,
                  const std::vector<std::uint32_t>& patches) {
    RowErrors errors;
    for (const std::uint32_t i : patches) {
        errors.add(i, factors.row(i), reference.row(i));
    }
    return errors;
}

std::string describe(std::string_view preset, const RowErrors& errors, double seconds) {
    return std::string(preset) + ": rms " + std::to_string(1e6 * errors.rms) + "e-6, max " +
           std::to_string(1e6 * errors.max) + "e-6 (" + std::to_string(errors.worst_i) + " to " +
           std::to_string(errors.worst_j) + "), " + std::to_string(seconds) + " s";
}

/// Heading of a preset's column.
std::string column(Preset preset) {
    return "`" + std::string(to_word(preset)) + "`";
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

TEST_CASE("presets: the unit cube of 24 x 24 patches a face", "[pipeline][gl][slow][accuracy]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0), 24);
    scene.enclosure = Enclosure::closed;
    const PatchMesh mesh(scene);
    const OccludedReference reference(mesh, {}, 1);
    const Computed computed = compute(scene, Preset::standard);
    // Every kind of pair: patches at corners, at edges and inside of two walls.
    std::vector<std::uint32_t> patches{0, 1, 23, 24, 25, 300, 575, 2 * 576, 2 * 576 + 11, 2 * 576 + 288};
    const auto spread = sampled_patches(mesh, 14);
    patches.insert(patches.end(), spread.begin(), spread.end());
    const RowErrors errors = compare(computed.factors, reference, patches);
    INFO(describe("default", errors, computed.seconds));
    const AccuracyRow row("single factors", "unit cube, 24 x 24 patches a face");
    row.check_below(column(Preset::standard), "rms", errors.rms, 2e-7);
    row.check_below(column(Preset::standard), "max", errors.max, 1e-5);
}

TEST_CASE("presets: a room with two turned boxes, 1,110 patches", "[pipeline][gl][accuracy][slow]") {
    const Scene scene = coarse_room_with_turned_boxes();
    const PatchMesh mesh(scene);
    const OccludedReference reference(mesh, {"first", "second"}, 20);
    const auto patches = sampled_patches(mesh, 40);
    const Computed fair = compute(scene, Preset::standard);
    const RowErrors default_errors = compare(fair.factors, reference, patches);
    const Computed best = compute(scene, Preset::exact);
    const RowErrors exact_errors = compare(best.factors, reference, patches);
    INFO(describe("default", default_errors, fair.seconds)
         << "; " << describe("exact", exact_errors, best.seconds));
    const AccuracyRow row("single factors", "closed room with two rotated boxes, 1,110 patches");
    row.check_below(column(Preset::standard), "rms", default_errors.rms, 2e-5);
    row.check_below(column(Preset::standard), "max", default_errors.max, 1e-3);
    row.check_below(column(Preset::exact), "rms", exact_errors.rms, 5e-6);
}

TEST_CASE("presets: a room with two turned boxes, 5,790 patches", "[pipeline][gl][slow][accuracy]") {
    const Scene scene = fine_room_with_turned_boxes();
    const PatchMesh mesh(scene);
    const OccludedReference reference(mesh, {"first", "second"}, 14);
    const auto patches = sampled_patches(mesh, 32);
    const Computed fair = compute(scene, Preset::standard, cpu_device);
    const RowErrors default_errors = compare(fair.factors, reference, patches);
    const Computed best = compute(scene, Preset::exact, cpu_device);
    const RowErrors exact_errors = compare(best.factors, reference, patches);
    const Computed without = compute(scene, Preset::standard, cpu_device, 0);
    const RowErrors errors_without = compare(without.factors, reference, patches);
    INFO(describe("default", default_errors, fair.seconds)
         << "; " << describe("exact", exact_errors, best.seconds) << "; "
         << describe("no rays", errors_without, without.seconds));
    const AccuracyRow row("single factors", "closed room with two rotated boxes, 5,790 patches");
    row.check_below(column(Preset::standard), "rms", default_errors.rms, 8e-6);
    row.check_below(column(Preset::exact), "rms", exact_errors.rms, 3e-6);
    AccuracyRow("other limits", "rms of single factors with shadow rays / without them, 5,790 patches")
        .check_below("limit", "", default_errors.rms / errors_without.rms, 0.8);
}

TEST_CASE("presets: triangles cut into patches behind a sphere", "[pipeline][gl][accuracy][slow]") {
    Scene scene = read_case("10_concentric_spheres.obj");
    for (Surface& surface : scene.surfaces) {
        surface.patches = Grid{2, 2};
    }
    scene.materials.resize(1);
    const PatchMesh mesh(scene);
    const OccludedReference reference(mesh, {"inner"}, 10);
    const Computed computed = compute(scene, Preset::exact);
    const RowErrors errors = compare(computed.factors, reference, sampled_patches(mesh, 30));
    INFO(describe("exact", errors, computed.seconds));
    AccuracyRow("single factors", "facets between concentric spheres")
        .check_below(column(Preset::exact), "rms", errors.rms, 1.2e-5);
}

TEST_CASE("presets: the shared cases of 16 patches a face", "[pipeline][gl][slow][accuracy]") {
    const std::set<std::string> occluded{"occluded_corner", "concentric_spheres"};
    for (const ExactCase& exact : exact_cases()) {
        const bool hidden = occluded.contains(exact.name);
        const AccuracyRow row("group factors", hidden ? "occluded" : "unoccluded");
        struct Limit {
            Preset preset;
            double error;
        };
        for (const Limit& limit :
             {Limit{Preset::standard, hidden ? 3e-4 : 1e-4}, Limit{Preset::exact, hidden ? 3e-5 : 1e-6}}) {
            const Scene scene = read_case(exact.file);
            const PatchMesh mesh(scene, {.patch_size = {}, .patches_per_face = 16});
            FactorSettings settings;
            settings.preset = limit.preset;
            settings.estimate_error = false;
            settings.engine.device = cpu_device;
            const FormFactors factors = compute_form_factors(scene, mesh, settings);
            const GroupFactors groups = group_factors(factors.matrix, factors.areas, factors.group_of,
                                                      static_cast<std::uint32_t>(factors.groups.size()));
            INFO(exact.name << ", " << to_word(limit.preset));
            const auto index = [&factors](const std::string& name) {
                const auto found = std::find(factors.groups.begin(), factors.groups.end(), name);
                REQUIRE(found != factors.groups.end());
                return static_cast<std::size_t>(found - factors.groups.begin());
            };
            for (const auto& pair : exact.pairs) {
                const double factor = groups.factors[index(pair.from) * groups.groups + index(pair.to)];
                INFO(pair.from << " to " << pair.to << ": " << factor << " for " << pair.factor);
                const double error = std::abs(factor - pair.factor);
                row.check_below(column(limit.preset), "absolute", error, limit.error);
                if (!hidden && pair.factor > 0.0) { // a factor of 3e-7 has digits of its own
                    row.check_below(column(limit.preset), "relative", error / pair.factor, 1e-3);
                }
            }
        }
    }
}

TEST_CASE("presets: a patch half under a block keeps what its other half sees",
          "[pipeline][gl][accuracy][slow]") {
    struct Limit {
        Preset preset;
        double row, element;
    };
    const AccuracyRow factor_row("difficult geometry", "patches buried by 10 % to 90 %: single factor");
    const AccuracyRow sum_row("difficult geometry", "patches buried by 10 % to 90 %: row sum");
    for (const Limit& limit : {Limit{Preset::standard, 0.04, 3e-3}, Limit{Preset::exact, 0.02, 1.2e-3}}) {
        for (const double buried : {0.1, 0.4, 0.6, 0.9}) {
            const StraddledRoom room = straddled_room(buried);
            const PatchMesh whole(room.whole);
            const PatchMesh cut(room.cut);
            const auto parent = parents(whole, cut);
            const OccludedReference reference(cut, {"block"}, 24);
            const Computed computed = compute(room.whole, limit.preset);
            for (const std::uint32_t i : floor_patches(whole)) {
                const RowView row = computed.factors.row(i);
                // The back-face share is that of the sample points; the sum comes from F0 and is closer.
                CHECK(row.sum() + row.environment + row.blocked == Approx(1.0).margin(0.1).epsilon(0));
                const auto expected = straddled_row(whole, cut, parent, reference, i);
                RowErrors errors;
                errors.add(i, row, expected);
                const double sum = std::accumulate(expected.begin(), expected.end(), 0.0);
                INFO(to_word(limit.preset)
                     << ", buried " << buried << ", patch " << i << " at " << whole.centres()[i].x << " "
                     << whole.centres()[i].y << ": sum " << row.sum() << " for " << sum << "; "
                     << describe("", errors, 0.0));
                factor_row.check_below(column(limit.preset), "", errors.max, limit.element);
                sum_row.check_below(column(limit.preset), "", std::abs(row.sum() - sum), limit.row);
                if (sum == 0.0) { // all of it buried
                    CHECK(row.sum() <= 1e-4);
                }
            }
        }
    }
}

TEST_CASE("presets: a sheet close above a patch", "[pipeline][gl][accuracy][slow]") {
    struct Limit {
        Preset preset;
        double element;
    };
    for (const Limit& limit : {Limit{Preset::standard, 4e-3}, Limit{Preset::exact, 2.5e-3}}) {
        for (const double gap : {0.05, 0.1, 0.25, 0.5}) {
            const Scene scene = room_with_sheet(gap);
            const PatchMesh mesh(scene);
            const OccludedReference reference(mesh, {"sheet"}, 32);
            const Computed computed = compute(scene, limit.preset);
            auto patches = sampled_patches(mesh, 12);
            const auto floor = floor_patches(mesh);
            patches.insert(patches.end(), floor.begin(), floor.end());
            const RowErrors errors = compare(computed.factors, reference, patches);
            INFO("gap " << gap << ", " << describe(to_word(limit.preset), errors, computed.seconds));
            AccuracyRow("difficult geometry", "a sheet 0.05 to 0.5 patch sizes above a patch: single factor")
                .check_below(column(limit.preset), "", errors.max, limit.element);
        }
    }
}
