#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/matrix/source_clusters.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// Where a cluster lies, and what it looks at.
struct ClusterShape {
    Vec3 centre;               ///< of a sphere that holds its patches
    double radius;             ///< of that sphere, scene units; not smaller than that of a child
    Vec3 axis;                 ///< mean direction of the normals
    double cone;               ///< largest angle between a normal and the axis, radians
    double cone_sine;          ///< of it
    double cone_cosine;        ///< of it
    bool one_direction = true; ///< whether the cone is narrow enough for one source
};

/// Moments of the area of a cluster.
struct ClusterMoments {
    double area = 0.0;   ///< scene units squared
    Vec3 centre{0.0};    ///< of the area
    Vec3 normals{0.0};   ///< sum of the patches' normals times their areas
    double second = 0.0; ///< area times distance from the centre squared, summed
    /// By how much points of strata are farther from the centre than the strata's centres, so that they have
    /// the second moment, as far as none leaves the sphere then; see ClusterTree::strata().
    double spread = 1.0;
};

/// Nodes that stand for a cluster far away.
struct ClusterStrata {
    std::array<std::uint32_t, 4> nodes; ///< in the order of their patches
    std::uint32_t count = 0;
};

/// Whether some patch of a cluster may have its front towards a receiver, and be above its horizon.
/// @param at      middle of the receiver, scene units
/// @param normal  of it, of unit length; without it looks all ways
/// @param reach   radius of a sphere about its middle that holds it, scene units
[[nodiscard]] bool may_face(const ClusterShape& cluster, const Vec3& at, const std::optional<Vec3>& normal,
                            double reach);

/// Clusters of the patches of a mesh by direction and place. A receiver sees a patch far away in the largest
/// cluster that is small and far enough to be one source. What is near is so both ways, so that pairs near
/// each other can be made reciprocal.
class ClusterTree {
public:
    /// @param apart  see ClusterSettings; may be empty
    explicit ClusterTree(const PatchMesh& mesh, std::span<const std::uint8_t> apart = {});

    /// For a matrix.
    [[nodiscard]] const std::shared_ptr<const SourceClusters>& clusters() const noexcept { return clusters_; }
    [[nodiscard]] const ClusterShape& shape(std::uint32_t node) const { return shapes_[node]; }
    /// Of the sphere about a patch, scene units.
    [[nodiscard]] double radius_of(std::uint32_t patch) const { return shapes_[leaf_of_[patch]].radius; }
    /// Where the area of a node lies, and what it looks at.
    [[nodiscard]] const ClusterMoments& moments(std::uint32_t node) const { return moments_[node]; }
    /// The nodes two below one, or what stands for them where it has no more.
    [[nodiscard]] ClusterStrata strata(std::uint32_t node) const;
    /// Position of a patch in SourceClusters::order().
    [[nodiscard]] std::uint32_t position(std::uint32_t patch) const { return position_[patch]; }

    /// One source of a receiver, or a patch near it.
    struct Part {
        std::uint32_t node; ///< a leaf where it is near
        bool far;
        bool away = false; ///< nothing of it can face the receiver, a point; such parts are far
    };
    /// How a patch sees all patches, itself among them: nodes in the order of their patches, which make up
    /// the whole tree.
    /// @param opening  a cluster is far where its radius and the patch's are below this share of the gap
    /// between
    ///   their spheres
    /// @param parts    overwritten
    void seen_from(std::uint32_t patch, double opening, std::vector<Part>& parts) const;

    /// How a point sees all patches, as above.
    /// @param normal   of the point, of unit length; without it sees all ways
    /// @param opening  a cluster is far where its radius is below this share of its sphere's distance
    /// @param parts    overwritten
    void seen_from(const Vec3& at, const std::optional<Vec3>& normal, double opening,
                   std::vector<Part>& parts) const;

private:
    std::vector<ClusterShape> shapes_;
    std::vector<std::uint32_t> position_;
    std::vector<std::uint32_t> leaf_of_;  ///< of a patch
    std::vector<ClusterMoments> moments_; ///< of nodes
    std::shared_ptr<const SourceClusters> clusters_;
};

} // namespace hemi
