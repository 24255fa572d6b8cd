#pragma once

#include "engine/hemicube/gl_rows.hpp"
#include "gl/objects.hpp"
#include "hemi/scene/image_mesh.hpp"
#include "viewer/overlays.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hemi::viewer {

/// The hemicube of a patch, drawn by the engine's own code in the window's context, and unfolded: the top in
/// the middle, the sides about it, empty corners. Seen from the patch, not from outside: not mirrored.
class HemicubeInset {
public:
    /// @param settings  as the rows are computed; @param window  current, and outlives this
    HemicubeInset(const PatchMesh& mesh, const HemicubeSettings& settings, gl::Context& window);

    /// Draws it, unless it was the last one.
    /// @param eye  of the patch's eye points; the first where there are fewer
    void look(std::uint32_t patch, std::uint32_t eye);
    /// @param colours      of the patches, display linear
    /// @param environment  where nothing else is seen; none: dark grey
    void paint(std::span<const std::array<float, 3>> colours,
               const std::optional<std::array<float, 3>>& environment);

    [[nodiscard]] HemicubePicture picture() const;
    /// Item at a point of the unfolded hemicube, x to the right and y down in [0, 1); nothing in its corners.
    [[nodiscard]] std::optional<std::uint32_t> item_at(double x, double y) const;
    /// Patches that some texel of the unfolded hemicube shows, ascending.
    [[nodiscard]] std::vector<std::uint32_t> seen() const;

private:
    HemicubeInset(const ImageMesh& images, const HemicubeSettings& settings, gl::Context& window);

    HemicubeSettings settings_;
    EngineGeometry geometry_;
    GlRows rows_;
    std::vector<std::uint32_t> original_; ///< of every patch that is drawn, the scene's
    std::uint32_t patch_ = 0xFFFFFFFFU;
    std::uint32_t eye_ = 0;
    std::vector<std::uint32_t> items_;
    gl::Texture2D texture_;
};

} // namespace hemi::viewer
