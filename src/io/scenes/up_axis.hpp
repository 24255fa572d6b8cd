#pragma once

#include "hemi/scene/scene.hpp"

namespace hemi::io {

/// The axis that points upwards as faces tell it, where the file does not: most of the area that lies across
/// y or z is of floors, roofs and grounds, not of walls. Without such a majority a scene that is flat along y
/// has y upwards, and any other one z.
[[nodiscard]] UpAxis up_by_faces(const Scene& scene);

} // namespace hemi::io
