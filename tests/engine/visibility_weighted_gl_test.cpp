#include "engine/baselines/reference_engine.hpp"
#include "engine/hemicube/eye.hpp"
#include "support/accuracy_row.hpp"
#include "support/device.hpp"
#include "support/scenes.hpp"

#include "hemi/core/error.hpp"
#include "hemi/engine/delta_form_factors.hpp"
#include "hemi/engine/visibility_weighted.hpp"
#include "hemi/scene/near_surface.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <numeric>

using namespace hemi;
using namespace hemi::test;

namespace {

std::vector<std::uint32_t> all_of(const PatchMesh& mesh) {
    std::vector<std::uint32_t> patches(mesh.size());
    std::iota(patches.begin(), patches.end(), 0u);
    return patches;
}

HemicubeSettings visibility_settings(std::uint32_t eye_points, std::uint32_t resolution) {
    HemicubeSettings settings;
    settings.eye_points = eye_points;
    settings.resolution = resolution;
    return settings;
}

/// A floor of 4 x 4 patches of size 1, and a sheet of 0.4 x 0.4 close above patch 5.
Scene sheet_above_floor() {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(4, 4, 0), Vec3(0, 4, 0)}, {4, 4});
    add_polygon(scene, "sheet",
                {Vec3(1.3, 1.3, 0.08), Vec3(1.3, 1.7, 0.08), Vec3(1.7, 1.7, 0.08), Vec3(1.7, 1.3, 0.08)});
    return scene;
}

FormFactorMatrix hybrid(const PatchMesh& mesh, const HemicubeSettings& settings,
                        std::span<const std::uint32_t> patches, Enclosure enclosure = Enclosure::automatic,
                        std::uint32_t jobs = 2) {
    const auto engine = make_visibility_engine(mesh, settings, {test_device(), jobs, find_worker_program()});
    return compute_visibility_weighted(*engine, mesh, patches, VisibilityWeightedSettings{}, enclosure);
}

/// Whether a ray from an eye on `from` meets the front of patch `to`, whatever lies between.
bool meets(const PatchMesh& mesh, const Vec3& eye, const Vec3& direction, std::uint32_t to) {
    const PatchCorners corners = mesh.corners(to);
    const Vec3 normal = mesh.normal(to);
    const double height = glm::dot(eye - corners.points[0], normal);
    const double approach = glm::dot(direction, normal);
    if (height <= 0.0 || approach >= 0.0) {
        return false;
    }
    const Vec3 point = eye - height / approach * direction;
    for (std::uint32_t c = 0; c < corners.count; ++c) {
        const Vec3 edge = corners.points[(c + 1) % corners.count] - corners.points[c];
        if (glm::dot(glm::cross(edge, point - corners.points[c]), normal) < 0.0) {
            return false;
        }
    }
    return true;
}

/// Visible over covered delta form factors of one patch from another, texel by texel; negative if no texel
/// covers it.
double traced_visibility(const PatchMesh& mesh, const HemicubeSettings& settings, std::uint32_t from,
                         std::uint32_t to) {
    const ReferenceTracer tracer(mesh, settings);
    const DeltaFormFactors weights(settings.resolution);
    double visible = 0.0;
    double covered = 0.0;
    const auto eyes = tracer.eyes().of(from);
    for (std::uint32_t e = 0; e < eyes.size(); ++e) {
        const auto items = tracer.items(from, e);
        const EyeFrame frame(eyes[e].normal, from, e, settings.seed);
        std::size_t texel = 0;
        for (int face = 0; face < hemicube_faces; ++face) {
            const std::uint32_t rows = face == 0 ? settings.resolution : settings.resolution / 2;
            for (std::uint32_t y = 0; y < rows; ++y) {
                for (std::uint32_t x = 0; x < settings.resolution; ++x, ++texel) {
                    const double right = (2.0 * x + 1.0) / settings.resolution - 1.0;
                    const double up = (2.0 * y + 1.0) / settings.resolution - (face == 0 ? 1.0 : 0.0);
                    const Vec3 local = face_direction(face, right, up);
                    const Vec3 direction = local.x * frame.x + local.y * frame.y + local.z * frame.z;
                    const double weight =
                        eyes[e].share *
                        weights.weight(static_cast<std::uint32_t>(texel / settings.resolution), x);
                    if (meets(mesh, eyes[e].position, direction, to)) {
                        covered += weight;
                        visible += items[texel] == item_first_patch + to ? weight : 0.0;
                    }
                }
            }
        }
    }
    return covered > 0.0 ? visible / covered : -1.0;
}

} // namespace

