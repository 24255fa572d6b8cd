#include "support/device.hpp"
#include "support/group_irradiance.hpp"
#include "support/places.hpp"
#include "support/scenes.hpp"

#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "hemi/display/vertex_colours.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/patch_size_error.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/pipeline/vertex_gather.hpp"
#include "pipeline/quarter_rows.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

FactorSettings settings_of(Preset preset) {
    FactorSettings settings;
    settings.preset = preset;
    settings.engine.device = test_device();
    settings.engine.jobs = 2;
    return settings;
}

struct Solved {
    PatchMesh mesh;
    FormFactors factors;
    Solution solution;
};

Solved solved(const Scene& scene, Preset preset) {
    PatchMesh mesh(scene);
    FormFactors factors = compute_form_factors(scene, mesh, settings_of(preset));
    Solution solution = solve_radiosity(scene, mesh, factors, {}, no_observer(), true);
    return {std::move(mesh), std::move(factors), std::move(solution)};
}

/// Every grid `times` as fine each way.
Scene refined(Scene scene, std::uint32_t times) {
    for (Surface& surface : scene.surfaces) {
        surface.patches = Grid{surface.patches->u * times, surface.patches->v * times};
    }
    return scene;
}

/// A room with blocks and an upright sheet that a lamp below the ceiling lights: hard and soft shadows,
/// concave corners.
Scene lit_room(std::uint32_t cells, double reflectance, double lamp_size) {
    Scene scene = room_with_blocks(cells);
    scene.materials[0].reflectance = {reflectance};
    scene.materials.push_back({"lamp", {0.3}, {10.0}});
    const double half = 0.5 * lamp_size;
    add_polygon(scene, "lamp",
                {Vec3(0.6 - half, 0.5 - half, 0.78), Vec3(0.6 - half, 0.5 + half, 0.78),
                 Vec3(0.6 + half, 0.5 + half, 0.78), Vec3(0.6 + half, 0.5 - half, 0.78)},
                {2, 2});
    scene.surfaces.back().material = 1;
    add_polygon(scene, "sheet",
                {Vec3(0.1, 0.1, 0.1), Vec3(0.5, 0.2, 0.1), Vec3(0.5, 0.2, 0.5), Vec3(0.1, 0.1, 0.5)},
                {std::max(1u, cells / 2), std::max(1u, cells / 2)});
    scene.surfaces.back().two_sided = true;
    return scene;
}

/// Every quadrilateral as two triangles, cut as many ways along their edges.
Scene triangulated(const Scene& scene) {
    Scene result = scene;
    result.surfaces.clear();
    for (const Surface& surface : scene.surfaces) {
        const auto& p = surface.vertices;
        const std::uint32_t n = std::max(surface.patches->u, surface.patches->v);
        for (const auto& corners : {std::array{p[0], p[1], p[2]}, std::array{p[0], p[2], p[3]}}) {
            Surface half = surface;
            half.vertex_count = 3;
            std::copy(corners.begin(), corners.end(), half.vertices.begin());
            half.patches = Grid{n, n};
            result.surfaces.push_back(half);
        }
    }
    return result;
}

