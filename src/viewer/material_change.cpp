#include "viewer/material_change.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::viewer {

void apply_set(const SetCommand& set, const ViewerInput& input, Choices& choices) {
    if (input.factors == nullptr) {
        throw InvalidArgument("set: there are no form factors; open the scene, and let it be solved");
    }
    const auto found =
        std::find_if(choices.materials.begin(), choices.materials.end(),
                     [&set](const Material& material) { return material.name == set.material; });
    if (found == choices.materials.end()) {
        throw InvalidArgument(fmt::format("set: the scene has no material \"{}\"", set.material));
    }
    std::vector<double>& values = set.exitance ? found->exitance : found->reflectance;
    if (set.values.size() != 1 && set.values.size() != values.size()) {
        throw InvalidArgument(
            fmt::format("set: {} values for {} channels", set.values.size(), values.size()));
    }
    for (std::size_t c = 0; c < values.size(); ++c) {
        values[c] = set.values[set.values.size() == 1 ? 0 : c];
    }
}

} // namespace hemi::viewer
