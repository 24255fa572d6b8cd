#include "cli/cell_data.hpp"
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

/// Rows of the --factors file, repaired, if it belongs to the patches of `mesh`.
FormFactorMatrix read_rows(const ConvertArguments& arguments, const PatchMesh& mesh) {
    io::FactorFile file = io::read_hff(*arguments.factors);
    if (file.geometry_hash != mesh.geometry_hash() || file.factors.size() != mesh.size()) {
        throw InputError(fmt::format("{}: belongs to another geometry than {}", arguments.factors->string(),
                                     arguments.input.string()));
    }
    settle_contacts(file);
    (void)repair_rows(file, arguments.repair);
    return std::move(file.factors);
}

void convert_result(const ConvertArguments& arguments) {
    if (arguments.repair && !arguments.factors) {
        throw InvalidArgument("--repair needs form factors: --factors FILE.hff");
    }
    const io::ResultFile result = io::read_hres(arguments.input);
    const PatchMesh mesh(result.scene, result.subdivision);
    std::vector<io::CellArray> arrays = cell_data(result, mesh);
    if (arguments.factors) {
        const FormFactorMatrix factors = read_rows(arguments, mesh);
        for (const std::uint32_t row : arguments.rows) {
            arrays.push_back(row_data(factors, row));
        }
    }
    io::write_vtp(arguments.output, mesh, arrays);
    if (arguments.common.json) {
        std::vector<std::string> names;
        for (const io::CellArray& array : arrays) {
            names.push_back(array.name);
        }
        print_json({{"schema", "hemi/convert/1"},
                    {"input", arguments.input.string()},
                    {"output", arguments.output.string()},
                    {"patches", mesh.size()},
                    {"arrays", names}});
    }
}

/// Whether IN and OUT go together.
void check_formats(const ConvertArguments& arguments) {
    const std::string input = extension_of(arguments.input);
    const bool from_result = input == ".hres";
    if (from_result != (extension_of(arguments.output) == ".vtp")) {
        throw InvalidArgument(
            from_result
                ? fmt::format("{}: a stored solution can be written as .vtp", arguments.output.string())
                : fmt::format("{}: a .vtp needs the patches, which {} does not have; convert a .hres, or "
                              "use `hemi factors SCENE -o FILE.vtp`",
                              arguments.output.string(), arguments.input.string()));
    }
    if (from_result) {
        return;
    }
    if (arguments.factors) {
        throw InvalidArgument("--factors and --row are for a .hres that becomes a .vtp");
    }
    const FactorFormat& format = factor_format(arguments.output);
    if (!format.needs.empty() && is_bare_factor_file(arguments.input)) {
        throw InvalidArgument(
            fmt::format("{}: a {} holds {}, which {} does not have; `hemi factors SCENE -o FILE{}` "
                        "makes one",
                        arguments.output.string(), format.extension, format.needs, arguments.input.string(),
                        format.extension));
    }
    const bool to_hff = format.extension == ".hff";
    if (arguments.repair && (to_hff || input != ".hff")) {
        throw InvalidArgument(to_hff ? "--repair: a .hff holds the rows before the repair, which is redone "
                                       "when it is read"
                                     : "--repair needs areas and row balance, which only a .hff has");
    }
}

/// What `file`, from a .hff, is in the other format, and what is left behind.
void tell_losses(const ConvertArguments& arguments, const FactorFormat& format, Repair repaired,
                 const Terminal& terminal) {
    if (repaired != Repair::none) {
        terminal.note(fmt::format("written are the rows after the repair ({})", repair_name(repaired)));
    }
    terminal.note(fmt::format("not in {}: {}",
                              is_standard_output(arguments.output) ? "a .csv" : arguments.output.string(),
                              format.lost));
    if (format.extension == ".txt" || format.extension == ".vf") {
        terminal.note("emissivities are not in a .hff and are written as 0.999; `hemi factors SCENE -o "
                      "FILE` writes the scene's");
    }
}

} // namespace

ExitStatus run(const ConvertArguments& arguments, const Terminal& terminal) {
    Outputs outputs;
    std::vector<std::string_view> extensions = factor_extensions();
    extensions.push_back(".vtp");
    outputs.add("OUT", arguments.output, extensions, true);
    if (outputs.uses_standard_output() && arguments.common.json) {
        throw InvalidArgument("--json and an output to - cannot both go to standard output");
    }
    check_formats(arguments);
    if (extension_of(arguments.input) == ".hres") {
        convert_result(arguments);
        return ExitStatus::ok;
    }
    const FactorFormat& format = factor_format(arguments.output);
    io::FactorFile file = read_input(arguments.input);
    const bool changes = extension_of(arguments.input) == ".hff" && format.extension != ".hff";
    Repair repaired = Repair::none;
    if (changes) {
        settle_contacts(file);
        repaired = repair_rows(file, arguments.repair).report.repair;
    }
    Diagnostics diagnostics;
    write_factors(arguments.output, file, {{}, repaired}, diagnostics);
    terminal.warn(diagnostics);
    if (changes) {
        tell_losses(arguments, format, repaired, terminal);
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
