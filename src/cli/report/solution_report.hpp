#pragma once

#include "cli/loaded_scene.hpp"
#include "cli/report/report.hpp"
#include "cli/report/seconds.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/light_balance.hpp"
#include "hemi/pipeline/refinement.hpp"
#include "hemi/solver/solution.hpp"

/// Report of a solution.
namespace hemi::cli {

/// What the light does at every group.
[[nodiscard]] Report light_report(const LoadedScene& loaded, const Solution& solution);

/// Report of `hemi solve`, without the picture: a table of the groups; the error, the balance of the light
/// and the time.
/// @param rows     report of the rows
/// @param balance  of the light, where it is known
/// @param error_of which error was asked for
/// @param in_full  the text has all other numbers as well, as the JSON has
[[nodiscard]] Report solve_report(const LoadedScene& loaded, const FormFactors& factors, const Report& rows,
                                  const Solution& solution, const std::optional<LightBalance>& balance,
                                  const Seconds& seconds, ErrorOf error_of, bool in_full);
/// Where the light goes.
/// @param metres  in a unit of the scene
/// @param unit    behind powers; may be empty
[[nodiscard]] Report light_balance_report(const std::optional<LightBalance>& balance, double metres,
                                          const char* unit = "");
/// Warns where more than 0.1 % of the light is lost.
/// @param groups  their names
void report_lost_light(const std::optional<LightBalance>& balance, const std::vector<std::string>& groups,
                       const Terminal& terminal);
/// Report of the meshes on the way to the last one.
[[nodiscard]] Report refinement_report(const std::vector<Refinement::Step>& steps,
                                       const std::string& stopped);
/// Report of a stored solution: its solver and errors.
[[nodiscard]] Report stored_solution_report(const Solution& solution, const PatchMesh& mesh);
/// With -v: the work that was saved: rows, channels and polygons that were left out.
void report_savings(const LoadedScene& loaded, const FormFactors& factors, const Solution& solution,
                    bool merge_lattices, const Terminal& terminal);

} // namespace hemi::cli
