#pragma once

#include "hemi/core/patch_parts.hpp"
#include "hemi/matrix/error_estimate.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"
#include "hemi/solver/solution.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi::io {

/// A stored solution: what a `.hres` file holds. The patches are PatchMesh(scene, subdivision). In the file,
/// and after reading, every surface has the grid that was solved as its own, and the subdivision asks for
/// nothing: the patches do not depend on how surfaces would be cut today.
struct ResultFile {
    Scene scene;             ///< geometry, materials, camera, channels: all but file names
    Subdivision subdivision; ///< how surfaces were cut, for write_hres()
    /// In a file all but the exitance, which the scene's materials have, see complete_solution(). Of heat
    /// (Solution::temperature) the exitance, too, and the scene is scene_of_heat().
    Solution solution;
    /// The surfaces as they were read, each with its own grid, where those of the scene are what is left of
    /// them, or pieces of faces (imprint()); else none.
    std::vector<Surface> surfaces_as_read = {};
    /// Which patches of their whole faces those of the scene are parts of; none without them.
    PatchParts parts = {};

    /// The scene with the surfaces as they were read.
    [[nodiscard]] Scene scene_as_read() const;
    /// The patches that results are about: those of whole faces as they were read.
    [[nodiscard]] PatchMesh patches_as_read() const;
};

/// Gives a solution that was read the exitance of the scene's materials, unless it has one of its own.
/// @param result  gets it
/// @param mesh    of the result
void complete_solution(ResultFile& result, const PatchMesh& mesh);

/// Writes `.hres`. What is not known of heat is not a number: temperatures, net fluxes, radiosity,
/// irradiance, exitance.
/// @throws InvalidArgument for arrays of other lengths and values that are not finite; IoError
void write_hres(const std::filesystem::path& path, const ResultFile& result);
/// Reads `.hres`.
/// @throws InputError for anything that is not a sound `.hres`.
[[nodiscard]] ResultFile read_hres(const std::filesystem::path& path);

/// Where patches are of which a part is left, in place of what their mesh says: one value for every patch, or
/// none at all.
struct PatchPlaces {
    std::vector<double> areas; ///< scene units squared; 0 where nothing is left
    std::vector<Vec3> centres; ///< area centroids
};

/// Where what is left of patches is.
/// @param as_read  mesh of the patches
/// @param mesh     of their parts
/// @param parts    none: each patch is its own part
/// @return nothing at all where there are no parts
[[nodiscard]] PatchPlaces places_left(const PatchMesh& as_read, const PatchMesh& mesh,
                                      const PatchParts& parts);

/// One line a patch: index,group,area,cx,cy,cz,nx,ny,nz (index from 0; shortest digits that read back equal).
/// @param path  of the file
/// @param mesh  N patches
/// @param left  what is left of them
/// @throws InvalidArgument for other than N places; IoError
void write_patches_csv(const std::filesystem::path& path, const PatchMesh& mesh,
                       const PatchPlaces& left = {});
/// The same columns of a stored solution: one line a patch of the surfaces as they were read, with means over
/// what is left of it; then, for every channel name C, exitance_C, irradiance_C, radiosity_C, error_C and
/// direct_C, reflectance_C and emissivity_C, environment, blocked and row_sum, and, where the error has
/// parts, error_factors_C and error_patch_size_C; of heat temperature and net_flux; each where it is known.
/// @throws IoError
void write_radiosity_csv(const std::filesystem::path& path, const ResultFile& result);

} // namespace hemi::io
