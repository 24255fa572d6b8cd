#include "hemi/matrix/form_factor_matrix.hpp"

#include "hemi/core/error.hpp"
#include "hemi/matrix/source_clusters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hemi {

namespace {

std::uint32_t rows_in_block(std::uint32_t size, std::uint32_t first_row) {
    return std::min(FormFactorMatrix::block_rows, size - first_row);
}

[[noreturn]] void refuse(const RowBlock& block, const std::string& what) {
    throw InvalidArgument(fmt::format("block of form factors at row {}: {}", block.first_row, what));
}

void check_shape(const RowBlock& block, std::uint32_t size) {
    if (block.first_row >= size || block.first_row % FormFactorMatrix::block_rows != 0) {
        refuse(block, fmt::format("it must start at a multiple of {} below the {} rows of the matrix",
                                  FormFactorMatrix::block_rows, size));
    }
    const std::size_t rows = rows_in_block(size, block.first_row);
    if (block.known.size() != rows || block.environment.size() != rows || block.blocked.size() != rows ||
        block.begin.size() != rows + 1) {
        refuse(block, fmt::format("{} rows, {} environment shares, {} blocked shares and {} offsets; it must "
                                  "be {} of each and one more offset",
                                  block.known.size(), block.environment.size(), block.blocked.size(),
                                  block.begin.size(), rows));
    }
    if (block.columns.size() != block.values.size()) {
        refuse(block, fmt::format("{} columns and {} values; it must be as many", block.columns.size(),
                                  block.values.size()));
    }
    if (!block.visibility.empty() && block.visibility.size() != block.values.size()) {
        refuse(block, fmt::format("{} visibilities for {} values; it must be as many or none",
                                  block.visibility.size(), block.values.size()));
    }
    if (block.begin.front() != 0 || block.begin.back() != block.columns.size() ||
        !std::is_sorted(block.begin.begin(), block.begin.end())) {
        refuse(block, fmt::format("offsets must ascend from 0 to the {} entries", block.columns.size()));
    }
}

void check_share(const RowBlock& block, std::uint32_t row, const char* name, double share) {
    if (!std::isfinite(share) || share < 0.0) {
        refuse(block,
               fmt::format("row {}: {} share {}; it must be finite and not negative", row, name, share));
    }
}

/// @param size  columns from here on are clusters
void check_row(const RowBlock& block, std::uint32_t local, std::uint32_t size, std::uint32_t all_columns) {
    const std::uint32_t row = block.first_row + local;
    const std::uint64_t begin = block.begin[local];
    const std::uint64_t end = block.begin[local + 1];
    if (block.known[local] == 0 && begin != end) {
        refuse(block,
               fmt::format("row {} is unknown and has {} entries; it must be empty", row, end - begin));
    }
    check_share(block, row, "environment", block.environment[local]);
    check_share(block, row, "blocked", block.blocked[local]);
    // Without branches first, which is several times as fast; what is wrong is looked for only if something
    // is.
    const std::uint32_t* const columns = block.columns.data();
    const float* const values = block.values.data();
    std::uint32_t wrong = begin < end && columns[end - 1] >= all_columns ? 1 : 0;
    for (std::uint64_t k = begin; k + 1 < end; ++k) {
        wrong |= columns[k] >= columns[k + 1] ? 1u : 0u;
    }
    for (std::uint64_t k = begin; k < end; ++k) {
        wrong |= values[k] >= 0.0F && values[k] <= std::numeric_limits<float>::max() ? 0u : 1u;
    }
    // Clusters are last.
    for (std::uint64_t k = end; k > begin && columns[k - 1] >= size; --k) {
        wrong |= values[k - 1] < PackedEntries::too_large ? 0u : 1u;
    }
    for (std::uint64_t k = begin; k < end && wrong != 0; ++k) {
        const std::uint32_t column = block.columns[k];
        if (column >= all_columns || (k > begin && column <= block.columns[k - 1])) {
            refuse(block, fmt::format("row {}: column {}; columns must ascend and be below {}", row, column,
                                      all_columns));
        }
        if (!(block.values[k] >= 0.0F) || !std::isfinite(block.values[k])) {
            refuse(block, fmt::format("F({}, {}) = {}; it must be finite and not negative", row, column,
                                      block.values[k]));
        }
        if (column >= size && !(block.values[k] < PackedEntries::too_large)) {
            refuse(block, fmt::format("row {}: {} for a cluster; it must be below 2", row, block.values[k]));
        }
    }
}

/// Where the entries of clusters of a block's row begin, which begins at `begin`.
std::uint64_t clusters_from(const RowBlock& block, std::uint32_t local, std::uint64_t begin,
                            std::uint32_t size) {
    const auto columns = block.columns.begin();
    return static_cast<std::uint64_t>(
        std::lower_bound(columns + static_cast<std::ptrdiff_t>(begin),
                         columns + static_cast<std::ptrdiff_t>(block.begin[local + 1]), size) -
        columns);
}

/// Packed values are as they must be.
void check_packed(const RowBlock& block, std::uint32_t local, const PackedEntries& entries,
                  std::uint32_t size, std::uint32_t all_columns) {
    const std::uint32_t row = block.first_row + local;
    if (block.known[local] == 0 && entries.size() > 0) {
        refuse(block,
               fmt::format("row {} is unknown and has {} entries; it must be empty", row, entries.size()));
    }
    std::uint64_t next = size;
    bool ascending = true;
    entries.visit([&](std::uint32_t column, float /*value*/, std::uint8_t /*visibility*/) {
        ascending = ascending && column >= next;
        next = std::uint64_t{column} + 1;
    });
    if (!ascending || next > all_columns) {
        refuse(block,
               fmt::format("row {}: clusters must ascend from {} and be below {}", row, size, all_columns));
    }
}

template <class T>
std::span<const T> part_of(const RowArray<T>& array, std::uint64_t begin, std::uint64_t end) {
    return array.empty() ? std::span<const T>() : std::span(array).subspan(begin, end - begin);
}

/// Takes the entries of clusters out of a block and packs them.
/// @param size  columns from here on are clusters
/// @return those of every row
std::vector<PackedEntries> take_clusters(RowBlock& block, std::uint32_t size) {
    std::vector<PackedEntries> packed;
    std::uint64_t kept = 0;
    std::uint64_t begin = 0;
    for (std::uint32_t local = 0; local < block.rows(); ++local) {
        const std::uint64_t far = clusters_from(block, local, begin, size);
        const std::uint64_t end = block.begin[local + 1];
        packed.emplace_back(part_of(block.columns, far, end), part_of(block.values, far, end),
                            part_of(block.visibility, far, end));
        const auto move_forward = [&](auto& array) {
            if (!array.empty()) {
                const auto at = array.begin();
                std::copy(at + static_cast<std::ptrdiff_t>(begin), at + static_cast<std::ptrdiff_t>(far),
                          at + static_cast<std::ptrdiff_t>(kept));
            }
        };
        move_forward(block.columns);
        move_forward(block.values);
        move_forward(block.visibility);
        kept += far - begin;
        begin = end;
        block.begin[local + 1] = kept;
    }
    const auto cut = [kept](auto& array) {
        array.resize(std::min<std::size_t>(array.size(), kept));
        array.shrink_to_fit();
    };
    cut(block.columns);
    cut(block.values);
    cut(block.visibility);
    return packed;
}

} // namespace

