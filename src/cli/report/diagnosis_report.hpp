#pragma once

#include "cli/report/text.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/diagnosis.hpp"

#include <string>

/// What `hemi check` says of a diagnosis, to people and as JSON.
namespace hemi::cli {

[[nodiscard]] std::string diagnosis_text(const Diagnosis& diagnosis, const FormFactors& factors,
                                         const PatchNames& names, double max_row_error);
[[nodiscard]] Json diagnosis_json(const Diagnosis& diagnosis, const FormFactors& factors,
                                  const PatchNames& names, double max_row_error, double repair_seconds);

} // namespace hemi::cli
