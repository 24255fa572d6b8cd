#pragma once

#include "hemi/io/scene_writer.hpp"
#include "viewer/panels.hpp"
#include "viewer/script.hpp"

#include <string>
#include <vector>

namespace hemi::viewer {

/// Puts a script's values into the materials that are chosen.
/// @throws InvalidArgument where there is no such material, no form factors, or another number of channels
void apply_set(const SetCommand& set, const ViewerInput& input, Choices& choices);

/// What is no longer as the scene has it, temperatures apart.
struct MaterialChanges {
    std::vector<io::MaterialValues> materials;
    std::vector<double> environment; ///< empty: as it is
    std::string words;               ///< "reflectance of white, exitance of lamp"; empty: nothing
};
[[nodiscard]] MaterialChanges changed_materials(const Scene& scene, const Choices& choices);

} // namespace hemi::viewer
