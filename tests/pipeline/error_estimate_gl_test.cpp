#include "support/accuracy_row.hpp"
#include "support/occluded_reference.hpp"
#include "support/scenes.hpp"

#include "hemi/core/error.hpp"
#include "hemi/matrix/error_estimate.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/solver/solver.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace hemi;
using namespace hemi::test;

namespace {

/// All rows from what is known of them.
FormFactorMatrix matrix_of(const std::vector<std::vector<double>>& rows) {
    FormFactorMatrix matrix(static_cast<std::uint32_t>(rows.size()));
    for (RowBlock& block : matrix.take_blocks()) {
        for (std::uint32_t local = 0; local < block.rows(); ++local) {
            const auto& row = rows[block.first_row + local];
            for (std::uint32_t j = 0; j < row.size(); ++j) {
                if (row[j] > 0.0) {
                    block.columns.push_back(j);
                    block.values.push_back(static_cast<float>(row[j]));
                }
            }
            block.begin[local + 1] = block.columns.size();
            block.known[local] = 1;
        }
        matrix.set_block(std::move(block));
    }
    return matrix;
}

/// What the patches of a scene reflect, emit and radiate.
struct Light {
    std::vector<double> reflectances, exitance, radiosity;

    [[nodiscard]] std::vector<double> solve(const FormFactorMatrix& factors) const {
        SolverSettings settings;
        settings.tolerance = 1e-9;
        return solve_radiosity({&factors, 1, reflectances, exitance, {}}, settings).radiosity;
    }
};

/// A scene whose factors are known, element by element, with the light for each reflectance of its walls.
struct KnownScene {
    KnownScene(const Scene& geometry, const std::vector<std::string>& bodies, std::size_t points,
               const std::vector<double>& reflectances)
        : scene(geometry), mesh(geometry) {
        const OccludedReference reference(mesh, bodies, points);
        std::vector<std::vector<double>> rows;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            rows.push_back(reference.row(i));
        }
        factors = matrix_of(rows);
        for (const double reflectance : reflectances) {
            Light light;
            for (std::uint32_t i = 0; i < mesh.size(); ++i) {
                light.exitance.push_back(mesh.group(i) == 0 ? 1.0 : 0.0); // one wall is a lamp
                light.reflectances.push_back(mesh.group(i) == 0 ? 0.0 : reflectance);
            }
            light.radiosity = light.solve(factors);
            lights.push_back(light);
        }
    }

    Scene scene;
    PatchMesh mesh;
    FormFactorMatrix factors{0};
    std::vector<Light> lights;
};

/// Settings as they are used, and what is enforced on the rows.
struct Trial {
    const char* name;
    FactorSettings settings;
};

FactorSettings plain(std::uint32_t eye_points, std::uint32_t resolution, Repair repair = Repair::none) {
    FactorSettings settings;
    settings.preset = Preset::plain;
    settings.eye_points = eye_points;
    settings.resolution = resolution;
    settings.repair = repair;
    return settings;
}

/// A preset as it ships.
FactorSettings preset(Preset name, std::optional<Repair> repair = {}) {
    FactorSettings settings;
    settings.preset = name;
    settings.repair = repair;
    return settings;
}

/// Over how many cases an estimate held, and how far it was off.
class Tally {
public:
    void add(double truth, double estimate) { ratios_.push_back(estimate > 0.0 ? truth / estimate : 1e9); }
    [[nodiscard]] double held() const {
        return static_cast<double>(
                   std::count_if(ratios_.begin(), ratios_.end(), [](double r) { return r < 2.0; })) /
               static_cast<double>(ratios_.size());
    }
    [[nodiscard]] double median() const {
        auto sorted = ratios_;
        std::sort(sorted.begin(), sorted.end());
        return sorted[sorted.size() / 2];
    }
    [[nodiscard]] double largest() const { return *std::max_element(ratios_.begin(), ratios_.end()); }

private:
    std::vector<double> ratios_;
};

struct FactorTallies {
    Tally rms, max, row_rms, rows;
};
struct LightTallies {
    Tally radiosity, patches;
};

