#pragma once

#include "viewer/document.hpp"
#include "viewer/look.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hemi::viewer {

/// One value a patch of what is shown, whether in false colours or not.
struct ShownValues {
    std::vector<double> values; ///< N; not a number where there is none
    std::string title;
    std::string unit;
    std::string word; ///< in scripts
};

/// @param field  what is shown in false colours; none: the radiosity, of the channels' mean
[[nodiscard]] ShownValues shown_values(const Document& document, const Look& look,
                                       const std::optional<Field>& field);

} // namespace hemi::viewer
