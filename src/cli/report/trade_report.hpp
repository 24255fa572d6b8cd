#pragma once

#include "cli/loaded_scene.hpp"
#include "cli/report/report.hpp"
#include "hemi/pipeline/trade.hpp"

#include <string>

namespace hemi::cli {

/// Report of the measurements of `hemi trade`.
/// @param given    options of the scene, which are part of what is recommended
/// @param budget   seconds that were allowed
/// @param seconds  that it took
[[nodiscard]] Report trade_report(const Trade& trade, const LoadedScene& loaded, const SceneOptions& given,
                                  double budget, double seconds);
/// The measurements as an SVG, see trade_plot().
[[nodiscard]] std::string trade_drawing(const Trade& trade, const LoadedScene& loaded);

} // namespace hemi::cli
