#pragma once

#include "hemi/scene/scene.hpp"
#include "io/formats/json_node.hpp"
#include "io/scenes/mtl_reader.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace hemi::io {

/// The materials of a JSON scene: its own, and those that the MTL files of its meshes add.
class JsonMaterials {
public:
    /// Reads the scene's own ("materials" may be missing).
    /// @param channels   must outlive this
    /// @param adiabatic  whether reflectances of 1 are allowed
    JsonMaterials(const JsonNode& scene, const std::vector<std::string>& channels, bool adiabatic);

    /// Index of one of the scene's own. @throws InputError at `node` for an unknown name, with the nearest.
    [[nodiscard]] std::uint32_t index(const JsonNode& node) const;

    /// Index of a material that a mesh uses: the scene's own of that name, else what the MTL file says.
    /// @throws InputError at `node` if two MTL files mean different things by the name, or three values are
    /// to
    ///   be put into another number of channels.
    std::uint32_t add(const JsonNode& node, const std::string& name, const std::optional<MtlMaterial>& found);

    [[nodiscard]] std::vector<Material> take() { return std::move(materials_); }

private:
    [[nodiscard]] std::vector<double> spread(const JsonNode& node, const MtlMaterial& material,
                                             const std::array<double, 3>& values) const;

    const std::vector<std::string>& channels_;
    std::vector<Material> materials_;
    std::vector<std::string> own_;
    std::unordered_map<std::string, std::uint32_t> indices_;
};

/// One value per channel, from a number (stands for all) or an array. @param below  exclusive upper limit
[[nodiscard]] std::vector<double> channel_values(const JsonNode& node,
                                                 const std::vector<std::string>& channels, double below);

} // namespace hemi::io
