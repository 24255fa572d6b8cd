#include "hemi/pipeline/vertex_gather.hpp"

#include "display/smooth_surfaces.hpp"
#include "pipeline/known_corners.hpp"

#include "support/device.hpp"
#include "support/lamp_and_sheet.hpp"
#include "support/scenes.hpp"

#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "hemi/display/picture.hpp"
#include "hemi/display/vertex_colours.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

FactorSettings settings_of(Preset preset) {
    FactorSettings settings;
    settings.preset = preset;
    settings.estimate_error = false;
    settings.engine.device = test_device();
    settings.engine.jobs = 2;
    return settings;
}

Solution solved(const Scene& scene, const PatchMesh& mesh, Preset preset = Preset::standard) {
    const FormFactors factors = compute_form_factors(scene, mesh, settings_of(preset));
    return solve_radiosity(scene, mesh, factors);
}

double at_corner(const Solution& solution, std::uint32_t patch, std::uint32_t corner) {
    return static_cast<double>(solution.vertex_radiosity[std::size_t{patch} * 4 + corner]);
}

} // namespace

TEST_CASE("gather: vertices of a floor behind a sheet have their own light", "[pipeline][every-device]") {
    // The lamp's patches: a single one gets as many rays as several.
    for (const std::uint32_t lamp_cells : {1u, 2u}) {
        const Scene scene = lamp_and_sheet(16, lamp_cells);
        const PatchMesh mesh(scene);
        Solution solution = solved(scene, mesh);
        const auto error_of = [&](const std::vector<float>& corners) {
            double squares = 0.0;
            double light = 0.0;
            for (std::uint32_t i = 0; i < 16 * 16; ++i) {
                const PatchCorners at = mesh.corners(i);
                for (std::uint32_t k = 0; k < 4; ++k) {
                    const double exact = exact_floor(at.points[k]);
                    squares += std::pow(static_cast<double>(corners[std::size_t{i} * 4 + k]) - exact, 2.0);
                    light += exact * exact;
                }
            }
            return std::sqrt(squares / light);
        };
        const double means = error_of(corner_values(mesh, 1, solution.radiosity, solution.back_face_share));
        gather_at_vertices(scene, mesh, settings_of(Preset::standard), Gather::automatic, solution);
        REQUIRE(solution.vertex_radiosity.size() == std::size_t{mesh.size()} * 4);
        const double gathered = error_of(solution.vertex_radiosity);
        INFO("off by " << gathered << ", means by " << means);
        CHECK(gathered < 0.0025);
        CHECK(gathered < 0.2 * means);
        // The lamp's vertices have what it radiates.
        for (std::uint32_t k = 0; k < 4; ++k) {
            CHECK(at_corner(solution, 256, k) == 10.0);
        }
    }
}

TEST_CASE("gather: in a furnace every vertex has the radiosity of all", "[pipeline][every-device]") {
    Scene scene = empty_scene();
    scene.materials[0] = {"wall", {0.5}, {1.0}};
    add_room(scene, Vec3(0.0), Vec3(1.0), 10);
    add_block(scene, "block", Vec3(0.3, 0.4, 0.0), Vec3(0.6, 0.7, 0.3), 3); // along the floor's patches
    const PatchMesh mesh(scene);
    Solution solution = solved(scene, mesh);
    gather_at_vertices(scene, mesh, settings_of(Preset::standard), Gather::automatic, solution);
    CHECK(solution.vertex_radiosity.empty()); // it would change nothing
    gather_at_vertices(scene, mesh, settings_of(Preset::standard), Gather::on, solution);
    REQUIRE(solution.vertex_radiosity.size() == std::size_t{mesh.size()} * 4);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        for (std::uint32_t k = 0; k < 4 && solution.back_face_share[i] < buried_above; ++k) {
            REQUIRE(at_corner(solution, i, k) == Approx(2.0).epsilon(5e-4));
        }
    }
}

TEST_CASE("gather: a vertex under a block is not taken for dark", "[pipeline]") {
    // The block's foot goes through the middle of floor patches.
    Scene scene = empty_scene();
    scene.materials[0].reflectance = {0.8};
    scene.materials.push_back({"lamp", {0.5}, {10.0}});
    add_room(scene, Vec3(0.0), Vec3(1.0), 8);
    for (Surface& surface : scene.surfaces) {
        surface.material = scene.groups[surface.group] == "z1" ? 1 : 0;
    }
    add_block(scene, "block", Vec3(0.3, 0.3, 0.0), Vec3(0.7, 0.7, 0.3), 4);
    const PatchMesh mesh(scene);
    Solution solution = solved(scene, mesh);
    gather_at_vertices(scene, mesh, settings_of(Preset::standard), Gather::on, solution);
    double darkest = 1e9;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (mesh.groups()[mesh.group(i)] != "z0") {
            continue;
        }
        const PatchCorners at = mesh.corners(i);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const Vec3& point = at.points[k];
            const bool under = point.x > 0.3 && point.x < 0.7 && point.y > 0.3 && point.y < 0.7;
            darkest = under ? darkest : std::min(darkest, at_corner(solution, i, k));
        }
    }
    CHECK(darkest > 3.5); // on a grid five times as fine the darkest has 4.3
}

