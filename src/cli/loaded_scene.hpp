#pragma once

#include "cli/arguments/arguments.hpp"
#include "cli/report/text.hpp"
#include "cli/terminal.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/pipeline/coarse_mesh.hpp"
#include "hemi/scene/imprint.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The scene that a command line names.
namespace hemi::cli {

/// A scene before its faces were cut, where they touch or to meet an error. Patches of its whole faces are
/// what results are about.
struct SceneAsRead {
    Scene scene;
    std::vector<Surface> surfaces;          ///< of the scene, each with its own subdivision
    PatchMesh mesh;                         ///< see WholeFaces::mesh
    PatchParts parts;                       ///< those of the patches that are computed with
    io::PatchPlaces left;                   ///< areas and centres of what is left of the patches
    std::vector<Imprint::Finding> findings; ///< what was done
    double covered = 0.0;                   ///< area that is left out
};

struct LoadedScene {
    Scene scene;
    PatchMesh mesh;                      ///< what is computed with
    Subdivision subdivision;             ///< with the scene it makes the mesh
    std::optional<SceneAsRead> as_read;  ///< where its faces were cut
    std::vector<std::uint32_t> group_of; ///< group of every patch of the mesh
    double seconds = 0.0;
    bool thermal = false; ///< the file says something of heat; without SceneReaderOptions::adiabatic the
                          ///< scene has it as exitance

    /// Takes a mesh of the scene whose patches were cut further. Results stay about the scene's own patches
    /// where these are whole faces.
    /// @param begin  what the mesh was cut from
    /// @param parts  results are about the patches of the mesh in any case
    void adopt(PatchMesh other, const CoarseMesh& begin, bool parts);
    /// The mesh as it is, to be cut further.
    [[nodiscard]] CoarseMesh as_begin() const { return {mesh, patches(), parts()}; }
    /// Whether every patch that results are about is one side of a face as the file has it.
    [[nodiscard]] bool has_whole_faces() const;

    /// The scene as it was read.
    [[nodiscard]] const Scene& uncut() const { return as_read ? as_read->scene : scene; }
    /// Patches that results are about: those of the scene as it was read.
    [[nodiscard]] const PatchMesh& patches() const { return as_read ? as_read->mesh : mesh; }
    /// What patches of the mesh are parts of.
    [[nodiscard]] PatchParts parts() const { return as_read ? as_read->parts : PatchParts(); }
    /// Of patches of the mesh.
    [[nodiscard]] PatchNames names() const {
        return {mesh.groups(), group_of, mesh.centres(),
                as_read ? as_read->parts.patch_of : std::span<const std::uint32_t>()};
    }
    /// Of the patches that results are about.
    [[nodiscard]] PatchNames patch_names() const {
        return as_read ? PatchNames{mesh.groups(), as_read->parts.group_of, as_read->left.centres} : names();
    }
    /// Values of the mesh's patches, as means over those that results are about.
    /// @param channels  of the values
    [[nodiscard]] std::vector<double> means(std::span<const double> values, std::size_t channels) const;
    /// What a `.hres` holds of a solution of the mesh.
    [[nodiscard]] io::ResultFile result(Solution solution) const;
    /// --patches
    void write_patches(const std::filesystem::path& path) const;
    /// The same with what the rows of the mesh say: environment shares, empty where rows are not known.
    void write_patches(const std::filesystem::path& path, const FormFactorMatrix& factors) const;
};

/// Warns where a scene that is lit has one patch a face and few of them, and proposes a size.
void advise_patch_size(const LoadedScene& loaded, const Terminal& terminal);

/// Reads the scene and cuts it into patches, after its faces were cut where they touch;
/// `--enclosure` and `--environment` replace the scene's own.
/// @throws InputError for the file; InvalidArgument for options that do not fit it.
[[nodiscard]] LoadedScene load_scene(const SceneOptions& options, const Terminal& terminal);

/// A mesh that patches were cut into from another.
struct CutMesh {
    CoarseMesh begin;
    PatchMesh mesh;
};
/// What refinement begins with: patches of the size that the command line asks for, or a coarse mesh.
[[nodiscard]] CoarseMesh coarse_begin(const LoadedScene& loaded, const SceneOptions& options);
/// @throws InvalidArgument if there is a budget for nothing
void check_budget(const RefinementOptions& refinement, const RowOptions& rows);
/// The mesh that the rows of a `.hff` are of: the scene's own, one that a refinement begins with, or one that
/// was cut from either; the scene's own where the rows are of another geometry.
/// @throws InputError for the file
[[nodiscard]] CutMesh mesh_of_rows(const LoadedScene& loaded, const SceneOptions& options,
                                   const std::filesystem::path& path);
/// Cuts the scene as the rows of a file are, where a refinement stored them.
/// @param path   does nothing if it is no file yet
/// @param parts  see LoadedScene::adopt
void adopt_mesh_of_rows(LoadedScene& loaded, const SceneOptions& options, const std::filesystem::path& path,
                        bool parts = false);

/// Refuses settings on the command line that --error-target chooses.
/// @throws InvalidArgument
void refuse_chosen_settings(const CommonOptions& common, const RowOptions& rows);

/// Refuses options on the command line that say nothing about a stored file.
/// @param allowed  options that do ("--json"); @throws InvalidArgument
void refuse_all_but(const CommonOptions& common, std::span<const std::string> allowed,
                    const std::filesystem::path& file);

} // namespace hemi::cli
