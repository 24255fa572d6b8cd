#pragma once

#include "cli/report/report.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/heat.hpp"

#include <span>
#include <string>
#include <vector>

/// Reports of heat: fluxes and temperatures, series, exchange factors.
namespace hemi::cli {

/// Table of groups, balance and solver; the keys of `heat --json` but "seconds" and "series".
[[nodiscard]] Report heat_report(const FormFactors& factors, const HeatProblem& problem,
                                 const HeatSolution& solution);

/// One line a line of the schedule; key "series".
/// @param names   of the groups
/// @param labels  of the lines, such as times
[[nodiscard]] Report series_report(std::span<const std::string> names, std::span<const std::string> labels,
                                   const HeatSeries& series);

/// Conductances; the keys of `exchange --json` but "seconds".
/// @param names  of the groups
[[nodiscard]] Report exchange_report(std::span<const std::string> names, const HeatExchange& exchange);

} // namespace hemi::cli
