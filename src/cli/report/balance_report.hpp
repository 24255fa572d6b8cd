#pragma once

#include "cli/report/report.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/matrix/repair.hpp"

#include <cstdint>
#include <span>

/// How far rows are from closure and reciprocity, and what was enforced.
namespace hemi::cli {

/// Line "row sums", key "row_sum".
[[nodiscard]] Report row_sum_report(const RowSums& sums);
/// Differences between the directions of pairs, rms and max.
/// @param patch_of  as PatchNames has it
[[nodiscard]] Json reciprocity_json(const Reciprocity& reciprocity, std::span<const std::uint32_t> patch_of);
/// Lines and key "repair": what was enforced, and how far the rows were and are from it.
/// @param factors  repaired
/// @param seconds  that the repair took
[[nodiscard]] Report repair_report(const FormFactors& factors, double seconds);

} // namespace hemi::cli
