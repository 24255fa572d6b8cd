#include "io/scenes/json_materials.hpp"

#include "hemi/core/nearest_word.hpp"
#include "io/formats/text_scan.hpp"
#include "io/scenes/json_thermal.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>

namespace hemi::io {

namespace {

const double up_to_one = std::nextafter(1.0, 2.0);
constexpr double room_temperature = 300.0; // where emissivity is by temperature, and none is given

double channel_value(const JsonNode& node, double below) {
    const double value = node.number();
    if (!(value >= 0.0 && value < below)) {
        node.fail(below <= up_to_one ? fmt::format("{}; must be at least 0 and {} 1", value,
                                                   below > 1.0 ? "at most" : "below")
                                     : fmt::format("{}; must not be negative", value));
    }
    return value;
}

Material read_material(const JsonNode& node, const std::string& name,
                       const std::vector<std::string>& channels, bool adiabatic) {
    node.check_keys({"reflectance", "emissivity", "exitance"});
    Material material{name, {}, std::vector<double>(channels.size(), 0.0)};
    if (node.has("emissivity")) {
        if (node.has("reflectance")) {
            node.fail("both \"emissivity\" and \"reflectance\", which is 1 - emissivity; must have one of "
                      "them");
        }
        const JsonNode emissivity = node.member("emissivity");
        if (is_emissivity_table(emissivity.value())) {
            material.emissivity_table = read_emissivity_table(emissivity);
            material.reflectance.assign(channels.size(),
                                        1.0 - emissivity_at(material.emissivity_table, room_temperature));
        } else {
            for (const double value : read_emissivity(emissivity, channels)) {
                material.reflectance.push_back(1.0 - value);
            }
        }
    } else {
        material.reflectance =
            channel_values(node.member("reflectance"), channels, adiabatic ? up_to_one : 1.0);
    }
    if (node.has("exitance")) {
        material.exitance =
            channel_values(node.member("exitance"), channels, std::numeric_limits<double>::infinity());
    }
    return material;
}

} // namespace

std::vector<double> channel_values(const JsonNode& node, const std::vector<std::string>& channels,
                                   double below) {
    if (!node.value().is_array()) {
        return std::vector<double>(channels.size(), channel_value(node, below));
    }
    if (node.size() != channels.size()) {
        node.fail(fmt::format("{} values; must be one for all channels, or {} ({})", node.size(),
                              channels.size(), fmt::join(channels, ", ")));
    }
    std::vector<double> values;
    for (std::size_t k = 0; k < node.size(); ++k) {
        values.push_back(channel_value(node.element(k), below));
    }
    return values;
}

JsonMaterials::JsonMaterials(const JsonNode& scene, const std::vector<std::string>& channels, bool adiabatic)
    : channels_(channels) {
    if (!scene.has("materials")) {
        return;
    }
    const JsonNode all = scene.member("materials");
    all.check_object();
    for (const auto& [name, ignored] : all.value().items()) {
        indices_.emplace(name, static_cast<std::uint32_t>(materials_.size()));
        materials_.push_back(read_material(all.member(name), name, channels, adiabatic));
        own_.push_back(name);
    }
}

std::uint32_t JsonMaterials::index(const JsonNode& node) const {
    const std::string name = node.text();
    const auto found = indices_.find(name);
    if (found == indices_.end() || found->second >= own_.size()) {
        node.fail(fmt::format("unknown material {}{}", in_quotes(name), did_you_mean_or_list(name, own_)));
    }
    return found->second;
}

std::uint32_t JsonMaterials::add(const JsonNode& node, const std::string& name,
                                 const std::optional<MtlMaterial>& found) {
    Material material{name, std::vector<double>(channels_.size(), 0.5),
                      std::vector<double>(channels_.size(), 0.0)};
    const auto [entry, is_new] = indices_.emplace(name, static_cast<std::uint32_t>(materials_.size()));
    if (!is_new && entry->second < own_.size()) {
        return entry->second;
    }
    if (found) {
        material.reflectance = spread(node, *found, found->reflectance);
        material.exitance = spread(node, *found, found->exitance);
    }
    if (is_new) {
        materials_.push_back(std::move(material));
    } else if (!(materials_[entry->second] == material)) {
        node.fail(
            fmt::format("material {} has other values in an earlier mesh; define it in \"materials\", which "
                        "counts before MTL files",
                        in_quotes(name)));
    }
    return entry->second;
}

std::vector<double> JsonMaterials::spread(const JsonNode& node, const MtlMaterial& material,
                                          const std::array<double, 3>& values) const {
    if (channels_.size() == values.size()) {
        return {values.begin(), values.end()};
    }
    if (values[0] != values[1] || values[1] != values[2]) {
        node.fail(fmt::format("material {} of {} has three values ({}); the scene has {} channels ({})",
                              in_quotes(material.name), material.place, fmt::join(values, ", "),
                              channels_.size(), fmt::join(channels_, ", ")));
    }
    return std::vector<double>(channels_.size(), values[0]);
}

} // namespace hemi::io
