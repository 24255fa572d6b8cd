#pragma once

#include "hemi/scene/scene.hpp"
#include "io/formats/json_node.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// What a JSON scene says of temperatures and heat.
namespace hemi::io {

/// Keys of a surface or a group that say it.
inline const std::vector<std::string> heat_keys{"temperature", "heat_flux", "power", "isothermal"};

/// Kelvin, from a number or a text with a unit.
[[nodiscard]] double read_temperature(const JsonNode& node);

/// Emissivities, each above 0 and at most 1: one value a channel, from a number (stands for all) or an array.
[[nodiscard]] std::vector<double> read_emissivity(const JsonNode& node,
                                                  const std::vector<std::string>& channels);
/// Whether it is a table [[T, eps], ...] by temperature.
[[nodiscard]] bool is_emissivity_table(const Json& value);
[[nodiscard]] std::vector<std::array<double, 2>> read_emissivity_table(const JsonNode& node);

/// Metres in a unit: m, cm, mm, in or ft.
[[nodiscard]] double read_unit(const JsonNode& node);

/// Wavelengths, µm, ascending.
[[nodiscard]] std::vector<double> read_band_limits(const JsonNode& node);

/// What the heat keys of a surface or a group say; nothing where there are none.
[[nodiscard]] std::optional<HeatCondition> read_heat(const JsonNode& node);

/// Adds conditions and luminous fluxes by the "groups" of the scene to its surfaces.
/// @throws InputError for unknown groups, with the nearest, and for surfaces that have one of their own
void read_groups(const JsonNode& groups, Scene& scene);

/// The conditions of a scene, made where there are none.
[[nodiscard]] Thermal& thermal_of(Scene& scene);

} // namespace hemi::io
