#pragma once

#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solver.hpp"

#include <optional>
#include <vector>

namespace hemi {

/// About what the radiosity will be, in a small part of the time: that of the same scene in about a thousand
/// patches by the preset fast, spread over the patches of `mesh`; N·channels. Nothing where the scene is
/// small, or its surfaces alone are so many that this would hardly be less work.
/// @throws Cancelled
[[nodiscard]] std::optional<std::vector<double>> coarse_preview(const Scene& scene, const PatchMesh& mesh,
                                                                const FactorSettings& settings,
                                                                const SolverSettings& solver,
                                                                Observer& observer = no_observer());

} // namespace hemi