double RowView::sum() const {
    double sum = 0.0;
    for (const float value : values) {
        sum += static_cast<double>(value);
    }
    return sum;
}

RowView RowBlock::row(std::uint32_t local) const {
    const std::uint64_t from = begin[local];
    const std::uint64_t to = begin[local + 1];
    return {.columns = part_of(columns, from, to),
            .values = part_of(values, from, to),
            .visibility = part_of(visibility, from, to),
            .environment = environment[local],
            .blocked = blocked[local]};
}

FormFactorMatrix::FormFactorMatrix(std::uint32_t size, std::shared_ptr<const SourceClusters> clusters)
    : size_(size), columns_(size), clusters_(std::move(clusters)) {
    if (clusters_ != nullptr) {
        if (clusters_->size() != size) {
            throw InvalidArgument(fmt::format("{} rows and clusters of {} patches; it must be as many", size,
                                              clusters_->size()));
        }
        columns_ += static_cast<std::uint32_t>(clusters_->nodes().size());
        packed_.resize(size);
    }
    blocks_.resize(size / block_rows + (size % block_rows != 0 ? 1 : 0));
    std::uint32_t first_row = 0;
    for (RowBlock& block : blocks_) {
        const std::size_t rows = rows_in_block(size, first_row);
        block.first_row = first_row;
        block.begin.assign(rows + 1, 0);
        block.environment.assign(rows, 0.0);
        block.blocked.assign(rows, 0.0);
        block.known.assign(rows, 0);
        first_row += static_cast<std::uint32_t>(rows);
    }
}

RowView FormFactorMatrix::row(std::uint32_t i) const {
    RowView row = blocks_[i / block_rows].row(i % block_rows);
    if (!packed_.empty() && packed_[i].size() > 0) {
        const PackedEntries& far = packed_[i];
        const std::size_t near = row.columns.size();
        const std::size_t count = near + far.size();
        const std::size_t codes = far.has_visibility() ? count : 0;
        const auto room = std::make_shared_for_overwrite<std::byte[]>(
            count * (sizeof(std::uint32_t) + sizeof(float)) + codes);
        auto* const columns = reinterpret_cast<std::uint32_t*>(room.get());
        auto* const values = reinterpret_cast<float*>(columns + count);
        auto* const visibility = reinterpret_cast<std::uint8_t*>(values + count);
        std::copy(row.columns.begin(), row.columns.end(), columns);
        std::copy(row.values.begin(), row.values.end(), values);
        std::copy(row.visibility.begin(), row.visibility.end(), visibility);
        far.unpack(columns + near, values + near, visibility + near);
        row.columns = {columns, count};
        row.values = {values, count};
        row.visibility = {visibility, codes};
        row.unpacked = room;
    }
    return row;
}

