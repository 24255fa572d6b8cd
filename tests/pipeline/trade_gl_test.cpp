#include "hemi/pipeline/trade.hpp"

#include "pipeline/answers.hpp"
#include "pipeline/patch_locator.hpp"
#include "support/device.hpp"
#include "support/lamp_and_sheet.hpp"
#include "support/scenes.hpp"

#include "hemi/core/error.hpp"
#include "hemi/display/vertex_colours.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/pipeline/vertex_gather.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
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

struct Solved {
    PatchMesh mesh;
    Solution solution;
};

Solved solved(const Scene& scene, Preset preset, Gather gather) {
    PatchMesh mesh(scene);
    const FormFactors factors = compute_form_factors(scene, mesh, settings_of(preset));
    Solution solution = solve_radiosity(scene, mesh, factors);
    gather_at_vertices(scene, mesh, settings_of(preset), gather, solution);
    return {std::move(mesh), std::move(solution)};
}

/// What a solution of lamp_and_sheet() is off by, at 12 x 12 points of every patch of the floor.
RadiosityError true_error(const Solved& solved) {
    const auto corners =
        solved.solution.vertex_radiosity.empty()
            ? corner_values(solved.mesh, 1, solved.solution.radiosity, solved.solution.back_face_share)
            : solved.solution.vertex_radiosity;
    constexpr int points = 12;
    double field = 0.0;
    double vertices = 0.0;
    double light = 0.0;
    for (std::uint32_t i = 0; i < solved.mesh.size(); ++i) {
        if (solved.mesh.groups()[solved.mesh.group(i)] != "floor") {
            continue;
        }
        const PatchCorners at = solved.mesh.corners(i);
        for (int k = 0; k < points * points; ++k) {
            const double u = (k % points + 0.5) / points;
            const double v = (k / points + 0.5) / points;
            const std::array<double, 4> weights{(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
            double shown = 0.0;
            Vec3 point(0.0);
            for (std::size_t c = 0; c < 4; ++c) {
                shown += weights[c] * static_cast<double>(corners[std::size_t{i} * 4 + c]);
                point += weights[c] * at.points[c];
            }
            const double exact = exact_floor(point);
            const double area = solved.mesh.areas()[i];
            vertices += area * std::pow(shown - exact, 2.0);
            field += area * std::pow(solved.solution.radiosity[i] - exact, 2.0);
            light += area * exact * exact;
        }
    }
    RadiosityError error;
    error.vertices.rms = std::sqrt(vertices / light);
    error.field.rms = std::sqrt(field / light);
    return error;
}

/// A floor of four patches under a lamp.
Scene floor_and_lamp(bool lit) {
    Scene scene = empty_scene();
    scene.materials.push_back({"lamp", {0.0}, {10.0}});
    add_polygon(scene, "floor", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {2, 2});
    std::vector<Vec3> lamp{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}};
    if (!lit) { // its front is above
        std::reverse(lamp.begin(), lamp.end());
    }
    add_polygon(scene, "lamp", lamp, {2, 2});
    scene.surfaces.back().material = 1;
    return scene;
}

/// Stops work in a phase.
class StopIn : public Observer {
public:
    explicit StopIn(Phase phase) : phase_(phase) {}
    bool progress(Phase phase, std::size_t, std::size_t) override { return phase != phase_; }

private:
    Phase phase_;
};

} // namespace

TEST_CASE("pareto_front: what nothing beats, with all that are equally good", "[pipeline]") {
    const std::vector<Offer> offers{{1.0, 0.5}, {2.0, 0.1}, {2.0, 0.2}, {3.0, 0.1},
                                    {0.5, 0.9}, {1.0, 0.5}, {4.0, 0.05}};
    CHECK(pareto_front(offers) == std::vector<bool>{true, true, false, false, true, true, true});
    CHECK(pareto_front({}).empty());
}

TEST_CASE("recommend: nobody gains by less than what is of use", "[pipeline]") {
    const std::vector<Offer> offers{{0.01, 0.2}, {0.9, 0.04}, {3.0, 0.02}, {20.0, 0.001}, {60.0, 0.0001}};
    // By the product alone the first would be the best.
    CHECK(recommend(offers, {0.0, 1e-6}).best == 0);
    const Recommendation useful = recommend(offers, {1.0, 1e-2});
    CHECK(useful.best == 1);
    CHECK_FALSE(useful.faster); // the best is as quick as anybody wants
    CHECK(useful.more_accurate == 2);
    const Recommendation precise = recommend(offers, {1.0, 1e-3});
    CHECK(precise.best == 3);
    CHECK(precise.faster == 2);
    CHECK_FALSE(precise.more_accurate); // nobody needs it
    CHECK_FALSE(recommend({}, {1.0, 1e-3}).best);
}

