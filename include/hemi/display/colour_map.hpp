#pragma once

#include "hemi/core/names.hpp"

namespace hemi {

/// Colours that numbers are shown in, from the lowest to the highest.
enum class ColourMap {
    viridis,   ///< violet, blue, green, yellow: brighter all the way, for every kind of eyes
    inferno,   ///< black, violet, red, yellow, pale: brighter all the way
    turbo,     ///< blue, green, yellow, red: more steps can be told, but not by every eye
    cool_warm, ///< blue, grey, red: for values on both sides of zero, which is grey
    grey,      ///< black to white
};

/// Words of ColourMap.
template <>
struct Names<ColourMap> {
    /// Every value with its word.
    static constexpr NamedValue<ColourMap> table[] = {{ColourMap::viridis, "viridis"},
                                                      {ColourMap::inferno, "inferno"},
                                                      {ColourMap::turbo, "turbo"},
                                                      {ColourMap::cool_warm, "cool-warm"},
                                                      {ColourMap::grey, "grey"}};
};

} // namespace hemi
