#pragma once

#include "support/polygon_factors.hpp"

#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace hemi::test {

/// Form factors, element by element, of a convex room with one or two convex bodies in it.
///
/// F(i, j) is the exact unoccluded factor less what is hidden. The hidden part is exact at every point of
/// patch i: patch j clipped by the planes through the point and the body's silhouette, and by the body's
/// faces that the point sees; two bodies by inclusion and exclusion. The only error is that of the n x n
/// Gauss points on patch i over which hidden parts are averaged.
class OccludedReference {
public:
    /// @param mesh    must outlive the reference; walls hide nothing
    /// @param bodies  groups, each a closed convex body or a two-sided sheet; at most two
    OccludedReference(const PatchMesh& mesh, const std::vector<std::string>& bodies, std::size_t points);

    /// F(i, j) of all j; 0 for pairs of which no point sees anything of j. Not for patches under or inside a
    /// body.
    [[nodiscard]] std::vector<double> row(std::uint32_t i) const;

private:
    struct Face {
        std::vector<Vec3> corners;
        Plane plane;
    };
    struct Edge {
        Vec3 a, b; ///< as they run round face `left`
        std::size_t left;
        std::size_t right;
    };
    struct Body {
        std::vector<Face> faces;
        std::vector<Edge> edges;
    };
    struct Target;

    static Body make_body(const PatchMesh& mesh, std::uint32_t group);
    static std::vector<Plane> shadow(const Body& body, const Vec3& point);
    [[nodiscard]] std::vector<Target> targets(std::uint32_t i) const;

    const PatchMesh& mesh_;
    std::size_t points_;
    std::vector<Body> bodies_;
    std::vector<std::size_t> body_of_; ///< per patch; bodies_.size() for walls
    std::vector<Plane> planes_;        ///< per patch
};

/// Closed unit room with two turned boxes, "first" and "second", floating in it: 6 walls of walls² patches,
/// 12 faces of first² and second².
[[nodiscard]] Scene room_with_turned_boxes(std::uint32_t walls, std::uint32_t first, std::uint32_t second);
/// 1,110 and 5,790 patches of about equal size.
[[nodiscard]] Scene coarse_room_with_turned_boxes();
[[nodiscard]] Scene fine_room_with_turned_boxes();

/// A room with a block on its floor, the border of which runs through the patches of the floor, beside the
/// same room with the floor cut along that border.
struct StraddledRoom {
    Scene whole;
    Scene cut;
};
/// Closed unit room, walls of 4 x 4 patches, with a "block". Of the floor's patches with x in 0.25 … 0.5 and
/// y in 0.25 … 0.75 the share `covered` is under the block, of those with x in 0.5 … 0.75 all.
[[nodiscard]] StraddledRoom straddled_room(double covered);
/// The patch of `whole` that each patch of `cut` is a part of.
[[nodiscard]] std::vector<std::uint32_t> parents(const PatchMesh& whole, const PatchMesh& cut);
/// The row of patch i of `whole` from rows of `cut`: of each share of the patch that does not lie under the
/// "block".
[[nodiscard]] std::vector<double> straddled_row(const PatchMesh& whole, const PatchMesh& cut,
                                                std::span<const std::uint32_t> parents,
                                                const OccludedReference& reference, std::uint32_t i);

/// Closed unit room, walls of 4 x 4 patches, with a two-sided "sheet" of 2 x 2 patches as large as a patch of
/// the floor, `gap` times the size of a patch above it and a fifth of that size off its borders.
[[nodiscard]] Scene room_with_sheet(double gap);

/// `count` patches spread over all of the mesh, ascending, at irregular distances.
[[nodiscard]] std::vector<std::uint32_t> sampled_patches(const PatchMesh& mesh, std::uint32_t count);

/// How far rows are from their reference.
struct RowErrors {
    double rms = 0.0; ///< over pairs with reference factor above 0
    double max = 0.0; ///< over all pairs
    std::uint32_t worst_i = 0;
    std::uint32_t worst_j = 0;
    std::uint64_t pairs = 0; ///< with reference factor above 0

    /// Takes in the row of patch i.
    void add(std::uint32_t i, const RowView& row, const std::vector<double>& reference);

private:
    double squares_ = 0.0;
};

} // namespace hemi::test
