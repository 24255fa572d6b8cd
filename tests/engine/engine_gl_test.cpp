#include "engine/baselines/reference_engine.hpp"
#include "engine/hemicube/gl_rows.hpp"
#include "support/accuracy_row.hpp"
#include "support/device.hpp"
#include "support/item_agreement.hpp"
#include "support/scenes.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/engine/baselines.hpp"
#include "hemi/engine/delta_form_factors.hpp"
#include "hemi/scene/contact.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <random>

using namespace hemi;
using namespace hemi::test;

namespace {

std::vector<std::uint32_t> every(std::uint32_t step, std::uint32_t count) {
    std::vector<std::uint32_t> patches;
    for (std::uint32_t i = 0; i < count; i += step) {
        patches.push_back(i);
    }
    return patches;
}

FormFactorMatrix compute(const PatchMesh& mesh, const HemicubeSettings& settings,
                         const std::string& device = test_device(), std::uint32_t jobs = 2) {
    return compute_matrix(*make_hemicube_engine(mesh, settings, {device, jobs, find_worker_program()}));
}

bool same_bytes(const FormFactorMatrix& a, const FormFactorMatrix& b) {
    if (a.size() != b.size() || a.blocks().size() != b.blocks().size()) {
        return false;
    }
    for (std::size_t k = 0; k < a.blocks().size(); ++k) {
        const RowBlock& x = a.blocks()[k];
        const RowBlock& y = b.blocks()[k];
        if (x.begin != y.begin || x.columns != y.columns || x.environment != y.environment ||
            x.blocked != y.blocked || x.known != y.known || x.values.size() != y.values.size() ||
            std::memcmp(x.values.data(), y.values.data(), x.values.size() * sizeof(float)) != 0) {
            return false;
        }
    }
    return true;
}

void check_against_rays(const PatchMesh& mesh, std::uint32_t resolution, std::uint32_t step) {
    HemicubeSettings settings;
    settings.resolution = resolution;
    const EngineGeometry geometry = make_engine_geometry(mesh, settings);
    for (const char* where : {"cpu", "gpu"}) {
        const WithTransform transform(where);
        GlRows engine(geometry, settings, RowQuantity::form_factors, "osmesa");
        for (const std::uint32_t patch : every(step, mesh.size())) {
            INFO("patch " << patch << ", polygons transformed by " << where);
            CHECK(disagreements(mesh, settings, patch, 1.0 / 256.0, engine) == 0);
        }
    }
}

} // namespace

TEST_CASE("GlRows: item buffers of a room with blocks equal rays through the texel centres", "[engine][gl]") {
    check_against_rays(PatchMesh(room_with_blocks(6)), 64, 17);
}

TEST_CASE("GlRows: item buffers of triangles cut n² ways equal rays", "[engine][gl]") {
    check_against_rays(
        PatchMesh(read_case("14_sphere_interior.obj"), {.patch_size = {}, .patches_per_face = 9}), 48, 611);
}

TEST_CASE("GlRows: item buffers of general quadrilaterals equal rays", "[engine][gl]") {
    check_against_rays(PatchMesh(tapered_box(5)), 64, 13);
}

TEST_CASE("GlRows: a quadrilateral with a straight corner shows the right cells wherever it starts",
          "[engine][gl]") {
    const std::array<Vec3, 4> corners{Vec3(0.5, 0, 1), Vec3(0, 0, 1), Vec3(0.5, 1, 1), Vec3(1, 0, 1)};
    for (std::size_t start = 0; start < 4; ++start) {
        Scene scene = empty_scene();
        add_polygon(scene, "floor", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}, {2, 2});
        add_polygon(
            scene, "ceiling",
            {corners[start], corners[(start + 1) % 4], corners[(start + 2) % 4], corners[(start + 3) % 4]},
            {4, 3});
        const PatchMesh mesh(scene);
        const HemicubeSettings settings{.resolution = 64};
        const EngineGeometry geometry = make_engine_geometry(mesh, settings);
        for (const char* where : {"cpu", "gpu"}) {
            const WithTransform transform(where);
            GlRows engine(geometry, settings, RowQuantity::form_factors, "osmesa");
            INFO("start " << start << ", polygons transformed by " << where);
            CHECK(disagreements(mesh, settings, 0, 1.0 / 256.0, engine) <=
                  2); // the map is singular at that corner
        }
    }
}

