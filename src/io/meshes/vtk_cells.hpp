#pragma once

#include "hemi/core/diagnostics.hpp"
#include "io/meshes/face_builder.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::io {

/// Points and cells of a VTK data set, or of a piece of one.
struct VtkCells {
    std::vector<Vec3> points;
    std::vector<std::int64_t> nodes; ///< of all cells; indices of points, not yet checked
    std::vector<std::int64_t> ends;  ///< of each cell in `nodes`
    std::vector<int> types;          ///< of each cell, VTK's numbers
    std::string group_array;         ///< name of the cell array that tells groups; empty: none
    std::vector<double> groups;      ///< its values
};

/// How well an array of cells tells groups, from 1: the lower, the better; 0: it does not.
[[nodiscard]] int vtk_group_rank(std::string_view array);

/// Makes faces of the cells that are surfaces.
class VtkFaces {
public:
    VtkFaces(const std::filesystem::path& path, const SceneReaderOptions& options);

    /// @throws InputError for cells that name no points
    void add(const VtkCells& cells);

    [[nodiscard]] FaceMesh finish(Diagnostics& diagnostics);

private:
    std::string file_;
    FaceBuilder faces_;
    std::uint32_t material_;
    std::uint64_t cells_ = 0;
    std::uint64_t left_out_ = 0;
    std::uint64_t curved_ = 0;
};

/// The XML formats .vtp and .vtu. @param bytes  of the file
[[nodiscard]] FaceMesh read_vtk_xml(const std::filesystem::path& path, std::string_view bytes,
                                    const SceneReaderOptions& options, Diagnostics& diagnostics);
/// The legacy format .vtk.
[[nodiscard]] FaceMesh read_vtk_legacy(const std::filesystem::path& path, std::string_view bytes,
                                       const SceneReaderOptions& options, Diagnostics& diagnostics);

} // namespace hemi::io
