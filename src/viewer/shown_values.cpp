#include "viewer/shown_values.hpp"

#include "hemi/scene/light_unit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemi::viewer {

ShownValues shown_values(const Document& document, const Look& look, const std::optional<Field>& field) {
    if (field) {
        ShownValues result{field->shown.values, field->shown.title, field->shown.unit,
                           std::string(name_of(look.shown).word)};
        if (look.shown.view == View::row || look.shown.view == View::column) { // grey are those that are 0
            std::replace_if(
                result.values.begin(), result.values.end(), [](double value) { return std::isnan(value); },
                0.0);
        }
        return result;
    }
    const ViewerInput& input = document.input();
    const Light& light = document.light();
    const std::uint32_t channels = input.channels();
    ShownValues result{std::vector<double>(input.mesh->size(), std::numeric_limits<double>::quiet_NaN()),
                       channels > 1 ? "radiosity, mean of the channels" : "radiosity",
                       flux_density_unit(*input.scene), "radiosity"};
    for (std::uint32_t i = 0; i < input.mesh->size(); ++i) {
        if (light.knows(i)) {
            double sum = 0.0;
            for (std::uint32_t c = 0; c < channels; ++c) {
                sum += light.radiosity[std::size_t{i} * channels + c];
            }
            result.values[i] = sum / channels;
        }
    }
    return result;
}

} // namespace hemi::viewer
