#pragma once

#include "hemi/pipeline/form_factors.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"
#include "hemi/solver/solution.hpp"
#include "pipeline/error_sample.hpp"
#include "pipeline/group_importance.hpp"

#include <vector>

namespace hemi {

/// What the form factors' errors do to the mean irradiance of groups: errors of the sampled rows' irradiance,
/// times area and importance. Zero where the errors of the rows are not known.
/// @return channel c of group g at [g·channels + c], as irradiance times area
[[nodiscard]] std::vector<SampledSum> factor_error_sums(const Scene& scene, const PatchMesh& mesh,
                                                        const FormFactors& factors, const Solution& solution,
                                                        const GroupImportance& importance);

} // namespace hemi
