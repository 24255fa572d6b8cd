#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace hemi::bench {

/// A scene to be timed.
struct Case {
    std::string name;
    PatchMesh mesh;
};

/// Closed room of 16 parallelograms: six walls and two blocks, of five faces each, that stand on the floor.
/// Cut into about `patches` patches, as near to squares of one size as the walls allow.
[[nodiscard]] Case make_room(std::uint32_t patches);

/// @throws InputError, ParseError
[[nodiscard]] Case read_case(const std::filesystem::path& scene_file);

} // namespace hemi::bench
