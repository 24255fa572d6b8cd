#pragma once

#include "hemi/scene/scene.hpp"

#include <string>
#include <vector>

namespace hemi::io {

/// Makes the surfaces of the named groups two-sided.
/// @throws InputError for an unknown group, with the nearest.
void make_two_sided(Scene& scene, const std::vector<std::string>& groups, const std::string& file);

} // namespace hemi::io
