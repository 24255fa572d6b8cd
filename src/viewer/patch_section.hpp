#pragma once

namespace hemi::viewer {

struct Choices;
struct PanelContent;

/// What the picked patch is, and whom it exchanges most with.
void patch_section(const PanelContent& content, Choices& choices);

} // namespace hemi::viewer
