#pragma once

#include "engine/clusters/cluster_tree.hpp"
#include "hemi/core/row_memory.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace hemi {

/// What is known of one source of a row.
struct ClusterEntry {
    std::uint32_t column;
    float value;
    std::uint8_t visibility;
};

/// Entries of a row, 9 bytes each: all rows together are what takes most of the memory.
class EntryList {
public:
    EntryList() = default;
    explicit EntryList(std::span<const ClusterEntry> entries)
        : size_(static_cast<std::uint32_t>(entries.size())), words_(entries.empty() ? 0 : word_count()) {
        for (std::uint32_t k = 0; k < size_; ++k) {
            words_[k] = entries[k].column;
            set_value(k, entries[k].value);
            reinterpret_cast<std::uint8_t*>(&words_[2 * std::size_t{size_}])[k] = entries[k].visibility;
        }
    }

    [[nodiscard]] std::uint32_t size() const noexcept { return size_; }
    [[nodiscard]] ClusterEntry operator[](std::uint32_t k) const {
        return {words_[k], std::bit_cast<float>(words_[size_ + k]),
                reinterpret_cast<const std::uint8_t*>(&words_[2 * std::size_t{size_}])[k]};
    }
    void set_value(std::uint32_t k, float value) { words_[size_ + k] = std::bit_cast<std::uint32_t>(value); }
    /// Of all values, in double, in their order.
    [[nodiscard]] double sum() const {
        double sum = 0.0;
        for (std::uint32_t k = 0; k < size_; ++k) {
            sum += static_cast<double>((*this)[k].value);
        }
        return sum;
    }
    [[nodiscard]] std::size_t bytes() const { return size_ > 0 ? word_count() * sizeof(std::uint32_t) : 0; }

private:
    [[nodiscard]] std::size_t word_count() const { return 2 * std::size_t{size_} + (size_ + 3) / 4; }

    std::uint32_t size_ = 0;
    RowArray<std::uint32_t> words_; ///< columns, values, and four codes of visibility in each
};

/// One row while all are computed.
struct ClusteredRow {
    EntryList near; ///< patches, ascending
    EntryList far;  ///< clusters, ascending
    double environment = 0.0;
    double blocked = 0.0;
    bool hides = false; ///< whether it sees nothing of some patch that faces it

    [[nodiscard]] std::size_t bytes() const { return sizeof(ClusteredRow) + near.bytes() + far.bytes(); }
};

/// A row of visibility, kept.
struct SeenRow {
    std::uint32_t patch = 0;
    std::vector<std::uint32_t> columns;
    std::vector<float> shares;
    std::vector<std::uint8_t> texels;
    std::vector<JointVisibility> joint;
    double environment = 0.0;
    double blocked = 0.0;
};

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

/// Makes rows of factors of rows of visibility: F0 V patch by patch near the receiver; far away, cluster by
/// cluster. Patches of a far cluster stand together in up to four strata, the nodes two below it. What an
/// area of a stratum gives the receiver is that of a point with the mean of the normals: points as far from
/// the middle of the cluster as it takes to have the second moment of its area, so that the sum over the
/// strata is right to the third order of their size over their distance. Patches that no texel covers are as
/// visible as the others of their cluster. One a thread. Memory: about 250 bytes a source of a row.
class RowMaker {
public:
    /// All must outlive this.
    RowMaker(const PatchMesh& mesh, const ClusterTree& tree, const ExchangeAreas& exchange, double opening)
        : mesh_(mesh), tree_(tree), exchange_(exchange), opening_(opening) {}

    /// @param places  of what the row tells as a whole; null where that is nothing
    [[nodiscard]] ClusteredRow make(const SeenRow& seen, const SetPlaces* places);

private:
    static constexpr std::uint32_t strata_depth = 2; ///< of strata below their cluster

    /// Of one part of what a row sees.
    struct Sum {
        std::uint32_t first_stratum = 0;
        std::uint32_t strata = 0;
        std::uint32_t known = 0; ///< patches that the row tells of
        double shares = 0.0;     ///< of these, together
        bool clear = true;       ///< whether nothing of these is hidden
        bool asked = false;      ///< whether may_face is known
        bool may_face = false;   ///< whether some of the part may face the receiver
    };
    /// Of a node of the tree within a far part; areas in scene units squared.
    struct Stratum {
        std::uint32_t node = 0;
        std::uint32_t begin = 0; ///< position of its first patch
        double known = 0.0;      ///< area that the row tells of
        double seen = 0.0;       ///< area of what is not hidden as a whole
        double lit = 0.0;        ///< area times visibility
    };
    /// What is known of the visibility of patches.
    struct Share {
        double value;
        bool clear;
    };

    void stand_at(std::uint32_t patch);
    void add_strata(std::uint32_t node, std::uint32_t depth);
    [[nodiscard]] std::uint32_t part_at(std::uint32_t position, std::uint32_t not_before = 0) const;
    [[nodiscard]] std::uint32_t stratum_at(std::uint32_t part, std::uint32_t position) const;
    void add_patch(std::uint32_t patch, Share share);
    void add_set(std::uint32_t set, Share share);
    void add_to_strata(std::uint32_t part, std::uint32_t low, std::uint32_t high, double area, Share share);
    void add_near(std::uint32_t patch, Share share);
    void add_far(std::uint32_t part, double mean);
    [[nodiscard]] bool may_face_part(std::uint32_t part);
    [[nodiscard]] double spread(std::uint32_t part) const;
    [[nodiscard]] double factor_of_area(std::uint32_t part, const Stratum& stratum, double spread) const;

    const PatchMesh& mesh_;
    const ClusterTree& tree_;
    const ExchangeAreas& exchange_;
    double opening_;
    const SetPlaces* places_ = nullptr;    ///< of the sets of the row
    std::uint32_t patch_ = 0;              ///< of the row
    double area_ = 0.0;                    ///< of it
    double shares_ = 0.0;                  ///< of all patches that the row tells of
    std::uint64_t known_ = 0;              ///< number of these
    std::vector<ClusterTree::Part> parts_; ///< what it sees
    std::vector<std::uint32_t> begins_;    ///< of the parts: positions of their first patches
    std::vector<Sum> sums_;                ///< by part
    std::vector<Stratum> strata_;          ///< part by part
    bool hides_ = false;                   ///< see ClusteredRow
    std::vector<ClusterEntry> near_;       ///< of the row, in any order
    std::vector<ClusterEntry> far_;
};

} // namespace hemi
