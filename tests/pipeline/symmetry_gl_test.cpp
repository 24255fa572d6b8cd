#include "support/device.hpp"
#include "support/scenes.hpp"

#include "hemi/engine/baselines.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/pipeline/daylight.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/scene/image_mesh.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <numeric>

using namespace hemi;
using namespace hemi::test;

namespace {

FactorSettings by(Preset preset, Method method = Method::hemicube) {
    FactorSettings settings;
    settings.preset = preset;
    settings.method = method;
    settings.engine.device = "cpu";
    settings.engine.jobs = 2;
    return settings;
}

Symmetry mirrors(int count) {
    Symmetry symmetry;
    for (int axis = 0; axis < count; ++axis) {
        symmetry.mirrors.push_back({axis, 0.0});
    }
    return symmetry;
}

void add_wall(Scene& scene, const std::string& group, const Vec3& at, const Vec3& u, const Vec3& v,
              Grid cells) {
    add_polygon(scene, group, {at, at + u, at + u + v, at + v}, cells);
}

/// The part of the cube from -1 to 1 with all coordinates above 0 of the first `count` axes; patches of 0.5.
Scene cube_part(int count) {
    Scene scene = empty_scene();
    Vec3 lower(-1.0);
    for (int axis = 0; axis < count; ++axis) {
        lower[axis] = 0.0;
    }
    const Vec3 size = Vec3(1.0) - lower;
    for (int axis = 0; axis < 3; ++axis) {
        const int a = (axis + 1) % 3;
        const int b = (axis + 2) % 3;
        Vec3 u(0.0);
        Vec3 v(0.0);
        u[a] = size[a];
        v[b] = size[b];
        const auto cells = [&size](int k) { return static_cast<std::uint32_t>(2.0 * size[k]); };
        Vec3 far = lower;
        far[axis] = 1.0;
        add_wall(scene, "upper", far, v, u, {cells(b), cells(a)});
        if (lower[axis] < 0.0) {
            add_wall(scene, "lower", lower, u, v, {cells(a), cells(b)});
        }
    }
    scene.enclosure = Enclosure::closed;
    scene.symmetry = mirrors(count);
    return scene;
}

/// One sixth of a hexagonal furnace of height 1.5, about z.
Scene hexagon_part() {
    Scene scene = empty_scene();
    const double half = 0.5 * std::sqrt(3.0);
    const Vec3 a(half, -0.5, 0.0);
    const Vec3 b(half, 0.5, 0.0);
    const Vec3 up(0.0, 0.0, 1.5);
    add_polygon(scene, "wall", {b, a, a + up, b + up}, {3, 3});
    add_polygon(scene, "floor", {Vec3(0.0), a, b}, {2, 2});
    add_polygon(scene, "roof", {up, b + up, a + up}, {2, 2});
    scene.enclosure = Enclosure::closed;
    scene.symmetry.emplace();
    scene.symmetry->rotation = RotationAxis{2, 6};
    return scene;
}

/// The half with x > 0 of a room 4 x 3 x 2 with a table in its middle, which the plane cuts.
Scene half_room() {
    Scene scene = empty_scene();
    add_wall(scene, "floor", {0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {6, 9});
    add_wall(scene, "ceiling", {0, 0, 2}, {0, 3, 0}, {2, 0, 0}, {9, 6});
    add_wall(scene, "wall", {2, 0, 0}, {0, 0, 2}, {0, 3, 0}, {6, 9});
    add_wall(scene, "front", {0, 0, 0}, {0, 0, 2}, {2, 0, 0}, {6, 6});
    add_wall(scene, "back", {0, 3, 0}, {2, 0, 0}, {0, 0, 2}, {6, 6});
    add_wall(scene, "table", {0, 1, 1}, {1, 0, 0}, {0, 1, 0}, {3, 3});
    add_wall(scene, "table", {0, 1, 0.7}, {0, 1, 0}, {1, 0, 0}, {3, 3});
    add_wall(scene, "table", {1, 1, 0.7}, {0, 1, 0}, {0, 0, 0.3}, {3, 1});
    add_wall(scene, "table", {0, 1, 0.7}, {1, 0, 0}, {0, 0, 0.3}, {3, 1});
    add_wall(scene, "table", {0, 2, 0.7}, {0, 0, 0.3}, {1, 0, 0}, {1, 3});
    scene.enclosure = Enclosure::closed;
    scene.symmetry = mirrors(1);
    return scene;
}

/// A piece of a street of width 1 between walls of height 1, along y.
Scene canyon_part(double length, std::uint32_t images) {
    Scene scene = empty_scene();
    add_wall(scene, "street", {0, 0, 0}, {1, 0, 0}, {0, length, 0}, {8, 1});
    add_wall(scene, "west", {0, 0, 0}, {0, length, 0}, {0, 0, 1}, {1, 8});
    add_wall(scene, "east", {1, 0, 0}, {0, 0, 1}, {0, length, 0}, {8, 1});
    scene.enclosure = Enclosure::open;
    scene.symmetry.emplace();
    scene.symmetry->periods = {{0, length, 0}};
    scene.symmetry->images = images;
    return scene;
}

std::vector<double> dense_row(const FormFactorMatrix& factors, std::uint32_t i) {
    std::vector<double> row(factors.size(), 0.0);
    const RowView view = factors.row(i);
    for (std::size_t k = 0; k < view.columns.size(); ++k) {
        row[view.columns[k]] = static_cast<double>(view.values[k]);
    }
    return row;
}

/// How far factors of a part and those of all of its images, computed as any scene, are apart.
struct Difference {
    double max = 0.0;
    double rms = 0.0;         ///< over all pairs
    double environment = 0.0; ///< the largest
};
Difference difference(const PatchMesh& mesh, const FormFactorMatrix& folded, const FormFactorMatrix& whole) {
    const ImageMesh images(mesh);
    Difference result;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::vector<double> row = dense_row(folded, i);
        std::vector<double> other(mesh.size(), 0.0);
        const std::vector<double> unfolded = dense_row(whole, i);
        for (std::uint32_t p = 0; p < unfolded.size(); ++p) {
            other[images.original(p)] += unfolded[p];
        }
        for (std::uint32_t j = 0; j < mesh.size(); ++j) {
            result.max = std::max(result.max, std::abs(row[j] - other[j]));
            result.rms += (row[j] - other[j]) * (row[j] - other[j]);
        }
        result.environment =
            std::max(result.environment, std::abs(folded.row(i).environment - whole.row(i).environment));
    }
    result.rms = std::sqrt(result.rms) / mesh.size();
    return result;
}

FormFactors of_whole(const Scene& scene, const PatchMesh& mesh, const FactorSettings& settings) {
    const ImageMesh images(mesh);
    Scene whole = scene;
    whole.symmetry.reset();
    return compute_form_factors(whole, images.mesh(), settings);
}

double largest_diagonal(const FormFactorMatrix& factors) {
    double largest = 0.0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        largest = std::max(largest, dense_row(factors, i)[i]);
    }
    return largest;
}

} // namespace