TEST_CASE("GlRows: a merged lattice shows the same items as its faces", "[engine][gl]") {
    const PatchMesh mesh(lattice_room());
    HemicubeSettings settings;
    settings.resolution = 64;
    HemicubeSettings unmerged = settings;
    unmerged.merge_lattices = false;
    const EngineGeometry merged = make_engine_geometry(mesh, settings);
    const EngineGeometry plain = make_engine_geometry(mesh, unmerged);
    CHECK(merged.list.polygons.size() * 8 < plain.list.polygons.size());
    GlRows merged_engine(merged, settings, RowQuantity::form_factors, "osmesa");
    GlRows plain_engine(plain, settings, RowQuantity::form_factors, "osmesa");
    for (const std::uint32_t patch : every(37, mesh.size())) {
        const auto a = merged_engine.items(patch);
        const auto b = plain_engine.items(patch);
        std::size_t different = 0;
        for (std::size_t texel = 0; texel < a.size(); ++texel) {
            different += a[texel] != b[texel] ? 1 : 0;
        }
        // Drawn separately, inner edges are snapped to 1/256 texel.
        CHECK(different < a.size() / 300);
        CHECK(disagreements(mesh, settings, patch, 1.0 / 256.0, merged_engine) == 0);
    }
}

TEST_CASE("hemicube rows: sum, environment and blocked share add up to one",
          "[engine][gl][accuracy][every-device]") {
    for (const Scene& scene : {room_with_blocks(6), open_corner(), tapered_box(4)}) {
        const PatchMesh mesh(scene);
        const FormFactorMatrix factors = compute(mesh, {.resolution = 64});
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const RowView row = factors.row(i);
            AccuracyRow("other limits", "row balance of plain rows")
                .check_below("limit", "", std::abs(row.sum() + row.environment + row.blocked - 1.0), 1e-9);
        }
    }
}

TEST_CASE("hemicube rows: nothing leaks out of closed scenes", "[engine][gl][every-device]") {
    struct Named {
        const char* name;
        Scene scene;
    };
    for (const Named& closed :
         {Named{"room with blocks", room_with_blocks(8)}, Named{"tapered box", tapered_box(6)},
          Named{"lattice room", lattice_room()}, Named{"T-junctions", t_junction_room()},
          Named{"sphere", read_case("14_sphere_interior.obj")}}) {
        for (const std::uint32_t resolution : {32u, 128u}) {
            INFO(closed.name << " at " << resolution);
            const PatchMesh mesh(closed.scene);
            const FormFactorMatrix factors = compute(mesh, {.resolution = resolution});
            std::uint32_t leaks = 0;
            std::uint32_t deficits = 0;
            std::vector<std::uint32_t> looking_out; // bottoms of blocks that stand on the floor
            for (std::uint32_t i = 0; i < mesh.size(); ++i) {
                const RowView row = factors.row(i);
                if (row.environment == 1.0) {
                    looking_out.push_back(i);
                    continue;
                }
                leaks += row.environment > 0.0 ? 1 : 0;
                deficits += row.blocked < 0.5 && row.sum() < 1.0 - 1e-4 ? 1 : 0;
            }
            CHECK(leaks == 0);
            CHECK(deficits == 0);
            CHECK(patches_in_contact(mesh, looking_out) == looking_out);
        }
    }
}

TEST_CASE("hemicube rows: a covered patch is blocked, not open", "[engine][gl][every-device]") {
    const PatchMesh mesh(room_with_blocks(8));
    const FormFactorMatrix factors = compute(mesh, {.resolution = 64});
    std::uint32_t covered = 0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const bool under = under_block(mesh.centres()[i]) && mesh.groups()[mesh.group(i)] == "z0";
        if (under) {
            ++covered;
            CHECK(factors.row(i).blocked == Approx(1.0));
            CHECK(factors.row(i).environment == 0.0);
        }
    }
    CHECK(covered > 0);
}

TEST_CASE("hemicube rows: the same bytes from two runs, one and two workers, EGL and OSMesa",
          "[engine][gl]") {
    const PatchMesh mesh(room_with_blocks(7));
    const HemicubeSettings settings{.resolution = 96, .seed = 3};
    const FormFactorMatrix first = compute(mesh, settings);
    CHECK(same_bytes(first, compute(mesh, settings)));
    CHECK(same_bytes(first, compute(mesh, settings, "osmesa", 1)));
    CHECK(same_bytes(first, compute_matrix(*make_hemicube_engine(mesh, settings, {"osmesa", 0, ""}))));
    bool software_egl = false;
    for (const DeviceInfo& device : list_devices()) {
        if (device.name.starts_with("egl") && device.software && device.problem.empty()) {
            software_egl = true;
            CHECK(same_bytes(first, compute(mesh, settings, device.name)));
        }
    }
    CHECK(software_egl);
}

