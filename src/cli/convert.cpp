#include "cli/commands.hpp"
#include "cli/outputs.hpp"
#include "cli/pipeline.hpp"
#include "cli/repair_rows.hpp"
#include "cli/report.hpp"
#include "cli/stored_factors.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>

namespace hemi::cli {

namespace {

io::FactorFile read_input(const std::filesystem::path& path) {
    if (extension_of(path) == ".hff") {
        return io::read_hff(path);
    }
    io::FactorFile file;
    file.factors = read_bare_factors(path);
    return file;
}

} // namespace

ExitStatus run(const ConvertArguments& arguments, const Terminal& terminal) {
    Outputs outputs;
    outputs.add("OUT", arguments.output, {".hff", ".mtx", ".csv", ".npz", ".txt", ".vf"}, true);
    if (outputs.uses_standard_output() && arguments.common.json) {
        throw InvalidArgument("--json and an output to - cannot both go to standard output");
    }
    const bool from_hff = extension_of(arguments.input) == ".hff";
    const bool to_hff = extension_of(arguments.output) == ".hff";
    if (to_hff && !from_hff && is_bare_factor_file(arguments.input)) {
        throw InvalidArgument(
            fmt::format("{}: a .hff holds areas, names, row balance and the geometry's hash, which "
                        "{} does not have; `hemi factors SCENE -o FILE.hff` makes one",
                        arguments.output.string(), arguments.input.string()));
    }
    const bool to_view3d = is_view3d_factor_file(arguments.output);
    if (to_view3d && !from_hff && is_bare_factor_file(arguments.input)) {
        throw InvalidArgument(
            fmt::format("{}: View3D's files hold areas, which {} does not have; a .hff does",
                        arguments.output.string(), arguments.input.string()));
    }
    if (arguments.repair && (to_hff || !from_hff)) {
        throw InvalidArgument(to_hff ? "--repair: a .hff holds the rows before the repair, which is redone "
                                       "when it is read"
                                     : "--repair needs areas and row balance, which only a .hff has");
    }
    io::FactorFile file = read_input(arguments.input);
    Repair repaired = Repair::none;
    if (from_hff && !to_hff) {
        settle_contacts(file);
        repaired = repair_rows(file, arguments.repair).report.repair;
    }
    write_factors(arguments.output, file);
    if (repaired != Repair::none) {
        terminal.note(fmt::format("written are the rows after the repair ({})", repair_name(repaired)));
    }
    if (from_hff && !to_hff) {
        terminal.note(
            fmt::format("not in {}: {}group names, row balance (environment, blocked), settings and the "
                        "geometry's hash",
                        is_standard_output(arguments.output) ? "a .csv" : arguments.output.string(),
                        to_view3d ? "" : "areas, "));
        if (to_view3d) {
            terminal.note("emissivities are not in a .hff and are written as 0.999; `hemi factors SCENE -o "
                          "FILE` writes the scene's");
        }
        if (!file.factors.all_known()) {
            terminal.warn("rows that were not computed become empty rows");
        }
    }
    if (arguments.common.json) {
        print_json({{"schema", "hemi/convert/1"},
                    {"input", arguments.input.string()},
                    {"output", arguments.output.string()},
                    {"patches", file.factors.size()},
                    {"entries", file.factors.entries()}});
    }
    return ExitStatus::ok;
}

} // namespace hemi::cli
