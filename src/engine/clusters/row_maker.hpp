#pragma once

#include "engine/clusters/cluster_tree.hpp"
#include "engine/clusters/source_sums.hpp"
#include "hemi/core/row_memory.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "hemi/matrix/packed_entries.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// What is known of one source of a row.
struct ClusterEntry {
    std::uint32_t column;
    float value;
    std::uint8_t visibility;
};

/// Entries of a row, 9 bytes each.
class EntryList {
public:
    EntryList() = default;
    explicit EntryList(std::span<const ClusterEntry> entries)
        : size_(static_cast<std::uint32_t>(entries.size())), words_(entries.empty() ? 0 : word_count()) {
        for (std::uint32_t k = 0; k < size_; ++k) {
            words_[k] = entries[k].column;
            words_[size_ + k] = std::bit_cast<std::uint32_t>(entries[k].value);
            reinterpret_cast<std::uint8_t*>(&words_[2 * std::size_t{size_}])[k] = entries[k].visibility;
        }
    }

    [[nodiscard]] std::uint32_t size() const noexcept { return size_; }
    [[nodiscard]] ClusterEntry operator[](std::uint32_t k) const {
        return {words_[k], std::bit_cast<float>(words_[size_ + k]),
                reinterpret_cast<const std::uint8_t*>(&words_[2 * std::size_t{size_}])[k]};
    }
    [[nodiscard]] std::size_t bytes() const { return size_ > 0 ? word_count() * sizeof(std::uint32_t) : 0; }

private:
    [[nodiscard]] std::size_t word_count() const { return 2 * std::size_t{size_} + (size_ + 3) / 4; }

    std::uint32_t size_ = 0;
    RowArray<std::uint32_t> words_; ///< columns, values, and four codes of visibility in each
};

/// Entries as separate arrays.
struct EntryArrays {
    std::vector<std::uint32_t> columns;
    std::vector<float> values;
    std::vector<std::uint8_t> visibility;

    void clear() {
        columns.clear();
        values.clear();
        visibility.clear();
    }
    void add(const ClusterEntry& entry) {
        columns.push_back(entry.column);
        values.push_back(entry.value);
        visibility.push_back(entry.visibility);
    }
    [[nodiscard]] PackedEntries packed() const { return {columns, values, visibility}; }
};

/// One row while all are computed.
struct ClusteredRow {
    EntryList near;    ///< patches, ascending
    PackedEntries far; ///< clusters, ascending: nearly all entries, and most of the memory
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

/// Makes rows of factors of rows of visibility, see SourceSums. One a thread.
class RowMaker {
public:
    /// All must outlive this.
    RowMaker(const PatchMesh& mesh, const ClusterTree& tree, const ExchangeAreas& exchange, double opening)
        : mesh_(mesh), tree_(tree), opening_(opening), sums_(mesh, tree, exchange) {}

    /// @param places  of what the row tells as a whole; null where that is nothing
    [[nodiscard]] ClusteredRow make(const SeenRow& seen, const SetPlaces* places);

private:
    const PatchMesh& mesh_;
    const ClusterTree& tree_;
    double opening_;
    SourceSums sums_;
    std::vector<ClusterTree::Part> parts_; ///< what the patch sees
    std::vector<ClusterEntry> entries_;
    EntryArrays far_;
};

} // namespace hemi
