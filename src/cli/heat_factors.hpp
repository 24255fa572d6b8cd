#pragma once

#include "cli/arguments/arguments.hpp"
#include "cli/loaded_scene.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/report.hpp"
#include "cli/report/seconds.hpp"
#include "cli/terminal.hpp"
#include "hemi/pipeline/heat.hpp"

/// What `heat` and `exchange` have in common.
namespace hemi::cli {

/// The scene, with what the options say of its groups.
/// @throws InputError, InvalidArgument; for unknown groups with the nearest
/// @param input       rows of another program are those of the scene's faces as they are: none is cut
/// @param conditions  whether temperatures and fluxes are of interest
[[nodiscard]] LoadedScene load_thermal_scene(SceneOptions scene, const FactorInput& input, HeatOptions heat,
                                             bool conditions, const Terminal& terminal);

/// All rows, reciprocal: computed, or from a file.
/// @param seconds  gets "factors", "estimate" and "repair"
[[nodiscard]] FormFactors find_heat_rows(const CommonOptions& common, const RowOptions& rows,
                                         const FactorInput& input, const LoadedScene& loaded,
                                         Observer& observer, const Terminal& terminal, Seconds& seconds);

/// Outputs that both have to look at before the work.
void check_factor_input(Outputs& outputs, const FactorInput& input);

} // namespace hemi::cli
