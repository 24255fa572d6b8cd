#pragma once

#include <string>
#include <vector>

/// Error against seconds, as a drawing.
namespace hemi::cli {

struct PlotPoint {
    std::string family; ///< points of one are of one colour and joined by a line in the order given
    std::string label;
    double seconds = 0.0; ///< above 0
    double error = 0.0;   ///< above 0
    bool front = false;   ///< nothing is both faster and better
};

/// An SVG with both axes logarithmic, the front as a stair, a legend, and a label at every point. Labels
/// avoid each other, the points and the frame.
/// @throws InvalidArgument if a coordinate is not above 0 and finite.
[[nodiscard]] std::string trade_plot(const std::string& title, const std::string& error_name,
                                     const std::vector<PlotPoint>& points);

} // namespace hemi::cli
