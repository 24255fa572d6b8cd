#pragma once

#include "display/orbit_camera.hpp"
#include "hemi/display/dots.hpp"
#include "viewer/look.hpp"
#include "viewer/panels.hpp"
#include "viewer/scene_view.hpp"
#include "viewer/viewer.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

/// Points of a table, as dots on the scene.
namespace hemi::viewer {

/// Those that the look asks for; none where there are none.
[[nodiscard]] std::optional<Dots> dots_of(const ViewerInput& input, const Look& look);

/// The column of that name in a table that was read again, else the first to show.
/// @param column  of the points before
[[nodiscard]] std::optional<std::size_t> column_again(const ViewerInput& before, const ViewerInput& now,
                                                      std::optional<std::size_t> column);

/// The first dot that a ray meets.
/// @param cut      leaves dots out
/// @param surface  that the ray meets, and hides what is behind it; none: nothing
[[nodiscard]] std::optional<std::size_t> dot_at(const Dots& dots, const PictureCut& cut, const ViewRay& ray,
                                                const std::optional<Vec3>& surface);
/// Chooses a column by its name; "none" hides the dots.
/// @throws InvalidArgument where there is none of that name
void choose_dots(const ViewerInput& input, std::string_view name, Look& look);

/// Options by which a command line draws them.
/// @param command  that they are for
/// @throws InvalidArgument where that is not `hemi render`, which alone has such options
[[nodiscard]] std::string dots_options(const ViewerInput& input, const Look& look, std::string_view command);

/// The panel's section on them. Between Gui::begin() and Gui::end(), as the next.
void dots_section(const ViewerInput& input, Choices& choices);
/// Their legend, and beside the cursor what the dot under it has.
/// @param cursor  as the view in the units of the panels
void dots_overlay(const SceneView& scene, const ViewerInput& input, const Look& look,
                  std::optional<std::size_t> under_cursor, std::array<double, 2> cursor,
                  std::array<std::uint32_t, 2> view);

} // namespace hemi::viewer
