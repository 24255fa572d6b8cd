#pragma once

#include "hemi/scene/scene.hpp"

#include <nlohmann/json.hpp>

#include <string>

namespace hemi::test {

/// A scene as hemi's JSON, every surface a polygon with its own patches, to the last bit.
inline nlohmann::json scene_json(const Scene& scene) {
    nlohmann::json json{{"hemi", 1}, {"channels", scene.channels}};
    for (const Material& material : scene.materials) {
        json["materials"][material.name] = {{"reflectance", material.reflectance},
                                            {"exitance", material.exitance}};
    }
    for (const Surface& surface : scene.surfaces) {
        nlohmann::json entry{{"name", scene.groups[surface.group]},
                             {"material", scene.materials[surface.material].name},
                             {"two_sided", surface.two_sided}};
        for (const Vec3& vertex : surface.polygon()) {
            entry["polygon"].push_back({vertex.x, vertex.y, vertex.z});
        }
        if (surface.patches) {
            entry["patches"] = {surface.patches->u, surface.patches->v};
        }
        json["surfaces"].push_back(entry);
    }
    if (scene.patch_size) {
        json["patch_size"] = *scene.patch_size;
    }
    if (!scene.environment.empty()) {
        json["environment"] = {{"exitance", scene.environment}};
    }
    constexpr const char* enclosures[]{"auto", "closed", "open"};
    json["enclosure"] = enclosures[static_cast<int>(scene.enclosure)];
    return json;
}

} // namespace hemi::test
