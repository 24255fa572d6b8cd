#pragma once

#include "cli/report/report.hpp"
#include "hemi/pipeline/difference.hpp"

#include <span>
#include <string>
#include <string_view>

namespace hemi::cli {

/// How patches were paired, and a table of groups.
/// @param names     of the groups of the first solution
/// @param quantity  its word
/// @param channel   of it
/// @param metres    of the first scene's unit
[[nodiscard]] Report diff_report(const SolutionDifference& found, std::span<const std::string> names,
                                 std::string_view quantity, const std::string& channel, double metres);

} // namespace hemi::cli
