#pragma once

#include "cli/arguments/arguments.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/report.hpp"
#include "cli/report/seconds.hpp"
#include "cli/terminal.hpp"
#include "hemi/io/table_file.hpp"
#include "hemi/pipeline/heat.hpp"

/// What `heat` and `exchange` have in common.
namespace hemi::cli {

/// The scene, with what the options say of its groups.
/// @throws InputError, InvalidArgument; for unknown groups with the nearest
/// @param command     that needs it
/// @param input       rows of another program are those of the scene's faces as they are: none is cut
/// @param conditions  whether temperatures and fluxes are of interest
[[nodiscard]] LoadedScene load_thermal_scene(std::string_view command, SceneOptions scene,
                                             const FactorInput& input, const HeatOptions& heat,
                                             bool conditions, const Terminal& terminal);

/// A number, or a temperature with or without its unit, in a cell of a table.
/// @throws ParseError with the place, for numbers with units, and temperatures below 0 K
[[nodiscard]] double parse_cell(const std::filesystem::path& path, const io::TextTable& table,
                                std::size_t row, std::size_t column, bool temperature);

/// All rows, reciprocal: computed, or from a file.
/// @param seconds  gets "factors", "estimate" and "repair"
[[nodiscard]] FormFactors find_heat_rows(const CommonOptions& common, const RowOptions& rows,
                                         const FactorInput& input, const LoadedScene& loaded,
                                         Observer& observer, const Terminal& terminal, Seconds& seconds);

/// Outputs that both have to look at before the work.
void check_factor_input(Outputs& outputs, const FactorInput& input);

} // namespace hemi::cli
