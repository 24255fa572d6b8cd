#pragma once

#include "benchmark/report.hpp"

#include <filesystem>

namespace hemi::bench {

/// Patches that are cut until the error of the interpolated light is met, against evenly cut ones: the
/// largest patch size of a series, each 0.84 times the one before, whose estimated error meets it. Both by
/// the default preset with all cores, vertices gathered, from the same estimate.
/// @param scene        file
/// @param error        of `vertices`
/// @param most_rows    that the cut patches may need, of those of the evenly cut ones
/// @param most_seconds likewise; 0: no limit
void refinement_target(const std::filesystem::path& scene, double error, double most_rows,
                       double most_seconds, Report& report);

} // namespace hemi::bench
