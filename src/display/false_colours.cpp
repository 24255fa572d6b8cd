#include "hemi/display/false_colours.hpp"

#include "display/legend.hpp"
#include "display/painted.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemi {

namespace {

/// From the lowest value to the highest; about a single one, where there is no other.
ColourScale scale_of(const std::vector<double>& values) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const double value : values) {
        if (std::isinf(value)) {
            throw InvalidArgument("false colours: a value is infinite; must be finite, or not a number");
        }
        if (!std::isnan(value)) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    }
    if (low > high) {
        return {};
    }
    // Values that differ by what a solver leaves are one.
    const double least = 1e-9 * std::max(std::abs(low), std::abs(high));
    if (high - low <= least) {
        const double half = high == 0.0 ? 0.5 : 0.01 * std::abs(high);
        return {low - half, high + half, false};
    }
    return {low, high, false};
}

} // namespace

Picture draw_false_colours(const PatchMesh& mesh, const FalseColours& shown, const Camera& camera,
                           const PictureSettings& settings, const std::string& device) {
    if (shown.values.size() != mesh.size()) {
        throw InvalidArgument(
            fmt::format("false colours: {} values for {} patches", shown.values.size(), mesh.size()));
    }
    const ColourScale scale = scale_of(shown.values);
    const std::vector<double> dark(mesh.size(), 0.0);
    PictureSettings plain = settings;
    plain.shading = Shading::flat;
    plain.tone_mapping = ToneMapping::linear;
    plain.exposure = 1.0;
    Picture picture = draw_picture(
        painted(make_picture_mesh(mesh, 1, dark, {}, {0, 0, 0}), value_colours(shown.values, scale, mesh)),
        camera, plain, device);
    std::string title = shown.title + (shown.unit.empty() ? "" : "  [" + shown.unit + "]");
    const bool has_none =
        std::any_of(shown.values.begin(), shown.values.end(), [](double value) { return std::isnan(value); });
    title += has_none ? "; grey: not known" : "";
    draw_legend(picture, scale, title);
    return picture;
}

} // namespace hemi