RowBlock FormFactorMatrix::block(std::size_t b) const {
    if (packed_.empty()) {
        return blocks_[b];
    }
    RowBlock whole;
    whole.first_row = blocks_[b].first_row;
    whole.environment = blocks_[b].environment;
    whole.blocked = blocks_[b].blocked;
    whole.known = blocks_[b].known;
    whole.begin.assign(1, 0);
    const std::uint64_t count = entries(b);
    whole.columns.reserve(count);
    whole.values.reserve(count);
    for (std::uint32_t local = 0; local < whole.rows(); ++local) {
        const RowView row = this->row(whole.first_row + local);
        whole.columns.insert(whole.columns.end(), row.columns.begin(), row.columns.end());
        whole.values.insert(whole.values.end(), row.values.begin(), row.values.end());
        whole.visibility.insert(whole.visibility.end(), row.visibility.begin(), row.visibility.end());
        whole.begin.push_back(whole.columns.size());
    }
    return whole;
}

double FormFactorMatrix::environment(std::uint32_t i) const {
    return blocks_[i / block_rows].environment[i % block_rows];
}

double FormFactorMatrix::blocked(std::uint32_t i) const {
    return blocks_[i / block_rows].blocked[i % block_rows];
}

bool FormFactorMatrix::known(std::uint32_t i) const {
    return blocks_[i / block_rows].known[i % block_rows] != 0;
}

bool FormFactorMatrix::all_known() const {
    return std::all_of(blocks_.begin(), blocks_.end(), [](const RowBlock& block) {
        return std::find(block.known.begin(), block.known.end(), std::uint8_t{0}) == block.known.end();
    });
}

bool FormFactorMatrix::has_visibility() const noexcept {
    return entries() > 0 &&
           std::all_of(
               blocks_.begin(), blocks_.end(),
               [](const RowBlock& block) { return block.visibility.size() == block.values.size(); }) &&
           std::all_of(packed_.begin(), packed_.end(), [](const PackedEntries& entries) {
               return entries.size() == 0 || entries.has_visibility();
           });
}

std::uint64_t FormFactorMatrix::entries() const noexcept {
    std::uint64_t count = 0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        count += entries(b);
    }
    return count;
}

std::uint64_t FormFactorMatrix::entries(std::size_t b) const noexcept {
    std::uint64_t count = blocks_[b].columns.size();
    for (std::uint32_t local = 0; local < blocks_[b].rows() && !packed_.empty(); ++local) {
        count += packed_[blocks_[b].first_row + local].size();
    }
    return count;
}

std::uint64_t FormFactorMatrix::memory_bytes() const noexcept {
    std::uint64_t bytes = sizeof(*this) + blocks_.size() * sizeof(RowBlock);
    for (const RowBlock& block : blocks_) {
        bytes += block.begin.size() * sizeof(std::uint64_t);
        bytes += block.columns.size() * (sizeof(std::uint32_t) + sizeof(float)) + block.visibility.size();
        bytes += (block.environment.size() + block.blocked.size()) * sizeof(double);
        bytes += block.known.size();
    }
    for (const PackedEntries& entries : packed_) {
        bytes += sizeof(entries) + entries.bytes();
    }
    return bytes;
}

void FormFactorMatrix::set_block(RowBlock block) {
    check_shape(block, size_);
    for (std::uint32_t local = 0; local < block.rows(); ++local) {
        check_row(block, local, size_, columns_);
    }
    if (!packed_.empty()) {
        put(take_clusters(block, size_), block.first_row);
    }
    blocks_[block.first_row / block_rows] = std::move(block);
}

void FormFactorMatrix::set_block(RowBlock block, std::vector<PackedEntries> clusters) {
    check_shape(block, size_);
    if (packed_.empty() || clusters.size() != block.rows()) {
        refuse(block, fmt::format("{} rows with and {} without clusters; it must be as many",
                                  packed_.empty() ? 0 : clusters.size(), block.rows()));
    }
    for (std::uint32_t local = 0; local < block.rows(); ++local) {
        check_row(block, local, size_, size_);
        check_packed(block, local, clusters[local], size_, columns_);
    }
    put(std::move(clusters), block.first_row);
    blocks_[block.first_row / block_rows] = std::move(block);
}

void FormFactorMatrix::put(std::vector<PackedEntries> clusters, std::uint32_t first_row) {
    std::move(clusters.begin(), clusters.end(), packed_.begin() + static_cast<std::ptrdiff_t>(first_row));
}

std::vector<RowBlock> FormFactorMatrix::take_blocks() {
    std::vector<RowBlock> blocks;
    if (packed_.empty()) {
        blocks = std::move(blocks_);
    } else {
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            blocks.push_back(block(b));
        }
        packed_ = std::vector<PackedEntries>(size_);
    }
    blocks_ = FormFactorMatrix(size_).blocks_;
    return blocks;
}

} // namespace hemi
