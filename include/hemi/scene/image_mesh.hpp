#pragma once

#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/symmetry.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace hemi {

/// The patches of a scene and of all of its images: what rays and hemicubes meet.
///
/// Those of the scene come first, with their numbers; then image by image those of the others, surfaces in
/// the same order. A mirror image's vertices turn the other way round, so that fronts stay fronts. Without
/// symmetry it is the mesh itself. Memory: that of a mesh of so many patches, and 8 bytes a patch.
class ImageMesh {
public:
    /// @param mesh  must outlive this
    explicit ImageMesh(const PatchMesh& mesh);
    ImageMesh(const ImageMesh&) = delete;
    ImageMesh& operator=(const ImageMesh&) = delete;

    /// All patches. It has no symmetry of its own.
    [[nodiscard]] const PatchMesh& mesh() const noexcept { return all_ ? *all_ : mesh_; }
    /// Whether there are images.
    [[nodiscard]] bool any() const noexcept { return all_.has_value(); }
    /// Number of images, with the scene itself: 1 without symmetry.
    [[nodiscard]] std::uint32_t images() const noexcept {
        return any() ? static_cast<std::uint32_t>(images_.all.size()) : 1;
    }
    /// Number of patches of the scene.
    [[nodiscard]] std::uint32_t size() const noexcept { return mesh_.size(); }

    /// The patch of the scene whose image a patch is.
    [[nodiscard]] std::uint32_t original(std::uint32_t patch) const {
        return any() ? original_[patch] : patch;
    }
    /// A patch of an image.
    /// @param image     its number
    /// @param original  patch of the scene
    [[nodiscard]] std::uint32_t patch(std::uint32_t image, std::uint32_t original) const {
        return any() ? patch_[std::size_t{image} * size() + original] : original;
    }

    /// A pair of patches that lies to each other as another pair does, seen from its other end.
    struct Pair {
        std::uint32_t from; ///< patch of the scene
        std::uint32_t to;   ///< any patch
    };
    /// What the pair of patch i of the scene and patch p is from p's end: where p is an image of j, the pair
    /// of j and of i's image by the way back. The same pair where both are one.
    [[nodiscard]] Pair counterpart(std::uint32_t i, std::uint32_t p) const {
        return any() ? Pair{original_[p], patch(images_.inverse[p / size()], i)} : Pair{p, i};
    }

private:
    const PatchMesh& mesh_;
    SceneImages images_;
    std::optional<PatchMesh> all_;
    std::vector<std::uint32_t> original_; ///< of every patch
    std::vector<std::uint32_t> patch_;    ///< of every image's patches, by their original
};

} // namespace hemi
