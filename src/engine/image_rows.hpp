#pragma once

#include "hemi/engine/row_provider.hpp"
#include "hemi/scene/image_mesh.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace hemi {

/// Adds up what lies on images of one patch: rows over all images as rows over the scene's patches.
class ImageFold {
public:
    /// @param images  must outlive this
    explicit ImageFold(const ImageMesh& images) : images_(images), sums_(images.size(), 0.0) {}

    /// @param row  over all patches of ImageMesh::mesh(), without visibility
    /// @return the same over the scene's patches, valid until the next call
    [[nodiscard]] RowView operator()(const RowView& row);

private:
    const ImageMesh& images_;
    std::vector<double> sums_; ///< 0 between calls
    std::vector<std::uint32_t> columns_;
    std::vector<float> values_;
};

/// Rows of a scene's patches over them and their images, folded.
/// @param images  that `rows` are over
/// @param rows    of ImageMesh::mesh()
[[nodiscard]] std::unique_ptr<RowProvider> fold_images(std::unique_ptr<const ImageMesh> images,
                                                       std::unique_ptr<RowProvider> rows);

} // namespace hemi
