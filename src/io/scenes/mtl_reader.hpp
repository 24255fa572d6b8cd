#pragma once

#include "hemi/core/diagnostics.hpp"

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace hemi::io {

/// A material of an MTL file: `Kd` and `Ke` as red, green, blue; 0 where the file says nothing.
struct MtlMaterial {
    std::string name;
    std::array<double, 3> reflectance{};
    std::array<double, 3> exitance{};
    std::string place; ///< "file:line" of its newmtl, for messages

    [[nodiscard]] bool same_values(const MtlMaterial& other) const {
        return reflectance == other.reflectance && exitance == other.exitance;
    }
};

/// Adds the materials of an MTL file to `materials`. Values are numbers, not yet checked for their range.
/// @throws ParseError for values that are not numbers, for one name with two meanings.
void read_mtl(const std::filesystem::path& path, std::vector<MtlMaterial>& materials,
              Diagnostics& diagnostics);

/// What stands for a reflectance of 1, at which light never dies away.
constexpr double most_reflectance = 0.99;

/// Takes most_reflectance for 1. @return whether there was one
[[nodiscard]] bool limit_reflectance(MtlMaterial& material);

/// @throws InputError naming the material, where it is defined, the value and the range.
void check_range(const MtlMaterial& material);

} // namespace hemi::io
