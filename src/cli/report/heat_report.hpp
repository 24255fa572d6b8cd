#pragma once

#include "cli/output_paths.hpp"
#include "cli/report/report.hpp"
#include "cli/terminal.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/heat.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

/// Reports of heat: fluxes and temperatures, series, exchange factors.
namespace hemi::cli {

/// Table of groups, and its keys of `heat --json`.
/// @param patch_size_errors  of their net fluxes; empty: not estimated
[[nodiscard]] Report heat_report(const FormFactors& factors, const HeatProblem& problem,
                                 const HeatSolution& solution, std::span<const double> patch_size_errors);

/// Lines and keys on the balance, the solver and buried patches.
/// @param factors   rows of the patches
/// @param problem   what was solved
/// @param solution  of it
[[nodiscard]] Report heat_balance_report(const FormFactors& factors, const HeatProblem& problem,
                                         const HeatSolution& solution);

/// What making the exchange of clusters symmetric changes; keys "clusters", and "asymmetry", null without
/// any.
/// @param factors    rows of the patches
/// @param asymmetry  see HeatSolution
[[nodiscard]] Report asymmetry_report(const FormFactors& factors, double asymmetry);

/// Share of what leaves every group that meets backs of one-sided surfaces, of all that leaves; heat counts
/// it as coming back. One value a group.
/// @param factors   rows of the patches
/// @param solution  of their heat
[[nodiscard]] std::vector<double> power_to_backs(const FormFactors& factors, const HeatSolution& solution);

/// Warns where more than 0.1 % of the radiation meets backs.
/// @param shares    see power_to_backs()
/// @param groups    their names
/// @param terminal  gets the warning
void report_met_backs(const std::vector<double>& shares, const std::vector<std::string>& groups,
                      const Terminal& terminal);

/// Table of the lines of the schedule; key "series".
/// @param names   of the groups
/// @param labels  of the lines, such as times
[[nodiscard]] Report series_report(std::span<const std::string> names, std::span<const std::string> labels,
                                   const HeatSeries& series);

/// Table of conductances; the keys of `exchange --json` but "seconds".
/// @param names  of the groups
[[nodiscard]] Report exchange_report(std::span<const std::string> names, const HeatExchange& exchange);

/// What `--min` did; key "cutoff", null without it.
[[nodiscard]] Report cutoff_report(const std::optional<ExchangeCutoff>& cutoff);

/// Prints the JSON object, or the summary with tables behind it; the tables alone with -q.
void show_with_tables(const Outputs& outputs, Report summary, const Report& tables, bool json,
                      const Terminal& terminal);

} // namespace hemi::cli
