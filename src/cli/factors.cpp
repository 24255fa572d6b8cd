#include "cli/cell_data.hpp"
#include "cli/commands.hpp"
#include "cli/error_report.hpp"
#include "cli/error_target.hpp"
#include "cli/outputs.hpp"
#include "cli/pipeline.hpp"
#include "cli/repair_rows.hpp"
#include "cli/report.hpp"
#include "cli/solution.hpp"
#include "cli/stored_factors.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/baselines.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "io/formats/text_output.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace hemi::cli {

namespace {

struct Seconds {
    double load = 0.0;
    double factors = 0.0;
    double repair = 0.0;
    double estimate = 0.0; ///< of errors
    double search = 0.0;   ///< for settings that meet --error-target
    double total = 0.0;
};

/// Rows of a scene or of a file, with what is known of their patches.
struct Subject {
    std::optional<LoadedScene> loaded;
    Rows rows;
    RowRepair repair;
    Seconds seconds;

    [[nodiscard]] PatchNames names() const {
        return loaded ? loaded->names() : PatchNames{rows.file.groups, rows.file.group_of, {}};
    }
};

/// Where a group table goes: into the .csv that -o names, else to stdout.
bool table_goes_to_file(const FactorsArguments& arguments) {
    return arguments.by_group && arguments.output &&
           (is_standard_output(*arguments.output) || extension_of(*arguments.output) == ".csv");
}

/// `.hff` holds the rows as they were computed; repair is redone when it is read.
bool holds_raw_rows(const std::filesystem::path& path) {
    return extension_of(path) == ".hff";
}

/// 1 - reflectance of every patch, the mean of all channels.
std::vector<double> emissivities(const Subject& subject) {
    const LoadedScene& loaded = *subject.loaded;
    const std::vector<double> reflectance = patch_reflectance(loaded.scene, loaded.mesh);
    const std::size_t channels = loaded.scene.channels.size();
    std::vector<double> result;
    for (auto first = reflectance.begin(); first != reflectance.end();
         first += static_cast<std::ptrdiff_t>(channels)) {
        const double sum = std::accumulate(first, first + static_cast<std::ptrdiff_t>(channels), 0.0);
        result.push_back(1.0 - sum / static_cast<double>(channels));
    }
    return result;
}

Outputs check_outputs(const FactorsArguments& arguments) {
    Outputs outputs;
    if (arguments.output) {
        std::vector<std::string_view> extensions = factor_extensions();
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

/// Rows by the cheapest settings that are good enough, as far as a few of them show; those of the next where
/// all together are not.
void compute_to_target(const FactorsArguments& arguments, Subject& subject, const Terminal& terminal) {
    const LoadedScene& loaded = *subject.loaded;
    const auto patches = all_patches(loaded.mesh.size());
    const Stopwatch search_watch;
    TargetSearch search(loaded, patches, arguments.rows, *arguments.rows.error_target, terminal);
    double searched = 0.0;
    for (;;) {
        const Stopwatch watch;
        const RowOptions options = search.next();
        searched += watch.seconds();
        subject.rows = compute_rows(loaded, patches, options, terminal);
        subject.rows.file.reference = search.reference().rows;
        subject.rows.file.chosen_for = search.told();
        io::FactorFile repaired = subject.rows.file;
        settle_contacts(repaired);
        (void)repair_rows(repaired, arguments.rows.repair);
        estimate_rows(repaired);
        if (search.met(repaired.error ? repaired.error->row_rms : 0.0)) {
            break;
        }
    }
    subject.seconds.search = search.reference().seconds + searched;
    subject.seconds.factors = search_watch.seconds() - subject.seconds.search;
}

/// The file of all rows, if one is to be written; rows are kept beside it meanwhile.
std::optional<std::filesystem::path> factor_file(const FactorsArguments& arguments) {
    const bool writes = arguments.output && !table_goes_to_file(arguments) &&
                        !is_standard_output(*arguments.output) && !arguments.rows.error_target &&
                        io::is_scene_file(arguments.scene.path);
    if (arguments.rows.resume && !writes) {
        throw InvalidArgument(
            "--resume needs a file of form factors to go on with (-o FILE.hff), made from a "
            "scene");
    }
    return writes ? arguments.output : std::nullopt;
}

Subject from_scene(const FactorsArguments& arguments, const Terminal& terminal, KeptRows& kept) {
    Subject subject;
    subject.loaded = load_scene(arguments.scene, terminal);
    const PatchMesh& mesh = subject.loaded->mesh;
    if (arguments.row && arguments.rows.repair.value_or(Repair::none) != Repair::none) {
        throw InvalidArgument("--repair needs all rows, but --row computes one; store them first with -o "
                              "FILE.hff");
    }
    if (arguments.row && *arguments.row >= mesh.size()) {
        throw InvalidArgument(fmt::format("--row {}: the scene has {}, counted from 0", *arguments.row,
                                          plural(mesh.size(), "patch", "patches")));
    }
    subject.seconds.load = subject.loaded->seconds;
    const Stopwatch watch;
    const auto patches =
        arguments.row ? std::vector<std::uint32_t>{*arguments.row} : all_patches(mesh.size());
    if (arguments.rows.error_target) {
        compute_to_target(arguments, subject, terminal);
    } else {
        subject.rows = compute_rows(*subject.loaded, patches, arguments.rows, terminal, &kept);
        subject.seconds.factors = watch.seconds();
    }
    if (!arguments.row && !arguments.rows.error_target) {
        add_reference(subject.rows, *subject.loaded, arguments.rows, terminal);
        subject.seconds.estimate = subject.rows.reference_seconds;
    }
    if (arguments.patches) {
        io::write_patches_csv(*arguments.patches, mesh);
    }
    return subject;
}

Subject from_file(const FactorsArguments& arguments) {
    const std::filesystem::path& path = arguments.scene.path;
    if (extension_of(path) != ".hff") {
        throw InvalidArgument(fmt::format("{}: must be a scene ({}) or form factors with names (.hff)",
                                          path.string(), io::scene_extensions()));
    }
    refuse_all_but(arguments.common, std::vector<std::string>{"--row", "--by-group", "--output", "--repair"},
                   path);
    if (!arguments.row && !arguments.by_group) {
        throw InvalidArgument(
            fmt::format("{}: of a file, --row or --by-group can be shown; `hemi info` tells what "
                        "is in it, `hemi convert` writes it in other formats",
                        path.string()));
    }
    if (arguments.output && !table_goes_to_file(arguments)) {
        throw InvalidArgument("-o: of a file only the table of --by-group can be written, as .csv; for other "
                              "formats there is `hemi convert`");
    }
    Subject subject;
    const Stopwatch watch;
    subject.rows.file = io::read_hff(path);
    subject.rows.reused = true;
    subject.seconds.load = watch.seconds();
    const std::uint32_t size = subject.rows.file.factors.size();
    if (arguments.row && *arguments.row >= size) {
        throw InvalidArgument(fmt::format("--row {}: the file has {}, counted from 0", *arguments.row,
                                          plural(size, "row", "rows")));
    }
    if (arguments.row && !subject.rows.file.factors.known(*arguments.row)) {
        throw InputError(fmt::format("{}: row {} was not computed", path.string(), *arguments.row));
    }
    return subject;
}

void show_row(const FactorsArguments& arguments, const Subject& subject) {
    const std::uint32_t index = *arguments.row;
    const RowView row = subject.rows.file.factors.row(index);
    const PatchNames names = subject.names();
    std::vector<std::size_t> order(row.columns.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&row](std::size_t a, std::size_t b) { return row.values[a] > row.values[b]; });
    if (arguments.common.json) {
        Json entries = Json::array();
        for (const std::size_t k : order) {
            entries.push_back({{"patch", row.columns[k]},
                               {"group", names.group(row.columns[k])},
                               {"factor", row.values[k]}});
        }
        print_json({{"schema", "hemi/factors/1"},
                    {"renderer", subject.rows.file.renderer},
                    {"patches", subject.rows.file.factors.size()},
                    {"row", index},
                    {"group", names.group(index)},
                    {"entries", entries},
                    {"sum", row.sum()},
                    {"environment", row.environment},
                    {"blocked", row.blocked}});
        return;
    }
    Table table({"group", "patch", "F"});
    for (const std::size_t k : order) {
        table.add({names.group(row.columns[k]), std::to_string(row.columns[k]),
                   fmt::format("{:.9f}", row.values[k])});
    }
    print(fmt::format("row {}: what leaves {}\nsum {:.9f}, to the environment {:.9f}, blocked {:.9f}\n\n",
                      index, names.describe(index), row.sum(), row.environment, row.blocked) +
          table.text());
}

/// What leaves a surface element at a point, patch by patch.
void show_point(const FactorsArguments& arguments, const Terminal& terminal) {
    const LoadedScene loaded = load_scene(arguments.scene, terminal);
    const std::array<double, 6>& at = *arguments.from_point;
    const Vec3 point(at[0], at[1], at[2]);
    const Vec3 normal(at[3], at[4], at[5]);
    const double length = glm::length(normal);
    if (!(length > 0.0) || !std::isfinite(length)) {
        throw InvalidArgument("--from-point: the normal must have a length");
    }
    const std::vector<double> factors = point_factors(loaded.mesh, point, normal / length, true);
    const PatchNames names = loaded.names();
    std::vector<std::uint32_t> order;
    for (std::uint32_t patch = 0; patch < factors.size(); ++patch) {
        if (factors[patch] > 0.0) {
            order.push_back(patch);
        }
    }
    std::stable_sort(order.begin(), order.end(),
                     [&factors](std::uint32_t a, std::uint32_t b) { return factors[a] > factors[b]; });
    double sum = 0.0;
    for (const std::uint32_t patch : order) {
        sum += factors[patch];
    }
    if (arguments.common.json) {
        Json entries = Json::array();
        for (const std::uint32_t patch : order) {
            entries.push_back({{"patch", patch}, {"group", names.group(patch)}, {"factor", factors[patch]}});
        }
        print_json({{"schema", "hemi/factors/1"},
                    {"patches", factors.size()},
                    {"point", {point.x, point.y, point.z}},
                    {"normal", {normal.x / length, normal.y / length, normal.z / length}},
                    {"entries", entries},
                    {"sum", sum}});
        return;
    }
    Table table({"group", "patch", "F"});
    for (const std::uint32_t patch : order) {
        table.add({names.group(patch), std::to_string(patch), fmt::format("{:.9f}", factors[patch])});
    }
    print(fmt::format("what leaves a surface element at {} {} {}\nsum {:.9f}\n\n", number_text(point.x),
                      number_text(point.y), number_text(point.z), sum) +
          table.text());
}

GroupFactors sum_groups(const io::FactorFile& file, const std::filesystem::path& path) {
    if (!file.factors.all_known()) {
        throw InputError(fmt::format("{}: some rows were not computed; --by-group needs all", path.string()));
    }
    return group_factors(file.factors, file.areas, file.group_of,
                         static_cast<std::uint32_t>(file.groups.size()));
}

Json groups_json(const Subject& subject, const GroupFactors& groups) {
    const io::FactorFile& file = subject.rows.file;
    return {{"schema", "hemi/factors/1"},
            {"renderer", file.renderer},
            {"patches", file.factors.size()},
            {"groups", file.groups},
            {"areas", groups.areas},
            {"factors", rows_json(groups.factors, groups.groups)},
            {"environment", groups.environment},
            {"blocked", groups.blocked},
            {"row_sum", row_sum_json(row_sums(file.factors))},
            {"repair", repair_json(subject.repair)},
            {"error_estimate", error_json(file.error)},
            {"seconds",
             {{"load", subject.seconds.load},
              {"factors", subject.seconds.factors},
              {"repair", subject.seconds.repair},
              {"estimate", subject.seconds.estimate},
              {"search", subject.seconds.search},
              {"total", subject.seconds.total}}}};
}

/// A matrix while it fits a screen, else a line per pair of groups that see each other.
std::string groups_table(const io::FactorFile& file, const GroupFactors& groups) {
    constexpr std::uint32_t widest = 10;
    if (groups.groups > widest) {
        Table table({"from", "to", "F"}, 2);
        for (std::uint32_t g = 0; g < groups.groups; ++g) {
            for (std::uint32_t h = 0; h < groups.groups; ++h) {
                const double factor = groups.factors[std::size_t{g} * groups.groups + h];
                if (factor > 0.0) {
                    table.add({file.groups[g], file.groups[h], fmt::format("{:.6f}", factor)});
                }
            }
            if (groups.environment[g] > 0.0) {
                table.add({file.groups[g], "(environment)", fmt::format("{:.6f}", groups.environment[g])});
            }
            if (groups.blocked[g] > 0.0) {
                table.add({file.groups[g], "(blocked)", fmt::format("{:.6f}", groups.blocked[g])});
            }
        }
        return table.text();
    }
    std::vector<std::string> header{"F from / to"};
    header.insert(header.end(), file.groups.begin(), file.groups.end());
    header.insert(header.end(), {"(environment)", "(blocked)", "area"});
    Table table(header);
    for (std::uint32_t g = 0; g < groups.groups; ++g) {
        std::vector<std::string> line{file.groups[g]};
        for (std::uint32_t h = 0; h < groups.groups; ++h) {
            line.push_back(fmt::format("{:.6f}", groups.factors[std::size_t{g} * groups.groups + h]));
        }
        line.push_back(fmt::format("{:.6f}", groups.environment[g]));
        line.push_back(fmt::format("{:.6f}", groups.blocked[g]));
        line.push_back(number_text(groups.areas[g]));
        table.add(line);
    }
    return table.text();
}

/// group,area,<every group>,environment,blocked: a line per leaving group.
void write_groups_csv(const std::filesystem::path& path, const io::FactorFile& file,
                      const GroupFactors& groups) {
    std::string text = "group,area";
    for (const std::string& name : file.groups) {
        text += ',' + io::csv_field(name);
    }
    text += ",environment,blocked\n";
    for (std::uint32_t g = 0; g < groups.groups; ++g) {
        text += fmt::format("{},{}", io::csv_field(file.groups[g]), groups.areas[g]);
        for (std::uint32_t h = 0; h < groups.groups; ++h) {
            text += fmt::format(",{}", groups.factors[std::size_t{g} * groups.groups + h]);
        }
        text += fmt::format(",{},{}\n", groups.environment[g], groups.blocked[g]);
    }
    io::OutputFile output(path);
    output.write(text);
    output.commit();
}

std::string summary(const Subject& subject, const RowSums& sums, const EnclosureFinding& enclosure,
                    const FactorsArguments& arguments) {
    const PatchMesh& mesh = subject.loaded->mesh;
    std::string text =
        summary_line("scene", fmt::format("{}, {}, {}", plural(mesh.size(), "patch", "patches"),
                                          plural(mesh.surfaces().size(), "surface", "surfaces"),
                                          plural(mesh.groups().size(), "group", "groups")));
    text += rows_summary(subject.rows, sums, enclosure);
    text += repair_summary(subject.repair);
    text += chosen_summary(subject.rows.file.chosen_for) + error_summary(subject.rows.file.error);
    text += summary_line("seconds",
                         fmt::format("load {:.3f}, factors {:.3f}, repair {:.3f}, estimate {:.3f}, "
                                     "total {:.3f}",
                                     subject.seconds.load, subject.seconds.factors, subject.seconds.repair,
                                     subject.seconds.estimate, subject.seconds.total));
    if (arguments.output && !is_standard_output(*arguments.output)) {
        const bool repaired = subject.repair.report.repair != Repair::none;
        const char* const which = !repaired                           ? ""
                                  : holds_raw_rows(*arguments.output) ? " (the rows before the repair)"
                                                                      : " (the rows after the repair)";
        text += summary_line("written", arguments.output->string() + which);
    }
    return text;
}

Json summary_json(const Subject& subject, const RowSums& sums) {
    const FormFactorMatrix& factors = subject.rows.file.factors;
    return {{"schema", "hemi/factors/1"},
            {"renderer", subject.rows.file.renderer},
            {"patches", factors.size()},
            {"groups", subject.rows.file.groups},
            {"entries", factors.entries()},
            {"memory", factors.memory_bytes()},
            {"row_sum", row_sum_json(sums)},
            {"environment_max", sums.environment_max},
            {"blocked_max", sums.blocked_max},
            {"repair", repair_json(subject.repair)},
            {"chosen_for",
             subject.rows.file.chosen_for.empty() ? Json(nullptr) : Json(subject.rows.file.chosen_for)},
            {"error_estimate", error_json(subject.rows.file.error)},
            {"seconds",
             {{"load", subject.seconds.load},
              {"factors", subject.seconds.factors},
              {"repair", subject.seconds.repair},
              {"estimate", subject.seconds.estimate},
              {"search", subject.seconds.search},
              {"total", subject.seconds.total}}}};
}

ExitStatus run(const FactorsArguments& arguments, const Outputs& outputs, const Terminal& terminal,
               KeptRows& kept) {
    const Stopwatch total;
    const bool is_scene = io::is_scene_file(arguments.scene.path);
    if (arguments.from_point) {
        if (!is_scene) {
            throw InvalidArgument(fmt::format("--from-point does not apply to {}, which is not a scene",
                                              arguments.scene.path.string()));
        }
        static const std::vector<std::string> allowed{
            "--from-point", "--patch-size", "--patches-per-face", "--two-sided", "--skip-degenerate",
            "--json",       "--quiet",      "--verbose",          "--color"};
        for (const std::string& option : arguments.common.given) {
            if (std::find(allowed.begin(), allowed.end(), option) == allowed.end()) {
                throw InvalidArgument(
                    fmt::format("{} does not apply to --from-point, which needs no rows", option));
            }
        }
        show_point(arguments, terminal);
        return ExitStatus::ok;
    }
    Subject subject = is_scene ? from_scene(arguments, terminal, kept) : from_file(arguments);
    io::FactorFile& file = subject.rows.file;
    if (arguments.row && is_scene) {
        show_row(arguments, subject);
        return ExitStatus::ok;
    }
    const bool writes = arguments.output && !table_goes_to_file(arguments);
    Diagnostics diagnostics;
    if (writes && holds_raw_rows(*arguments.output)) {
        estimate_rows(file);
        write_factors(*arguments.output, file, {}, diagnostics);
        kept.discard();
    }
    settle_contacts(file);
    subject.repair = repair_rows(file, arguments.rows.repair);
    subject.seconds.repair = subject.repair.seconds;
    const Stopwatch estimate_watch;
    estimate_rows(file);
    subject.seconds.estimate += estimate_watch.seconds();
    if (writes && !holds_raw_rows(*arguments.output)) {
        if (extension_of(*arguments.output) == ".vtp") {
            io::write_vtp(*arguments.output, subject.loaded->mesh, cell_data(file));
        } else {
            const std::vector<double> emissivity = emissivities(subject);
            write_factors(*arguments.output, file, {emissivity, subject.repair.report.repair}, diagnostics);
        }
    }
    terminal.warn(diagnostics);
    kept.discard();
    if (arguments.row) {
        show_row(arguments, subject);
        return ExitStatus::ok;
    }
    const RowSums sums = row_sums(file.factors);
    const EnclosureFinding enclosure = find_leaks(file.factors, file.enclosure, arguments.rows.max_row_error);
    if (arguments.by_group) {
        const GroupFactors groups = sum_groups(file, arguments.scene.path);
        if (table_goes_to_file(arguments)) {
            write_groups_csv(*arguments.output, file, groups);
        }
        subject.seconds.total = total.seconds();
        if (arguments.common.json) {
            print_json(groups_json(subject, groups));
        } else if (!table_goes_to_file(arguments)) {
            print(groups_table(file, groups));
        }
    } else {
        subject.seconds.total = total.seconds();
        if (arguments.common.json) {
            print_json(summary_json(subject, sums));
        } else if (!terminal.quiet()) {
            const std::string text = summary(subject, sums, enclosure, arguments);
            if (outputs.uses_standard_output()) {
                std::fputs(text.c_str(), stderr);
            } else {
                print(text);
            }
        }
    }
    if (is_scene) {
        report_covered(sums, terminal);
    }
    report_leaks(enclosure, file.factors, subject.names(), subject.loaded ? &subject.loaded->mesh : nullptr,
                 arguments.rows.max_row_error, terminal);
    return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

} // namespace

ExitStatus run(const FactorsArguments& arguments, const Terminal& terminal) {
    const Outputs outputs = check_outputs(arguments);
    return keeping_rows(factor_file(arguments), arguments.rows.resume, terminal,
                        [&](KeptRows& kept) { return run(arguments, outputs, terminal, kept); });
}

} // namespace hemi::cli
