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
[[nodiscard]] Report heat_balance_report(const HeatSolution& solution);

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
