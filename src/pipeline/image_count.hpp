#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>

namespace hemi {

/// How often the patches of a mesh are there: once, or in as many images as its symmetry makes. What is far
/// down in the engine, tables of visibility and finer meshes, has a column for every image.
[[nodiscard]] inline std::uint64_t image_count(const PatchMesh& mesh) {
    return mesh.symmetry() ? images_of(*mesh.symmetry()).all.size() : 1;
}

} // namespace hemi
