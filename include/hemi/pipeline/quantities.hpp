#pragma once

#include "hemi/core/names.hpp"
#include "hemi/display/false_colours.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"
#include "hemi/solver/solution.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hemi {

/// What is known of every patch of a solution, to be shown in false colours.
enum class Quantity {
    radiosity,        ///< W/m²
    irradiance,       ///< W/m², or lx
    direct,           ///< irradiance that comes straight from sun and sky
    exitance,         ///< W/m²
    reflectance,      ///< share
    emissivity,       ///< share: 1 - reflectance
    environment,      ///< share of what a patch sees that is environment: the sky view factor, under a sky
    blocked,          ///< share that is backs of one-sided surfaces
    row_error,        ///< by which what a patch sees is not 1
    error,            ///< estimated, of the radiosity, W/m²
    error_factors,    ///< the part of it that comes from the form factors
    error_patch_size, ///< the part that comes from the patches' size
    area,             ///< m²
    temperature,      ///< K, where heat was solved for
    net_flux,         ///< of radiation, leaving positive, W/m², likewise
};

/// Words of Quantity.
template <>
struct Names<Quantity> {
    /// Every value with its word.
    static constexpr NamedValue<Quantity> table[] = {{Quantity::radiosity, "radiosity"},
                                                     {Quantity::irradiance, "irradiance"},
                                                     {Quantity::direct, "direct"},
                                                     {Quantity::exitance, "exitance"},
                                                     {Quantity::reflectance, "reflectance"},
                                                     {Quantity::emissivity, "emissivity"},
                                                     {Quantity::environment, "environment"},
                                                     {Quantity::blocked, "blocked"},
                                                     {Quantity::row_error, "row-error"},
                                                     {Quantity::error, "error"},
                                                     {Quantity::error_factors, "error-factors"},
                                                     {Quantity::error_patch_size, "error-patch-size"},
                                                     {Quantity::area, "area"},
                                                     {Quantity::temperature, "temperature"},
                                                     {Quantity::net_flux, "flux"}};
};

/// What a quantity is called.
[[nodiscard]] const char* title_of(Quantity quantity);

/// Whether a quantity needs the rows of all patches, not only of those that light comes from.
[[nodiscard]] bool needs_all_rows(Quantity quantity);

/// Whether a quantity is an estimated error.
[[nodiscard]] bool is_error(Quantity quantity);

/// Whether a quantity is found by solve_heat() alone.
[[nodiscard]] bool is_of_heat(Quantity quantity);

/// Temperatures in °C in place of K; other quantities stay as they are. Before a range is set.
void show_in_celsius(FalseColours& shown);

/// Refuses what patch_quantity() cannot take for a channel.
/// @throws InvalidArgument
void check_channel(const std::vector<std::string>& channels, const std::string& channel);

/// A quantity of every patch. Of several channels there is one value: that of a named channel, the "sum", the
/// "luminance" (0.2126 red + 0.7152 green + 0.0722 blue, IEC 61966-2-1; of channels with these names), or, by
/// "mean", the mean. Patches under other geometry, and such whose row was not computed, have none. The range
/// of radiosities is that of surfaces without exitance, where there are such and any with one is brighter;
/// that of radiosities and irradiances that are the same everywhere, within 1e-4, lies 1 % about them.
/// @param quantity  which one
/// @param scene     gives channels and materials
/// @param mesh      N patches
/// @param solution  of the mesh, with its exitance
/// @param channel   a name of scene.channels, "mean", "sum" or "luminance"
/// @throws InvalidArgument where the solution does not have it, and for an unknown channel
[[nodiscard]] FalseColours patch_quantity(Quantity quantity, const Scene& scene, const PatchMesh& mesh,
                                          const Solution& solution, const std::string& channel = "mean");

} // namespace hemi
