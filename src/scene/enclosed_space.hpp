#pragma once

#include "core/box_tree.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace hemi {

/// The space inside closed bodies of faces: nothing in it sees the environment, whatever else there is.
///
/// A body is what hangs together by edges, of one face or of several that meet along them (T-junctions). It
/// is closed if an even number of its faces meet at every part of every edge, once those are left out of
/// which some part of an edge is of no other face: sheets that stand on it. Faces of the same corners count
/// once where that closes a body. A body of which neither holds is not known to be closed. Memory: about 200
/// bytes a face of a closed body.
class EnclosedSpace {
public:
    /// @param mesh  with all images; must outlive this
    explicit EnclosedSpace(const PatchMesh& mesh);

    /// Whether there is none.
    [[nodiscard]] bool empty() const noexcept { return triangles_.empty(); }
    /// Whether a point is inside a closed body. Where rounding could decide it says no.
    [[nodiscard]] bool contains(const Vec3& point) const;
    /// Whether what lies just in front of a point of a face is inside a closed body.
    /// @param point   on a face, or anywhere
    /// @param normal  of the face, of unit length
    /// @param size    of the patch there, scene units
    [[nodiscard]] bool contains_in_front(const Vec3& point, const Vec3& normal, double size) const;
    /// Whether what the front of a patch of the mesh sees, seen from its centre, is inside a closed body.
    [[nodiscard]] bool encloses(std::uint32_t patch) const;

private:
    struct Triangle {
        std::array<Vec3, 3> corners;
        std::uint32_t body;
    };

    void add_closed_bodies(const std::vector<std::vector<std::uint32_t>>& corners, bool merge);
    [[nodiscard]] std::vector<std::uint32_t> bodies_around(const Vec3& point, const Vec3& direction) const;

    const PatchMesh& mesh_;
    double slack_; ///< of points that are one, scene units
    std::uint32_t bodies_ = 0;
    std::vector<Triangle> triangles_;
    std::optional<BoxTree> tree_; ///< over the triangles
};

} // namespace hemi
