#include "cli/cluster_settings.hpp"
#include "cli/commands.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/diagnosis_report.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/scene_report.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <fmt/format.h>

namespace hemi::cli {

namespace {

FormFactors read_file(const CheckArguments& arguments) {
    const std::filesystem::path& path = arguments.scene.path;
    if (extension_of(path) != ".hff") {
        throw InvalidArgument(fmt::format("{}: check needs a scene ({}) or a .hff; other files hold no row "
                                          "balance and no areas",
                                          path.string(), io::scene_extensions()));
    }
    refuse_all_but(arguments.common, std::vector<std::string>{"--enclosure", "--max-row-error", "--repair"},
                   path);
    FormFactors factors = io::read_hff(path);
    refuse_clusters(factors, path, "check, which compares pairs,");
    factors.enclosure = arguments.scene.enclosure.value_or(factors.enclosure);
    return factors;
}

FormFactors compute(const CheckArguments& arguments, const LoadedScene& loaded, Observer& observer) {
    FactorSettings settings = arguments.rows.factors;
    settings.estimate_error = false;
    return compute_raw_form_factors(loaded.scene, loaded.mesh, all_patches(loaded.mesh.size()), settings,
                                    observer);
}

} // namespace

ExitStatus run(const CheckArguments& arguments, const Terminal& terminal) {
    TerminalObserver observer(terminal);
    std::optional<LoadedScene> loaded;
    FormFactors factors;
    if (io::is_scene_file(arguments.scene.path)) {
        loaded = load_scene(arguments.scene, terminal);
        factors = compute(arguments, *loaded, observer);
    } else {
        factors = read_file(arguments);
    }
    const Stopwatch watch;
    prepare_form_factors(factors, arguments.rows.factors.repair, observer);
    const double repair_seconds = watch.seconds();
    const PatchNames names =
        loaded ? loaded->names() : PatchNames{factors.groups, factors.group_of, {}, factors.parts.patch_of};
    const double limit = arguments.rows.max_row_error;
    const Diagnosis diagnosis = diagnose(factors, loaded ? &loaded->mesh : nullptr, limit);
    if (arguments.common.json || !terminal.quiet()) {
        const Report mended =
            loaded ? imprint_report(*loaded, terminal.verbose()) : Report{"", {{"imprint", nullptr}}};
        show(diagnosis_report(diagnosis, factors, names, limit, repair_seconds, mended),
             arguments.common.json);
    }
    report_no_fronts(diagnosis.sums, factors.matrix, terminal);
    if (diagnosis.enclosure == EnclosureVerdict::nearly_closed) {
        terminal.warn(
            fmt::format("nearly closed: {}; --enclosure closed makes that an error, --enclosure open "
                        "declares that it is meant",
                        plural(diagnosis.leaks.size(), "patch leaks", "patches leak")));
    }
    return diagnosis.failures.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

} // namespace hemi::cli