TEST_CASE("make_eye_points: shares sum to one and their mean is the centroid", "[engine]") {
    for (const Scene& scene : {room_with_blocks(2), tapered_box(2), read_case("14_sphere_interior.obj")}) {
        const PatchMesh mesh(scene);
        for (const std::uint32_t count : {1u, 4u, 9u, 16u, 25u}) {
            const EyePoints eyes = make_eye_points(mesh, count);
            REQUIRE(eyes.patches() == mesh.size());
            for (std::uint32_t i = 0; i < mesh.size(); i += 7) {
                double share = 0.0;
                Vec3 mean(0.0);
                for (const EyePoint& eye : eyes.of(i)) {
                    CHECK(eye.share > 0.0);
                    CHECK(eye.surface == mesh.surface_of()[i]);
                    share += eye.share;
                    mean += eye.share * eye.position;
                }
                CHECK(share == Approx(1.0).margin(1e-12));
                const bool compact = eyes.of(i).size() <= count; // else points in no rows
                CHECK(glm::distance(mean, mesh.centres()[i]) < (compact ? 1e-9 : 0.05));
            }
        }
    }
}

TEST_CASE("make_eye_points: long patches have points for their length, in no rows", "[engine]") {
    Scene scene = empty_scene();
    add_polygon(scene, "square", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)});
    add_polygon(scene, "strip", {Vec3(0, 0, 1), Vec3(6, 0, 1), Vec3(6, 1, 1), Vec3(0, 1, 1)});
    add_polygon(scene, "needle", {Vec3(0, 0, 2), Vec3(50, 0, 2), Vec3(50, 0.5, 2)});
    const PatchMesh mesh(scene);
    const EyePoints eyes = make_eye_points(mesh, 4);
    CHECK(eyes.of(0).size() == 4);
    CHECK(eyes.of(1).size() == 12);
    CHECK(eyes.of(2).size() == 16);
    CHECK(make_eye_points(mesh, 1).points.size() == 3); // one point is one point
    for (const std::uint32_t patch : {1u, 2u}) {
        std::vector<double> along;
        double share = 0.0;
        for (const EyePoint& eye : eyes.of(patch)) {
            along.push_back(eye.position.x);
            share += eye.share;
        }
        CHECK(share == Approx(1.0).margin(1e-12));
        std::sort(along.begin(), along.end());
        // Every point has a place of its own along the patch, and gaps are about equal (towards the tip of
        // the triangle they are longer, since less of its area lies there).
        const double length = patch == 1 ? 6.0 : 50.0;
        for (std::size_t k = 1; k < along.size(); ++k) {
            CHECK(along[k] > along[k - 1]);
            CHECK(along[k] - along[k - 1] < 2.5 * length / static_cast<double>(along.size()));
        }
    }
}

TEST_CASE("make_eye_points: numbers that are no squares are refused", "[engine]") {
    const PatchMesh mesh(room_with_blocks(1));
    CHECK_THROWS_AS(make_eye_points(mesh, 5), InvalidArgument);
    CHECK_THROWS_AS(make_eye_points(mesh, 0), InvalidArgument);
    CHECK_THROWS_AS(make_eye_points(mesh, 81), InvalidArgument);
}

TEST_CASE("make_eye_points: only patches with a surface close above get more", "[engine]") {
    const PatchMesh mesh(sheet_above_floor());
    const auto near = find_near_surfaces(mesh);
    REQUIRE(near.size() == 2); // the patch below, and the sheet itself
    CHECK(near[0].patch == 5);
    CHECK(near[0].gap == Approx(0.08).epsilon(1e-9));
    CHECK(near[1].patch == 16);
    const EyePoints eyes = make_eye_points(mesh, 4, 64);
    CHECK(eyes.of(4).size() == 4);
    CHECK(eyes.of(5).size() == 49);
    CHECK(make_eye_points(mesh, 4, 16).of(5).size() == 16);
}

