#pragma once

#include "hemi/core/names.hpp"

namespace hemi::viewer {

/// What the mouse does: as in ParaView and MeshLab, or as in Blender.
enum class Controls { standard, blender };

} // namespace hemi::viewer

namespace hemi {
template <>
struct Names<viewer::Controls> {
    static constexpr NamedValue<viewer::Controls> table[] = {{viewer::Controls::standard, "standard"},
                                                             {viewer::Controls::blender, "blender"}};
};
} // namespace hemi