TEST_CASE("hemicube rows: rows of long patches, which have more eye points, fit what workers send",
          "[engine][gl][every-device]") {
    // A comb of 900 needles under a ceiling of 900: more columns a row than 4 hemicubes of 8² texels have.
    Scene scene = empty_scene();
    add_polygon(scene, "comb", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}, {1, 900});
    add_polygon(scene, "ceiling", {Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(1, 1, 1), Vec3(1, 0, 1)}, {30, 30});
    const PatchMesh mesh(scene);
    const HemicubeSettings settings{.resolution = 8, .eye_points = 4};
    const FormFactorMatrix by_workers = compute(mesh, settings);
    const FormFactorMatrix in_process =
        compute_matrix(*make_hemicube_engine(mesh, settings, {test_device(), 0, ""}));
    CHECK(same_bytes(by_workers, in_process));
}

TEST_CASE("hemicube rows: another seed turns the hemicubes", "[engine][gl][every-device]") {
    const PatchMesh mesh(room_with_blocks(4));
    CHECK_FALSE(same_bytes(compute(mesh, {.resolution = 32, .seed = 1}),
                           compute(mesh, {.resolution = 32, .seed = 2})));
}

TEST_CASE("hemicube rows: the unit cube by group within 5e-4 of the closed form",
          "[engine][gl][every-device]") {
    const PatchMesh mesh(read_case("01_unit_cube.obj"), {.patch_size = {}, .patches_per_face = 256});
    const GroupTable table = by_group(mesh, compute(mesh, {.resolution = 256}));
    constexpr double opposite = 0.19982489569838738;
    constexpr double adjacent = 0.20004377607540316;
    for (const auto& from : mesh.groups()) {
        for (const auto& to : mesh.groups()) {
            INFO(from << " to " << to);
            const double expected = from == to ? 0.0 : from[0] == to[0] ? opposite : adjacent;
            CHECK(table.factor(from, to) == Approx(expected).margin(5e-4).epsilon(0));
        }
    }
}

TEST_CASE("hemicube rows: additive over targets, area-weighted mean over sources",
          "[engine][gl][every-device]") {
    // The same wall as one polygon or as two halves: what arrives adds up, what leaves is a mean.
    const PatchMesh whole(two_plates(false), {.patch_size = 0.125, .patches_per_face = {}});
    const PatchMesh halves(two_plates(true), {.patch_size = 0.125, .patches_per_face = {}});
    const GroupTable one = by_group(whole, compute(whole, {.resolution = 128}));
    const GroupTable two = by_group(halves, compute(halves, {.resolution = 128}));
    CHECK(two.factor("floor", "left") + two.factor("floor", "right") ==
          Approx(one.factor("floor", "wall")).margin(2e-4).epsilon(0));
    CHECK(0.5 * (two.factor("left", "floor") + two.factor("right", "floor")) ==
          Approx(one.factor("wall", "floor")).margin(2e-4).epsilon(0));
    CHECK(two.factor("left", "floor") > 0.9 * one.factor("wall", "floor"));
}

TEST_CASE("hemicube rows: two polygons with the same projection have the same factor",
          "[engine][gl][every-device]") {
    const PatchMesh near_one(facing_square(1.0));
    const PatchMesh far_one(facing_square(3.0)); // three times as far, three times as large
    const double a = compute(near_one, {.resolution = 256}).row(0).sum();
    const double b = compute(far_one, {.resolution = 256}).row(0).sum();
    CHECK(a == Approx(b).margin(1e-12).epsilon(0));
}

TEST_CASE("hemicube rows: reciprocity of the unit cube to the one-point error",
          "[engine][gl][accuracy][every-device]") {
    const PatchMesh mesh(read_case("01_unit_cube.obj"), {.patch_size = {}, .patches_per_face = 64});
    const Reciprocity result = reciprocity(compute(mesh, {.resolution = 128}), mesh.areas());
    CHECK(result.rms > 0.0);
    const AccuracyRow row("plain hemicubes",
                          "unit cube: F(i, j) against F(j, i) A_j / A_i of single patches");
    row.check_below("error", "rms", result.rms, 1e-3);
    row.check_below("error", "max", result.max, 2e-2); // patches that share an edge are off by 1e-2
}