/// What the coarse solution is off by against one whose grids are `times` as fine, of quadrilaterals.
/// Pictures are taken to interpolate a patch's corner values bilinearly.
struct Truth {
    double field;
    double vertices;
};
Truth truth_of(const Solved& coarse, const Solved& fine, std::uint32_t times) {
    const PatchMesh& mesh = coarse.mesh;
    const auto corners =
        coarse.solution.vertex_radiosity.empty()
            ? corner_values(mesh, 1, coarse.solution.radiosity, coarse.solution.back_face_share)
            : coarse.solution.vertex_radiosity;
    double field = 0.0;
    double vertices = 0.0;
    double reflected = 0.0;
    for (std::uint32_t k = 0; k < fine.mesh.size(); ++k) {
        const std::uint32_t s = fine.mesh.surface_of()[k];
        const std::uint32_t local = (k - fine.mesh.first_patch(s)) % fine.mesh.patches_per_side(s);
        const std::uint32_t u = local % fine.mesh.grid(s).u;
        const std::uint32_t v = local / fine.mesh.grid(s).u;
        const std::uint32_t side = fine.mesh.is_back(k) ? mesh.patches_per_side(s) : 0;
        const std::uint32_t i = mesh.first_patch(s) + side + v / times * mesh.grid(s).u + u / times;
        if (fine.solution.back_face_share[k] > buried_above ||
            coarse.solution.back_face_share[i] > buried_above) {
            continue;
        }
        const PatchCorners at = mesh.corners(i);
        const Vec3 along = at.points[1] - at.points[0];
        const Vec3 across = at.points[3] - at.points[0];
        const Vec3 place = fine.mesh.centres()[k] - at.points[0];
        const Vec3 normal = glm::cross(along, across);
        const double a = glm::dot(glm::cross(place, across), normal) / glm::dot(normal, normal);
        const double b = glm::dot(glm::cross(along, place), normal) / glm::dot(normal, normal);
        const std::array<double, 4> weights{(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b};
        double shown = 0.0;
        for (std::size_t c = 0; c < 4; ++c) {
            shown += weights[c] * static_cast<double>(corners[std::size_t{i} * 4 + c]);
        }
        const double area = fine.mesh.areas()[k];
        const double right = fine.solution.radiosity[k];
        field += area * std::pow(coarse.solution.radiosity[i] - right, 2.0);
        vertices += area * std::pow(shown - right, 2.0);
        reflected += area * std::pow(right - fine.solution.exitance[k], 2.0);
    }
    // Constants on the fine grid leave out what they err by themselves, 1 / times² of the square.
    const double left_out = 1.0 - 1.0 / (static_cast<double>(times) * times);
    return {std::sqrt(field / reflected / left_out), std::sqrt(vertices / reflected)};
}

} // namespace

TEST_CASE("patch size: the error of lit rooms is that against a grid three times as fine",
          "[pipeline][gl][slow]") {
    std::uint32_t groups = 0;
    std::uint32_t too_small = 0;
    double true_squares = 0.0;
    double patch_size_squares = 0.0;
    struct Case {
        std::uint32_t cells;
        double reflectance;
        double lamp_size;
        Preset preset;
        double slant = 0.0; ///< by which y moves x: patches become parallelograms
    };
    for (const Case& c : {Case{6, 0.5, 0.3, Preset::standard}, Case{9, 0.5, 0.3, Preset::standard},
                          Case{6, 0.9, 0.3, Preset::fast}, Case{6, 0.2, 0.06, Preset::standard},
                          Case{6, 0.5, 0.3, Preset::plain}, Case{6, 0.5, 0.3, Preset::standard, 1.5}}) {
        Scene scene = lit_room(c.cells, c.reflectance, c.lamp_size);
        for (Surface& surface : scene.surfaces) {
            for (Vec3& vertex : surface.vertices) {
                vertex.x += c.slant * vertex.y;
            }
        }
        const Solved coarse = solved(scene, c.preset);
        const Solved fine = solved(refined(scene, 3), Preset::fast);
        const Truth truth = truth_of(coarse, fine, 3);
        const auto error = estimate_patch_size_error(scene, coarse.mesh, coarse.factors, coarse.solution,
                                                     settings_of(c.preset));
        REQUIRE(error);
        INFO(c.cells << " cells, reflectance " << c.reflectance << ", lamp " << c.lamp_size);
        INFO("field " << error->field.rms << ", true " << truth.field << "; vertices " << error->vertices.rms
                      << ", true " << truth.vertices);
        CHECK(error->field.rms > 0.6 * truth.field);
        CHECK(error->field.rms < 1.6 * truth.field);
        CHECK(error->vertices.rms > 0.5 * truth.vertices);
        CHECK(error->vertices.rms < 2.0 * truth.vertices);
        CHECK(error->sampled >= 48);
        Solved gathered = coarse;
        gather_at_vertices(scene, gathered.mesh, settings_of(c.preset), Gather::on, gathered.solution);
        const double less = truth_of(gathered, fine, 3).vertices;
        const auto of_gathered = estimate_patch_size_error(scene, gathered.mesh, gathered.factors,
                                                           gathered.solution, settings_of(c.preset));
        REQUIRE(of_gathered);
        INFO("gathered vertices " << of_gathered->vertices.rms << ", true " << less);
        CHECK(less < 0.75 * truth.vertices);
        CHECK(of_gathered->vertices.rms > 0.5 * less);
        CHECK(of_gathered->vertices.rms < 2.0 * less);
        REQUIRE(error->groups.size() == coarse.mesh.groups().size());
        const std::vector<double> is = group_irradiance(coarse.mesh, coarse.solution);
        const std::vector<double> should = group_irradiance(fine.mesh, fine.solution);
        for (std::size_t g = 0; g < is.size(); ++g) {
            const double true_error = std::abs(is[g] / should[g] - 1.0);
            const double printed = std::hypot(error->groups[g].patch_size, error->groups[g].factors);
            ++groups;
            // The finer rows err, too: by some 1e-4.
            too_small += true_error > 2.0 * printed + 2e-4 ? 1 : 0;
            true_squares += true_error * true_error;
            patch_size_squares += std::pow(error->groups[g].patch_size, 2.0);
        }
    }
    INFO(too_small << " of " << groups << " errors of groups are too small");
    CHECK(groups >= 60);
    CHECK(too_small <= groups / 10);
    INFO("groups, rms: true " << std::sqrt(true_squares / groups) << ", from patch size alone "
                              << std::sqrt(patch_size_squares / groups));
    CHECK(patch_size_squares > true_squares / 4.0);
    CHECK(patch_size_squares < 4.0 * true_squares);
}

