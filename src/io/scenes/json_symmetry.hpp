#pragma once

#include "hemi/io/scene_reader.hpp"
#include "hemi/scene/symmetry.hpp"
#include "io/formats/json_node.hpp"

/// What a JSON scene, or a result's header, says of its symmetry.
namespace hemi::io {

/// Reads "symmetry".
/// @throws InputError for what is none
[[nodiscard]] Symmetry read_symmetry(const JsonNode& node);
/// The same to be read again.
[[nodiscard]] Json symmetry_json(const Symmetry& symmetry);

/// Puts what options say in the place of what a scene says.
/// @throws InvalidArgument for images without a translation
void set_symmetry(Scene& scene, const SymmetryOptions& options);

} // namespace hemi::io
