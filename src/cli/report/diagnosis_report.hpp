#pragma once

#include "cli/report/report.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/diagnosis.hpp"

namespace hemi::cli {

/// Report of a diagnosis, by `hemi check`.
/// @param mended  what was done to the scene before; comes first
[[nodiscard]] Report diagnosis_report(const Diagnosis& diagnosis, const FormFactors& factors,
                                      const PatchNames& names, double max_row_error, double repair_seconds,
                                      const Report& mended);

} // namespace hemi::cli
