#pragma once

#include "engine/clusters/cluster_tree.hpp"
#include "hemi/core/geometry.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// Where the patches of sets stand in a tree. Memory: 24 bytes a patch and 16 a set.
class SetPlaces {
public:
    SetPlaces(const PatchSets& sets, const ClusterTree& tree, const PatchMesh& mesh);

    /// Positions in the tree of the patches of a set, or of those that make it up, ascending.
    [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t set) const {
        return std::span(positions_).subspan(first_[set], first_[set + 1] - first_[set]);
    }
    /// Area of some patches of a set, scene units squared.
    /// @param begin  into of(), and one behind the last
    [[nodiscard]] double area(std::uint32_t set, std::size_t begin, std::size_t end) const {
        return area_before_[first_[set] + set + end] - area_before_[first_[set] + set + begin];
    }

private:
    std::vector<std::size_t> first_; ///< sets + 1: where those of a set begin
    std::vector<std::uint32_t> positions_;
    std::vector<double> area_before_; ///< of a set: those of no patch, of the first, of the first two …
};

/// What receives light: a patch, a small area at a point, or a small sphere there.
struct RowReceiver {
    Vec3 at{0.0};                            ///< its middle, scene units
    std::optional<Vec3> normal = {};         ///< of unit length; none: a small sphere
    double radius = 0.0;                     ///< of a sphere about the middle that holds it, scene units
    std::optional<std::uint32_t> patch = {}; ///< that it is; none: a point
    double area = 0.0;                       ///< of this patch, scene units squared
};

/// What is known of the visibility of patches.
struct SeenShare {
    double value;  ///< V
    double texels; ///< that it rests on
    bool clear;    ///< of which none was hidden
};

/// A source of a row: a patch near the receiver or a cluster far away.
struct Source {
    std::uint32_t column; ///< patch j; or N + node of the tree
    double unoccluded;    ///< factor F0 from the receiver
    double visibility;    ///< V
    double texels;        ///< see SeenShare; 0: nothing is known of it, so that V is others'
    bool clear;           ///< see SeenShare
};

/// Sums up what texels saw from a receiver: patch by patch near it; far away, cluster by cluster. Patches of
/// a far cluster stand together in up to four strata, the nodes two below it. What an area of a stratum gives
/// the receiver is that of a point with the mean of the normals: points as far from the middle of the cluster
/// as it takes to have the second moment of its area, so that the sum over the strata is right to the third
/// order of their size over their distance; none leaves the sphere of the cluster. Patches that no texel
/// covers are as visible as the others of their cluster. One a thread. Memory: about 500 bytes a source of a
/// row, and a quarter of a byte a patch.
class SourceSums {
public:
    /// All must outlive this.
    SourceSums(const PatchMesh& mesh, const ClusterTree& tree, const ExchangeAreas& exchange)
        : mesh_(mesh), tree_(tree), exchange_(exchange) {}

    /// Starts a row.
    /// @param parts        as ClusterTree::seen_from() gives them: the whole tree, in the order of its
    ///                     patches; of a point, what cannot face it is away
    /// @param hidden_near  whether near patches of which nothing is seen are sources, too
    void start(const RowReceiver& receiver, std::span<const ClusterTree::Part> parts, bool hidden_near);
    /// What is known of a patch.
    void add_patch(std::uint32_t patch, SeenShare share);
    /// What is known of the patches of a set alike.
    void add_set(const SetPlaces& places, std::uint32_t set, SeenShare share);
    /// Ends the row.
    void finish();

    /// Patches near the receiver, ascending.
    [[nodiscard]] std::span<const Source> near() const { return near_; }
    /// Clusters, ascending.
    [[nodiscard]] std::span<const Source> far() const { return far_; }
    /// Whether the receiver sees nothing of some patch that faces it.
    [[nodiscard]] bool hides() const { return hides_; }

private:
    /// Of a near patch, of a part that is away, or of a node of the tree within a far part: a stratum. Areas
    /// in scene units squared.
    struct Slot {
        std::uint32_t part = 0;
        std::uint32_t node = 0;
        /// Patches that the row tells of; those of a set are counted where it begins in the part.
        std::uint32_t known = 0;
        bool clear = true;   ///< whether nothing of what is told is hidden
        double shares = 0.0; ///< of the known patches, together
        double area = 0.0;   ///< that the row tells of
        double seen = 0.0;   ///< area of what is not hidden as a whole
        double lit = 0.0;    ///< area times visibility
    };
    /// Of one part of what a row sees.
    struct PartSlots {
        std::uint32_t first = 0;
        std::uint32_t count = 0;
        bool asked = false;    ///< whether may_face is known
        bool may_face = false; ///< whether some of the part may face the receiver
    };
    /// Where the patches of a row are summed up: their slots, by positions in the tree. Blocks of positions
    /// are told by one number where all have the same.
    class SlotsOfPositions {
    public:
        /// Begins anew at position 0, of so many.
        void clear(std::uint32_t positions);
        /// Positions from the last ones' end to `end` have this slot.
        void add(std::uint32_t slot, std::uint32_t end);
        /// The slot of a position.
        [[nodiscard]] std::uint32_t operator[](std::uint32_t position) const {
            const std::uint32_t entry = blocks_[position / block];
            return (entry & is_mixed) == 0 ? entry : mixed_[(entry ^ is_mixed) + position % block];
        }

    private:
        static constexpr std::uint32_t block = 16;
        static constexpr std::uint32_t is_mixed = 0x80000000u;

        /// Of each block its slot; or, with is_mixed, where in mixed_ those of its positions begin.
        std::vector<std::uint32_t> blocks_;
        std::vector<std::uint32_t> mixed_; ///< slots of single positions; grows only
        std::uint32_t mixed_count_ = 0;    ///< of those that this row has
        std::uint32_t end_ = 0;            ///< of the positions so far
    };

    void add_to_strata(std::uint32_t first, std::uint32_t last, double area, SeenShare share);
    void add_near(std::uint32_t patch, SeenShare share);
    void add_far(std::uint32_t part, double mean);
    [[nodiscard]] bool may_face_part(std::uint32_t part);
    [[nodiscard]] double factor_to(std::uint32_t patch) const;
    [[nodiscard]] double factor_of_point(const Vec3& at, const Vec3& normal) const;
    [[nodiscard]] double factor_of_area(std::uint32_t part, std::uint32_t node) const;

    const PatchMesh& mesh_;
    const ClusterTree& tree_;
    const ExchangeAreas& exchange_;
    RowReceiver receiver_;
    bool hidden_near_ = false;
    double shares_ = 0.0;                  ///< of all patches that the row tells of
    std::uint64_t known_ = 0;              ///< number of these
    std::vector<ClusterTree::Part> parts_; ///< what it sees
    std::vector<PartSlots> part_slots_;    ///< by part
    std::vector<Slot> slots_;              ///< part by part
    SlotsOfPositions slot_at_;             ///< index into slots_
    bool hides_ = false;
    std::vector<Source> near_;
    std::vector<Source> far_;
};

} // namespace hemi
