#include "cli/factors.hpp"

#include "cli/cluster_settings.hpp"
#include "cli/commands.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/balance_report.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/factor_tables.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::cli {

namespace {

/// Whether the group table goes into the .csv that -o names, else to stdout.
bool table_goes_to_file(const FactorsArguments& arguments) {
    return arguments.by_group && arguments.output &&
           (is_standard_output(*arguments.output) || extension_of(*arguments.output) == ".csv");
}

Outputs check_outputs(const FactorsArguments& arguments) {
    Outputs outputs;
    if (arguments.selection) {
        outputs.add("-o", *arguments.output, {".hff"});
    } else if (arguments.output) {
        std::vector<std::string_view> extensions = io::factor_extensions();
        extensions.push_back(".vtp");
        outputs.add("-o", *arguments.output, extensions, true);
    }
    if (arguments.patches) {
        outputs.add("--patches", *arguments.patches, {".csv"}, true);
    }
    const bool prints =
        arguments.common.json || arguments.row || (arguments.by_group && !table_goes_to_file(arguments));
    if (outputs.uses_standard_output() && prints) {
        throw InvalidArgument("an output to - and a table or --json cannot both go to standard output");
    }
    return outputs;
}

/// Whether a file holds what clusters say: as they are, or summed over groups or patches.
bool holds_clusters(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    return extension == ".hff" || extension == ".idf" || extension == ".vtp";
}

/// What of `factors` keeps rows from being those of clusters.
std::optional<ClusterObstacle> cluster_obstacle(const FactorsArguments& arguments) {
    if (arguments.selection) {
        return {{"--rows", "whose parts are of single patches"}};
    }
    if (arguments.rows.error_target) {
        return {{"--error-target", "which needs the pairs of patches"}};
    }
    return std::nullopt;
}

void check_point_options(const FactorsArguments& arguments, bool is_scene) {
    if (!is_scene) {
        throw InvalidArgument(fmt::format("--from-point does not apply to {}, which is not a scene",
                                          arguments.scene.path.string()));
    }
    static const std::vector<std::string> allowed{
        "--from-point", "--patch-size", "--patches-per-face", "--two-sided", "--one-sided-group",
        "--orient",     "--flip",       "--flip-group",       "--strict",    "--planarity",
        "--no-imprint", "--zone",       "--allow-outside",    "--json",      "--quiet",
        "--verbose",    "--color"};
    for (const std::string& option : arguments.common.given) {
        if (std::find(allowed.begin(), allowed.end(), option) == allowed.end()) {
            throw InvalidArgument(
                fmt::format("{} does not apply to --from-point, which needs no rows", option));
        }
    }
}

} // namespace

bool writes_rows(const FactorsArguments& arguments) {
    return arguments.output && !table_goes_to_file(arguments);
}

bool keeps_rows(const FactorsArguments& arguments) {
    return writes_rows(arguments) && !is_standard_output(*arguments.output) && !arguments.rows.error_target;
}

Seconds factor_stages() {
    return Seconds({"load", "factors", "repair", "estimate", "search"});
}

void show_groups(const FactorsArguments& arguments, const FormFactors& factors, const Seconds& seconds) {
    if (!factors.matrix.all_known()) {
        throw InputError(fmt::format("{}: some rows were not computed; --by-group needs all",
                                     arguments.scene.path.string()));
    }
    const GroupFactors groups = group_factors(factors.matrix, factors.areas, factors.group_of,
                                              static_cast<std::uint32_t>(factors.groups.size()));
    if (table_goes_to_file(arguments)) {
        io::write_group_factors_csv(*arguments.output, factors.groups, groups);
    }
    if (arguments.common.json) {
        Report report{"", group_factors_json(factors.groups, groups)};
        report.json.update({{"renderer", factors.provenance.renderer}, {"patches", factors.patches()}});
        report.add(row_sum_report(row_sums(factors.matrix)));
        report.add(repair_report(factors, seconds["repair"]));
        report.add(error_report(factors.error));
        report.add(seconds.report());
        report.select("hemi/factors-by-group/1",
                      {"renderer", "patches", "groups", "areas", "factors", "environment", "blocked",
                       "row_sum", "repair", "error_estimate", "seconds"});
        print_json(report.json);
    } else if (!table_goes_to_file(arguments)) {
        print(group_factors_text(factors.groups, groups));
    }
}

ExitStatus run(const FactorsArguments& given, const Terminal& terminal) {
    FactorsArguments arguments = given;
    settle_clusters(arguments.common, arguments.rows, cluster_obstacle(arguments));
    if (arguments.rows.factors.clusters == Clusters::automatic && arguments.output &&
        !holds_clusters(*arguments.output)) {
        arguments.rows.factors.clusters = Clusters::off; // they would have to be expanded in the end
    }
    refuse_chosen_settings(arguments.common, arguments.rows);
    const bool is_scene = io::is_scene_file(arguments.scene.path);
    const Outputs outputs = check_outputs(arguments);
    if (arguments.rows.resume && !(is_scene && keeps_rows(arguments))) {
        throw InvalidArgument(
            "--resume needs a file of form factors to go on with (-o FILE.hff), made from a scene");
    }
    if (arguments.from_point) {
        check_point_options(arguments, is_scene);
        terminal.note("--from-point is another name of `hemi points`, for one point and by patch; that has "
                      "many points, factors to groups, the sky and the light");
        const LoadedScene loaded = load_scene(arguments.scene, terminal);
        show(point_report(loaded, *arguments.from_point), arguments.common.json);
        return ExitStatus::ok;
    }
    if (arguments.selection && is_scene) {
        return factors_part(arguments, outputs, terminal);
    }
    return is_scene ? factors_of_scene(arguments, outputs, terminal) : factors_of_file(arguments, terminal);
}

} // namespace hemi::cli
