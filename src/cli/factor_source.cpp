#include "cli/factor_source.hpp"

#include "cli/cluster_settings.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::cli {

namespace {

template <class A, class B>
void check_setting(const CommonOptions& common, const std::filesystem::path& path, const std::string& option,
                   const A& given, const B& stored) {
    if (std::find(common.given.begin(), common.given.end(), option) != common.given.end() &&
        given != stored) {
        throw InvalidArgument(fmt::format("{0} {1} conflicts with --factors {2}, whose rows were made with "
                                          "{0} {3}; leave {0} out, or name another file",
                                          option, given, path.string(), stored));
    }
}

/// Whether rows have clusters is up to the file, unless the command line says what they must be.
void check_clusters(const CommonOptions& common, const std::filesystem::path& path, Clusters wanted,
                    bool stored) {
    const auto given = [&common](const char* option) {
        return std::find(common.given.begin(), common.given.end(), option) != common.given.end();
    };
    if (given("--cluster-error")) {
        throw InvalidArgument(fmt::format("--cluster-error makes rows, but those of {} are there already; "
                                          "leave one out",
                                          path.string()));
    }
    if (given("--clusters") && wanted != Clusters::automatic && (wanted == Clusters::on) != stored) {
        throw InvalidArgument(
            fmt::format("--clusters {} conflicts with --factors {}, whose rows were made {} "
                        "clusters; leave --clusters out, or name another file",
                        to_word(wanted), path.string(), stored ? "with" : "without"));
    }
}

std::string preset_word(const std::optional<Preset>& preset) {
    return preset ? std::string(to_word(*preset)) : "none";
}

/// Settings by which rows of a file were made, where the presets of these patches say others.
void adopt_settings(FactorSettings& settings, const FormFactors& factors) {
    const Provenance& made = factors.provenance;
    settings.preset = *made.preset;
    settings.seed = made.seed;
    settings.resolution = made.resolution;
    const HemicubeSettings usual = plan_rows(settings, factors.matrix.size()).hemicube;
    if (factors.matrix.clusters() == nullptr &&
        (usual.eye_points != made.eye_points || usual.near_eye_points != made.near_eye_points)) {
        settings.eye_points = made.eye_points;
    }
}

} // namespace

FormFactors read_rows(const std::filesystem::path& path, const LoadedScene& loaded,
                      const FactorSettings& settings, const CommonOptions& common) {
    FormFactors factors = read_form_factors(path, loaded.scene, loaded.mesh);
    const Provenance& made = factors.provenance;
    check_setting(common, path, "--resolution", settings.resolution.value_or(0), made.resolution);
    check_setting(common, path, "--seed", settings.seed.value_or(0), made.seed);
    check_setting(common, path, "--preset", preset_word(settings.preset), preset_word(made.preset));
    check_setting(common, path, "--method", to_word(settings.method), to_word(made.method));
    check_setting(common, path, "--eye-points", settings.eye_points.value_or(0), made.eye_points);
    check_setting(common, path, "--shadow-rays", settings.shadow_rays.value_or(0), made.shadow_rays);
    check_clusters(common, path, settings.clusters, factors.matrix.clusters() != nullptr);
    return factors;
}

bool has_rows(const SolveArguments& arguments) {
    std::error_code ignored; // a name that no file can have
    return arguments.factors && std::filesystem::is_regular_file(*arguments.factors, ignored);
}

FormFactors rows_to_refine(const SolveArguments& arguments, const Scene& scene, const PatchMesh& mesh,
                           FactorSettings& settings) {
    const std::filesystem::path& path = *arguments.factors;
    FormFactors factors = read_form_factors(path, scene, mesh);
    const Provenance& made = factors.provenance;
    check_setting(arguments.common, path, "--seed", settings.seed.value_or(0), made.seed);
    check_setting(arguments.common, path, "--preset", preset_word(settings.preset), preset_word(made.preset));
    check_setting(arguments.common, path, "--resolution", settings.resolution.value_or(0), made.resolution);
    check_setting(arguments.common, path, "--eye-points", settings.eye_points.value_or(0), made.eye_points);
    if (made.method != Method::hemicube || !made.preset) {
        throw InvalidArgument(fmt::format("{}: rows by method {}; patches are cut with hemicubes only",
                                          path.string(), to_word(made.method)));
    }
    refuse_clusters(factors, path, "cutting patches further");
    adopt_settings(settings, factors);
    if (!factors.matrix.all_known()) {
        throw InputError(fmt::format("{}: rows are missing; to cut patches further those of all are needed",
                                     path.string()));
    }
    return factors;
}

void add_missing_reference(FormFactors& factors, const PatchMesh& mesh, FactorSettings settings,
                           Observer& observer) {
    const Provenance& made = factors.provenance;
    if (factors.reference.entries() > 0 || made.method != Method::hemicube || !made.preset) {
        return;
    }
    adopt_settings(settings, factors);
    std::string reason;
    try {
        add_reference_rows(factors, mesh, settings, observer,
                           factors.cuts.any() ? reference_rows_of_cut_patches : usual_reference_rows);
        return;
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& error) {
        reason = error.what();
    }
    observer.warning(fmt::format("errors are not estimated: {}", reason), "");
}

void store_rows(const SolveArguments& arguments, FormFactors& raw, const Terminal& terminal) {
    if (arguments.factors) {
        estimate_error(raw);
        io::write_hff(*arguments.factors, raw);
        terminal.detail(fmt::format("form factors written to {}", arguments.factors->string()));
    }
}

FormFactors find_rows(const SolveArguments& arguments, const LoadedScene& loaded,
                      std::span<const std::uint32_t> patches, Observer& observer, const Terminal& terminal,
                      RowCheckpoint* checkpoint) {
    FormFactors factors;
    if (has_rows(arguments)) {
        factors = read_rows(*arguments.factors, loaded, arguments.rows.factors, arguments.common);
        terminal.detail(fmt::format("form factors from {}: no rows to compute", arguments.factors->string()));
        if (arguments.with_irradiance() && !factors.matrix.all_known()) {
            throw InputError(fmt::format("{}: rows are missing that --result and --radiosity need",
                                         arguments.factors->string()));
        }
    } else {
        factors = compute_raw_form_factors(loaded.scene, loaded.mesh, patches, arguments.rows.factors,
                                           observer, checkpoint);
        factors.parts = loaded.parts();
        store_rows(arguments, factors, terminal);
    }
    if (checkpoint != nullptr) { // also that of a run which was killed when the file was complete
        checkpoint->discard();
    }
    return factors;
}

void report_checkpoint(const RowCheckpoint* checkpoint, const Terminal& terminal) {
    if (checkpoint != nullptr && checkpoint->rows() > 0) {
        terminal.note(
            fmt::format("{} kept in the checkpoint {}; the same command with --resume goes on from there",
                        plural(checkpoint->rows(), "row is", "rows are"), checkpoint->path().string()));
    }
}

} // namespace hemi::cli
