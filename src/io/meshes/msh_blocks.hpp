#pragma once

#include "hemi/core/diagnostics.hpp"
#include "io/meshes/face_mesh.hpp"

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace hemi::io {

/// What the first section of a Gmsh file says.
struct MshFormat {
    bool version_4 = false; ///< 4.1, else 2.2
    bool binary = false;
    std::size_t lines = 0; ///< before what follows the format's line
    std::size_t bytes = 0; ///< the same
};

/// The rest of a Gmsh file of version 4.1, or of a binary one of version 2.2: elements in blocks of one type.
/// @throws ParseError or InputError with the line, or the byte, and what would be right
[[nodiscard]] FaceMesh read_msh_blocks(const std::filesystem::path& path, std::string_view text,
                                       const MshFormat& format, const SceneReaderOptions& options,
                                       Diagnostics& diagnostics);

} // namespace hemi::io