TEST_CASE("patch size: shadows of the sun and the sky behind edges count", "[pipeline][gl][slow]") {
    constexpr std::uint32_t times = 6;
    std::uint32_t groups = 0;
    std::uint32_t too_small = 0;
    struct Case {
        const char* name;
        bool sun, sky;
    };
    for (const Case& c : {Case{"sun", true, false}, Case{"sky", false, true}, Case{"both", true, true}}) {
        Scene scene = room_with_blocks(4);
        std::erase_if(scene.surfaces, [](const Surface& surface) { // an open yard
            return std::all_of(surface.vertices.begin(), surface.vertices.end(),
                               [](const Vec3& vertex) { return vertex.z == 0.8; });
        });
        scene.materials[0].exitance = {0.0};
        scene.enclosure = Enclosure::open;
        if (c.sun) {
            scene.sun = Sun{glm::normalize(Vec3(0.5, -0.3, 1.0)), {10.0}, 0.0};
        }
        if (c.sky) {
            scene.sky = Sky{SkyDistribution::overcast, {5.0}, {0.2}};
        }
        const Solved coarse = solved(scene, Preset::standard);
        const Solved fine = solved(refined(scene, times), Preset::fast);
        const Truth truth = truth_of(coarse, fine, times);
        const auto error = estimate_patch_size_error(scene, coarse.mesh, coarse.factors, coarse.solution,
                                                     settings_of(Preset::standard));
        REQUIRE(error);
        INFO(c.name << ": field " << error->field.rms << ", true " << truth.field << "; vertices "
                    << error->vertices.rms << ", true " << truth.vertices);
        CHECK(error->field.rms > 0.6 * truth.field);
        CHECK(error->field.rms < 1.6 * truth.field);
        CHECK(error->vertices.rms > 0.5 * truth.vertices);
        CHECK(error->vertices.rms < 2.0 * truth.vertices);
        const std::vector<double> is = group_irradiance(coarse.mesh, coarse.solution);
        const std::vector<double> should = group_irradiance(fine.mesh, fine.solution);
        REQUIRE(error->groups.size() == is.size());
        for (std::size_t g = 0; g < is.size(); ++g) {
            if (coarse.mesh.groups()[g] == "z1") {
                continue; // the ceiling that is not there
            }
            const double true_error = std::abs(is[g] / should[g] - 1.0);
            const double printed = std::hypot(error->groups[g].patch_size, error->groups[g].factors);
            ++groups;
            too_small += true_error > 2.0 * printed + 2e-4 ? 1 : 0;
        }
    }
    INFO(too_small << " of " << groups << " errors of groups are too small");
    CHECK(groups == 21);
    CHECK(too_small <= groups / 10);
}