TEST_CASE("gather: kept rows give the same again, and follow other materials", "[pipeline]") {
    const Scene scene = lamp_and_sheet(6, 2);
    const PatchMesh mesh(scene);
    const Solution solution = solved(scene, mesh);
    const PatchValues values = patch_values(scene, mesh);
    VertexGather gather(mesh, solution.back_face_share, all_patches(mesh.size()));
    CHECK_FALSE(gather.has_rows());
    CHECK_THROWS_AS(gather.gather(values, solution.radiosity), InvalidArgument);
    const FactorSettings settings = settings_of(Preset::standard);
    const auto once =
        gather.compute(values, solution.radiosity, settings, scene.enclosure, std::uint64_t{1} << 30);
    REQUIRE(gather.has_rows());
    CHECK(gather.gather(values, solution.radiosity) == once);
    PatchValues brighter = values;
    std::vector<double> radiosity = solution.radiosity;
    for (double& value : brighter.exitance) {
        value *= 2.0;
    }
    for (double& value : radiosity) {
        value *= 2.0;
    }
    const auto twice = gather.gather(brighter, radiosity);
    for (std::size_t k = 0; k < once.size(); ++k) {
        REQUIRE(twice[k] == 2.0F * once[k]);
    }
    // Cancelled half way: nothing is kept that is not whole.
    class Stops : public Observer {
    public:
        bool progress(Phase, std::size_t, std::size_t) override { return false; }
    } stops;
    CHECK_THROWS_AS(
        gather.compute(values, solution.radiosity, settings, scene.enclosure, std::uint64_t{1} << 30, stops),
        Cancelled);
    CHECK_FALSE(gather.has_rows());
    // Not enough memory: nothing is kept, and the values are the same.
    CHECK(gather.compute(values, solution.radiosity, settings, scene.enclosure, 1000) == once);
    CHECK_FALSE(gather.has_rows());
    CHECK_THROWS_AS(gather.compute(values, std::vector<double>(3, 1.0), settings, scene.enclosure),
                    InvalidArgument);
}

TEST_CASE("gather: of some patches it is what it is of all, also beside patches twice their size",
          "[pipeline]") {
    const Scene scene = lamp_and_sheet(4, 1);
    PatchMesh mesh = PatchMesh(scene).split(std::vector<std::uint32_t>{0, 5, 9, 10}).mesh;
    mesh = mesh.split(std::vector<std::uint32_t>{mesh.first_patch(0) + 8}).mesh;
    const Solution solution = solved(scene, mesh);
    const PatchValues values = patch_values(scene, mesh);
    const auto corners_of = [&](const std::vector<std::uint32_t>& patches) {
        return VertexGather(mesh, solution.back_face_share, patches)
            .compute(values, solution.radiosity, settings_of(Preset::standard), scene.enclosure, 0);
    };
    const std::vector<float> all = corners_of(all_patches(mesh.size()));
    for (std::uint32_t i = 0; i < mesh.patches_per_side(0); ++i) {
        const std::vector<float> own = corners_of({i});
        for (std::size_t k = std::size_t{i} * 4; k < std::size_t{i} * 4 + 4; ++k) {
            INFO("patch " << i << " of " << mesh.patches_per_side(0) << ", corner " << k % 4);
            CHECK(own[k] == Approx(all[k]).epsilon(0.02).margin(2e-4)); // the same vertices by other rays
        }
    }
}

