#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/scene/scene.hpp"
#include "io/formats/json_node.hpp"

#include <cstdint>
#include <string>
#include <vector>

/// What a JSON scene says of sun, sky and lumens.
namespace hemi::io {

/// Keys of "environment" that are about the sky.
inline const std::vector<std::string> sky_keys{"sky", "horizontal_irradiance", "horizontal_illuminance",
                                               "ground"};

/// Reads "sun" into the scene, whose channels and bands are known. Below the horizon by place and time it
/// gives no light, with a warning.
void read_sun(const JsonNode& node, Scene& scene, Diagnostics& diagnostics);

/// Reads what "environment" says of the sky, if anything.
void read_sky(const JsonNode& environment, Scene& scene);

/// Gives surfaces an exitance by the flux that they have together.
/// @param node      a surface or a group with "luminous_flux"
/// @param surfaces  indices
void read_luminous_flux(const JsonNode& node, const std::vector<std::uint32_t>& surfaces, Scene& scene);

/// Whether a scene has lumens and watts.
/// @throws InputError at `root` if it does
void check_units(const JsonNode& root, const Scene& scene);

} // namespace hemi::io
