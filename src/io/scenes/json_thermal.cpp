#include "io/scenes/json_thermal.hpp"

#include "hemi/core/black_body.hpp"
#include "hemi/core/length_unit.hpp"
#include "hemi/core/nearest_word.hpp"
#include "io/formats/text_scan.hpp"
#include "io/scenes/json_daylight.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace hemi::io {

namespace {

/// Keys of a group.
const std::vector<std::string> group_keys{"temperature", "heat_flux", "power", "isothermal", "luminous_flux"};

double emissivity_value(const JsonNode& node) {
    const double value = node.number();
    if (!(value > 0.0 && value <= 1.0)) {
        node.fail(fmt::format("{}; must be above 0 and at most 1", value));
    }
    return value;
}

} // namespace

double read_temperature(const JsonNode& node) {
    double kelvin = 0.0;
    if (node.value().is_string()) {
        const std::string text = node.text();
        const auto value = parse_temperature(text);
        if (!value) {
            node.fail(
                fmt::format("{}; must be kelvin, or a text such as \"20 C\" or \"300 K\"", in_quotes(text)));
        }
        kelvin = *value;
    } else if (node.value().is_number()) {
        kelvin = node.number();
    } else {
        node.expect("kelvin, or a text such as \"20 C\"");
    }
    if (kelvin < 0.0) {
        node.fail(fmt::format("{} K; must not be below 0 K", kelvin));
    }
    return kelvin;
}

std::vector<double> read_emissivity(const JsonNode& node, const std::vector<std::string>& channels) {
    if (!node.value().is_array()) {
        return std::vector<double>(channels.size(), emissivity_value(node));
    }
    if (node.size() != channels.size()) {
        node.fail(fmt::format("{} values; must be one for all channels, or {} ({})", node.size(),
                              channels.size(), fmt::join(channels, ", ")));
    }
    std::vector<double> values;
    for (std::size_t k = 0; k < node.size(); ++k) {
        values.push_back(emissivity_value(node.element(k)));
    }
    return values;
}

bool is_emissivity_table(const Json& value) {
    return value.is_array() && !value.empty() && value[0].is_array();
}

std::vector<std::array<double, 2>> read_emissivity_table(const JsonNode& node) {
    std::vector<std::array<double, 2>> table;
    for (std::size_t k = 0; k < node.size(); ++k) {
        const JsonNode pair = node.element(k);
        if (pair.size() != 2) {
            pair.expect("[temperature, emissivity]");
        }
        const double kelvin = read_temperature(pair.element(0));
        if (!table.empty() && !(kelvin > table.back()[0])) {
            pair.fail(fmt::format("{} K after {} K; temperatures must ascend", kelvin, table.back()[0]));
        }
        table.push_back({kelvin, emissivity_value(pair.element(1))});
    }
    return table;
}

double read_unit(const JsonNode& node) {
    const std::string name = node.text();
    const auto unit = from_word<LengthUnit>(name);
    if (!unit) {
        node.fail(
            fmt::format("{}; must be one of {}", in_quotes(name), fmt::join(words<LengthUnit>(), ", ")));
    }
    return metres(*unit);
}

std::vector<double> read_band_limits(const JsonNode& node) {
    std::vector<double> limits;
    for (std::size_t k = 0; k < node.size(); ++k) {
        const double limit = node.element(k).positive();
        if (!limits.empty() && !(limit > limits.back())) {
            node.element(k).fail(
                fmt::format("{} after {}; limits of bands (µm) must ascend", limit, limits.back()));
        }
        limits.push_back(limit);
    }
    return limits;
}

std::optional<HeatCondition> read_heat(const JsonNode& node) {
    HeatCondition condition;
    std::vector<std::string> given;
    for (const std::string& key : heat_keys) {
        if (node.has(key) && key != "isothermal") {
            given.push_back(key);
        }
    }
    condition.isothermal = node.has("isothermal") && node.member("isothermal").boolean();
    if (given.size() > 1) {
        node.fail(fmt::format("both \"{}\" and \"{}\"; one follows from the other, must have one of them",
                              given[0], given[1]));
    }
    if (given.empty()) {
        if (condition.isothermal) {
            node.fail("\"isothermal\" without \"power\" or \"heat_flux\", by which the temperature is found");
        }
        return std::nullopt;
    }
    const JsonNode value = node.member(given[0]);
    if (given[0] == "temperature") {
        if (condition.isothermal) {
            node.fail(
                "\"isothermal\" beside \"temperature\", which is one for all already; it is for \"power\" "
                "or \"heat_flux\"");
        }
        condition.temperature = read_temperature(value);
    } else {
        (given[0] == "power" ? condition.power : condition.heat_flux) = value.number();
    }
    return condition;
}

void read_groups(const JsonNode& groups, Scene& scene) {
    groups.check_object();
    for (const auto& [name, ignored] : groups.value().items()) {
        const JsonNode group = groups.member(name);
        group.check_keys(group_keys);
        const auto found = std::find(scene.groups.begin(), scene.groups.end(), name);
        if (found == scene.groups.end()) {
            groups.fail(
                fmt::format("unknown group {}{}", in_quotes(name), did_you_mean_or_list(name, scene.groups)));
        }
        if (group.has("luminous_flux")) {
            std::vector<std::uint32_t> surfaces;
            for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
                if (scene.surfaces[s].group == found - scene.groups.begin()) {
                    surfaces.push_back(s);
                }
            }
            read_luminous_flux(group, surfaces, scene);
        }
        const std::optional<HeatCondition> condition = read_heat(group);
        if (!condition) {
            continue;
        }
        Thermal& thermal = thermal_of(scene);
        const auto index = static_cast<std::uint32_t>(thermal.conditions.size());
        thermal.conditions.push_back(*condition);
        for (Surface& surface : scene.surfaces) {
            if (surface.group == found - scene.groups.begin()) {
                if (surface.heat != no_heat) {
                    group.fail("a surface of this group has a temperature, heat flux or power of its own; "
                               "leave one out");
                }
                surface.heat = index;
            }
        }
    }
}

Thermal& thermal_of(Scene& scene) {
    return scene.thermal ? *scene.thermal : scene.thermal.emplace();
}

} // namespace hemi::io
