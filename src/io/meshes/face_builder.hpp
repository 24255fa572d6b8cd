#pragma once

#include "hemi/core/diagnostics.hpp"
#include "io/meshes/face_mender.hpp"
#include "io/meshes/face_mesh.hpp"

#include <cstdint>
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

/// Makes surfaces of the faces of a mesh file, mended as FaceMender does it. Faces keep their order.
class FaceBuilder {
public:
    FaceBuilder(const std::filesystem::path& path, const SceneReaderOptions& options);

    /// Memory for that many faces. `most`: as many as the file can have by its size, whatever it claims.
    void reserve(std::uint64_t faces, std::uint64_t most);

    /// The group of that name, made if it is new.
    std::uint32_t group(const std::string& name);
    /// The material of that name, made if it is new. @param line  where it is asked for
    std::uint32_t material(const std::string& name, std::size_t line);

    /// Adds a face.
    /// @throws ParseError or InputError for a face that cannot be mended
    void add(std::span<const Vec3> corners, std::uint32_t group, std::uint32_t material, FacePlace place);

    /// Faces added so far, those left out included.
    [[nodiscard]] std::uint64_t faces() const noexcept { return faces_; }

    /// @throws InputError if there are no faces. @param what  the format's word for them, for the message
    [[nodiscard]] FaceMesh finish(const std::string& what, Diagnostics& diagnostics);

private:
    [[noreturn]] void refuse(const std::string& defect, FacePlace place) const;

    FaceMesh mesh_;
    std::string file_;
    FaceMender mender_;
    std::unordered_map<std::string, std::uint32_t> groups_;
    std::unordered_map<std::string, std::uint32_t> materials_;
    std::uint64_t faces_ = 0;
};

} // namespace hemi::io
