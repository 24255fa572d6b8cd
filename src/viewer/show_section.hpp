#pragma once

namespace hemi::viewer {

struct Choices;
struct PanelContent;

/// What is shown of the scene, and how.
void show_section(const PanelContent& content, Choices& choices);

} // namespace hemi::viewer
