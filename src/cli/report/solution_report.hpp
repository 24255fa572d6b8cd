#pragma once

#include "cli/loaded_scene.hpp"
#include "cli/report/seconds.hpp"
#include "cli/report/text.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/solver/solution.hpp"

#include <string>

/// What is said of a solution: lines of a summary for people, and the same values as JSON.
namespace hemi::cli {

/// Lines on the solver and on errors.
[[nodiscard]] std::string solution_summary(const Solution& solution);
/// The object that `hemi solve --json` prints.
[[nodiscard]] Json solution_json(const LoadedScene& loaded, const FormFactors& factors, const RowSums& sums,
                                 const Solution& solution, const Seconds& seconds);
/// With -v: what the scene did not require.
void report_savings(const LoadedScene& loaded, const FormFactors& factors, const Solution& solution,
                    bool merge_lattices, const Terminal& terminal);

} // namespace hemi::cli
