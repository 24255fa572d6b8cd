#pragma once

#include "hemi/core/diagnostics.hpp"
#include "io/meshes/face_mesh.hpp"
#include "io/meshes/polygon_pieces.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace hemi::io {

/// Where a face is in its file, for messages: its line, or its number where there are no lines.
struct FacePlace {
    std::size_t line = 0;     ///< from 1; 0: none
    std::uint64_t number = 0; ///< from 0
};

/// Makes surfaces of the faces of a mesh file. Faces keep their order; triangles and quadrilaterals stay what
/// they are, faces of more corners are cut where they are planar and convex, and all others are refused.
class FaceBuilder {
public:
    FaceBuilder(const std::filesystem::path& path, bool skip_degenerate);

    /// Memory for that many faces. `most`: as many as the file can have by its size, whatever it claims.
    void reserve(std::uint64_t faces, std::uint64_t most);

    /// The group of that name, made if it is new.
    std::uint32_t group(const std::string& name);
    /// The material of that name, made if it is new. @param line  where it is asked for
    std::uint32_t material(const std::string& name, std::size_t line);

    /// Adds a face. Corners that are repeated in a row count once.
    /// @throws ParseError or InputError for a face that is not planar, not convex or without area; where
    ///   degenerate faces are to be skipped, those without area are left out instead.
    void add(std::span<const Vec3> corners, std::uint32_t group, std::uint32_t material, FacePlace place);

    /// Faces added so far, those left out included.
    [[nodiscard]] std::uint64_t faces() const noexcept { return faces_; }

    /// @throws InputError if there are no faces. @param what  the format's word for them, for the message
    [[nodiscard]] FaceMesh finish(const std::string& what, Diagnostics& diagnostics);

private:
    [[nodiscard]] bool accept(const std::optional<std::string>& defect, FacePlace place);
    [[noreturn]] void refuse(const std::string& defect, FacePlace place) const;
    void add_surface(std::span<const Vec3> polygon, std::uint32_t group, std::uint32_t material);

    FaceMesh mesh_;
    std::string file_;
    bool skip_degenerate_;
    std::unordered_map<std::string, std::uint32_t> groups_;
    std::unordered_map<std::string, std::uint32_t> materials_;
    std::vector<Vec3> corners_; // kept between faces for their memory
    std::vector<PolygonPiece> pieces_;
    std::uint64_t faces_ = 0;
    std::uint64_t split_ = 0;
    std::uint64_t skipped_ = 0;
    FacePlace first_skipped_;
};

} // namespace hemi::io
