#pragma once

#include "display/colour_scale.hpp"
#include "hemi/display/false_colours.hpp"

#include <string>

namespace hemi {

/// The scale that values are drawn by: from the lowest to the highest, or as was asked for; about a single
/// value, where there is no other.
/// @throws InvalidArgument for infinite values and a range that cannot be
[[nodiscard]] ColourScale scale_of(const FalseColours& shown);

/// What stands over it: title, unit of legend_scale(), and what grey is where some patch has no value.
/// @param grey  "not known"
[[nodiscard]] std::string legend_title(const FalseColours& shown, const ColourScale& scale, const char* grey);

/// The scale as its legend tells it: in kW/m² where there are 10,000 W/m² or more, so that numbers are short.
[[nodiscard]] ColourScale legend_scale(const FalseColours& shown, ColourScale scale);

/// Whether values lie below and above the scale.
[[nodiscard]] std::array<bool, 2> values_beyond(const FalseColours& shown, const ColourScale& scale);

} // namespace hemi
