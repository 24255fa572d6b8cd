#pragma once

#include "hemi/display/picture_cut.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>

namespace hemi::viewer {

struct Choices;
struct PanelContent;

/// Cuts away what lies in front of a patch, but not the patch.
[[nodiscard]] ClipPlane plane_of_patch(const PatchMesh& mesh, std::uint32_t patch);
/// The same plane, the other side of which is shown.
[[nodiscard]] ClipPlane other_side(const ClipPlane& plane);

/// Where the picture is cut.
void clip_section(const PanelContent& content, Choices& choices);

} // namespace hemi::viewer
