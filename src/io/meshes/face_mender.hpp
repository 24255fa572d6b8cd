#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/io/scene_reader.hpp"
#include "io/meshes/polygon_pieces.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// Where a face is in its file, for messages: its line or, where there are no lines, what it is called.
struct FaceSpot {
    std::size_t line = 0; ///< from 1; 0: none
    std::string name;     ///< "face 7"
};

/// Makes planar convex triangles and quadrilaterals of faces as files have them: faces without area are left
/// out, those that are not plane or not convex and those of many corners are cut. What was done is counted,
/// for one warning a kind. With SceneReaderOptions::strict it is refused instead.
class FaceMender {
public:
    using Where = std::function<FaceSpot()>; ///< asked only for messages

    /// @param noun  what the format calls a face
    FaceMender(const SceneReaderOptions& options, std::string noun);

    /// Makes pieces() of a face. Corners that are repeated in a row count once.
    /// @return what is wrong with it, where it cannot be mended
    [[nodiscard]] std::optional<std::string> mend(std::span<const Vec3> face, const Where& where);
    /// Of a plane face with holes, which are no reason for a warning.
    /// @param holes  in either orientation; they may touch the outline and each other
    [[nodiscard]] std::optional<std::string>
    mend(std::span<const Vec3> face, std::span<const std::vector<Vec3>> holes, const Where& where);

    /// Of the face that was last mended, in its orientation; none for a face that is left out.
    [[nodiscard]] std::span<const PolygonPiece> pieces() const noexcept { return pieces_; }

    /// Tells what was mended. @param file  for messages
    void tell(const std::string& file, Diagnostics& diagnostics) const;

private:
    struct Count {
        std::size_t count = 0;
        FaceSpot first;

        void add(const Where& where);
    };

    [[nodiscard]] std::optional<std::string> take_corners(std::span<const Vec3> face);
    [[nodiscard]] std::optional<std::string> mend_quadrilateral(const Where& where);
    [[nodiscard]] std::optional<std::string> mend_polygon(const Where& where);
    [[nodiscard]] bool make_plane(const Where& where);
    void add(std::span<const Vec3> piece);

    bool strict_;
    double planarity_;
    std::string noun_;
    std::vector<Vec3> corners_; ///< of the face, without those that are repeated
    std::vector<PolygonPiece> pieces_;
    Count without_area_;
    Count flattened_;
    Count not_plane_;
    Count not_convex_;
    Count many_corners_;
};

} // namespace hemi::io