TEST_CASE("PatchLocator: patches of any shape are found, and their corners make up the point", "[pipeline]") {
    Scene sheet = lamp_and_sheet(5, 1);
    const PatchMesh fine = PatchMesh(sheet).split(std::vector<std::uint32_t>{3, 7, 26, 27}).mesh;
    for (const PatchMesh& mesh : {PatchMesh(tapered_box(3)), PatchMesh(lattice_room()), fine}) {
        const PatchLocator locator(mesh);
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            const PatchCorners corners = mesh.corners(i);
            // Off the middle, towards the second corner.
            const Vec3 point = 0.45 * mesh.centres()[i] + 0.5 * corners.points[1] + 0.05 * corners.points[2];
            REQUIRE(locator.find({point, mesh.normal(i), mesh.surface_of()[i]}) == i);
            const auto weights = locator.weights(i, point);
            Vec3 sum(0.0);
            double total = 0.0;
            for (std::uint32_t k = 0; k < corners.count; ++k) {
                sum += weights[k] * corners.points[k];
                total += weights[k];
            }
            CHECK(glm::distance(sum, point) < 1e-9);
            CHECK(total == Approx(1.0));
            CHECK_FALSE(locator.find({point + 0.01 * mesh.normal(i), mesh.normal(i), 0}));
        }
    }
}

TEST_CASE(
    "reference: light at points is that of the closed form, and finds the true errors of coarser meshes",
    "[pipeline][gl]") {
    const Scene fine = lamp_and_sheet(24, 1);
    const PatchMesh mesh(fine);
    const PatchMesh coarser(lamp_and_sheet(16, 1));
    const RadiosityReference reference = find_radiosity_reference(fine, mesh, coarser, settings_of(), 1500);
    CHECK(reference.points.size() > 1400);
    CHECK(reference.points.size() < 1600);
    double squares = 0.0;
    double light = 0.0;
    double area = 0.0;
    for (std::size_t k = 0; k < reference.points.size(); ++k) {
        const double exact = exact_floor(reference.points[k].position);
        squares += reference.areas[k] * std::pow(reference.radiosity[k] - exact, 2.0);
        light += reference.areas[k] * exact * exact;
        area += reference.areas[k];
        CHECK(reference.reflected[k] == reference.radiosity[k]);
    }
    CHECK(area == Approx(4.0).epsilon(0.02)); // only the floor reflects
    const double off = std::sqrt(squares / light);
    INFO("reference: " << off << ", by its own estimate " << reference.own_error);
    CHECK(off < 0.01);
    // The lamp does not depend on patches: what it errs by is chance.
    CHECK(reference.own_error > 0.5 * off);
    CHECK(reference.own_error < 2.0 * off);

    std::array<RadiosityError, 2> last; // means at vertices, and gathered
    for (RadiosityError& error : last) {
        error.vertices.rms = error.field.rms = 1.0;
    }
    for (const std::uint32_t cells : {4u, 8u, 16u}) {
        const Scene scene = lamp_and_sheet(cells, 1);
        Solved coarse = solved(scene, Preset::standard, Gather::off);
        for (RadiosityError& last_error : last) {
            const RadiosityError truth = true_error(coarse);
            const RadiosityError error = judge_radiosity(coarse.mesh, coarse.solution, reference).value();
            INFO(cells << " cells: vertices " << error.vertices.rms << ", true " << truth.vertices.rms
                       << "; field " << error.field.rms << ", true " << truth.field.rms);
            CHECK(error.vertices.rms == Approx(truth.vertices.rms).epsilon(0.15));
            CHECK(error.field.rms == Approx(truth.field.rms).epsilon(0.15));
            CHECK(error.vertices.rms < 0.75 * last_error.vertices.rms);
            CHECK(error.field.rms < 0.75 * last_error.field.rms);
            CHECK(error.vertices.percentile95 > error.vertices.rms);
            CHECK(error.vertices.doubt < 0.15 * error.vertices.rms);
            last_error = error;
            if (coarse.solution.vertex_radiosity.empty()) {
                gather_at_vertices(scene, coarse.mesh, settings_of(), Gather::on, coarse.solution);
            }
        }
    }
    CHECK_THROWS_AS(
        judge_radiosity(coarser, solved(lamp_and_sheet(4, 1), Preset::fast, Gather::off).solution, reference),
        InvalidArgument);
}

