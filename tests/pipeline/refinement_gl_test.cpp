#include "hemi/pipeline/refinement.hpp"

#include "io/io_fixtures.hpp"
#include "matrix/split_rows.hpp"
#include "support/device.hpp"
#include "support/lamp_and_sheet.hpp"
#include "support/scenes.hpp"

#include "hemi/core/error.hpp"
#include "hemi/display/vertex_colours.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/pipeline/patch_size_error.hpp"
#include "hemi/pipeline/radiosity.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

FactorSettings settings_of(Preset preset = Preset::standard) {
    FactorSettings settings;
    settings.preset = preset;
    settings.engine.device = test_device();
    settings.engine.jobs = 2;
    return settings;
}

/// By which form factors are a large part of the error.
FactorSettings rough_settings(std::uint32_t resolution) {
    FactorSettings settings = settings_of();
    settings.engine.device = cpu_device;
    settings.resolution = resolution;
    settings.shadow_rays = 0;
    return settings;
}

/// What the interpolated vertices of the floor are off by, at 8 x 8 points of every patch, rms over rms.
double true_error(const PatchMesh& mesh, const Solution& solution) {
    const auto corners = solution.vertex_radiosity.empty()
                             ? corner_values(mesh, 1, solution.radiosity, solution.back_face_share)
                             : solution.vertex_radiosity;
    double squares = 0.0;
    double light = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (mesh.groups()[mesh.group(i)] != "floor") {
            continue;
        }
        const PatchCorners at = mesh.corners(i);
        for (int k = 0; k < 64; ++k) {
            const double u = (k % 8 + 0.5) / 8;
            const double v = (k / 8 + 0.5) / 8;
            const std::array<double, 4> weights{(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
            double shown = 0.0;
            Vec3 point(0.0);
            for (std::size_t c = 0; c < 4; ++c) {
                shown += weights[c] * static_cast<double>(corners[std::size_t{i} * 4 + c]);
                point += weights[c] * at.points[c];
            }
            const double exact = exact_floor(point);
            squares += mesh.areas()[i] * std::pow(shown - exact, 2.0);
            light += mesh.areas()[i] * exact * exact;
        }
    }
    return std::sqrt(squares / light);
}

} // namespace

TEST_CASE("refinement: rows go on where patches were not split, and parts are seen by reciprocity",
          "[pipeline][every-device]") {
    const Scene scene = room_with_blocks(5);
    const PatchMesh coarse(scene);
    FactorSettings settings = settings_of();
    settings.estimate_error = false;
    const FormFactors before = compute_raw_form_factors(scene, coarse, all_patches(coarse.size()), settings);
    std::vector<std::uint32_t> some;
    for (std::uint32_t i = 0; i < coarse.size(); i += 6) {
        some.push_back(i);
    }
    const auto [fine, parents] = coarse.split(some, Cut::in_four);
    std::vector<std::uint32_t> parts(coarse.size(), 0);
    for (const std::uint32_t parent : parents) {
        ++parts[parent];
    }
    std::vector<std::uint32_t> fresh;
    for (std::uint32_t k = 0; k < fine.size(); ++k) {
        if (parts[parents[k]] > 1) {
            fresh.push_back(k);
        }
    }
    const FormFactors rows = compute_raw_form_factors(scene, fine, fresh, settings);
    const FormFactorMatrix all = split_rows(before.matrix, rows.matrix, parents, fine.areas());
    REQUIRE(all.all_known());
    const auto at = [](const FormFactorMatrix& matrix, std::uint32_t i, std::uint32_t j) {
        const RowView row = matrix.row(i);
        const auto found = std::lower_bound(row.columns.begin(), row.columns.end(), j);
        return found != row.columns.end() && *found == j
                   ? row.values[static_cast<std::size_t>(found - row.columns.begin())]
                   : 0.0F;
    };
    double folded = 0.0;
    double lost = 0.0;
    for (std::uint32_t i = 0; i < fine.size(); ++i) {
        const RowView row = all.row(i);
        REQUIRE(std::is_sorted(row.columns.begin(), row.columns.end()));
        for (std::size_t e = 0; e < row.columns.size(); ++e) {
            const std::uint32_t j = row.columns[e];
            const double there = static_cast<double>(row.values[e]) * fine.areas()[i];
            const double back = static_cast<double>(at(all, j, i)) * fine.areas()[j];
            REQUIRE(there == Approx(back).epsilon(1e-5).margin(1e-12));
            if (parts[parents[i]] == 1 && parts[parents[j]] == 1) {
                REQUIRE(row.values[e] == at(before.matrix, parents[i], parents[j]));
            }
        }
        if (parts[parents[i]] == 1) {
            std::vector<double> of_parents(coarse.size(), 0.0);
            for (std::size_t e = 0; e < row.columns.size(); ++e) {
                of_parents[parents[row.columns[e]]] += static_cast<double>(row.values[e]);
            }
            for (std::uint32_t j = 0; j < coarse.size(); ++j) {
                folded +=
                    std::pow(of_parents[j] - static_cast<double>(at(before.matrix, parents[i], j)), 2.0);
            }
            lost = std::max(lost, std::abs(row.sum() - before.matrix.row(parents[i]).sum()));
        }
    }
    CHECK(std::sqrt(folded / fine.size()) < 0.01); // visibility by another end's texels
    CHECK(lost < 0.05);
    CHECK_THROWS_AS(split_rows(before.matrix, rows.matrix, std::vector<std::uint32_t>{0}, fine.areas()),
                    InvalidArgument);
}

