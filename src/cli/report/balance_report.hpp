#pragma once

#include "cli/report/report.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/matrix/repair.hpp"

/// How far rows are from closure and reciprocity, and what was enforced.
namespace hemi::cli {

/// Line "row sums", key "row_sum".
[[nodiscard]] Report row_sum_report(const RowSums& sums);
/// Differences between the directions of pairs, rms and max.
[[nodiscard]] Json reciprocity_json(const Reciprocity& reciprocity);
/// Lines and key "repair": what was enforced, and how far the rows were and are from it.
/// @param seconds  that the repair took
[[nodiscard]] Report repair_report(const RepairReport& repair, double seconds);

} // namespace hemi::cli
