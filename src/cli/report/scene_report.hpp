#pragma once

#include "cli/loaded_scene.hpp"
#include "cli/report/report.hpp"
#include "hemi/pipeline/cost.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <span>

/// Report of a scene.
namespace hemi::cli {

/// One line on its size.
[[nodiscard]] Report scene_size_report(const LoadedScene& loaded);
/// What was done to faces that touch; nothing where they do not.
/// @param all  text names all faces, else three of a kind
[[nodiscard]] Report imprint_report(const LoadedScene& loaded, bool all);
/// Contents of a scene. `more` is added before the tables of groups and materials, the end of the text.
/// @param areas  what is left of the mesh's patches
[[nodiscard]] Report contents_report(const Scene& scene, const PatchMesh& mesh, std::span<const double> areas,
                                     const Report& more);
/// Memory and time that its form factors will need.
[[nodiscard]] Report cost_report(const FactorCost& cost, const PatchMesh& mesh);

} // namespace hemi::cli
