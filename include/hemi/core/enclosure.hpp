#pragma once

#include "hemi/core/names.hpp"

namespace hemi {

/// Whether all that leaves a patch arrives at another.
enum class Enclosure {
    automatic, ///< as the rows show
    closed,    ///< yes; what a row lacks is a leak
    open,      ///< no; what a row lacks is the environment's share
};

/// Words of Enclosure.
template <>
struct Names<Enclosure> {
    /// Every value with its word.
    static constexpr NamedValue<Enclosure> table[] = {
        {Enclosure::automatic, "auto"}, {Enclosure::closed, "closed"}, {Enclosure::open, "open"}};
};

} // namespace hemi