TEST_CASE("reference: nothing errs in a furnace, and nothing is found where nothing reflects",
          "[pipeline][gl]") {
    Scene scene = tapered_box(3);
    scene.materials[0] = {"glow", {0.5}, {1.0}};
    scene.enclosure = Enclosure::closed;
    const PatchMesh mesh(scene);
    const RadiosityReference reference = find_radiosity_reference(scene, mesh, mesh, settings_of(), 200);
    for (const double light : reference.radiosity) {
        CHECK(light == Approx(2.0).epsilon(1e-4));
    }
    const Solved coarse = solved(scene, Preset::fast, Gather::off);
    CHECK(judge_radiosity(mesh, coarse.solution, reference)->vertices.rms < 1e-3);
    CHECK(reference.own_error < 1e-5);
    RadiosityReference dark = reference;
    std::fill(dark.reflected.begin(), dark.reflected.end(), 0.0);
    CHECK_FALSE(judge_radiosity(mesh, coarse.solution, dark));
    RadiosityReference elsewhere = reference;
    for (SurfacePoint& point : elsewhere.points) {
        point.position += Vec3(100.0, 0.0, 0.0);
    }
    CHECK_FALSE(judge_radiosity(mesh, coarse.solution, elsewhere));
    scene.sun = Sun{};
    CHECK_THROWS_AS(find_radiosity_reference(scene, mesh, mesh, settings_of(), 200), InvalidArgument);
    scene.sun.reset();
    scene.materials[0].reflectance = {0.0};
    CHECK_THROWS_AS(find_radiosity_reference(scene, mesh, mesh, settings_of(), 200), InvalidArgument);
}

TEST_CASE("reference: its own error has that of its patches, which light between walls errs by",
          "[pipeline][gl]") {
    const auto box = [](std::uint32_t cells) {
        Scene scene = tapered_box(cells);
        scene.enclosure = Enclosure::closed;
        scene.materials[0].reflectance = {0.7};
        scene.materials.push_back({"lamp", {0.0}, {1.0}});
        scene.surfaces[0].material = 1;
        return scene;
    };
    const Solved fine = solved(box(12), Preset::fast, Gather::on);
    for (const std::uint32_t cells : {2u, 4u}) {
        const Scene scene = box(cells);
        const RadiosityReference reference =
            find_radiosity_reference(scene, PatchMesh(scene), PatchMesh(box(cells / 2)), settings_of(), 400);
        const double off = judge_radiosity(fine.mesh, fine.solution, reference)->vertices.rms;
        INFO(cells << " cells: " << off << ", by its own estimate " << reference.own_error);
        CHECK(reference.own_error > 0.6 * off);
        CHECK(reference.own_error < 1.6 * off);
    }
}

TEST_CASE("trade: smaller patches are slower and better, and the front is what nothing beats",
          "[pipeline][gl][slow]") {
    const Scene scene = lamp_and_sheet(16, 1);
    const PatchMesh mesh(scene);
    const Trade trade = measure_trade(scene, mesh, {}, false, settings_of(), 6.0);
    INFO(trade.unanswered);
    REQUIRE(trade.answer_reference);
    REQUIRE_FALSE(trade.answers.empty());
    CHECK(trade.answer_reference->patches > mesh.size());
    std::vector<Offer> offers;
    for (const Trade::Answer& answer : trade.answers) {
        CHECK(trade.answer_reference->patches > answer.patches);
        CHECK(answer.memory > 0);
        CHECK(answer.row_error > 0.0);
        offers.push_back({answer.seconds, answer.vertices()});
    }
    const std::vector<bool> front = pareto_front(offers);
    for (std::size_t k = 0; k < offers.size(); ++k) {
        CHECK(trade.answers[k].front == front[k]);
    }
    for (const Preset preset : {Preset::fast, Preset::standard}) {
        double last = 1.0;
        for (const Trade::Answer& answer : trade.answers) {
            const FactorSettings& settings = answer.candidate.settings;
            // Other methods, for which a quick machine has time, have a preset that means nothing.
            if (settings.method != Method::hemicube || settings.preset != preset || settings.eye_points ||
                answer.error_target) {
                continue;
            }
            INFO(answer.patches << " patches, " << answer.candidate.label() << ": " << answer.vertices());
            CHECK(answer.vertices() < last);
            last = answer.vertices();
        }
        CHECK(last < 1.0);
    }
    const auto by_time = trade.answers_by_time();
    const Recommendation recommended = trade.recommended_answers();
    REQUIRE(recommended.best);
    CHECK(by_time[*recommended.best]->front);
}

