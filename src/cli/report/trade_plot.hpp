#pragma once

#include <string>
#include <vector>

/// Error against seconds, as a drawing.
namespace hemi::cli {

struct PlotPoint {
    std::string family;   ///< points of one are of one colour and joined by a line in the order given
    std::string label;    ///< empty: none
    double seconds = 0.0; ///< above 0
    double error = 0.0;   ///< above 0
    bool front = false;   ///< nothing is both faster and better
    bool joined = true;   ///< by a line to the next of its family
};

struct PlotPanel {
    std::string heading;
    std::string seconds_name; ///< below the axis
    std::string error_name;   ///< beside the axis
    bool percent = false;     ///< errors are shown in per cent
    std::vector<PlotPoint> points;
};

/// An SVG of panels one below the other, each with both axes logarithmic, the front as a stair, a legend, and
/// a label at every point that has one. Labels avoid each other, the points and the frame.
/// @throws InvalidArgument if there is no panel, one has no point, or a coordinate is not above 0 and finite.
[[nodiscard]] std::string trade_plot(const std::string& title, const std::vector<PlotPanel>& panels);

} // namespace hemi::cli
