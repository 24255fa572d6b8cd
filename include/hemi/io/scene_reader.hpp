#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/scene/orientation.hpp"
#include "hemi/scene/scene.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// Symmetry of a scene: what is given stands in the place of what the file says of it.
struct SymmetryOptions {
    std::vector<MirrorPlane> mirrors{};     ///< empty: the file's
    std::optional<RotationAxis> rotation{}; ///< none: the file's
    std::vector<Vec3> periods{};            ///< empty: the file's
    std::optional<std::uint32_t> images{};  ///< none: the file's
};

/// What a reader does beyond what the file says.
struct SceneReaderOptions {
    std::vector<std::string> two_sided_groups{}; ///< groups whose faces radiate on both sides; "*": all
    bool strict = false;        ///< refuse faces without area or out of plane, which are mended otherwise
    bool allow_outside = false; ///< open files outside the scene's folder that the scene names
    /// How far corners of a face may be off its plane, as a share of its longest edge, before the face is cut
    /// into triangles. Above 1e-5, corners that are off by less are moved into the plane.
    double planarity = 1e-5;
    std::vector<std::string> one_sided_groups{};    ///< groups of which only the front counts; "*": all
    std::vector<std::string> flipped_groups{};      ///< groups whose faces are turned round; "*": all
    Orientation orientation = Orientation::as_read; ///< before flipped_groups
    /// glTF: closed bodies of double-sided faces are taken as one-sided where one of their sides meets
    /// nothing, see make_bodies_one_sided(); not those with faces of two_sided_groups.
    bool close_bodies = true;
    std::string zone{};           ///< .epJSON: the zone that is read; empty: the only one
    bool adiabatic = false;       ///< allow reflectances of 1 in .json, where heat is solved for
    std::optional<UpAxis> up{};   ///< axis upwards, in place of the file's
    std::optional<double> unit{}; ///< metres in a unit of lengths, in place of the file's
    SymmetryOptions symmetry{};   ///< what the scene repeats itself by
};

/// Reads a scene by its extension: .json (hemi's own), .obj (with its .mtl), .gltf and .glb, .vs3 (View3D),
/// .epJSON (a zone of EnergyPlus), .msh (Gmsh), .inp (Abaqus), .bdf and .nas (Nastran), .vtk, .vtp and .vtu
/// (VTK), .ply, .stl. Files that the scene names must be in its folder or below it, unless allowed.
/// @throws ParseError or InputError with file, place, value and what would be right; InvalidArgument for
///         options that name groups the scene does not have, or call one both two-sided and one-sided.
[[nodiscard]] Scene read_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                               Diagnostics& diagnostics);
/// The same by default options; warnings are not kept.
[[nodiscard]] Scene read_scene(const std::filesystem::path& path);

/// Reads several files as one scene: of each the groups are called FILE/GROUP, or FILE where it has one
/// alone, FILE being its name without folder and extension. Files of one channel have the same values in all
/// channels of the others. What a file says of its enclosure counts where all say the same; environments are
/// dark.
/// @param paths        one or more; of one it is read_scene()
/// @param options      groups in them are called as in the scene
/// @param diagnostics  gets warnings
/// @throws as read_scene(); InputError for two files of one name or of other channels; InvalidArgument for a
///   JSON scene among several
[[nodiscard]] Scene read_scenes(std::span<const std::filesystem::path> paths,
                                const SceneReaderOptions& options, Diagnostics& diagnostics);

/// hemi's JSON: see the page on scenes. Meshes it names are read relative to the file.
[[nodiscard]] Scene read_json_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                                    Diagnostics& diagnostics);

/// Wavefront OBJ: every face a surface, `o`/`g` its group, `Kd` reflectance and `Ke` exitance (red, green,
/// blue). Without a material: reflectance 0.5, exitance 0.
[[nodiscard]] Scene read_obj_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                                   Diagnostics& diagnostics);

/// glTF 2.0, text or binary: triangles as surfaces, placed by their nodes; a group for every node's name (or
/// its mesh's). Base colour is reflectance, emissiveFactor times KHR_materials_emissive_strength is exitance
/// in W/m², doubleSided is two-sided. Without a material: reflectance 0.5, exitance 0. Buffers are read from
/// data URIs and from files in the scene's folder.
[[nodiscard]] Scene read_gltf_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                                    Diagnostics& diagnostics);

/// View3D input, format 3: every `S` a surface in the group of its name (or, combined, of the surface it is
/// combined with), reflectance 1 - emissivity, exitance 0. Every `O` is a black two-sided surface of the
/// group "obstruction": it blocks, and nothing comes from it. Control `encl` is the enclosure.
[[nodiscard]] Scene read_vs3_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                                   Diagnostics& diagnostics);

/// Gmsh MSH 4.1 and 2.2, ASCII and binary: every triangle and quadrilateral a surface, in the file's order;
/// its group is its physical surface, and so is its material's name, reflectance 0.5, exitance 0. Points,
/// lines and volumes are left out, and curved elements taken as plane between their corners, with warnings.
[[nodiscard]] Scene read_msh_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                                   Diagnostics& diagnostics);

/// EnergyPlus' .epJSON: the surfaces of a zone and the windows in them, each a group of its name, fronts
/// towards the inside; windows lie over the walls that they are in, see imprint(). The scene has the zone's
/// name. Reflectance 0.5, exitance 0.
/// @throws InvalidArgument where several zones are there and none is named, or one that is not there
[[nodiscard]] Scene read_epjson_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                                      Diagnostics& diagnostics);

/// PLY, ASCII or binary: every face a surface, in the file's order, all of the group "default"; reflectance
/// 0.5, exitance 0. Positions and faces are used, nothing else.
[[nodiscard]] Scene read_ply_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                                   Diagnostics& diagnostics);

/// STL, ASCII or binary: every triangle a surface, in the file's order; groups are solids ("default" in
/// binary files); reflectance 0.5, exitance 0. The order of vertices says which side is the front, not the
/// normals.
[[nodiscard]] Scene read_stl_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                                   Diagnostics& diagnostics);

/// The extensions that read_scene knows, as a message lists them: ".json, .obj".
[[nodiscard]] std::string scene_extensions();

/// Whether a path's extension says that it is a scene (rather than factors or a result).
[[nodiscard]] bool is_scene_file(const std::filesystem::path& path);

} // namespace hemi::io
