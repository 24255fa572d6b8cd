#pragma once

#include "viewer/line_probe.hpp"
#include "viewer/look.hpp"
#include "viewer/panels.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hemi::viewer {

/// What the cursor points at.
struct UnderCursor {
    std::uint32_t patch;
    Vec3 position;
};

/// What a window shows, as a script may ask.
struct Report {
    const Document& document;
    const Choices& choices;
    const std::optional<Field>& field;
    const std::optional<PickedPatch>& picked;
    const Camera& camera;
    const std::string& message;
    std::vector<std::uint32_t> seen; ///< patches in the hemicube that is shown
    const std::optional<UnderCursor>& under_cursor;
    std::optional<std::size_t> dot_under_cursor;
    bool asks_to_close;
    const GroupTable& groups;
    const ShownValues& values;
    const std::optional<LineProbe>& probe;
    const std::vector<double>& histogram;
    bool hides_backs;
};

/// One JSON object: {"schema": "hemi/view/1", "quantity", "picked": patch or null, "pointed_at", "partners":
/// [patch …], "hemicube": [patch …], "values": one a patch, null where there is none, or null, "scale":
/// {"low", "high", "logarithmic", "map", "bands", "lines": [values]} or null, "radiosity": [[per channel] …],
/// "residuals": [after every sweep], "light": how it was solved, "camera": {"eye", "target", "up", "fov",
/// "orthographic"}, "message": what went wrong last, "under_cursor": {"patch", "position"} or null,
/// "dots": {"column", "under_cursor": point, "value" of it}, null where there is none, or null where no
/// points are shown, "asks_to_close": whether it does, "group": index of the selected one or null, "groups":
/// [{"name", "visibility", "area", "mean", "net_power"} …], "clip": what is shown or null, "line": {"ends",
/// "length", "values": [one a point or null …]} or null, "histogram": [share of the area by value …],
/// "hides_backs": whether the window says so, "compared": file or null, "difference": whether that is shown,
/// "findings": {kind: [patch ...] ...} or null where none were looked for}.
/// @throws IoError
void write_report(const std::filesystem::path& path, const Report& report);

/// The first of STEM-001, STEM-002 … with that extension that is not there.
[[nodiscard]] std::filesystem::path free_name(const std::string& stem, const std::string& extension);

} // namespace hemi::viewer
