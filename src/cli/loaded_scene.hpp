#pragma once

#include "cli/arguments/arguments.hpp"
#include "cli/report/text.hpp"
#include "cli/terminal.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The scene that a command line names.
namespace hemi::cli {

struct LoadedScene {
    Scene scene;
    PatchMesh mesh;
    Subdivision subdivision;             ///< with the scene it makes the mesh
    std::optional<Scene> as_read;        ///< where its faces were cut
    std::vector<std::uint32_t> group_of; ///< group of every patch
    double seconds = 0.0;

    /// Takes another mesh of the scene.
    void adopt(PatchMesh other);

    [[nodiscard]] PatchNames names() const { return {mesh.groups(), group_of, mesh.centres()}; }
};

/// Reads the scene and cuts it into patches, with `--imprint` after its faces were cut where they touch;
/// `--enclosure` and `--environment` replace the scene's own.
/// @throws InputError for the file; InvalidArgument for options that do not fit it.
[[nodiscard]] LoadedScene load_scene(const SceneOptions& options, const Terminal& terminal);

/// Refuses settings on the command line that --error-target chooses.
/// @throws InvalidArgument
void refuse_chosen_settings(const CommonOptions& common, const RowOptions& rows);

/// Refuses options on the command line that say nothing about a stored file.
/// @param allowed  options that do ("--json"); @throws InvalidArgument
void refuse_all_but(const CommonOptions& common, std::span<const std::string> allowed,
                    const std::filesystem::path& file);

} // namespace hemi::cli
