#include "viewer/material_change.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hemi::viewer {

namespace {

/// Of all conditions of a group that have a temperature.
void set_temperature(const SetCommand& set, const ViewerInput& input, Choices& choices) {
    if (set.values.size() != 1) {
        throw InvalidArgument(fmt::format("set: {} temperatures; must be one", set.values.size()));
    }
    const PatchMesh& mesh = *input.mesh;
    bool found = false;
    const bool known = input.heat != nullptr && input.heat->condition_of.size() == mesh.size();
    for (std::uint32_t i = 0; i < mesh.size() && known; ++i) {
        const std::uint32_t condition = input.heat->condition_of[i];
        if (mesh.groups()[mesh.group(i)] == set.name && condition != no_heat &&
            choices.conditions[condition].temperature) {
            choices.conditions[condition].temperature = set.values[0];
            found = true;
        }
    }
    if (!found) {
        throw InvalidArgument(fmt::format("set: no group \"{}\" has a temperature", set.name));
    }
}

} // namespace

void apply_set(const SetCommand& set, const ViewerInput& input, Choices& choices) {
    if (input.factors == nullptr) {
        throw InvalidArgument("set: there are no form factors; open the scene, and let it be solved");
    }
    if (set.property == SetCommand::Property::temperature) {
        set_temperature(set, input, choices);
        return;
    }
    const auto put = [&set](std::vector<double>& values) {
        if (set.values.size() != 1 && set.values.size() != values.size()) {
            throw InvalidArgument(
                fmt::format("set: {} values for {} channels", set.values.size(), values.size()));
        }
        for (std::size_t c = 0; c < values.size(); ++c) {
            values[c] = set.values[set.values.size() == 1 ? 0 : c];
        }
    };
    if (set.property == SetCommand::Property::environment) {
        put(choices.environment);
        return;
    }
    const auto found = std::find_if(choices.materials.begin(), choices.materials.end(),
                                    [&set](const Material& material) { return material.name == set.name; });
    if (found == choices.materials.end()) {
        throw InvalidArgument(fmt::format("set: the scene has no material \"{}\"", set.name));
    }
    put(set.property == SetCommand::Property::exitance ? found->exitance : found->reflectance);
}

MaterialChanges changed_materials(const Scene& scene, const Choices& choices) {
    MaterialChanges changes;
    const auto tell = [&changes](const std::string& what) {
        changes.words += (changes.words.empty() ? "" : ", ") + what;
    };
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        const Material& now = choices.materials[m];
        io::MaterialValues values{now.name, {}, {}};
        if (now.reflectance != scene.materials[m].reflectance) {
            values.reflectance = now.reflectance;
            tell("reflectance of " + now.name);
        }
        if (now.exitance != scene.materials[m].exitance) {
            values.exitance = now.exitance;
            tell("exitance of " + now.name);
        }
        if (!values.reflectance.empty() || !values.exitance.empty()) {
            changes.materials.push_back(std::move(values));
        }
    }
    const std::vector<double> dark(scene.channels.size(), 0.0);
    if (choices.environment != (scene.environment.empty() ? dark : scene.environment)) {
        changes.environment = choices.environment;
        tell("exitance of the environment");
    }
    return changes;
}

} // namespace hemi::viewer