/// One way on one scene: computes, estimates, and compares the estimate with the truth, for each of its
/// lights.
void judge(const KnownScene& scene, const Trial& trial, std::uint64_t seed, FactorTallies& tallies,
           std::vector<LightTallies>& by_light) {
    FactorSettings settings = trial.settings;
    settings.seed = seed;
    settings.engine.device = cpu_device;
    settings.engine.jobs = 1;
    const FormFactors found_factors = compute_form_factors(scene.scene, scene.mesh, settings);
    const FormFactorMatrix& factors = found_factors.matrix;
    const FactorErrorEstimate& error = *found_factors.error;
    const auto patches = all_patches(scene.mesh.size());

    double rows = 0.0;
    double largest = 0.0;
    std::uint64_t pairs = 0;
    for (const std::uint32_t i : patches) {
        std::vector<double> difference(scene.mesh.size(), 0.0);
        const RowView truth = scene.factors.row(i);
        const RowView found = factors.row(i);
        for (std::size_t k = 0; k < truth.columns.size(); ++k) {
            difference[truth.columns[k]] -= double{truth.values[k]};
        }
        for (std::size_t k = 0; k < found.columns.size(); ++k) {
            difference[found.columns[k]] += double{found.values[k]};
        }
        double square = 0.0;
        for (const double d : difference) {
            square += d * d;
            largest = std::max(largest, std::abs(d));
        }
        pairs += truth.columns.size();
        rows += square;
        tallies.rows.add(std::sqrt(square), error.rows[i]);
    }
    tallies.row_rms.add(std::sqrt(rows / scene.mesh.size()), error.row_rms);
    tallies.rms.add(std::sqrt(rows / static_cast<double>(pairs)), error.rms);
    tallies.max.add(largest, error.max);

    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const Light& light = scene.lights[l];
        const auto radiosity = light.solve(factors);
        const RadiosityErrorEstimate shown =
            estimate_radiosity_error(factors, found_factors.reference, scene.mesh.areas(), 1,
                                     light.reflectances, light.exitance, radiosity);
        double errors = 0.0;
        double all = 0.0;
        for (const std::uint32_t i : patches) {
            const double d = radiosity[i] - light.radiosity[i];
            const double area = scene.mesh.areas()[i];
            errors += area * d * d;
            if (light.reflectances[i] > 0.0) {
                const double reflected = light.radiosity[i] - light.exitance[i];
                all += area * reflected * reflected;
                by_light[l].patches.add(std::abs(d), shown.patches[i]);
            }
        }
        by_light[l].radiosity.add(std::sqrt(errors / all), shown.rms);
    }
}

/// `share`: of the cases in which the true error must be below twice the estimate.
void check(const char* name, const Tally& tally, double share = 0.95) {
    INFO(name << ": held in " << tally.held() << ", median " << tally.median() << ", largest "
              << tally.largest());
    const AccuracyRow row("error estimate", name);
    row.check_above("true error below twice the estimate: share of the cases", "", tally.held(), share);
    row.check_above("true error / estimate, median", "", tally.median(), 0.1);
}

const std::vector<Trial> trials{
    {"plain 64", plain(1, 64)},
    {"plain 128", plain(1, 128)},
    {"plain 4x64", plain(4, 64)},
    {"plain closed", plain(1, 64, Repair::closure)},
    {"fast, raw", preset(Preset::fast, Repair::none)},
    {"fast", preset(Preset::fast)},
    {"default, raw", preset(Preset::standard, Repair::none)},
    {"default", preset(Preset::standard)},
    {"exact", preset(Preset::exact)},
};

void judge_all(const KnownScene& scene, const std::vector<std::size_t>& chosen, std::uint64_t seeds) {
    FactorTallies tallies;
    std::vector<LightTallies> by_light(scene.lights.size());
    for (const std::size_t m : chosen) {
        for (std::uint64_t seed = 0; seed < seeds; ++seed) {
            judge(scene, trials[m], seed, tallies, by_light);
        }
    }
    check("factors, rms", tallies.rms);
    check("factors, max", tallies.max);
    check("rows, rms", tallies.row_rms);
    check("each row", tallies.rows);
    for (const LightTallies& light : by_light) {
        check("radiosity, rms", light.radiosity);
        // The error of a single patch's radiosity is one draw from what is estimated.
        check("radiosity of each patch", light.patches, 0.9);
    }
}

} // namespace

