#pragma once

#include "display/picture_renderer.hpp"
#include "hemi/display/dots.hpp"
#include "viewer/document.hpp"
#include "viewer/look.hpp"
#include "viewer/scene_target.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace hemi::viewer {

/// A document's scene as it is drawn: the quantity that was chosen, in its colours. Lives in the window's
/// context.
class SceneView {
public:
    /// Puts on the scene what the look asks for. Needed again after document, look or picked patch changed.
    void show(const Document& document, const Look& look, std::optional<std::uint32_t> picked);

    /// What is left out of it from now on.
    void cut(const PictureCut& cut) { cut_ = cut; }

    /// The field that is shown in false colours; none: the picture, outlines, items.
    [[nodiscard]] const std::optional<Field>& field() const { return field_; }
    /// Points that are shown.
    [[nodiscard]] const std::optional<Dots>& dots() const { return dots_; }
    /// Colours of the patches as they are shown, display linear.
    [[nodiscard]] std::vector<std::array<float, 3>> colours() const;
    /// That of the environment; nothing where none is shown.
    [[nodiscard]] std::optional<std::array<float, 3>> environment_colour() const;
    [[nodiscard]] double exposure() const { return settings_.exposure; }

    /// @param samples  along an edge of a pixel
    void draw(const Camera& camera, SceneTarget& target, std::uint32_t samples);
    [[nodiscard]] Picture picture(const Camera& camera, std::array<std::uint32_t, 2> size,
                                  std::uint32_t samples);
    [[nodiscard]] std::optional<std::uint32_t> item(const Camera& camera, std::array<std::uint32_t, 2> size,
                                                    std::uint32_t x, std::uint32_t y);

    /// Whether surfaces that face away would be seen somewhere in the picture, were backs shown.
    [[nodiscard]] bool hides_backs(const Camera& camera, std::array<std::uint32_t, 2> size);

private:
    [[nodiscard]] PictureSettings settings(std::array<std::uint32_t, 2> size, std::uint32_t samples) const;

    PictureRenderer renderer_;
    PictureSettings settings_; ///< but for size and samples
    PictureCut cut_;
    std::optional<Field> field_;
    std::optional<Dots> dots_;
    std::vector<std::array<float, 3>> colours_; ///< what was painted
    std::optional<std::vector<KeyLine>> key_;   ///< what it means, where that is no number
    PictureMesh light_;                         ///< where nothing was painted
    std::size_t drawn_patches_ = 0;             ///< with their images, without dots
    bool evenly_lit_ = false;                   ///< that is even_light()
};

} // namespace hemi::viewer
