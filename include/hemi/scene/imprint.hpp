#pragma once

#include "hemi/core/patch_parts.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace hemi {

/// A scene whose faces are what is really there of them: cut where others stand on them or pass through
/// them, without what is covered. Faces that were read in pieces are whole here.
struct Imprint {
    /// What was done to a face.
    enum class What {
        duplicate,  ///< left out: another one lies over it in its plane
        overlapped, ///< cut: another one lies on a part of it, in its plane
        cut,        ///< cut: others stand on it or pass through it
        buried,     ///< left out: it is inside another body
        joined,     ///< made the back of another one that lies in its place and looks the other way
    };
    /// One face, and what was done to it.
    struct Finding {
        What what; ///< was done
        /// Index of the surface in the scene as it was; of a face in pieces, the first one.
        std::uint32_t face;
        std::uint32_t other; ///< for one, which other face does it; 0xFFFFFFFF: none by itself
    };

    /// A patch with parts on both sides of a sheet: a two-sided face that stands on it or passes through it,
    /// along half of it at least.
    struct Divided {
        std::uint32_t patch; ///< as in PatchParts
        std::uint32_t face;  ///< that it is of, and
        std::uint32_t sheet; ///< that divides it, as in Finding
    };

    Scene scene;                        ///< every surface has its own subdivision
    std::vector<std::uint32_t> face_of; ///< of its surfaces, those of the scene as it was; ascending
    /// Which patches of the scene as it was those of this one are parts of: of PatchMesh(scene,
    /// subdivision).whole_faces() as imprint() got them, and PatchMesh(this->scene).
    PatchParts parts;
    std::vector<Finding> findings; ///< a face at most once, ascending
    std::vector<Divided> divided;  ///< what is told of one is a mean over both sides; ascending
    double covered = 0.0;          ///< area that is left out, scene units squared
};

/// Cuts the faces of a scene where they touch, so that no patch lies on both sides of another face or is
/// covered in part.
///
/// Faces are cut along edges of others that lie in their plane, and along lines where others pass through
/// them: patches at these lines become convex pieces, each a surface of its own; the rest stays in rectangles
/// of whole patches. What is left out: pieces that see nothing but backs, in all of 64 directions, or, in a
/// cavity, nothing but backs and one another; where faces lie in one plane over each other, all but the
/// smallest of them, or of equal ones but the one that is listed last; a side of a two-sided surface that
/// lies on another one. Two one-sided faces of one material and group, alike subdivided, back to back in one
/// place become one that is two-sided. Faces that do not touch others are as they were. Gaps up to 1e-7 of
/// the scene's diagonal are none. Time: about N log N for N faces,
/// also where many of them are the same. Memory: about 300 bytes a face.
/// @param scene        as read
/// @param subdivision  as for PatchMesh, without parts
/// @param contacts     else nothing is cut or left out, and pieces of faces alone are found together
/// @return nothing where there is nothing to cut and no patch in pieces: the scene is what it should be
/// @throws InvalidArgument for parts, and as PatchMesh; InputError as PatchMesh
[[nodiscard]] std::optional<Imprint> imprint(const Scene& scene, const Subdivision& subdivision = {},
                                             bool contacts = true);

} // namespace hemi