TEST_CASE("error_estimate: holds in a room with two boxes", "[pipeline][gl][slow][accuracy]") {
    const KnownScene scene(room_with_turned_boxes(6, 2, 2), {"first", "second"}, 10, {0.5, 0.9});
    judge_all(scene, {0, 1, 2, 3, 4, 5, 6, 7, 8}, 3);
}

TEST_CASE("error_estimate: holds in a cube", "[pipeline][gl][slow][accuracy]") {
    Scene cube = empty_scene();
    add_room(cube, Vec3(0.0), Vec3(1.0), 8);
    judge_all(KnownScene(cube, {}, 1, {0.5}), {0, 1, 2, 3, 4, 5, 6, 7, 8}, 3);
}

TEST_CASE("error_estimate: holds between two plates", "[pipeline][gl][slow][accuracy]") {
    Scene plates = empty_scene();
    add_polygon(plates, "lower", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}, {8, 8});
    add_polygon(plates, "upper", {Vec3(0, 0, 0.3), Vec3(0, 1, 0.3), Vec3(1, 1, 0.3), Vec3(1, 0, 0.3)},
                {8, 8});
    const KnownScene scene(plates, {}, 1, {0.5});
    judge_all(scene, {0, 1, 2, 4, 6}, 3);
}

TEST_CASE("estimate_factor_error: nothing to say where nothing was compared", "[matrix]") {
    const FormFactorMatrix none(3);
    CHECK_THROWS_AS(estimate_factor_error(none, none), InvalidArgument);
    CHECK_THROWS_AS(estimate_factor_error(none, FormFactorMatrix(4)), InvalidArgument);
    const FormFactorMatrix rows = matrix_of({{0.0, 0.5, 0.25}, {0.5, 0.0, 0.25}, {0.25, 0.25, 0.0}});
    const FactorErrorEstimate same = estimate_factor_error(rows, rows);
    CHECK(same.sampled == 3);
    CHECK(same.rms > 0.0); // what floats cannot say
    CHECK(same.rms < 3e-8);
    CHECK(same.max < 1e-7);
    CHECK(same.row_max < 1e-7);
    const FormFactorMatrix other = matrix_of({{0.0, 0.5, 0.25}, {0.5, 0.0, 0.25}, {0.25, 0.5, 0.0}});
    const FactorErrorEstimate off = estimate_factor_error(other, rows);
    CHECK(off.rms == Approx(0.25 / std::sqrt(6.0)));
    CHECK(off.row_rms == Approx(0.25 / std::sqrt(3.0)));
    CHECK(off.max >= 0.25);
    const std::vector<double> short_areas(2, 1.0);
    CHECK_THROWS_AS(
        estimate_radiosity_error(rows, rows, short_areas, 1, short_areas, short_areas, short_areas),
        InvalidArgument);
}

TEST_CASE("error estimate: a wrong row of a small patch does not stand for those of large ones",
          "[pipeline]") {
    const std::vector<std::vector<double>> right{
        {0.0, 0.3, 0.3, 0.3}, {0.3, 0.0, 0.3, 0.3}, {0.3, 0.3, 0.0, 0.3}, {0.3, 0.3, 0.3, 0.0}};
    auto wrong = right;
    wrong[3][0] = 0.4;
    const std::vector<double> reflectance(4, 0.5);
    const std::vector<double> exitance{1.0, 0.0, 0.0, 0.0};
    const std::vector<double> radiosity{1.1, 0.3, 0.3, 0.3};
    const auto rms = [&](double area) {
        const std::vector<double> areas{1.0, 1.0, 1.0, area};
        return estimate_radiosity_error(matrix_of(wrong), matrix_of(right), areas, 1, reflectance, exitance,
                                        radiosity)
            .rms;
    };
    // The area mean of the squared error goes down with the area.
    CHECK(rms(1e-4) < 0.03 * rms(1.0));
}