TEST_CASE("refinement: the error that was asked for is met, with fewer patches than evenly cut ones",
          "[pipeline][every-device]") {
    const Scene scene = lamp_and_sheet(4, 1);
    RefinementGoal goal;
    for (const Gather gather : {Gather::on, Gather::off}) {
        goal.error = gather == Gather::on ? 0.03 : 0.06;
        goal.gather = gather;
        const Refinement found = solve_refined(scene, PatchMesh(scene), settings_of(), {}, goal);
        REQUIRE(found.stopped.empty());
        REQUIRE(found.steps.size() > 1);
        const auto printed = solution_error(found.solution);
        REQUIRE(printed);
        const double truth = true_error(found.mesh, found.solution);
        INFO(found.mesh.size() << " patches, printed " << printed->vertices.rms << ", true " << truth);
        CHECK(printed->vertices.rms <= *goal.error);
        CHECK(truth < 2.0 * *goal.error);
        CHECK(truth > printed->vertices.rms / 4.0);
        CHECK(found.mesh.size() == found.steps.back().patches);
        // Evenly cut, with as many patches, it is off by more.
        const auto cells = static_cast<std::uint32_t>(std::sqrt(found.mesh.size()));
        const Scene even = lamp_and_sheet(cells, 1);
        const PatchMesh mesh(even);
        const FormFactors factors = compute_form_factors(even, mesh, settings_of());
        Solution solution = solve_radiosity(even, mesh, factors);
        gather_at_vertices(even, mesh, settings_of(), gather, solution);
        CHECK(true_error(mesh, solution) > 1.1 * truth);
    }
}

