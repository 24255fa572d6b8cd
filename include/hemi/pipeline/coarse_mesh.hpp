#pragma once

#include "hemi/core/patch_parts.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

namespace hemi {

/// A mesh that refinement begins with.
struct CoarseMesh {
    PatchMesh mesh;    ///< the patches
    PatchMesh as_read; ///< those of the scene as read, of whole faces, before these were cut where they touch
    PatchParts parts;  ///< of those; none where no face was cut or read in pieces
};

/// A coarse mesh to begin with: some hundreds of patches of about one size, whatever sizes the scene wants;
/// surfaces that shine have 4 x 4 at least where they are few, since a few shadow rays to each patch must
/// make their shadows.
/// @param scene          as read
/// @param with_imprint   cut where faces touch, see imprint()
[[nodiscard]] CoarseMesh coarse_mesh(const Scene& scene, bool with_imprint = false);

/// Which sides of faces the patches of a mesh are parts of.
/// @param mesh   of the surfaces of `begin`, cut further
/// @param begin  what it was cut from
/// @param faces  the scene as read, every whole face one patch a side
/// @return of every patch of `mesh` the patch of `faces`, and the groups of these
/// @throws InvalidArgument if a face has several patches
[[nodiscard]] PatchParts parts_of_faces(const PatchMesh& mesh, const CoarseMesh& begin,
                                        const PatchMesh& faces);

} // namespace hemi
