#include "io/scenes/json_daylight.hpp"

#include "hemi/core/black_body.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/core/text.hpp"
#include "hemi/scene/sun.hpp"
#include "io/formats/text_scan.hpp"
#include "io/scenes/json_materials.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

namespace hemi::io {

namespace {

constexpr double any_value = std::numeric_limits<double>::infinity();
constexpr double sun_temperature = 5772.0; // K. Source: IAU 2015 resolution B3.

/// Irradiance or illuminance; one number for several bands is shared out as the sun's spectrum is.
std::vector<double> read_light(const JsonNode& node, const std::string& quantity, Scene& scene) {
    const std::string watts = quantity + "_irradiance";
    const std::string lux = quantity + "_illuminance";
    if (node.has(watts) == node.has(lux)) {
        node.fail(fmt::format("{} \"{}\" (W/m²) {} \"{}\" (lx); must have one of them",
                              node.has(lux) ? "both" : "neither", watts, node.has(lux) ? "and" : "nor", lux));
    }
    scene.photometric = scene.photometric || node.has(lux);
    const JsonNode value = node.member(node.has(lux) ? lux : watts);
    std::vector<double> light = channel_values(value, scene.channels, any_value);
    if (!value.value().is_array() && scene.thermal && !scene.thermal->band_limits.empty()) {
        const std::vector<double> shares = band_fractions(sun_temperature, scene.thermal->band_limits);
        for (std::size_t k = 0; k < light.size(); ++k) {
            light[k] *= shares[k];
        }
    }
    return light;
}

double read_angle(const JsonNode& node, double largest) {
    const double degrees = node.number();
    if (!(std::abs(degrees) <= largest)) {
        node.fail(fmt::format("{}; must be in [-{}, {}] degrees", degrees, largest, largest));
    }
    return degrees;
}

/// Which of the ways to say where the sun is was taken: the first key of it.
std::string way_of(const JsonNode& node) {
    const std::vector<std::vector<std::string>> ways{
        {"direction"}, {"azimuth", "elevation"}, {"latitude", "longitude", "time"}};
    std::string found;
    for (const std::vector<std::string>& keys : ways) {
        for (const std::string& key : keys) {
            if (!node.has(key)) {
                continue;
            }
            if (!found.empty() && found != keys.front()) {
                node.fail(fmt::format("both \"{}\" and \"{}\"; the sun's place is given by direction, by "
                                      "azimuth and elevation, or by latitude, longitude and time",
                                      found, key));
            }
            found = keys.front();
        }
    }
    if (found.empty()) {
        node.fail("nothing says where the sun is; must have a direction, azimuth and elevation, or latitude, "
                  "longitude and time");
    }
    return found;
}

std::vector<double> read_flux(const JsonNode& node, const std::vector<std::string>& channels) {
    std::vector<double> flux = channel_values(node, channels, any_value);
    if (std::all_of(flux.begin(), flux.end(), [](double value) { return value == 0.0; })) {
        node.fail("0 lm; must be above 0");
    }
    return flux;
}

} // namespace

void read_sun(const JsonNode& node, Scene& scene, Diagnostics& diagnostics) {
    node.check_keys({"direction", "azimuth", "elevation", "north", "latitude", "longitude", "time",
                     "diameter", "normal_irradiance", "normal_illuminance"});
    const std::string way = way_of(node);
    if (way == "direction" && node.has("north")) {
        node.fail("\"north\" turns an azimuth, and a direction has none; leave it out");
    }
    constexpr double whole = 360.0;
    constexpr double quarter = 90.0;
    const double north = node.has("north") ? read_angle(node.member("north"), whole) : 0.0;
    Sun sun;
    sun.irradiance = read_light(node, "normal", scene);
    if (node.has("diameter")) {
        const JsonNode diameter = node.member("diameter");
        sun.diameter = diameter.number();
        if (!(sun.diameter >= 0.0 && sun.diameter <= quarter)) {
            diameter.fail(
                fmt::format("{}; must be in [0, {}] degrees (the sun's is 0.53)", sun.diameter, quarter));
        }
    }
    if (way == "direction") {
        const JsonNode direction = node.member("direction");
        const Vec3 towards = direction.point();
        const double largest = std::max({std::abs(towards.x), std::abs(towards.y), std::abs(towards.z)});
        if (!(largest > 0.0 && std::isfinite(largest))) {
            direction.fail("a direction of length 0; must point to the sun");
        }
        sun.direction = glm::normalize(towards / largest);
    } else if (way == "azimuth") {
        const double azimuth = read_angle(node.member("azimuth"), whole);
        sun.direction =
            sky_direction(azimuth, read_angle(node.member("elevation"), quarter), north, scene.up);
    } else {
        SunPosition position;
        const JsonNode time = node.member("time");
        const double latitude = read_angle(node.member("latitude"), quarter);
        const double longitude = read_angle(node.member("longitude"), 0.5 * whole);
        try {
            position = sun_position(latitude, longitude, time.text());
        } catch (const InvalidArgument& error) {
            time.fail(error.what());
        }
        if (!(position.elevation > 0.0)) {
            diagnostics.warn(fmt::format("{}: the sun is {} degrees below the horizon and gives no light",
                                         time.path(), number_text(-position.elevation)));
            return;
        }
        sun.direction = sky_direction(position.azimuth, position.elevation, north, scene.up);
    }
    const double height = glm::dot(sun.direction, upwards(scene.up));
    if (way == "azimuth" && !(height > 0.0)) {
        diagnostics.warn(fmt::format("{}: the sun is {} degrees below the horizon and gives no light",
                                     node.path(),
                                     number_text(-std::asin(height) * 180.0 / std::numbers::pi)));
        return;
    }
    if (height < 0.0) {
        diagnostics.warn(fmt::format("{}: the sun shines from below the horizon", node.path()));
    }
    scene.sun = std::move(sun);
}

void read_sky(const JsonNode& environment, Scene& scene) {
    if (std::none_of(sky_keys.begin(), sky_keys.end(),
                     [&](const std::string& key) { return environment.has(key); })) {
        return;
    }
    Sky sky;
    if (environment.has("sky")) {
        const JsonNode kind = environment.member("sky");
        const std::string word = kind.text();
        const auto distribution = from_word<SkyDistribution>(word);
        if (!distribution) {
            kind.fail(fmt::format("{}; must be one of {}", in_quotes(word),
                                  fmt::join(words<SkyDistribution>(), ", ")));
        }
        sky.distribution = *distribution;
    }
    sky.horizontal = read_light(environment, "horizontal", scene);
    sky.ground.assign(scene.channels.size(), 0.0);
    if (environment.has("ground")) {
        sky.ground = channel_values(environment.member("ground"), scene.channels, std::nextafter(1.0, 2.0));
    }
    scene.sky = std::move(sky);
}

void read_luminous_flux(const JsonNode& node, const std::vector<std::uint32_t>& surfaces, Scene& scene) {
    const JsonNode value = node.member("luminous_flux");
    const std::vector<double> flux = read_flux(value, scene.channels);
    const double unit = scene.unit.value_or(1.0);
    double area = 0.0;
    for (const std::uint32_t s : surfaces) {
        const Surface& surface = scene.surfaces[s];
        const Material& material = scene.materials[surface.material];
        if (std::any_of(material.exitance.begin(), material.exitance.end(),
                        [](double exitance) { return exitance > 0.0; })) {
            value.fail(fmt::format("the material {} has an exitance or a luminous flux already; one follows "
                                   "from the other, must have one of them",
                                   in_quotes(material.name)));
        }
        area += (surface.two_sided ? 2.0 : 1.0) * glm::length(area_vector(surface.polygon())) * unit * unit;
    }
    if (!(area > 0.0)) {
        value.fail("no area that could radiate; must be on surfaces");
    }
    // Materials that other surfaces have, too, stay dark for these.
    std::vector<bool> lit(scene.surfaces.size(), false);
    for (const std::uint32_t s : surfaces) {
        lit[s] = true;
    }
    std::set<std::uint32_t> shared;
    for (std::size_t s = 0; s < scene.surfaces.size(); ++s) {
        if (!lit[s]) {
            shared.insert(scene.surfaces[s].material);
        }
    }
    const auto shine = [&](Material& material) {
        for (std::size_t c = 0; c < flux.size(); ++c) {
            material.exitance[c] = flux[c] / area;
        }
    };
    std::map<std::uint32_t, std::uint32_t> shining; // by material
    for (const std::uint32_t s : surfaces) {
        Surface& surface = scene.surfaces[s];
        const bool copy = shared.contains(surface.material);
        const auto [entry, is_new] = shining.try_emplace(
            surface.material, copy ? static_cast<std::uint32_t>(scene.materials.size()) : surface.material);
        if (is_new && copy) {
            Material material = scene.materials[surface.material];
            material.name += fmt::format(" with {} lm", fmt::join(flux, ", "));
            scene.materials.push_back(std::move(material));
        }
        if (is_new) {
            shine(scene.materials[entry->second]);
        }
        surface.material = entry->second;
    }
    scene.photometric = true;
}

void check_units(const JsonNode& root, const Scene& scene) {
    if (!scene.photometric) {
        return;
    }
    const bool heat =
        scene.thermal && (!scene.thermal->conditions.empty() || !scene.thermal->band_limits.empty() ||
                          scene.thermal->environment_temperature);
    const auto has = [&](const char* node, const char* key) {
        return root.has(node) && root.value().at(node).contains(key);
    };
    const bool watts = has("sun", "normal_irradiance") || has("environment", "horizontal_irradiance");
    if (heat || watts) {
        root.fail(
            fmt::format("a scene in lumens (luminous_flux, *_illuminance) with {}; must be all in lumens "
                        "or all in watts",
                        watts ? "an irradiance in watts" : "temperatures, heat fluxes or bands"));
    }
}

} // namespace hemi::io
