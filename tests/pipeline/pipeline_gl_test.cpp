#include "support/scenes.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/pipeline/accuracy.hpp"
#include "hemi/pipeline/diagnosis.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/picture.hpp"
#include "hemi/pipeline/radiosity.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

using namespace hemi;
using namespace hemi::test;

namespace {

/// A closed cube of k x k patches a face that radiates 1 and reflects 0.8: the radiosity is 5 everywhere.
Scene furnace(std::uint32_t k) {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0), k);
    scene.enclosure = Enclosure::closed;
    for (Material& material : scene.materials) {
        material.reflectance.assign(scene.channels.size(), 0.8);
        material.exitance.assign(scene.channels.size(), 1.0);
    }
    return scene;
}

FactorSettings on_osmesa(Preset preset) {
    FactorSettings settings;
    settings.preset = preset;
    settings.engine.device = "osmesa";
    settings.engine.jobs = 2;
    return settings;
}

/// Cancels once some blocks are complete.
class Interrupting : public Observer {
public:
    bool progress(Phase, std::size_t done, std::size_t) override { return done < 300; }
};

/// Keeps what it is told; cancels at the first call of a phase, or never.
class Recorder : public Observer {
public:
    explicit Recorder(std::optional<Phase> cancel_at = {}) : cancel_at_(cancel_at) {}

    bool progress(Phase phase, std::size_t done, std::size_t total) override {
        CHECK(done <= total);
        if (phases.empty() || phases.back() != phase) {
            phases.push_back(phase);
        }
        return phase != cancel_at_;
    }
    void row(std::uint32_t, const RowView&) override { ++factor_rows; }
    void row(std::uint32_t, const VisibilityRow&) override { ++visibility_rows; }
    void warning(std::string_view message, std::string_view setting) override {
        warnings.emplace_back(message);
        settings.emplace_back(setting);
    }

    std::vector<Phase> phases;
    std::size_t factor_rows = 0;
    std::size_t visibility_rows = 0;
    std::vector<std::string> warnings;
    std::vector<std::string> settings;

private:
    std::optional<Phase> cancel_at_;
};

/// A folder that goes with the test.
class Folder {
public:
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "hemi-pipeline-XXXXXX").string();
        REQUIRE(mkdtemp(name.data()) != nullptr);
        path_ = name;
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    [[nodiscard]] std::filesystem::path operator/(const char* name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

void check_same(const FormFactorMatrix& a, const FormFactorMatrix& b) {
    REQUIRE(a.size() == b.size());
    for (std::uint32_t i = 0; i < a.size(); ++i) {
        const RowView x = a.row(i);
        const RowView y = b.row(i);
        REQUIRE(std::equal(x.columns.begin(), x.columns.end(), y.columns.begin(), y.columns.end()));
        REQUIRE(std::equal(x.values.begin(), x.values.end(), y.values.begin(), y.values.end()));
        REQUIRE(x.environment == y.environment);
        REQUIRE(x.blocked == y.blocked);
    }
}

} // namespace

