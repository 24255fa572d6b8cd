#pragma once

#include "cli/loaded_scene.hpp"
#include "cli/report/report.hpp"
#include "cli/report/seconds.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/solver/solution.hpp"

/// What is said of a solution.
namespace hemi::cli {

/// What `hemi solve` says.
/// @param rows  what is said of the rows
[[nodiscard]] Report solve_report(const LoadedScene& loaded, const FormFactors& factors, const Report& rows,
                                  const Solution& solution, Seconds& seconds);
/// What a stored solution says of its solver and errors.
[[nodiscard]] Report stored_solution_report(const Solution& solution);
/// With -v: what the scene did not require.
void report_savings(const LoadedScene& loaded, const FormFactors& factors, const Solution& solution,
                    bool merge_lattices, const Terminal& terminal);

} // namespace hemi::cli
