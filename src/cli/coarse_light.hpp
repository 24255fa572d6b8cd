#pragma once

#include "cli/arguments.hpp"
#include "cli/pipeline.hpp"

#include <optional>
#include <vector>

namespace hemi::cli {

/// What the light will be about, in a small part of the time: that of the same scene in about a thousand
/// patches by the preset fast, spread over the patches of `loaded`; N·channels. Nothing where the scene is
/// small, or its surfaces alone are so many that this would hardly be less work.
/// @throws Cancelled
[[nodiscard]] std::optional<std::vector<double>> coarse_light(const LoadedScene& loaded,
                                                              const RowOptions& rows,
                                                              const SolverSettings& solver,
                                                              const Terminal& terminal);

} // namespace hemi::cli
