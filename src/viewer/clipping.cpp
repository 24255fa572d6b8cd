#include "viewer/clipping.hpp"

#include "viewer/panels.hpp"
#include "viewer/widgets.hpp"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

namespace hemi::viewer {

namespace {

/// Index of the axis that the plane is across; nothing where it is oblique.
std::optional<int> axis_of(const ClipPlane& plane) {
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(plane.normal[axis]) == 1.0) {
            return axis;
        }
    }
    return std::nullopt;
}

/// The least and the largest offset of a plane that cuts the scene.
std::array<double, 2> offsets(const Bounds& bounds, const Vec3& normal) {
    std::array<double, 2> ends{0.0, 0.0};
    for (int axis = 0; axis < 3; ++axis) {
        const double low = normal[axis] * bounds.lower[axis];
        const double high = normal[axis] * bounds.upper[axis];
        ends[0] += std::min(low, high);
        ends[1] += std::max(low, high);
    }
    return ends;
}

/// Through the middle of the scene.
ClipPlane across(int axis, const Bounds& bounds) {
    ClipPlane plane{Vec3(0.0), bounds.centre()[axis]};
    plane.normal[axis] = 1.0;
    return plane;
}

void offset_slider(ClipPlane& plane, const Bounds& bounds) {
    // Told along the axis, whichever side is shown.
    const bool turned = axis_of(plane) && plane.normal[*axis_of(plane)] < 0.0;
    std::array<double, 2> ends = offsets(bounds, plane.normal);
    if (turned) {
        ends = {-ends[1], -ends[0]};
    }
    double at = turned ? -plane.offset : plane.offset;
    if (slider("##offset", at, ends[0], ends[1], "at %.4g", -1.0F,
               "Where the plane lies along its normal, in the scene's unit.")) {
        plane.offset = turned ? -at : at;
    }
}

} // namespace

ClipPlane plane_of_patch(const PatchMesh& mesh, std::uint32_t patch) {
    constexpr double share = 1e-4; // of the scene, so that the patch itself is drawn
    Vec3 normal = glm::normalize(mesh.normal(patch));
    for (int axis = 0; axis < 3; ++axis) { // rounding left on an axis would be told as an oblique plane
        constexpr double rounding = 1e-12;
        if (std::abs(normal[axis]) > 1.0 - rounding) {
            const double sign = normal[axis] < 0.0 ? -1.0 : 1.0;
            normal = Vec3(0.0);
            normal[axis] = sign;
        }
    }
    return {normal, glm::dot(normal, mesh.centres()[patch]) + share * mesh.bounds().diagonal()};
}

ClipPlane other_side(const ClipPlane& plane) {
    return {Vec3(0.0) - plane.normal, 0.0 - plane.offset};
}

void clip_section(const PanelContent& content, Choices& choices) {
    if (!heading("Clipping plane", "Cuts the picture, and what a click finds; not the light.", false)) {
        return;
    }
    const PatchMesh& mesh = *content.document.input().mesh;
    std::optional<ClipPlane>& clip = choices.cut.clip;
    const std::optional<int> axis = clip ? axis_of(*clip) : std::nullopt;
    if (radio_button("none", !clip, "Nothing is cut.")) {
        clip.reset();
    }
    constexpr std::array<const char*, 3> names{"x", "y", "z"};
    for (int k = 0; k < 3; ++k) {
        ImGui::SameLine();
        const char* name = names[static_cast<std::size_t>(k)];
        if (radio_button(name, axis == k, std::string("A plane across ") + name + ".") && axis != k) {
            clip = across(k, mesh.bounds());
        }
    }
    ImGui::SameLine();
    radio_button("oblique", clip && !axis, "A plane across no axis: through a patch that lies so.");
    ImGui::BeginDisabled(!choices.picked);
    if (button("Through the picked patch", "In the plane of the patch that was clicked (K).")) {
        clip = plane_of_patch(mesh, *choices.picked);
    }
    ImGui::EndDisabled();
    if (!clip) {
        return;
    }
    ImGui::SameLine();
    if (button("Other side", "Shows what was cut away, and cuts what was shown (shift + K).")) {
        clip = other_side(*clip);
    }
    offset_slider(*clip, mesh.bounds());
    text("shown: " + clip_plane_text(*clip));
}

} // namespace hemi::viewer