TEST_CASE("Symmetry: factors of a part are those of the whole where nothing is hidden",
          "[pipeline][every-device]") {
    const int count = test_device() == "cpu" ? GENERATE(0, 1, 2, 3) : GENERATE(0, 3);
    CAPTURE(count);
    const Scene scene = count == 0 ? hexagon_part() : cube_part(count);
    const PatchMesh mesh(scene);
    FactorSettings settings = by(Preset::fast);
    settings.engine.device = test_device();
    settings.repair = Repair::none;
    settings.estimate_error = false;
    FormFactors folded = compute_form_factors(scene, mesh, settings);
    FormFactors whole = of_whole(scene, mesh, settings);
    for (const Repair repair : {Repair::none, Repair::closure}) {
        folded.repair.reset();
        whole.repair.reset();
        prepare_form_factors(folded, repair);
        prepare_form_factors(whole, repair);
        REQUIRE(folded.matrix.size() == mesh.size());
        CHECK(difference(mesh, folded.matrix, whole.matrix).max < 1e-6);
        CHECK(is_reciprocal(reciprocity(folded.matrix, mesh.areas())));
        CHECK(largest_diagonal(folded.matrix) > 0.01);
    }
    const RowSums sums = row_sums(folded.matrix);
    CHECK(sums.min == Approx(1.0).margin(1e-6));
    CHECK(sums.max == Approx(1.0).margin(1e-6));
}

TEST_CASE("Symmetry: factors of half a room are within the printed errors of the whole's", "[pipeline]") {
    const Scene scene = half_room();
    const PatchMesh mesh(scene);
    const FactorSettings settings = by(Preset::standard);
    const FormFactors folded = compute_form_factors(scene, mesh, settings);
    const FormFactors whole = of_whole(scene, mesh, settings);
    REQUIRE((folded.error && whole.error));
    const Difference found = difference(mesh, folded.matrix, whole.matrix);
    CHECK(found.rms < folded.error->rms + whole.error->rms);
    CHECK(folded.error->row_rms < 2.0 * whole.error->row_rms);
    CHECK(is_reciprocal(reciprocity(folded.matrix, mesh.areas())));
    CHECK(row_sums(folded.matrix).balance_error_max < 1e-6);
}

TEST_CASE("Symmetry: a white furnace of which half is given is as bright everywhere", "[pipeline]") {
    Scene scene = half_room();
    for (Material& material : scene.materials) {
        material.reflectance = {0.8};
        material.exitance = {1.0};
    }
    const PatchMesh mesh(scene);
    FactorSettings settings = by(Preset::standard);
    settings.estimate_error = false;
    const FormFactors factors = compute_form_factors(scene, mesh, settings);
    for (const SolverMethod method :
         {SolverMethod::gauss_seidel, SolverMethod::jacobi, SolverMethod::conjugate_gradient}) {
        SolverSettings solver;
        solver.method = method;
        solver.tolerance = 1e-9;
        const Solution solution = solve_radiosity(scene, mesh, factors, solver);
        for (const double value : solution.radiosity) {
            CHECK(value == Approx(5.0).epsilon(1e-5));
        }
    }
}

