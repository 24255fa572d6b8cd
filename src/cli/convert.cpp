#include "cli/cluster_settings.hpp"
#include "cli/commands.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/text.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/vtp_file.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace hemi::cli {

namespace {

/// Rows of the --factors file, prepared, if it belongs to the patches of `mesh`.
FormFactors read_rows(const ConvertArguments& arguments, const PatchMesh& mesh) {
    FormFactors factors = io::read_hff(*arguments.factors);
    if (factors.geometry_hash != mesh.geometry_hash() || factors.matrix.size() != mesh.size()) {
        throw InputError(fmt::format("{}: belongs to another geometry than {}", arguments.factors->string(),
                                     arguments.input.string()));
    }
    prepare_form_factors(factors, arguments.repair);
    return factors;
}

/// --json: what every conversion says, and `more`.
void report(const ConvertArguments& arguments, const Json& more) {
    if (arguments.common.json) {
        Json object{{"schema", "hemi/convert/1"},
                    {"input", arguments.input.string()},
                    {"output", arguments.output.string()}};
        object.update(more);
        print_json(object);
    }
}

std::string output_name(const ConvertArguments& arguments) {
    return is_standard_output(arguments.output) ? "a .csv" : arguments.output.string();
}

void write_cells(const ConvertArguments& arguments, const io::ResultFile& result, const PatchMesh& mesh) {
    std::vector<io::CellArray> arrays = io::solution_arrays(result, mesh);
    if (arguments.factors) {
        const FormFactors factors = read_rows(arguments, mesh);
        for (const std::uint32_t row : arguments.rows) {
            arrays.push_back(io::row_array(factors, row));
        }
    }
    io::write_vtp(arguments.output, mesh, arrays);
    std::vector<std::string> names;
    for (const io::CellArray& array : arrays) {
        names.push_back(array.name);
    }
    report(arguments, {{"patches", result.parts.any() ? result.parts.patches() : mesh.size()},
                       {"parts", mesh.size()},
                       {"arrays", names}});
}

void convert_result(const ConvertArguments& arguments, const Terminal& terminal) {
    if (arguments.repair && !arguments.factors) {
        throw InvalidArgument("--repair needs form factors: --factors FILE.hff");
    }
    const io::ResultFile result = io::read_hres(arguments.input);
    const PatchMesh mesh(result.scene, result.subdivision);
    const bool to_paraview = extension_of(arguments.output) == ".vtp";
    if (to_paraview) {
        write_cells(arguments, result, mesh);
    } else {
        io::write_radiosity_csv(arguments.output, result);
        report(arguments, {{"patches", result.parts.any() ? result.parts.patches() : mesh.size()},
                           {"parts", mesh.size()}});
    }
    terminal.note(fmt::format("not in {}: names of materials, subdivision, environment, camera, solver{}",
                              output_name(arguments), to_paraview ? "" : " and corners"));
}

/// Whether IN and OUT go together.
void check_formats(const ConvertArguments& arguments) {
    const std::string input = extension_of(arguments.input);
    const std::string output = extension_of(arguments.output);
    if (!arguments.zone.empty() && output != ".idf") {
        throw InvalidArgument(
            fmt::format("--zone is for EnergyPlus' .idf, and OUT is {}", arguments.output.string()));
    }
    if (input == ".hres") {
        if (output != ".vtp" && output != ".csv" && !is_standard_output(arguments.output)) {
            throw InvalidArgument(
                fmt::format("{}: a stored solution can be written as .vtp, or as .csv, the radiosity "
                            "of every patch; `hemi bake` makes .glb and .ply, `hemi render` pictures",
                            arguments.output.string()));
        }
        if (arguments.factors && output != ".vtp") {
            throw InvalidArgument("--factors and --row are for a .hres that becomes a .vtp");
        }
        return;
    }
    if (output == ".vtp") {
        throw InvalidArgument(
            fmt::format("{}: a .vtp needs the patches, which {} does not have; convert a .hres, or "
                        "use `hemi factors SCENE -o FILE.vtp`",
                        arguments.output.string(), arguments.input.string()));
    }
    if (arguments.factors) {
        throw InvalidArgument("--factors and --row are for a .hres that becomes a .vtp");
    }
    const io::FactorFormat& format = io::factor_format(arguments.output);
    const auto content = io::factor_content(arguments.input);
    if (content && *content < format.needs) {
        throw InvalidArgument(fmt::format("{}: {} files hold {}, which {} does not have; `hemi factors SCENE "
                                          "-o FILE{}` writes one",
                                          arguments.output.string(), format.extension, format.holds,
                                          arguments.input.string(), format.extension));
    }
    const bool to_hff = format.extension == ".hff";
    if (arguments.repair && (to_hff || input != ".hff")) {
        throw InvalidArgument(to_hff ? "--repair: a .hff holds the rows before the repair, which is redone "
                                       "when it is read"
                                     : "--repair needs areas and row balance, which only a .hff has");
    }
}

/// What the rows are in the other format, and what is left behind.
void report_losses(const ConvertArguments& arguments, const io::FactorFormat& format, bool from_hff,
                   Repair repaired, const Terminal& terminal) {
    if (repaired != Repair::none) {
        terminal.note(fmt::format("the rows are written after repair ({})", to_word(repaired)));
    }
    if (from_hff) {
        terminal.note(fmt::format("not in {}: {}", output_name(arguments), format.lost));
    } else if (io::factor_content(arguments.input) == io::FactorContent::areas) {
        terminal.note(fmt::format("not in {}: emissivities{}", output_name(arguments),
                                  format.lost.starts_with("areas") ? " and areas" : ""));
    }
    if (format.needs == io::FactorContent::areas) {
        terminal.note("emissivities are written as 0.999; `hemi factors SCENE -o FILE` writes the scene's");
    }
}

} // namespace

ExitStatus run(const ConvertArguments& arguments, const Terminal& terminal) {
    Outputs outputs;
    std::vector<std::string_view> extensions = io::factor_extensions();
    extensions.push_back(".vtp");
    outputs.add("OUT", arguments.output, extensions, true);
    outputs.refuse_with_json(arguments.common.json);
    check_formats(arguments);
    if (extension_of(arguments.input) == ".hres") {
        convert_result(arguments, terminal);
        return ExitStatus::ok;
    }
    const io::FactorFormat& format = io::factor_format(arguments.output);
    FormFactors file = io::read_factors(arguments.input);
    const bool from_hff = extension_of(arguments.input) == ".hff";
    Repair repaired = Repair::none;
    if (from_hff && format.extension != ".hff") {
        prepare_form_factors(file, arguments.repair);
        repaired = file.repair->repair;
        file = merge_parts(std::move(file));
    }
    Diagnostics diagnostics;
    if (format.extension != ".hff" && format.extension != ".idf") { // which has sums over groups
        expand_clusters(file, arguments.output, memory_limit({}), diagnostics);
    }
    io::write_factors(arguments.output, file, {{}, arguments.zone}, diagnostics);
    terminal.warn(diagnostics);
    if (format.extension != ".hff") {
        report_losses(arguments, format, from_hff, repaired, terminal);
    }
    report(arguments, {{"patches", file.matrix.size()}, {"entries", file.matrix.entries()}});
    return ExitStatus::ok;
}

} // namespace hemi::cli
