#include "cli/factors.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/factor_tables.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/diagnosis.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <fmt/format.h>

namespace hemi::cli {

namespace {

void check_options(const FactorsArguments& arguments) {
    const std::filesystem::path& path = arguments.scene.path;
    if (extension_of(path) != ".hff") {
        throw InvalidArgument(fmt::format("{}: must be a scene ({}) or form factors with names (.hff)",
                                          path.string(), io::scene_extensions()));
    }
    refuse_all_but(arguments.common, std::vector<std::string>{"--row", "--by-group", "--output", "--repair"},
                   path);
    if (!arguments.row && !arguments.by_group) {
        throw InvalidArgument(
            fmt::format("{}: of a file, --row or --by-group can be shown; `hemi info` says what "
                        "is in it, `hemi convert` writes it in other formats",
                        path.string()));
    }
    if (writes_rows(arguments)) {
        throw InvalidArgument("-o: of a file only the table of --by-group can be written, as .csv; for other "
                              "formats there is `hemi convert`");
    }
}

void check_row(std::uint32_t row, const FormFactors& factors, const std::filesystem::path& path) {
    const std::uint32_t rows = factors.patches();
    if (row >= rows) {
        throw InvalidArgument(
            fmt::format("--row {}: the file has {}, counted from 0", row, plural(rows, "row", "rows")));
    }
    bool known = factors.parts.any() || factors.matrix.known(row);
    for (std::uint32_t part = 0; part < factors.parts.patch_of.size(); ++part) {
        known = known && (factors.parts.patch_of[part] != row || factors.matrix.known(part));
    }
    if (!known) {
        throw InputError(fmt::format("{}: row {} was not computed", path.string(), row));
    }
}

} // namespace

ExitStatus factors_of_file(const FactorsArguments& arguments, const Terminal& terminal) {
    const std::filesystem::path& path = arguments.scene.path;
    check_options(arguments);
    Seconds seconds = factor_stages();
    const Stopwatch load_watch;
    FormFactors factors = io::read_hff(path);
    seconds["load"] = load_watch.seconds();
    if (arguments.row) {
        check_row(*arguments.row, factors, path);
    }
    const Stopwatch repair_watch;
    TerminalObserver observer(terminal);
    prepare_form_factors(factors, arguments.rows.factors.repair, observer);
    seconds["repair"] = repair_watch.seconds();
    if (arguments.row) {
        const FormFactors merged = merge_parts(std::move(factors));
        show(row_report(merged, *arguments.row, {merged.groups, merged.group_of, {}}), arguments.common.json);
        return ExitStatus::ok;
    }
    const PatchNames names{factors.groups, factors.group_of, {}, factors.parts.patch_of};
    const double max_row_error = arguments.rows.max_row_error;
    const EnclosureFinding enclosure = find_leaks(factors, max_row_error);
    show_groups(arguments, factors, seconds);
    report_leaks(enclosure, factors.matrix, names, nullptr, max_row_error, terminal);
    return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

} // namespace hemi::cli
