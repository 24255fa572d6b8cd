#pragma once

namespace hemi::viewer {

struct Choices;
struct PanelContent;

/// Sliders of temperatures, and temperatures and net powers of groups; nothing of scenes without heat.
void heat_section(const PanelContent& content, Choices& choices);
/// Sliders of what materials reflect and emit, and of the environment.
void material_section(const PanelContent& content, Choices& choices);

} // namespace hemi::viewer
