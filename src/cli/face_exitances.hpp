#pragma once

#include "hemi/scene/scene.hpp"

#include <filesystem>

namespace hemi::cli {

/// `--exitance-from`: what faces radiate by themselves, from a table with the columns "index", the number of
/// a face in the order of the scene's files, from 0, and "exitance", or "exitance_CHANNEL" for each channel.
/// Other columns do not count, so that a table of `--radiosity` will do where every face is one patch. Faces
/// that the table lacks, and empty cells, stay as they are.
/// @param scene  as read, its faces not yet cut where they touch; gets materials of such exitances
/// @throws ParseError or InputError with file, line, value and what would be right
void set_exitances(Scene& scene, const std::filesystem::path& path);

} // namespace hemi::cli