TEST_CASE("refinement: nothing is cut where nothing is wrong, and as much as was asked for else",
          "[pipeline]") {
    Scene furnace = empty_scene();
    furnace.materials[0] = {"wall", {0.5}, {1.0}};
    add_room(furnace, Vec3(0.0), Vec3(1.0), 3);
    RefinementGoal goal;
    goal.error = 1e-4;
    const Refinement even = solve_refined(furnace, PatchMesh(furnace), settings_of(), {}, goal);
    CHECK(even.steps.size() == 1);
    CHECK(even.stopped.empty());

    const Scene scene = lamp_and_sheet(4, 1);
    goal = {};
    goal.patches = 120;
    const Refinement number = solve_refined(scene, PatchMesh(scene), settings_of(Preset::fast), {}, goal);
    CHECK(number.mesh.size() >= 120);
    CHECK(number.mesh.size() < 200);
    Scene two_sided = scene; // each split of the floor adds as much on its back
    two_sided.surfaces[0].two_sided = true;
    goal.patches = 200;
    const Refinement both =
        solve_refined(two_sided, PatchMesh(two_sided), settings_of(Preset::fast), {}, goal);
    CHECK(both.mesh.size() >= 200);
    CHECK(both.mesh.size() < 220);
    Scene from_below = empty_scene(); // what is cut is the floor's back
    from_below.materials.push_back(scene.materials[1]);
    add_polygon(from_below, "floor", {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {4, 4});
    from_below.surfaces.back().two_sided = true;
    add_polygon(from_below, "lamp", {{0.3, 0.3, -1}, {0.5, 0.3, -1}, {0.5, 0.5, -1}, {0.3, 0.5, -1}});
    from_below.surfaces.back().material = 1;
    goal.gather = Gather::on;
    const Refinement below = solve_refined(from_below, PatchMesh(from_below), settings_of(), {}, goal);
    goal.gather = Gather::automatic;
    CHECK(below.mesh.size() >= 200);
    CHECK(below.mesh.size() < 220);
    goal.patches = 120;
    goal.error = 1e-9;
    const Refinement stopped = solve_refined(scene, PatchMesh(scene), settings_of(Preset::fast), {}, goal);
    CHECK_FALSE(stopped.stopped.empty());
    CHECK(stopped.steps.back().error > 1e-9);
    goal.patches = 0;
    FactorSettings little = settings_of(Preset::fast);
    little.max_memory = 400000;
    const Refinement poor = solve_refined(scene, PatchMesh(scene), little, {}, goal);
    CHECK(poor.stopped.find("memory") != std::string::npos);

    goal.seconds = 1e-9;
    const Refinement late = solve_refined(scene, PatchMesh(scene), settings_of(Preset::fast), {}, goal);
    CHECK(late.stopped.find("budget") != std::string::npos);
    CHECK(late.steps.size() == 1);

    Scene black = scene;
    black.materials[0].reflectance = {0.0};
    RefinementGoal more;
    more.patches = 100;
    CHECK_THROWS_AS(solve_refined(black, PatchMesh(black), settings_of(), {}, more), InvalidArgument);
    more.gather = Gather::on;
    CHECK_THROWS_WITH(solve_refined(black, PatchMesh(black), settings_of(), {}, more),
                      Catch::Contains("reflects light"));
    Scene dark = scene;
    dark.materials[1].exitance = {0.0};
    CHECK_THROWS_WITH(solve_refined(dark, PatchMesh(dark), settings_of(), {}, more),
                      Catch::Contains("reflects light"));
    Scene many = scene;
    for (int k = 0; k < 70; ++k) {
        const double x = -0.9 + 0.02 * k;
        add_polygon(many, "strip " + std::to_string(k),
                    {Vec3(x, 1.1, 0), Vec3(x + 0.01, 1.1, 0), Vec3(x + 0.01, 1.2, 0), Vec3(x, 1.2, 0)});
    }
    more = {};
    more.error = 0.5;
    more.error_of = ErrorOf::groups;
    CHECK_THROWS_AS(solve_refined(many, PatchMesh(many), settings_of(Preset::fast), {}, more),
                    InvalidArgument);

    goal.error_of = ErrorOf::factors;
    CHECK_THROWS_AS(solve_refined(scene, PatchMesh(scene), settings_of(), {}, goal), InvalidArgument);
    CHECK_THROWS_AS(solve_refined(scene, PatchMesh(scene), settings_of(), {}, {}), InvalidArgument);
    goal.error_of = ErrorOf::field;
    FactorSettings rays = settings_of();
    rays.method = Method::montecarlo;
    CHECK_THROWS_AS(solve_refined(scene, PatchMesh(scene), rays, {}, goal), InvalidArgument);
}

TEST_CASE("refinement: an error below what the form factors allow is given up", "[pipeline][slow]") {
    const Scene scene = lamp_and_sheet(4, 1);
    RefinementGoal goal;
    goal.error = 1e-3;
    const Refinement stuck = solve_refined(scene, PatchMesh(scene), settings_of(Preset::fast), {}, goal);
    CHECK(stuck.stopped.find("no longer") != std::string::npos);
    CHECK(stuck.mesh.size() < 20000);
}

TEST_CASE("refinement: where better rows say that the error is not met, it goes on until they say it is",
          "[pipeline]") {
    const Scene scene = lamp_and_sheet(4, 4);
    const FactorSettings rough = rough_settings(24);
    RefinementGoal goal;
    goal.gather = Gather::on;
    std::size_t went_on = 0;
    for (const double error : {0.13, 0.12, 0.11, 0.1, 0.09}) {
        goal.error = error;
        std::vector<std::uint32_t> judged;
        RefinementRows rows;
        rows.store = [&](const PatchMesh& mesh, const FormFactors& raw) {
            if (raw.reference.entries() > 0) {
                judged.push_back(mesh.size());
            }
        };
        const Refinement found =
            solve_refined(scene, PatchMesh(scene), rough, {}, goal, false, no_observer(), std::move(rows));
        INFO("error " << error);
        CHECK(found.stopped.empty());
        CHECK(found.steps.back().error <= error);
        REQUIRE_FALSE(judged.empty());
        CHECK(judged.back() == found.mesh.size());
        for (const Refinement::Step& step : found.steps) {
            const bool is_judged = std::count(judged.begin(), judged.end(), step.patches) > 0;
            CHECK((!is_judged || step.patches == found.mesh.size() || step.error > error));
        }
        went_on += judged.size() - 1;
    }
    CHECK(went_on > 0);
}

TEST_CASE("refinement: without gathered vertices, steps know of the form factors once better rows were seen",
          "[pipeline]") {
    struct Steps : Observer {
        void refined(const Refinement& so_far) override {
            const double of_size = so_far.solution.patch_size_error->vertices.rms;
            const double error = so_far.steps.back().error;
            CHECK((judged > 0 ? error > of_size : error == of_size));
            later += judged;
        }
        int judged = 0;
        int later = 0;
    } steps;
    const Scene scene = lamp_and_sheet(4, 4);
    const FactorSettings rough = rough_settings(16);
    RefinementGoal goal;
    goal.gather = Gather::off;
    for (const double error : {0.19, 0.14, 0.13}) {
        goal.error = error;
        steps.judged = 0;
        RefinementRows rows;
        rows.store = [&](const PatchMesh&, const FormFactors& raw) {
            steps.judged += raw.reference.entries() > 0 ? 1 : 0;
        };
        (void)solve_refined(scene, PatchMesh(scene), rough, {}, goal, false, steps, std::move(rows));
    }
    CHECK(steps.later > 2);
}

TEST_CASE("refinement: that memory ends it does not count where the error is met", "[pipeline]") {
    Scene scene = lamp_and_sheet(4, 4);
    scene.surfaces.pop_back(); // without the sheet: bends in smooth light err on the safe side
    RefinementGoal goal;
    goal.gather = Gather::on;
    goal.error = 8.3e-4;
    std::vector<std::uint64_t> bytes;
    std::vector<std::uint32_t> patches;
    RefinementRows rows;
    rows.store = [&](const PatchMesh& mesh, const FormFactors&) {
        if (patches.empty() || patches.back() != mesh.size()) {
            patches.push_back(mesh.size());
            bytes.push_back(patch_size_error_bytes(mesh, {.effort = 2.0, .groups = false}, 1));
        }
    };
    (void)solve_refined(scene, PatchMesh(scene), settings_of(), {}, goal, false, no_observer(),
                        std::move(rows));
    REQUIRE(patches.size() > 2);
    FactorSettings little = settings_of(); // for all meshes but the last
    little.max_memory = (bytes.back() + bytes[bytes.size() - 2]) / 2;
    const Refinement found = solve_refined(scene, PatchMesh(scene), little, {}, goal);
    CHECK(found.mesh.size() == patches[patches.size() - 2]);
    CHECK(found.steps.back().error <= *goal.error);
    CHECK(found.stopped.empty());

    goal.error = 1e-5;
    const Refinement missed = solve_refined(scene, PatchMesh(scene), little, {}, goal);
    CHECK(missed.stopped.find("memory") != std::string::npos);
    CHECK(missed.steps.back().error > *goal.error); // and is known
}

TEST_CASE("refinement: by groups, memory ends it before their errors are no longer known", "[pipeline]") {
    const Scene scene = lamp_and_sheet(4, 4);
    const PatchMesh coarse(scene);
    RefinementGoal goal;
    goal.error_of = ErrorOf::groups;
    goal.error = 1e-6;
    goal.patches = coarse.size() + 8;
    const PatchMesh finer = solve_refined(scene, coarse, settings_of(), {}, goal).mesh;
    FactorSettings little = settings_of(); // for the rows of the finer mesh's sample, not for its groups
    little.max_memory = (patch_size_error_bytes(finer, {.effort = 2.0, .groups = false}, 1) +
                         patch_size_error_bytes(finer, {.effort = 2.0}, 1)) /
                        2;
    REQUIRE(*little.max_memory > patch_size_error_bytes(coarse, {.effort = 2.0}, 1));
    const Refinement found = solve_refined(scene, coarse, little, {}, goal);
    CHECK(found.mesh.size() == coarse.size());
    CHECK(found.stopped.find("memory") != std::string::npos);
    CHECK(found.steps.back().error > *goal.error);
}

TEST_CASE("refinement: what the first mesh's memory allows is known in the end, too", "[pipeline]") {
    const Scene scene = lamp_and_sheet(12, 1);
    const PatchMesh coarse(scene);
    RefinementGoal goal;
    goal.error = 1e-6;
    goal.gather = Gather::off;
    for (const ErrorOf error_of : {ErrorOf::vertices, ErrorOf::groups}) {
        goal.error_of = error_of;
        FactorSettings little =
            settings_of(); // for the usual sample, not for the larger one of the last mesh
        little.max_memory = patch_size_error_bytes(coarse, {}, 1);
        REQUIRE(*little.max_memory < patch_size_error_bytes(coarse, {.effort = 2.0, .groups = false}, 1));
        const Refinement found = solve_refined(scene, coarse, little, {}, goal);
        CHECK(found.stopped.find("memory") != std::string::npos);
        CHECK(found.steps.back().error > *goal.error);
        CHECK(found.solution.patch_size_error);
    }
}

TEST_CASE("refinement: goes on from a mesh whose form factors were judged to a smaller error", "[pipeline]") {
    const Scene scene = lamp_and_sheet(4, 4);
    RefinementGoal goal;
    goal.gather = Gather::off;
    goal.error = 0.4;
    RefinementRows rows;
    rows.begin = solve_refined(scene, PatchMesh(scene), settings_of(), {}, goal).raw;
    REQUIRE(rows.begin->reference.entries() > 0);
    goal.error = 0.05;
    const Refinement found = solve_refined(scene, PatchMesh(scene), settings_of(), {}, goal, false,
                                           no_observer(), std::move(rows));
    REQUIRE(found.steps.size() > 3);
    CHECK(found.stopped.empty());
    CHECK(found.steps.back().error <= 0.05);
}

TEST_CASE("refinement: cuts nothing where better rows of the file say that it cannot help", "[pipeline]") {
    const Scene scene = lamp_and_sheet(4, 4);
    const FactorSettings rough = rough_settings(16);
    for (const Gather gather : {Gather::off, Gather::on}) {
        RefinementGoal goal;
        goal.gather = gather;
        goal.error = 0.5;
        const Refinement first = solve_refined(scene, PatchMesh(scene), rough, {}, goal);
        REQUIRE(first.solution.error);
        RefinementRows rows;
        rows.begin = first.raw;
        goal.error = 0.5 * first.solution.error->rms;
        const Refinement found =
            solve_refined(scene, PatchMesh(scene), rough, {}, goal, false, no_observer(), std::move(rows));
        CHECK(found.mesh.size() == first.mesh.size());
        CHECK(found.stopped.find("better preset") != std::string::npos);
    }
}

TEST_CASE("refinement: sizes of patches side by side differ by a factor of two at most", "[pipeline]") {
    const Scene scene = lamp_and_sheet(4, 1);
    RefinementGoal goal;
    goal.patches = 400;
    const PatchMesh mesh = solve_refined(scene, PatchMesh(scene), settings_of(Preset::fast), {}, goal).mesh;
    double largest = 0.0;
    for (std::uint32_t i = 0; i < mesh.patches_per_side(0); ++i) {
        for (std::uint32_t j = 0; j < mesh.patches_per_side(0); ++j) {
            const double a = std::sqrt(mesh.areas()[i]);
            const double b = std::sqrt(mesh.areas()[j]);
            const Vec3 way = glm::abs(mesh.centres()[i] - mesh.centres()[j]);
            // They share a piece of an edge.
            if (std::max(way.x, way.y) < 0.5 * (a + b) * 1.0001 &&
                std::min(way.x, way.y) < 0.4999 * (a + b)) {
                largest = std::max(largest, a / b);
            }
        }
    }
    CHECK(largest == Approx(2.0));
}

TEST_CASE("refinement: where patches meet, an edge is at most twice as long as the other", "[pipeline]") {
    const Scene scene = lamp_and_sheet(4, 1);
    RefinementGoal goal;
    goal.patches = 400;
    goal.gather = Gather::on;
    const Refinement found = solve_refined(scene, PatchMesh(scene), settings_of(), {}, goal);
    const PatchMesh& mesh = found.mesh;
    double longest = 0.0;
    bool strips = false;
    const auto lower = [&mesh](std::uint32_t i) { return mesh.corners(i).points[0]; };
    const auto upper = [&mesh](std::uint32_t i) { return mesh.corners(i).points[2]; };
    for (std::uint32_t i = 0; i < mesh.patches_per_side(0); ++i) {
        const Vec3 size = upper(i) - lower(i);
        strips = strips || std::max(size.x, size.y) > 1.5 * std::min(size.x, size.y);
        for (std::uint32_t j = 0; j < mesh.patches_per_side(0); ++j) {
            for (const int way : {0, 1}) {
                const bool beside =
                    upper(i)[1 - way] == lower(j)[1 - way] || lower(i)[1 - way] == upper(j)[1 - way];
                if (beside && lower(i)[way] < upper(j)[way] - 1e-9 && lower(j)[way] < upper(i)[way] - 1e-9) {
                    longest = std::max(longest, size[way] / (upper(j) - lower(j))[way]);
                }
            }
        }
    }
    CHECK(strips);
    CHECK(longest == Approx(2.0));
    // The vertices are those of the last light, whenever they were gathered on the way.
    Solution again = found.solution;
    gather_at_vertices(scene, mesh, settings_of(), Gather::on, again);
    CHECK(again.vertex_radiosity == found.solution.vertex_radiosity);
}

TEST_CASE("refinement: goes on from stored rows to the bits of an undisturbed one", "[pipeline]") {
    const Scene scene = lamp_and_sheet(3, 1);
    const PatchMesh coarse(scene);
    RefinementGoal goal;
    goal.patches = 600; // by more steps than have small samples where an error is to be met
    std::vector<FormFactors> kept;
    RefinementRows rows;
    rows.store = [&kept](const PatchMesh& mesh, FormFactors& raw) {
        REQUIRE(raw.geometry_hash == mesh.geometry_hash());
        REQUIRE(raw.cuts == mesh.cuts());
        kept.push_back(raw);
    };
    const FactorSettings settings = settings_of(Preset::fast);
    const Refinement whole = solve_refined(scene, coarse, settings, {}, goal, false, no_observer(), rows);
    REQUIRE(kept.size() == whole.steps.size() + 1); // with the sample of better rows in the end
    REQUIRE(whole.steps.size() > 4);
    for (const std::size_t step : {std::size_t{0}, std::size_t{1}, kept.size() - 1}) {
        RefinementRows from;
        from.begin = kept[step];
        const Refinement again = solve_refined(scene, coarse, settings, {}, goal, false, no_observer(), from);
        CHECK(again.mesh.geometry_hash() == whole.mesh.geometry_hash());
        CHECK(again.steps.front().rows == 0);
        CHECK(again.solution.radiosity == whole.solution.radiosity);
        CHECK(again.raw.reference.entries() == whole.raw.reference.entries());
    }
    // Gathered vertices on the way are the same, too, where rows are kept.
    goal.patches = 150;
    const io_test::Folder folder;
    FactorSettings gathering = settings_of();
    std::vector<FormFactors> of_steps;
    RowCheckpoint first_kept(folder / "first.hff", false);
    RowCheckpoint second_kept(folder / "second.hff", false);
    rows.store = [&of_steps](const PatchMesh&, FormFactors& raw) { of_steps.push_back(raw); };
    rows.checkpoint = &first_kept;
    const Refinement gathered =
        solve_refined(scene, coarse, gathering, {}, goal, false, no_observer(), std::move(rows));
    REQUIRE(of_steps.size() > 3);
    RefinementRows from;
    from.begin = of_steps[1];
    from.checkpoint = &second_kept;
    const Refinement resumed =
        solve_refined(scene, coarse, gathering, {}, goal, false, no_observer(), std::move(from));
    CHECK(resumed.mesh.geometry_hash() == gathered.mesh.geometry_hash());
    CHECK(resumed.solution.vertex_radiosity == gathered.solution.vertex_radiosity);
    // They are whole: a later solution of that mesh needs nothing else.
    CHECK(coarse.cut(kept.back().cuts).geometry_hash() == whole.mesh.geometry_hash());
    RefinementRows wrong;
    wrong.begin = kept[1];
    wrong.begin->cuts = {};
    CHECK_THROWS_AS(solve_refined(scene, coarse, settings, {}, goal, false, no_observer(), wrong),
                    InvalidArgument);
}