TEST_CASE("Symmetry: an endless street sees what the closed forms say", "[pipeline]") {
    // Crossed strings of a cross section of width and height 1.
    const double diagonal = std::numbers::sqrt2;
    const Scene scene = canyon_part(2.0, 40);
    const PatchMesh mesh(scene);
    FactorSettings settings = by(Preset::standard);
    settings.estimate_error = false;
    const GroupTable table = by_group(mesh, compute_form_factors(scene, mesh, settings).matrix);
    constexpr double of_the_ends = 3e-6; // of what lies beyond 80 on either side
    CHECK(table.factor("street", "west") == Approx(0.5 * (2.0 - diagonal)).margin(of_the_ends));
    CHECK(table.factor("west", "east") == Approx(diagonal - 1.0).margin(of_the_ends));
    CHECK(table.factors.environment[0] == Approx(diagonal - 1.0).margin(of_the_ends));
    CHECK(table.factors.environment[1] == Approx(0.5 * (2.0 - diagonal)).margin(of_the_ends));
}

TEST_CASE("Symmetry: a street of 50 images is one whose images are given", "[pipeline]") {
    const Scene scene = canyon_part(1.0, 25);
    const PatchMesh mesh(scene);
    FactorSettings settings = by(Preset::fast);
    settings.estimate_error = false;
    const FormFactors folded = compute_form_factors(scene, mesh, settings);
    Scene whole = scene;
    whole.symmetry.reset();
    const ImageMesh images(mesh);
    const FormFactors rows =
        compute_raw_form_factors(whole, images.mesh(), all_patches(mesh.size()), settings);
    const Difference found = difference(mesh, folded.matrix, rows.matrix);
    CHECK(found.max < 1e-6);
    CHECK(found.environment < 1e-5);
}

TEST_CASE("Symmetry: a point sees a patch and its images", "[pipeline]") {
    const Scene scene = cube_part(3);
    const std::vector<double> factors =
        point_factors(PatchMesh(scene), {0.2, -0.3, 0.1}, {0.0, 0.6, -0.8}, true);
    REQUIRE(factors.size() == PatchMesh(scene).size());
    CHECK(std::accumulate(factors.begin(), factors.end(), 0.0) == Approx(1.0).epsilon(1e-3));
}

TEST_CASE("Symmetry: images cast shadows of the sun", "[pipeline]") {
    Scene scene = canyon_part(4.0, 3);
    scene.surfaces.clear();
    add_wall(scene, "street", {0, 0, 0}, {1, 0, 0}, {0, 4, 0}, {4, 16});
    add_wall(scene, "house", {1, 1, 0}, {0, 0, 3}, {0, 2, 0}, {6, 4});
    add_wall(scene, "house", {0, 1, 0}, {1, 0, 0}, {0, 0, 3}, {4, 6});
    scene.sun = Sun{glm::normalize(Vec3(0.2, 1.0, 0.6)), {1000.0}, 0.0};
    const PatchMesh mesh(scene);
    const ImageMesh images(mesh);
    const std::vector<double> part = direct_irradiance(scene, mesh, FormFactorMatrix(mesh.size()));
    const std::vector<double> whole =
        direct_irradiance(scene, images.mesh(), FormFactorMatrix(images.mesh().size()));
    Scene alone = scene;
    alone.symmetry.reset();
    const std::vector<double> without =
        direct_irradiance(alone, PatchMesh(alone), FormFactorMatrix(mesh.size()));
    REQUIRE(part.size() == mesh.size());
    double hidden = 0.0;
    for (std::size_t i = 0; i < part.size(); ++i) {
        CHECK(part[i] == Approx(whole[i]).margin(1e-9));
        hidden = std::max(hidden, without[i] - part[i]);
    }
    CHECK(hidden > 100.0);
}

TEST_CASE("Symmetry: other methods fold their rows, too", "[pipeline]") {
    const Scene scene = cube_part(2);
    const PatchMesh mesh(scene);
    for (const Method method : {Method::contour, Method::direct, Method::montecarlo, Method::hemicube}) {
        FactorSettings settings = by(Preset::plain, method);
        settings.estimate_error = false;
        settings.repair = Repair::none;
        const FormFactors folded = compute_form_factors(scene, mesh, settings);
        REQUIRE(folded.matrix.size() == mesh.size());
        const Difference found = difference(mesh, folded.matrix, of_whole(scene, mesh, settings).matrix);
        CHECK(found.max < 1e-6);
    }
}
