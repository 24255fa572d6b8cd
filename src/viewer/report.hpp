#pragma once

#include "viewer/look.hpp"
#include "viewer/panels.hpp"

#include <filesystem>
#include <optional>

namespace hemi::viewer {

/// What a window shows, as a script may ask.
struct Report {
    const ViewerInput& input;
    const Light& light;
    const Choices& choices;
    const std::optional<Field>& field;
    const std::optional<PickedPatch>& picked;
};

/// One JSON object: {"schema": "hemi/view/1", "quantity", "picked": patch or null, "pointed_at", "partners":
/// [patch …], "values": one a patch, null where there is none, or null, "scale": {"low", "high",
/// "logarithmic"} or null, "radiosity": [[per channel] …]}.
/// @throws IoError
void write_report(const std::filesystem::path& path, const Report& report);

} // namespace hemi::viewer