TEST_CASE("patch size: the sun's disc, where nothing hides it, adds no error to that of parallel light",
          "[pipeline][sun]") {
    Scene scene;
    scene.channels = {"grey"};
    scene.materials.push_back({"white", {0.6}, {0.0}});
    const auto plate = [&scene](const char* group, std::array<Vec3, 4> corners) {
        Surface surface;
        surface.vertices = corners;
        surface.group = scene.group_index(group);
        surface.patches = Grid{4, 4};
        scene.surfaces.push_back(surface);
    };
    plate("floor", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)});
    plate("slope", {Vec3(1, 0, 0), Vec3(2, 0, 1), Vec3(2, 1, 1), Vec3(1, 1, 0)});
    scene.enclosure = Enclosure::open;
    const auto error_of = [&](double diameter) {
        scene.sun = Sun{glm::normalize(Vec3(-0.3, 0.1, 1.0)), {1000.0}, diameter};
        const Solved found = solved(scene, Preset::fast);
        const auto error = estimate_patch_size_error(scene, found.mesh, found.factors, found.solution,
                                                     settings_of(Preset::fast));
        REQUIRE(error);
        return error->field.rms;
    };
    const double parallel = error_of(0.0);
    CHECK(parallel > 1e-4); // what goes from plate to plate
    CHECK(error_of(0.53) == Approx(parallel).epsilon(1e-3));
}

TEST_CASE("patch size: triangles err as the quadrilaterals that they halve, or less", "[pipeline][gl]") {
    const Scene scene = lit_room(6, 0.5, 0.3);
    const auto error_of = [](const Scene& of) {
        const Solved coarse = solved(of, Preset::fast);
        const auto error = estimate_patch_size_error(of, coarse.mesh, coarse.factors, coarse.solution,
                                                     settings_of(Preset::fast));
        REQUIRE(error);
        return *error;
    };
    const PatchSizeError whole = error_of(scene);
    const PatchSizeError halves = error_of(triangulated(scene));
    CHECK(halves.field.rms > 0.6 * whole.field.rms);
    CHECK(halves.field.rms < 1.1 * whole.field.rms);
    CHECK(halves.vertices.rms > 0.6 * whole.vertices.rms);
    CHECK(halves.vertices.rms < 1.1 * whole.vertices.rms);
}

TEST_CASE("patch size: none in a furnace, whatever the shape of the patches", "[pipeline][gl][slow]") {
    Diagnostics diagnostics;
    for (const char* const name : {"furnace.json", "sphere"}) {
        Scene scene = std::string(name) == "sphere"
                          ? read_case("14_sphere_interior.obj")
                          : io::read_scene(HEMI_SOURCE_DIR "/scenes/furnace.json", {}, diagnostics);
        for (Material& material : scene.materials) {
            material.reflectance.assign(material.reflectance.size(), 0.6);
            material.exitance.assign(material.exitance.size(), 2.0);
        }
        scene.environment.clear();
        const Solved coarse = solved(scene, Preset::standard);
        const auto error = estimate_patch_size_error(scene, coarse.mesh, coarse.factors, coarse.solution,
                                                     settings_of(Preset::standard));
        REQUIRE(error);
        INFO(name);
        CHECK(error->field.rms < 1e-6);
        CHECK(error->vertices.rms < 1e-6);
    }
}

TEST_CASE("patch size: what is seen of a patch that a block stands on is as bright as what is beside it",
          "[pipeline][gl]") {
    // A furnace: wherever light is seen, it is the same. The block's outline runs through patches.
    Scene scene;
    scene.materials.push_back({"grey", {0.5}, {1.0}});
    add_room(scene, Vec3(0.0), Vec3(1.0), 4);
    const std::array<Vec3, 4> foot{Vec3(0.33, 0.33, 0.0), Vec3(0.67, 0.33, 0.0), Vec3(0.67, 0.67, 0.0),
                                   Vec3(0.33, 0.67, 0.0)};
    const Vec3 up(0.0, 0.0, 0.4);
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3& from = foot[k];
        const Vec3& to = foot[(k + 1) % 4];
        add_polygon(scene, "block", {from, to, to + up, from + up}, {4, 4});
    }
    add_polygon(scene, "block", {foot[0] + up, foot[1] + up, foot[2] + up, foot[3] + up}, {4, 4});
    constexpr double all_of_them = 100.0; // in the sample
    const Solved coarse = solved(scene, Preset::standard);
    const auto error =
        estimate_patch_size_error(scene, coarse.mesh, coarse.factors, coarse.solution,
                                  settings_of(Preset::standard), no_observer(), {.effort = all_of_them});
    REQUIRE(error);
    CHECK(error->field.rms < 0.008);
}