TEST_CASE("make_hemicube_engine: counts the hemicubes of the rows that it delivered",
          "[engine][gl][every-device]") {
    const PatchMesh mesh(sheet_above_floor());
    HemicubeSettings settings = visibility_settings(4, 32);
    settings.near_eye_points = 16;
    const std::vector<std::uint32_t> some{4, 5, 16};
    for (const std::filesystem::path& program : {std::filesystem::path(), find_worker_program()}) {
        const auto engine = make_hemicube_engine(mesh, settings, {test_device(), 1, program});
        CHECK(engine->hemicubes() == 0);
        engine->rows(some, [](std::uint32_t, const RowView&) {});
        CHECK(engine->hemicubes() == 4 + 16 + 9); // the sheet is small for its gap
    }
}

TEST_CASE("find_near_surfaces: walls at the border are neighbours, what stands on a patch straddles it",
          "[scene]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0, 0, 0), Vec3(4, 4, 4), 4);
    CHECK(find_near_surfaces(PatchMesh(scene)).empty());
    CHECK(find_near_surfaces(PatchMesh(read_case("14_sphere_interior.obj"))).empty());
    add_block(scene, "block", Vec3(1, 1, 0), Vec3(2.5, 2, 1), 1);
    const PatchMesh mesh(scene);
    std::size_t straddled = 0;
    for (const NearSurface& near : find_near_surfaces(mesh)) {
        straddled += mesh.groups()[mesh.group(near.patch)] == "z0" ? 1 : 0;
    }
    CHECK(straddled == 1); // the block's base runs along patch borders but for this one
}

TEST_CASE("Rows: several eye points a patch equal rays from the same points", "[engine][gl][every-device]") {
    const PatchMesh mesh(room_with_blocks(3));
    for (const std::uint32_t count : {4u, 9u}) {
        HemicubeSettings settings;
        settings.eye_points = count;
        settings.resolution = 32;
        const double two_texels = 2.0 * 4.0 / (32.0 * 32.0 * std::numbers::pi) * 0.33;
        const std::vector<std::uint32_t> some{0, 20, 47, 60};
        const auto drawn = compute_matrix(
            *make_hemicube_engine(mesh, settings, {test_device(), 1, find_worker_program()}), some);
        const auto traced = compute_matrix(*make_reference_engine(mesh, settings), some);
        for (const std::uint32_t i : some) {
            std::vector<double> difference(mesh.size());
            const RowView a = drawn.row(i);
            const RowView b = traced.row(i);
            CHECK(a.sum() + a.environment + a.blocked == Approx(1.0).margin(1e-9));
            for (std::size_t k = 0; k < a.columns.size(); ++k) {
                difference[a.columns[k]] += static_cast<double>(a.values[k]);
            }
            for (std::size_t k = 0; k < b.columns.size(); ++k) {
                difference[b.columns[k]] -= static_cast<double>(b.values[k]);
            }
            for (const double d : difference) {
                CHECK(std::abs(d) < two_texels); // on an edge
            }
        }
    }
}

TEST_CASE("Visibility rows: equal rays that meet a patch or something before it",
          "[engine][gl][every-device]") {
    const bool triangles = GENERATE(false, true);
    const PatchMesh mesh(triangles ? read_case("10_concentric_spheres.obj") : room_with_blocks(3),
                         triangles ? Subdivision{.patch_size = {}, .patches_per_face = 4} : Subdivision{});
    const HemicubeSettings settings = visibility_settings(4, 48);
    const std::vector<std::uint32_t> some =
        triangles ? std::vector<std::uint32_t>{330, 500, 600} : std::vector<std::uint32_t>{4, 31, 50, 62};
    const auto engine = make_visibility_engine(mesh, settings, {test_device(), 1, find_worker_program()});
    std::size_t partly = 0;
    engine->rows(some, [&](std::uint32_t i, const VisibilityRow& row) {
        REQUIRE(row.texels.size() == row.shares.size());
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            CHECK((row.shares[k] >= 0.0f && row.shares[k] <= 1.0f));
            if (row.texels[k] < 40 || row.texels[k] == visibility_clear) {
                continue; // few texels: neighbours stand in
            }
            INFO("patch " << i << " to " << row.columns[k]);
            const double traced = traced_visibility(mesh, settings, i, row.columns[k]);
            if (traced < 0.0) {
                continue; // behind the horizon
            }
            partly += traced > 0.0 && traced < 1.0 ? 1 : 0;
            CHECK(std::abs(static_cast<double>(row.shares[k]) - traced) < 0.02); // texels on edges
        }
    });
    CHECK(partly > 10);
}