TEST_CASE("gather: what is known already stays, and only the rest is seen", "[pipeline]") {
    const Scene scene = lamp_and_sheet(4, 1);
    const PatchMesh coarse(scene);
    const auto [mesh, parents] = coarse.split(std::vector<std::uint32_t>{0, 5, 9, 10});
    const Solution solution = solved(scene, mesh);
    const PatchValues values = patch_values(scene, mesh);
    std::vector<std::uint32_t> unknown;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (std::count(parents.begin(), parents.end(), parents[i]) > 1) {
            unknown.push_back(i);
        }
    }
    REQUIRE(unknown.size() == 16);
    const auto compute = [&](VertexGather& gather) {
        return gather.compute(values, solution.radiosity, settings_of(Preset::standard), scene.enclosure, 0);
    };
    VertexGather whole(mesh, solution.back_face_share, all_patches(mesh.size()));
    const std::vector<float> all = compute(whole);
    KnownCorners known{std::vector<float>(all.size(), 7.0F), unknown};
    VertexGather rest(mesh, solution.back_face_share, all_patches(mesh.size()), known);
    CHECK(rest.points().size() < whole.points().size());
    const std::vector<float> mixed = compute(rest);
    const SmoothSurfaces surfaces(mesh);
    std::vector<bool> seen(surfaces.vertex_count(), false);
    for (const std::uint32_t i : unknown) {
        for (const std::uint32_t vertex : surfaces.corners(i)) {
            seen[vertex] = true;
        }
    }
    std::vector<bool> hangs(surfaces.vertex_count(), false);
    for (const SmoothSurfaces::Hanging& hanging : surfaces.hanging()) {
        hangs[hanging.vertex] = true;
    }
    std::size_t kept = 0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const auto ring = surfaces.corners(i);
        for (std::uint32_t k = 0; k < ring.size(); ++k) {
            const float value = mixed[std::size_t{i} * 4 + k];
            INFO("patch " << i << ", corner " << k);
            if (hangs[ring[k]]) {
                continue; // shows what the longer edge does
            }
            if (seen[ring[k]]) {
                CHECK(value == Approx(all[std::size_t{i} * 4 + k]).epsilon(0.02).margin(2e-4));
            } else {
                CHECK(value == 7.0F);
                ++kept;
            }
        }
    }
    CHECK(kept > 0);
    known.values.pop_back();
    VertexGather wrong(mesh, solution.back_face_share, all_patches(mesh.size()), known);
    CHECK_THROWS_AS(compute(wrong), InvalidArgument);
}

TEST_CASE("gather: corners of patches that were not cut keep what they showed, as bright as their patch",
          "[pipeline]") {
    Solution before;
    before.channels = 2;
    before.exitance = {1, 0, 0, 0, 0, 0};
    before.radiosity = {3, 4, 5, 6, 0, 8};
    for (int k = 0; k < 24; ++k) {
        before.vertex_radiosity.push_back(static_cast<float>(k));
    }
    Solution now;
    now.channels = 2;
    now.exitance = {1, 0, 0, 0, 0, 0, 0, 0};
    now.radiosity = {2, 4, 5, 6, 5, 6, 0, 4};
    const KnownCorners known = known_corners(before, now, std::vector<std::uint32_t>{0, 1, 1, 2});
    CHECK(known.unknown == std::vector<std::uint32_t>{1, 2});
    REQUIRE(known.values.size() == 32);
    for (std::size_t k = 0; k < 4; ++k) {
        const auto shown = [&](std::size_t patch, std::size_t channel) {
            return before.vertex_radiosity[(patch * 4 + k) * 2 + channel];
        };
        CHECK(known.values[k * 2] == Approx(1.0 + (shown(0, 0) - 1.0F) / 2.0F)); // reflects half as much
        CHECK(known.values[k * 2 + 1] == shown(0, 1));
        CHECK(known.values[(12 + k) * 2] == shown(2, 0)); // dark, as it was
        CHECK(known.values[(12 + k) * 2 + 1] == Approx(shown(2, 1) / 2.0F));
    }
    now.radiosity[7] = 17.0; // more than twice as much: another light
    CHECK(known_corners(before, now, std::vector<std::uint32_t>{0, 1, 1, 2}).unknown ==
          std::vector<std::uint32_t>{1, 2, 3});
    before.vertex_radiosity.clear();
    CHECK(known_corners(before, now, std::vector<std::uint32_t>{0, 1, 1, 2}).values.empty());
}

TEST_CASE("gather: automatic leaves plain and fast pictures alone", "[pipeline]") {
    const Scene scene = lamp_and_sheet(4, 2);
    const PatchMesh mesh(scene);
    for (const Preset preset : {Preset::plain, Preset::fast}) {
        Solution solution = solved(scene, mesh, preset);
        gather_at_vertices(scene, mesh, settings_of(preset), Gather::automatic, solution);
        CHECK(solution.vertex_radiosity.empty());
        gather_at_vertices(scene, mesh, settings_of(preset), Gather::on, solution);
        CHECK(solution.vertex_radiosity.size() == std::size_t{mesh.size()} * 4);
        gather_at_vertices(scene, mesh, settings_of(preset), Gather::off, solution);
        CHECK(solution.vertex_radiosity.empty());
    }
}

TEST_CASE("gather: a picture shows the gathered values", "[pipeline]") {
    const Scene scene = lamp_and_sheet(4, 2);
    const PatchMesh mesh(scene);
    Solution solution = solved(scene, mesh);
    gather_at_vertices(scene, mesh, settings_of(Preset::standard), Gather::on, solution);
    const PictureMesh picture = make_picture_mesh(mesh, 1, solution.radiosity, solution.back_face_share,
                                                  {0, 0, 0}, solution.vertex_radiosity);
    for (std::size_t corner = 0; corner < std::size_t{mesh.size()} * 4; ++corner) {
        REQUIRE(picture.corners[corner * 3] == solution.vertex_radiosity[corner]);
    }
    CHECK_THROWS_AS(make_picture_mesh(mesh, 1, solution.radiosity, {}, {0, 0, 0}, std::vector<float>(3)),
                    InvalidArgument);
}