TEST_CASE("trade: what fails is left out and said, and the rest goes on", "[pipeline][gl]") {
    const Scene scene = floor_and_lamp(false);
    const PatchMesh mesh(scene);
    const FactorSettings settings = settings_of();
    const Subdivision none;
    const Answers::Subject subject{scene, mesh, none, false, settings};
    Answers answers(subject, 30.0, no_observer());
    CHECK(answers.obstacle().empty()); // there is light, and something that could reflect it
    answers.solve_uniform([](Preset) {});
    CHECK_NOTHROW(answers.refine()); // no light, no error to refine by
    Trade trade;
    answers.judge(trade);
    CHECK(trade.answers.empty());
    CHECK_FALSE(trade.answer_reference);
    CHECK(trade.unanswered == "no light comes to what reflects it");
    REQUIRE(trade.omitted.size() == 1);
    CHECK(trade.omitted[0].first == "patches refined to 4 %");
    CHECK(trade.omitted[0].second.find("patches cannot be cut where it tells") != std::string::npos);
}

TEST_CASE("trade: short of memory or of time, it says of which", "[pipeline][gl]") {
    const Scene scene = floor_and_lamp(true);
    const PatchMesh mesh(scene);
    const Subdivision none;
    FactorSettings settings = settings_of();
    const auto judged = [&](double budget) {
        Answers answers({scene, mesh, none, false, settings}, budget, no_observer());
        answers.solve_uniform([](Preset) {});
        answers.refine();
        Trade trade;
        answers.judge(trade);
        return trade;
    };
    const Trade hasty = judged(1e-6);
    CHECK(hasty.unanswered == "there was no time for a reference: give more with --budget");
    REQUIRE(hasty.omitted.size() == 1);
    CHECK(hasty.omitted[0].second == "a finer reference would take too long");
    settings.max_memory = 1000;
    const Trade poor = judged(60.0);
    CHECK(poor.unanswered == "there was no memory for a reference: give more with --max-memory");
    REQUIRE(poor.omitted.size() == 1);
    CHECK(poor.omitted[0].second == "a finer reference does not fit into the memory");
}

TEST_CASE("trade: an observer stops it in whatever it is at", "[pipeline][gl]") {
    const Scene scene = floor_and_lamp(true);
    const PatchMesh mesh(scene);
    const Subdivision none;
    const FactorSettings settings = settings_of();
    const auto patches = all_patches(mesh.size());
    StopIn in_estimate(Phase::error_estimate);
    CHECK_THROWS_AS(find_reference(mesh, patches, settings, 0.0, in_estimate), Cancelled);
    StopIn in_visibility(Phase::visibility);
    for (Observer* const observer : {&in_estimate, &in_visibility}) { // of patches of other sizes
        Answers answers({scene, mesh, none, false, settings}, 12.0, *observer);
        CHECK_THROWS_AS(answers.solve_uniform([](Preset) {}), Cancelled);
    }
    const Reference reference = find_reference(mesh, patches, settings, 0.0);
    for (const Candidate& candidate : {hemicube_candidate(settings, Preset::fast, mesh.size()),
                                       hemicube_candidate(settings, Preset::plain, mesh.size()),
                                       baseline_candidate(settings, Method::montecarlo, 64)}) {
        INFO(candidate.label());
        StopIn in_rows(candidate.settings.preset == Preset::fast ? Phase::visibility : Phase::form_factors);
        CHECK_THROWS_AS(try_on_sample(scene, mesh, candidate, reference, mesh.size(), {}, in_rows),
                        Cancelled);
        CHECK_THROWS_AS(try_on_all(scene, mesh, candidate, reference, {}, nullptr, in_rows), Cancelled);
    }
}