TEST_CASE("Visibility rows: where nothing hides anything, all is clear", "[engine][gl][every-device]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0, 0, 0), Vec3(1, 1, 1), 12);
    const PatchMesh mesh(scene);
    const auto engine =
        make_visibility_engine(mesh, visibility_settings(1, 16), {test_device(), 1, find_worker_program()});
    const std::vector<std::uint32_t> some{0, 300, 700};
    engine->rows(some, [&](std::uint32_t, const VisibilityRow& row) {
        CHECK(row.columns.size() == 5 * 144); // also those that no texel fell on
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            CHECK(row.shares[k] == 1.0f);
            CHECK(row.texels[k] == visibility_clear);
        }
    });
}

TEST_CASE("Hybrid: pairs are reciprocal to the rounding of floats, on any number of workers",
          "[engine][gl][every-device][accuracy]") {
    const PatchMesh mesh(room_with_blocks(4));
    const HemicubeSettings settings = visibility_settings(4, 32);
    const FormFactorMatrix one = hybrid(mesh, settings, all_of(mesh), Enclosure::closed, 1);
    const FormFactorMatrix two = hybrid(mesh, settings, all_of(mesh), Enclosure::closed, 2);
    for (std::size_t b = 0; b < one.blocks().size(); ++b) {
        REQUIRE(one.blocks()[b].columns == two.blocks()[b].columns);
        REQUIRE(one.blocks()[b].values == two.blocks()[b].values);
        REQUIRE(one.blocks()[b].visibility == two.blocks()[b].visibility);
    }
    const Reciprocity error = reciprocity(one, mesh.areas());
    AccuracyRow("other limits", "reciprocity of visibility-weighted rows, relative, rms")
        .check_below("limit", "", error.relative_rms, 1e-7);
    CHECK(error.pairs > 1000);
}

TEST_CASE("Hybrid: two parallel plates in the open have the exact factor, the sky the rest",
          "[engine][gl][every-device]") {
    const ExactCase plates = [] {
        for (const ExactCase& one : exact_cases()) {
            if (one.file == "03_parallel_d1.obj") {
                return one;
            }
        }
        throw Error("no such case");
    }();
    const PatchMesh mesh(read_case(plates.file), {.patch_size = {}, .patches_per_face = 16});
    const FormFactorMatrix factors = hybrid(mesh, visibility_settings(1, 64), all_of(mesh));
    const GroupTable table = by_group(mesh, factors);
    for (const auto& pair : plates.pairs) {
        CHECK(table.factor(pair.from, pair.to) == Approx(pair.factor).margin(2e-7));
    }
    const RowSums sums = row_sums(factors);
    CHECK(sums.balance_error_max < 1e-9);
}

TEST_CASE("Hybrid: rows that are not asked for stay unknown, their columns do not",
          "[engine][gl][every-device]") {
    const PatchMesh mesh(room_with_blocks(3));
    const HemicubeSettings settings = visibility_settings(16, 64);
    std::vector<std::uint32_t> most;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (i % 5 != 2) {
            most.push_back(i);
        }
    }
    const FormFactorMatrix part = hybrid(mesh, settings, most, Enclosure::closed);
    const FormFactorMatrix whole = hybrid(mesh, settings, all_of(mesh), Enclosure::closed);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        REQUIRE(part.known(i) == (i % 5 != 2));
        if (!part.known(i)) {
            CHECK(part.row(i).columns.empty());
            continue;
        }
        CHECK(part.row(i).sum() == Approx(whole.row(i).sum()).margin(0.02)); // V from one side only
        const RowView row = part.row(i);
        CHECK(std::is_sorted(row.columns.begin(), row.columns.end()));
    }
}

TEST_CASE("Hybrid: a patch half under a block has half its factors, and half is blocked",
          "[engine][gl][every-device]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0, 0, 0), Vec3(4, 4, 4), 4);
    add_block(scene, "block", Vec3(1, 1, 0), Vec3(2.5, 2, 1), 2);
    const PatchMesh mesh(scene);
    HemicubeSettings settings = visibility_settings(4, 64);
    settings.near_eye_points = 64;
    const FormFactorMatrix factors = hybrid(mesh, settings, all_of(mesh), Enclosure::closed);
    for (const NearSurface& near : find_near_surfaces(mesh)) {
        if (mesh.groups()[mesh.group(near.patch)] == "z0") {
            const RowView row = factors.row(near.patch);
            CHECK(row.blocked == Approx(0.5).margin(1e-3));
            CHECK(row.sum() == Approx(0.5).margin(0.03));
            CHECK(row.environment == 0.0);
        }
    }
}