TEST_CASE("patch size: nothing where nothing reflects, refused for another mesh", "[pipeline][gl]") {
    Scene scene = lit_room(2, 0.5, 0.3);
    const Solved coarse = solved(scene, Preset::fast);
    Solution other = coarse.solution;
    other.radiosity.pop_back();
    CHECK_THROWS_AS(
        estimate_patch_size_error(scene, coarse.mesh, coarse.factors, other, settings_of(Preset::fast)),
        InvalidArgument);
    for (Material& material : scene.materials) {
        material.reflectance = {0.0};
    }
    const Solved black = solved(scene, Preset::fast);
    CHECK_FALSE(estimate_patch_size_error(scene, black.mesh, black.factors, black.solution,
                                          settings_of(Preset::fast)));
}

TEST_CASE("patch size: can be cancelled, and is left out where the memory is short", "[pipeline][gl]") {
    const Scene scene = lit_room(3, 0.5, 0.3);
    const Solved coarse = solved(scene, Preset::fast);
    class Stops : public Observer {
    public:
        bool progress(Phase, std::size_t, std::size_t) override { return false; }
    } stops;
    CHECK_THROWS_AS(estimate_patch_size_error(scene, coarse.mesh, coarse.factors, coarse.solution,
                                              settings_of(Preset::fast), stops),
                    Cancelled);
    class Warned : public Observer {
    public:
        void warning(std::string_view, std::string_view setting) override { settings.emplace_back(setting); }
        std::vector<std::string> settings;
    } warned;
    FactorSettings little = settings_of(Preset::fast);
    little.max_memory = 1024;
    CHECK_FALSE(
        estimate_patch_size_error(scene, coarse.mesh, coarse.factors, coarse.solution, little, warned));
    CHECK(warned.settings == std::vector<std::string>{"max-memory"});
}

TEST_CASE("patch size: an estimate that fails is a warning where the solution must not be lost",
          "[pipeline][gl]") {
    const Scene scene = lit_room(2, 0.5, 0.3);
    const Solved coarse = solved(scene, Preset::fast);
    class Warned : public Observer {
    public:
        void warning(std::string_view message, std::string_view) override { messages.emplace_back(message); }
        std::vector<std::string> messages;
    } warned;
    FactorSettings nowhere = settings_of(Preset::fast);
    nowhere.engine.device = "egl:99";
    CHECK_FALSE(
        try_estimate_patch_size_error(scene, coarse.mesh, coarse.factors, coarse.solution, nowhere, warned));
    REQUIRE(warned.messages.size() == 1);
    CHECK_THAT(warned.messages[0], Catch::Contains("is not estimated") && Catch::Contains("99"));
}

TEST_CASE("solution error: parts combine as the root of the sum of squares", "[pipeline]") {
    Solution solution;
    solution.radiosity = {2.0, 1.0};
    solution.exitance = {1.0, 0.0};
    solution.residual = 1e-3;
    solution.dominance = 0.5;
    CHECK_FALSE(solution_error(solution));
    solution.error = RadiosityErrorEstimate{0.03, {}};
    CHECK_FALSE(solution_error(solution));
    solution.patch_size_error = PatchSizeError{{0.04, 0.05}, {0.08, 0.09}, {{0.03, 0.04}}, {}, 64, 0.0};
    const auto error = solution_error(solution);
    REQUIRE(error);
    CHECK(error->patch_size == 0.04);
    CHECK(error->factors == 0.03);
    CHECK(error->solver == Approx(2e-3 * std::sqrt(2.5)));
    CHECK(error->vertices.rms == Approx(std::hypot(0.04, 0.03, error->solver)));
    CHECK(error->field.rms == Approx(std::hypot(0.08, 0.03, error->solver)));
    REQUIRE(error->groups.size() == 1);
    CHECK(error->groups[0] == Approx(std::hypot(0.03, 0.04, error->solver)));
    CHECK(error->vertices.percentile95 > error->vertices.rms);
    solution.dominance = 1.0; // the residual says nothing then
    CHECK_FALSE(solution_error(solution));
}