TEST_CASE("hemicube rows: rotation, scale, translation and surface order do not change factors by group",
          "[engine][gl][every-device]") {
    const Scene scene = room_with_blocks(6);
    const PatchMesh mesh(scene);
    const HemicubeSettings settings{.resolution = 128};
    const GroupTable base = by_group(mesh, compute(mesh, settings));
    struct Change {
        const char* name;
        Scene scene;
    };
    for (const Change& change :
         {Change{"rotated", rotated(scene)}, Change{"scaled by 1e-6", scaled(scene, 1e-6)},
          Change{"scaled by 1e6", scaled(scene, 1e6)},
          Change{"moved by 1e5", moved(scene, Vec3(1e5, -1e5, 1e5))},
          Change{"reversed order", reversed(scene)}}) {
        INFO(change.name);
        const PatchMesh other(change.scene);
        const GroupTable table = by_group(other, compute(other, settings));
        for (const auto& from : mesh.groups()) {
            for (const auto& to : mesh.groups()) {
                INFO(from << " to " << to);
                // A group of n patches averages n independently turned hemicubes of 3·128² texels.
                CHECK(table.factor(from, to) == Approx(base.factor(from, to)).margin(5e-4).epsilon(0));
            }
        }
    }
}

TEST_CASE("hemicube rows: scale by a power of two changes no bit", "[engine][gl][every-device]") {
    const Scene scene = room_with_blocks(5);
    const PatchMesh mesh(scene);
    const PatchMesh larger(scaled(scene, 1024.0));
    CHECK(same_bytes(compute(mesh, {.resolution = 64}), compute(larger, {.resolution = 64})));
}

TEST_CASE("hemicube rows: coincident opposite faces see their own sides only", "[engine][gl][every-device]") {
    const PatchMesh mesh(read_case("12_occluded_corner.obj"), {.patch_size = {}, .patches_per_face = 256});
    const GroupTable table = by_group(mesh, compute(mesh, {.resolution = 128}));
    CHECK(table.factor("a", "blocker_up") == 0.0);
    CHECK(table.factor("b", "blocker_down") == 0.0);
    CHECK(table.factor("blocker_down", "b") == 0.0);
    CHECK(table.factor("a", "b") == Approx(0.1498686717737907).margin(1e-3).epsilon(0));
    CHECK(table.factor("a", "blocker_down") == Approx(0.10381332089428669).margin(1e-3).epsilon(0));
    CHECK(table.factor("blocker_up", "b") == Approx(0.41525328357714675).margin(1e-3).epsilon(0));
}

TEST_CASE("hemicube rows: a two-sided sheet radiates on both sides", "[engine][gl][every-device]") {
    Scene scene = read_case("12_occluded_corner.obj");
    Scene sheet = scene;
    sheet.surfaces.pop_back(); // blocker_down; the other becomes a sheet with two sides
    sheet.surfaces.back().two_sided = true;
    const Subdivision subdivision{.patch_size = {}, .patches_per_face = 64};
    const PatchMesh two(scene, subdivision);
    const PatchMesh one(sheet, subdivision);
    REQUIRE(two.size() == one.size());
    const GroupTable a = by_group(two, compute(two, {.resolution = 64}));
    const GroupTable b = by_group(one, compute(one, {.resolution = 64}));
    // The sheet's group holds both sides: what arrives is their sum, what leaves their mean.
    CHECK(b.factor("a", "blocker_up") == Approx(a.factor("a", "blocker_down")).margin(1e-3));
    CHECK(b.factor("b", "blocker_up") == Approx(a.factor("b", "blocker_up")).margin(1e-3));
    CHECK(b.factor("blocker_up", "a") == Approx(0.5 * a.factor("blocker_down", "a")).margin(1e-3));
    CHECK(b.factor("blocker_up", "b") == Approx(0.5 * a.factor("blocker_up", "b")).margin(1e-3));
    CHECK(b.factor("a", "b") == Approx(a.factor("a", "b")).margin(1e-3));
}

