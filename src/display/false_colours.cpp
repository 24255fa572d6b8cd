#include "hemi/display/false_colours.hpp"

#include "display/false_colour_scale.hpp"
#include "display/legend.hpp"
#include "display/painted.hpp"
#include "display/picture_mesh.hpp"
#include "hemi/core/error.hpp"
#include "hemi/display/dots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace hemi {

namespace {

/// Lowest and highest value; nothing where there is none.
std::optional<std::array<double, 2>> extent_of(const std::vector<double>& values) {
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
    return low <= high ? std::optional(std::array{low, high}) : std::nullopt;
}

bool is_in_thousands(const FalseColours& shown, const ColourScale& scale) {
    constexpr double long_number = 1e4;
    return shown.unit == "W/m²" && std::max(std::abs(scale.low), std::abs(scale.high)) >= long_number;
}

} // namespace

ColourScale scale_of(const FalseColours& shown) {
    constexpr double decades = 1e-3; // what a logarithmic scale spans
    constexpr std::uint32_t most_bands = 32;
    if (shown.bands == 1 || shown.bands > most_bands) {
        throw InvalidArgument(
            fmt::format("false colours: {} band{}; must be 2 to {}, or 0 for smooth colours", shown.bands,
                        shown.bands == 1 ? "" : "s", most_bands),
            {"bands"});
    }
    const auto extent = extent_of(shown.values);
    ColourScale scale{0.0, 1.0, shown.logarithmic, shown.map, shown.bands, shown.iso_lines};
    if (shown.range) {
        scale.low = (*shown.range)[0];
        scale.high = (*shown.range)[1];
        if (!(scale.low < scale.high) || (shown.logarithmic && !(scale.low > 0.0))) {
            throw InvalidArgument(fmt::format("false colours: from {} to {}; the range must ascend{}",
                                              scale.low, scale.high,
                                              shown.logarithmic ? ", from above 0 where logarithmic" : ""),
                                  {"range"});
        }
        return scale;
    }
    if (!extent) {
        scale.low = shown.logarithmic ? decades : 0.0;
        return scale;
    }
    scale.low = (*extent)[0];
    scale.high = (*extent)[1];
    if (shown.logarithmic) {
        if (!(scale.high > 0.0)) {
            throw InvalidArgument("false colours: no value is above 0, which a logarithmic scale needs",
                                  {"log"});
        }
        scale.low = std::max(scale.low, decades * scale.high);
    } else if (shown.map == ColourMap::cool_warm) {
        scale.high = std::max(std::abs(scale.low), std::abs(scale.high));
        scale.low = -scale.high;
    }
    // Values that differ by what a solver leaves are one.
    const double least = 1e-9 * std::max(std::abs(scale.low), std::abs(scale.high));
    if (scale.high - scale.low <= least) {
        const double half = scale.high == 0.0 ? 0.5 : 0.01 * std::abs(scale.high);
        scale.low -= half;
        scale.high += half;
    }
    return scale;
}

std::string legend_title(const FalseColours& shown, const ColourScale& scale, const char* grey) {
    const bool has_none =
        std::any_of(shown.values.begin(), shown.values.end(), [](double value) { return std::isnan(value); });
    const std::string unit = (is_in_thousands(shown, scale) ? "k" : "") + shown.unit;
    return shown.title + (unit.empty() ? "" : "  [" + unit + "]") +
           (has_none ? fmt::format("; grey: {}", grey) : "");
}

ColourScale legend_scale(const FalseColours& shown, ColourScale scale) {
    if (is_in_thousands(shown, scale)) {
        scale.low /= 1000.0;
        scale.high /= 1000.0;
    }
    return scale;
}

std::array<bool, 2> values_beyond(const FalseColours& shown, const ColourScale& scale) {
    const auto extent = extent_of(shown.values);
    constexpr double rounding = 1e-9;
    const double slack = rounding * (scale.high - scale.low);
    return {extent && (*extent)[0] < scale.low - slack, extent && (*extent)[1] > scale.high + slack};
}

Picture draw_false_colours(const PatchMesh& mesh, const FalseColours& shown, const Camera& camera,
                           const PictureSettings& settings, const std::string& device, const Dots* dots) {
    if (shown.values.size() != mesh.size()) {
        throw InvalidArgument(
            fmt::format("false colours: {} values for {} patches", shown.values.size(), mesh.size()));
    }
    const ColourScale scale = scale_of(shown);
    const std::vector<double> dark(mesh.size(), 0.0);
    PictureSettings plain = settings;
    plain.shading = Shading::flat;
    plain.tone_mapping = ToneMapping::linear;
    plain.exposure = 1.0;
    plain.iso_lines = iso_positions(scale);
    const SmoothSurfaces surfaces(mesh);
    PictureMesh drawn = painted(make_picture_mesh(mesh, surfaces, 1, dark, {}, {0, 0, 0}),
                                value_colours(shown.values, scale, mesh));
    if (scale.lines) {
        put_iso_values(drawn, mesh, shown.across_materials ? SmoothSurfaces(mesh, true) : surfaces,
                       shown.values, scale);
    }
    drawn = with_images(std::move(drawn), mesh);
    if (dots != nullptr) {
        drawn = with_dots(std::move(drawn), *dots, plain);
    }
    Picture picture = draw_picture(drawn, camera, plain, device);
    if (shown.legend) {
        draw_legend(picture, legend_scale(shown, scale), legend_title(shown, scale, "not known"),
                    values_beyond(shown, scale));
    }
    if (dots != nullptr) {
        draw_dots_legend(picture, *dots, shown.legend ? 1 : 0);
    }
    return picture;
}

} // namespace hemi
