#include "hemi/scene/thermal_exitance.hpp"

#include "hemi/core/black_body.hpp"
#include "hemi/core/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace hemi {

namespace {

/// Adds a black body's exitance, times an emissivity a channel, in every band its share; all of it in every
/// channel of scenes without bands.
void add_exitance(std::vector<double>& exitance, const std::vector<double>& emissivity, double kelvin,
                  const std::vector<double>& limits) {
    const std::vector<double> shares = band_fractions(kelvin, limits);
    for (std::size_t c = 0; c < exitance.size(); ++c) {
        exitance[c] += emissivity[c] * (limits.empty() ? 1.0 : shares[c]) * black_body_exitance(kelvin);
    }
}

Material radiating(Material material, double kelvin, const std::vector<double>& limits) {
    if (!material.emissivity_table.empty()) {
        for (double& reflectance : material.reflectance) {
            reflectance = 1.0 - emissivity_at(material.emissivity_table, kelvin);
        }
    }
    std::vector<double> emissivity;
    for (const double reflectance : material.reflectance) {
        emissivity.push_back(1.0 - reflectance);
    }
    add_exitance(material.exitance, emissivity, kelvin, limits);
    material.name += fmt::format(" at {} K", number_text(kelvin));
    return material;
}

} // namespace

void radiate_by_temperature(Scene& scene, Diagnostics& diagnostics) {
    if (!scene.thermal) {
        return;
    }
    const Thermal thermal = std::move(*scene.thermal);
    scene.thermal.reset();
    std::map<std::pair<std::uint32_t, double>, std::uint32_t> hot; // by material and temperature
    std::set<std::uint32_t> unsolved;
    for (Surface& surface : scene.surfaces) {
        if (surface.heat == no_heat) {
            continue;
        }
        const auto kelvin = thermal.conditions[surface.heat].temperature;
        surface.heat = no_heat;
        if (!kelvin) {
            unsolved.insert(surface.group);
            continue;
        }
        const auto [entry, is_new] =
            hot.try_emplace({surface.material, *kelvin}, static_cast<std::uint32_t>(scene.materials.size()));
        if (is_new) {
            scene.materials.push_back(
                radiating(scene.materials[surface.material], *kelvin, thermal.band_limits));
        }
        surface.material = entry->second;
    }
    if (thermal.environment_temperature) {
        add_exitance(scene.environment, std::vector<double>(scene.environment.size(), 1.0),
                     *thermal.environment_temperature, thermal.band_limits);
    }
    if (!unsolved.empty()) {
        diagnostics.warn(
            fmt::format("{} with a heat flux or power (such as {}) absorb{} and radiate{} nothing "
                        "here; `hemi heat` solves for temperatures",
                        plural(unsolved.size(), "group", "groups"), scene.groups[*unsolved.begin()],
                        unsolved.size() == 1 ? "s" : "", unsolved.size() == 1 ? "s" : ""));
    }
}

std::vector<double> reflectances_at(const PatchMesh& mesh, std::span<const Material> materials,
                                    std::span<const double> temperature) {
    std::vector<double> values = patch_values(mesh, materials, &Material::reflectance);
    for (std::uint32_t i = 0; i < mesh.size() && i < temperature.size(); ++i) {
        const Material& material = materials[mesh.material(i)];
        if (!material.emissivity_table.empty() && std::isfinite(temperature[i])) {
            const std::size_t channels = material.reflectance.size();
            std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(i * channels), channels,
                        1.0 - emissivity_at(material.emissivity_table, temperature[i]));
        }
    }
    return values;
}

} // namespace hemi