TEST_CASE("hemicube rows: the closed-form cases within what one eye point can reach",
          "[engine][gl][accuracy][every-device][slow]") {
    for (const ExactCase& exact : exact_cases()) {
        const PatchMesh mesh(read_case(exact.file),
                             {.patch_size = {}, .patches_per_face = exact.patches_per_face});
        const GroupTable table = by_group(mesh, compute(mesh, {.resolution = 256}));
        for (const auto& pair : exact.pairs) {
            INFO(exact.name << ": " << pair.from << " to " << pair.to << " is "
                            << table.factor(pair.from, pair.to) << ", exactly " << pair.factor);
            AccuracyRow("plain hemicubes", exact.title)
                .check_below("error", "", std::abs(table.factor(pair.from, pair.to) - pair.factor),
                             exact.one_point_limit);
        }
    }
}

TEST_CASE("hemicube engine: resolutions 2 and 4096 work, odd ones are refused", "[engine][gl]") {
    const PatchMesh mesh(facing_square(1.0));
    for (const std::uint32_t resolution : {2u, 4096u}) {
        const FormFactorMatrix factors = compute(mesh, {.resolution = resolution}, "osmesa", 1);
        CHECK(factors.row(0).sum() + factors.row(0).environment == Approx(1.0).margin(1e-9));
    }
    CHECK_THROWS_AS(make_hemicube_engine(mesh, {.resolution = 3}, {}), InvalidArgument);
    CHECK_THROWS_AS(make_hemicube_engine(mesh, {.resolution = 4098}, {}), InvalidArgument);
}

TEST_CASE("hemicube engine: an unknown or missing device is refused by name", "[engine][gl]") {
    const PatchMesh mesh(facing_square(1.0));
    CHECK_THROWS_AS(make_hemicube_engine(mesh, {}, {"vulkan", 0, ""}), InvalidArgument);
    CHECK_THROWS_AS(static_cast<void>(compute(mesh, {}, "egl:77")), NoDevice);
}

TEST_CASE("hemicube engine: a worker that cannot start or dies is an error", "[engine][gl]") {
    const PatchMesh mesh(facing_square(1.0));
    CHECK_THROWS_WITH(compute_matrix(*make_hemicube_engine(mesh, {}, {"osmesa", 1, "/nonexistent/hemi"})),
                      Catch::Contains("cannot be started"));
    CHECK_THROWS_WITH(compute_matrix(*make_hemicube_engine(mesh, {}, {"osmesa", 1, "/bin/true"})),
                      Catch::Contains("ended early"));
}

TEST_CASE("hemicube engine: it can be stopped and used again", "[engine][gl]") {
    const PatchMesh mesh(room_with_blocks(6));
    for (const std::filesystem::path& program : {std::filesystem::path(), find_worker_program()}) {
        const auto engine = make_hemicube_engine(mesh, {.resolution = 64}, {"osmesa", 2, program});
        CHECK_THROWS_AS(compute_matrix(*engine, [](std::size_t done, std::size_t) { return done < 5; }),
                        Cancelled);
        CHECK(same_bytes(compute_matrix(*engine), compute(mesh, {.resolution = 64})));
    }
}

TEST_CASE("providers: an interrupt stops them at the next row", "[engine][gl]") {
    const PatchMesh mesh(room_with_blocks(2));
    static int rows_left = 0;
    const auto stopped_after = [](auto& provider, int rows) {
        std::vector<std::uint32_t> patches(provider.size());
        std::iota(patches.begin(), patches.end(), 0u);
        int delivered = 0;
        rows_left = rows;
        set_interrupt_check([] { return rows_left == 0; });
        CHECK_THROWS_AS(provider.rows(patches,
                                      [&](std::uint32_t, const auto&) {
                                          ++delivered;
                                          --rows_left;
                                      }),
                        Cancelled);
        set_interrupt_check(nullptr);
        return delivered;
    };
    for (const std::filesystem::path& program : {std::filesystem::path(), find_worker_program()}) {
        const EngineSettings where{"osmesa", 2, program};
        CHECK(stopped_after(*make_hemicube_engine(mesh, {.resolution = 32}, where), 3) == 3);
        CHECK(stopped_after(*make_visibility_engine(mesh, {.resolution = 32}, where), 3) == 3);
    }
    CHECK(stopped_after(*make_baseline(mesh, {.method = Method::contour}), 3) == 3);
}

TEST_CASE("hemicube rows: one open patch sees the environment alone", "[engine][gl][every-device]") {
    Scene scene = facing_square(1.0);
    scene.surfaces.resize(1);
    const PatchMesh mesh(scene);
    const FormFactorMatrix factors = compute(mesh, {.resolution = 32});
    CHECK(factors.row(0).columns.empty());
    CHECK(factors.row(0).environment == 1.0);
}