TEST_CASE("patch size: corner values of slanted patches are interpolated as those of others",
          "[pipeline][gl]") {
    // A floor beside a lamp: light changes evenly, and most patches lie within.
    for (const double slant : {0.0, 3.0}) {
        Scene scene = empty_scene();
        add_polygon(scene, "floor", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1 + slant, 1, 0), Vec3(slant, 1, 0)},
                    {40, 40});
        add_polygon(scene, "lamp", {Vec3(-3, -2, 1), Vec3(-3, -1, 1), Vec3(-2, -1, 1), Vec3(-2, -2, 1)},
                    {2, 2});
        scene.materials.push_back({"lamp", {0.0}, {10.0}});
        scene.surfaces.back().material = 1;
        const Solved coarse = solved(scene, Preset::fast);
        const auto error = estimate_patch_size_error(scene, coarse.mesh, coarse.factors, coarse.solution,
                                                     settings_of(Preset::fast));
        REQUIRE(error);
        INFO("slant " << slant << ": field " << error->field.rms << ", vertices " << error->vertices.rms);
        CHECK(error->vertices.rms < 0.5 * error->field.rms);
    }
}

TEST_CASE("patch size: groups without an error where there are too many of them", "[pipeline][gl]") {
    Scene scene = lit_room(3, 0.5, 0.3);
    for (int k = 0; k < 64; ++k) {
        const double x = 0.05 + 0.01 * k;
        add_polygon(scene, "strip " + std::to_string(k),
                    {Vec3(x, 0.9, 0.001), Vec3(x + 0.008, 0.9, 0.001), Vec3(x + 0.008, 0.95, 0.001),
                     Vec3(x, 0.95, 0.001)});
    }
    const Solved coarse = solved(scene, Preset::fast);
    const auto error = estimate_patch_size_error(scene, coarse.mesh, coarse.factors, coarse.solution,
                                                 settings_of(Preset::fast));
    REQUIRE(error);
    CHECK(error->groups.empty());
    CHECK(error->field.rms > 0.01);
}

TEST_CASE(
    "patch size error: where far patches stand in clusters, cutting the sample and what is near it says "
    "what cutting all patches does",
    "[pipeline]") {
    const Scene scene = lit_room(7, 0.5, 0.2);
    FactorSettings settings = settings_of(Preset::standard);
    settings.engine.device = "cpu";
    const PatchMesh mesh(scene);
    const Solved all{mesh, compute_form_factors(scene, mesh, settings), {}};
    settings.clusters = Clusters::on;
    Solved part{mesh, compute_form_factors(scene, mesh, settings), {}};
    part.solution = solve_radiosity(scene, part.mesh, part.factors, {}, no_observer(), true);
    for (const bool gathered : {false, true}) {
        if (gathered) {
            gather_at_vertices(scene, all.mesh, settings, Gather::on, part.solution);
        }
        // The same solution and sample, by both kinds of rows.
        const auto by_all = estimate_patch_size_error(scene, all.mesh, all.factors, part.solution, settings);
        const auto by_part =
            estimate_patch_size_error(scene, part.mesh, part.factors, part.solution, settings);
        REQUIRE(by_all);
        REQUIRE(by_part);
        CHECK(by_part->sampled == by_all->sampled);
        CHECK(by_part->vertices.rms == Approx(by_all->vertices.rms).epsilon(0.05));
        CHECK(by_part->field.rms == Approx(by_all->field.rms).epsilon(0.05));
        CHECK(by_part->groups.empty());
        CHECK(!by_all->groups.empty());
    }
    // All pairs of the cut sample would need more.
    settings.max_memory = std::uint64_t{1} << 20;
    CHECK(!estimate_patch_size_error(scene, all.mesh, all.factors, part.solution, settings));
}

TEST_CASE("patch size error: of a large scene only the sample and what is near it is cut", "[pipeline]") {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(9.0, 9.0, 9.0), 40);
    const PatchMesh mesh(scene);
    const std::vector<DrawnPatch> sample{{700, 2.0}, {3000, 5.0}};
    const CutSample cut = cut_sample(mesh, sample, false);
    CHECK(cut.mesh.size() < mesh.size() + mesh.size() / 10);
    REQUIRE(cut.rows.size() == 4 * sample.size());
    for (std::size_t k = 0; k < sample.size(); ++k) {
        for (const std::uint32_t quarter : cut.quarters[k]) {
            CHECK(cut.parents[quarter] == sample[k].patch);
            CHECK(cut.whole[quarter] == 0);
            CHECK(4.0 * cut.mesh.areas()[quarter] == Approx(mesh.areas()[sample[k].patch]));
        }
    }
    CHECK(std::count(cut.whole.begin(), cut.whole.end(), 1) > mesh.size() * 9 / 10);
    CHECK(cut_sample(mesh, sample, true).mesh.size() == 4 * mesh.size());
}