TEST_CASE("plan_rows: presets are what the pages say", "[pipeline]") {
    struct Row {
        Preset preset;
        std::uint32_t patches, resolution, eye_points, near_eye_points;
        std::optional<std::uint32_t> shadow_rays;
        ExchangeRule rule;
    };
    const auto standard = ExchangeRule::standard;
    for (const Row& row :
         {Row{Preset::plain, 1000, 128, 1, 1, {}, standard}, Row{Preset::fast, 1000, 64, 1, 4, 0, standard},
          Row{Preset::standard, 100, 64, 16, 16, 16, standard},
          Row{Preset::standard, 10'000, 64, 4, 16, 16, standard},
          Row{Preset::exact, 100, 128, 64, 64, 64, ExchangeRule::exact},
          Row{Preset::exact, 1000, 128, 16, 64, 64, ExchangeRule::exact},
          Row{Preset::exact, 100'000, 128, 4, 64, 64, ExchangeRule::exact}}) {
        INFO(to_word(row.preset) << ", " << row.patches << " patches");
        FactorSettings settings;
        settings.preset = row.preset;
        const RowPlan plan = plan_rows(settings, row.patches);
        CHECK(plan.hemicube.resolution == row.resolution);
        CHECK(plan.hemicube.eye_points == row.eye_points);
        CHECK(plan.hemicube.near_eye_points == row.near_eye_points);
        REQUIRE(plan.weighted.has_value() == row.shadow_rays.has_value());
        const Provenance provenance = provenance_of(settings, row.patches);
        CHECK(provenance.preset == row.preset);
        CHECK(provenance.near_eye_points == row.near_eye_points);
        if (plan.weighted) {
            CHECK(plan.weighted->shadow_rays == *row.shadow_rays);
            CHECK(plan.weighted->rule == row.rule);
            CHECK(provenance.exchange_rule == row.rule);
        }
        settings.eye_points = 9;
        settings.resolution = 32;
        const RowPlan single = plan_rows(settings, row.patches);
        CHECK(single.hemicube.eye_points == 9);
        CHECK(single.hemicube.near_eye_points == 1);
        CHECK(single.hemicube.resolution == 32);
    }
}

TEST_CASE("pipeline: a white furnace is white by every preset", "[pipeline][gl]") {
    const Scene scene = furnace(4);
    const PatchMesh mesh(scene);
    for (const NamedValue<Preset>& preset : Names<Preset>::table) {
        INFO(preset.word);
        const FormFactors factors = compute_form_factors(scene, mesh, on_osmesa(preset.value));
        CHECK(factors.provenance.preset == preset.value);
        CHECK(factors.repair.has_value());
        CHECK(factors.error.has_value());
        const Solution solution = solve_radiosity(scene, mesh, factors);
        REQUIRE(solution.radiosity.size() == mesh.size() * solution.channels);
        for (const double radiosity : solution.radiosity) {
            CHECK(radiosity == Approx(5.0).epsilon(1e-5));
        }
        CHECK(solution.error.has_value());
        const Diagnosis diagnosis = diagnose(factors, &mesh, 1e-4);
        CHECK(diagnosis.failures.empty());
        CHECK(diagnosis.enclosure == EnclosureVerdict::closed);
    }
}

TEST_CASE("pipeline: the observer hears of every phase and every row, and can cancel in each",
          "[pipeline][gl]") {
    const Scene scene = furnace(3);
    const PatchMesh mesh(scene);
    Recorder recorder;
    const FormFactors factors = compute_form_factors(scene, mesh, on_osmesa(Preset::standard), recorder);
    (void)solve_radiosity(scene, mesh, factors, {}, recorder);
    const std::vector<Phase> expected{Phase::visibility,     Phase::pairs,   Phase::form_factors,
                                      Phase::error_estimate, Phase::closure, Phase::radiosity};
    CHECK(recorder.phases == expected);
    CHECK(recorder.visibility_rows == mesh.size());
    CHECK(recorder.factor_rows == 0);
    for (const Phase phase : expected) {
        INFO(to_word(phase));
        Recorder cancels(phase);
        if (phase == Phase::radiosity) {
            CHECK_THROWS_AS(solve_radiosity(scene, mesh, factors, {}, cancels), Cancelled);
        } else {
            CHECK_THROWS_AS(compute_form_factors(scene, mesh, on_osmesa(Preset::standard), cancels),
                            Cancelled);
        }
        CHECK(cancels.phases.back() == phase);
    }
    Recorder plain;
    (void)compute_form_factors(scene, mesh, on_osmesa(Preset::plain), plain);
    CHECK(plain.phases == std::vector<Phase>{Phase::form_factors, Phase::error_estimate});
    CHECK(plain.factor_rows == mesh.size());
}

TEST_CASE("prepare_form_factors: stored raw rows become the same as those that were never stored",
          "[pipeline][gl]") {
    const Folder folder;
    const Scene scene = furnace(3);
    const PatchMesh mesh(scene);
    for (const Preset preset : {Preset::plain, Preset::exact}) {
        const FactorSettings settings = on_osmesa(preset);
        FormFactors raw = compute_raw_form_factors(scene, mesh, all_patches(mesh.size()), settings);
        CHECK_FALSE(raw.repair.has_value());
        io::write_hff(folder / "a.hff", raw);
        FormFactors read = read_form_factors(folder / "a.hff", scene, mesh);
        CHECK(read.work.from_file);
        CHECK(read.provenance.exchange_rule == raw.provenance.exchange_rule);
        check_same(read.matrix, raw.matrix);
        prepare_form_factors(raw);
        prepare_form_factors(read);
        check_same(read.matrix, raw.matrix);
        check_same(compute_form_factors(scene, mesh, settings).matrix, raw.matrix);
        const FormFactors once = raw;
        prepare_form_factors(raw);
        check_same(raw.matrix, once.matrix);
        CHECK(raw.error->row_rms == once.error->row_rms);
    }
    const Scene other = furnace(2);
    CHECK_THROWS_AS(read_form_factors(folder / "a.hff", other, PatchMesh(other)), InputError);
}

TEST_CASE("RowCheckpoint: a cancelled run resumes with the same bits", "[pipeline][gl]") {
    const Folder folder;
    const Scene scene = furnace(10);
    const PatchMesh mesh(scene);
    FactorSettings settings = on_osmesa(Preset::plain);
    settings.resolution = 16;
    settings.estimate_error = false;
    const auto patches = all_patches(mesh.size());
    {
        RowCheckpoint checkpoint(folder / "a.hff", false);
        Interrupting interrupting;
        CHECK_THROWS_AS(compute_raw_form_factors(scene, mesh, patches, settings, interrupting, &checkpoint),
                        Cancelled);
        CHECK(checkpoint.rows() >= FormFactorMatrix::block_rows);
    }
    RowCheckpoint checkpoint(folder / "a.hff", true);
    const FormFactors resumed =
        compute_raw_form_factors(scene, mesh, patches, settings, no_observer(), &checkpoint);
    CHECK(checkpoint.reused() >= FormFactorMatrix::block_rows);
    CHECK(resumed.work.rows == mesh.size() - checkpoint.reused());
    check_same(resumed.matrix, compute_raw_form_factors(scene, mesh, patches, settings).matrix);
    checkpoint.discard();
    CHECK_FALSE(std::filesystem::exists(checkpoint.path()));
}

TEST_CASE("RowCheckpoint: rows of clusters, too, and none of another run", "[pipeline][gl]") {
    const Folder folder;
    Scene scene = furnace(10);
    const PatchMesh mesh(scene);
    FactorSettings settings = on_osmesa(Preset::fast);
    settings.resolution = 32;
    settings.estimate_error = false;
    settings.clusters = Clusters::on;
    settings.cluster_error = 0.01;
    const auto patches = all_patches(mesh.size());
    const auto compute = [&](bool resume) {
        RowCheckpoint checkpoint(folder / "a.hff", resume);
        FormFactors factors =
            compute_raw_form_factors(scene, mesh, patches, settings, no_observer(), &checkpoint);
        CHECK(factors.work.rows == mesh.size() - checkpoint.reused());
        CHECK((checkpoint.reused() > 0) == resume);
        return factors;
    };
    const auto interrupt = [&] {
        RowCheckpoint checkpoint(folder / "a.hff", false);
        Interrupting interrupting;
        CHECK_THROWS_AS(compute_raw_form_factors(scene, mesh, patches, settings, interrupting, &checkpoint),
                        Cancelled);
        CHECK(checkpoint.rows() >= FormFactorMatrix::block_rows);
    };
    const auto refusal = [&] {
        try {
            RowCheckpoint checkpoint(folder / "a.hff", true);
            (void)compute_raw_form_factors(scene, mesh, patches, settings, no_observer(), &checkpoint);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("no refusal");
    };
    const FormFactors whole = compute_raw_form_factors(scene, mesh, patches, settings);
    REQUIRE(whole.matrix.clusters() != nullptr);
    interrupt();
    const std::filesystem::path file = folder / "a.hff.rows";
    SECTION("they go on") {
        check_same(compute(true).matrix, whole.matrix);
    }
    SECTION("what is behind a fault is computed again") {
        for (const double place : {0.9, 0.4, 0.0}) {
            interrupt();
            const auto size = static_cast<double>(std::filesystem::file_size(file));
            std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
            stream.seekp(40 + static_cast<std::streamoff>(place * size)); // behind the start
            stream.put('#');
            stream.close();
            RowCheckpoint checkpoint(folder / "a.hff", true);
            check_same(
                compute_raw_form_factors(scene, mesh, patches, settings, no_observer(), &checkpoint).matrix,
                whole.matrix);
            CHECK(checkpoint.reused() < 256);
            CHECK(checkpoint.rows() == mesh.size());
        }
    }
    SECTION("others are refused by name") {
        const std::vector<double> dark(scene.channels.size(), 0.0);
        settings.cluster_error = 0.02;
        CHECK_THAT(refusal(), Catch::Matchers::Contains("cluster error 0.01, here 0.02"));
        settings.cluster_error = 0.01;
        settings.resolution = 64;
        CHECK_THAT(refusal(), Catch::Matchers::Contains("resolution 32, here 64"));
        settings.resolution = 32;
        settings.clusters = Clusters::off;
        CHECK_THAT(refusal(), Catch::Matchers::Contains("rows of clusters, here visibility"));
        interrupt();
        settings.clusters = Clusters::on;
        CHECK_THAT(refusal(), Catch::Matchers::Contains("rows of visibility, here clusters"));
        interrupt();
        scene.materials.front().exitance = dark;
        CHECK_THAT(refusal(), Catch::Matchers::Contains("another run: lamps "));
    }
}

TEST_CASE("RowCheckpoint: rows that are not wanted any more are left out", "[pipeline][gl]") {
    const Folder folder;
    const Scene scene = furnace(10);
    const PatchMesh mesh(scene);
    FactorSettings settings = on_osmesa(Preset::fast);
    settings.engine.device = "cpu"; // which draws single rows as it draws all
    settings.resolution = 16;
    settings.estimate_error = false;
    settings.clusters = GENERATE(Clusters::off, Clusters::on);
    {
        RowCheckpoint checkpoint(folder / "a.hff", false);
        Interrupting interrupting;
        CHECK_THROWS_AS(compute_raw_form_factors(scene, mesh, all_patches(mesh.size()), settings,
                                                 interrupting, &checkpoint),
                        Cancelled);
    }
    std::vector<std::uint32_t> some;
    for (std::uint32_t patch = 50; patch < 500; patch += 3) {
        some.push_back(patch);
    }
    RowCheckpoint checkpoint(folder / "a.hff", true);
    const FormFactors resumed =
        compute_raw_form_factors(scene, mesh, some, settings, no_observer(), &checkpoint);
    CHECK(checkpoint.reused() > 0);
    CHECK(checkpoint.reused() < some.size());
    check_same(resumed.matrix, compute_raw_form_factors(scene, mesh, some, settings).matrix);
}

TEST_CASE("pipeline: too little memory for pairs means plain rows and a warning, for rows an error",
          "[pipeline][gl]") {
    const Scene scene = furnace(3);
    const PatchMesh mesh(scene);
    FactorSettings settings = on_osmesa(Preset::fast);
    settings.max_memory = 4000;
    Recorder recorder;
    const FormFactors factors = compute_form_factors(scene, mesh, settings, recorder);
    CHECK(factors.provenance.preset == Preset::plain);
    CHECK_FALSE(factors.matrix.has_visibility());
    REQUIRE(recorder.warnings.size() == 1);
    CHECK(recorder.settings[0] == "max-memory");
    CHECK_THAT(recorder.warnings[0], Catch::Contains("preset fast would need"));

    const Scene larger = furnace(8);
    settings.preset = Preset::plain;
    try {
        (void)compute_form_factors(larger, PatchMesh(larger), settings);
        FAIL("384 rows do not fit into 4000 bytes");
    } catch (const OutOfMemory& error) {
        CHECK_THAT(error.what(), Catch::Contains("384 rows") && Catch::Contains("3.9 KiB"));
        CHECK_THAT(error.what(), !Catch::Contains("--")); // options are the program's
        CHECK(std::find(error.settings().begin(), error.settings().end(), "max-memory") !=
              error.settings().end());
    }
}

TEST_CASE("solve_radiosity: equal channels are solved once, and give what different ones give",
          "[pipeline][gl]") {
    Scene grey = furnace(2);
    grey.channels = {"a", "b", "c"};
    for (Material& material : grey.materials) {
        material.reflectance.assign(3, 0.5);
        material.exitance.assign(3, 1.0);
    }
    grey.environment.assign(3, 0.0);
    const PatchMesh mesh(grey);
    const FormFactors factors = compute_form_factors(grey, mesh, on_osmesa(Preset::fast));
    const Solution once = solve_radiosity(grey, mesh, factors);
    CHECK(once.channels == 3);
    CHECK(once.channels_solved == 1);
    Scene coloured = grey;
    coloured.materials[0].exitance = {1.0, 1.0, 2.0};
    const Solution all = solve_radiosity(coloured, mesh, factors);
    CHECK(all.channels_solved == 3);
    REQUIRE(once.radiosity.size() == all.radiosity.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        CHECK(once.radiosity[i * 3] == once.radiosity[i * 3 + 2]);
        CHECK(all.radiosity[i * 3] == Approx(once.radiosity[i * 3]).epsilon(1e-6));
        CHECK(once.irradiance[i * 3 + 1] == Approx((once.radiosity[i * 3 + 1] - 1.0) / 0.5).epsilon(1e-5));
    }
    Scene dark = grey;
    for (Material& material : dark.materials) {
        material.exitance.assign(3, 0.0);
    }
    Recorder recorder;
    (void)solve_radiosity(dark, mesh, factors, {}, recorder);
    REQUIRE(recorder.warnings.size() == 1);
    CHECK(recorder.settings[0] == "environment");
}

TEST_CASE("error target: the cheapest settings that do, and how far the best come where none do",
          "[pipeline][gl]") {
    const Scene scene = furnace(2);
    const PatchMesh mesh(scene);
    const FactorSettings base = on_osmesa(Preset::standard);
    const TargetResult loose = factors_to_target(scene, mesh, base, 0.1);
    CHECK(loose.raw.provenance.preset == Preset::plain);
    CHECK(loose.factors.error->row_rms <= 0.1);
    const TargetResult close = factors_to_target(scene, mesh, base, 1e-5);
    CHECK(close.raw.provenance.preset != Preset::plain);
    CHECK(close.factors.error->row_rms <= 1e-5);
    CHECK_THAT(close.raw.provenance.chosen_for, Catch::Contains("error target of 1e-05"));
    CHECK_THROWS_AS(factors_to_target(scene, mesh, base, 1e-15), TargetMissed);
}

TEST_CASE(
    "draw_solution: a picture with the pixels asked for, of channels that are chosen where there are many",
    "[pipeline][gl]") {
    Scene scene = furnace(2);
    scene.channels = {"a", "b"};
    for (Material& material : scene.materials) {
        material.reflectance = {0.5, 0.2};
        material.exitance = {1.0, 2.0};
    }
    scene.environment.assign(2, 0.0);
    const PatchMesh mesh(scene);
    const FormFactors factors = compute_form_factors(scene, mesh, on_osmesa(Preset::fast));
    const Solution solution = solve_radiosity(scene, mesh, factors);
    DrawSettings settings;
    settings.device = "osmesa";
    settings.picture.width = 32;
    settings.picture.height = 24;
    CHECK_THROWS_AS(draw_solution(scene, mesh, solution, settings), InvalidArgument);
    settings.show = {{1, 1, 1}};
    const DrawnPicture drawn = draw_solution(scene, mesh, solution, settings);
    REQUIRE(drawn.picture.linear.size() == 32u * 24u * 3u);
    const double expected = 2.0 / (1.0 - 0.2);
    CHECK(drawn.picture.linear[3 * (12 * 32 + 16)] ==
          Approx(expected).epsilon(1e-4)); // inside, looking at a wall
}

TEST_CASE("find_worker_program: beside the program, and what HEMI_WORKER names first", "[pipeline]") {
    CHECK(find_worker_program().filename() == "hemi-hemicube-worker");
    CHECK(std::filesystem::exists(find_worker_program()));
    setenv("HEMI_WORKER", "/somewhere/else", 1);
    CHECK(find_worker_program() == "/somewhere/else");
    unsetenv("HEMI_WORKER");
}
