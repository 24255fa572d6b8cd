#pragma once

#include "hemi/core/names.hpp"

namespace hemi {

/// Units of length that scenes are in.
enum class LengthUnit {
    metre,      ///< the unit where none is given
    centimetre, ///< 0.01 m
    millimetre, ///< 0.001 m
    inch,       ///< 0.0254 m
    foot,       ///< 0.3048 m
};

/// Words of LengthUnit.
template <>
struct Names<LengthUnit> {
    /// Every value with its word.
    static constexpr NamedValue<LengthUnit> table[] = {{LengthUnit::metre, "m"},
                                                       {LengthUnit::centimetre, "cm"},
                                                       {LengthUnit::millimetre, "mm"},
                                                       {LengthUnit::inch, "in"},
                                                       {LengthUnit::foot, "ft"}};
};

/// Metres in a unit.
[[nodiscard]] constexpr double metres(LengthUnit unit) {
    switch (unit) {
    case LengthUnit::centimetre:
        return 0.01;
    case LengthUnit::millimetre:
        return 0.001;
    case LengthUnit::inch:
        return 0.0254;
    case LengthUnit::foot:
        return 0.3048;
    case LengthUnit::metre:
        break;
    }
    return 1.0;
}

} // namespace hemi
