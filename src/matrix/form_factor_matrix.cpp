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

void check_row(const RowBlock& block, std::uint32_t local, std::uint32_t all_columns) {
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
    }
}

} // namespace

double RowView::sum() const {
    double sum = 0.0;
    for (const float value : values) {
        sum += static_cast<double>(value);
    }
    return sum;
}

FormFactorMatrix::FormFactorMatrix(std::uint32_t size, std::shared_ptr<const SourceClusters> clusters)
    : size_(size), columns_(size), clusters_(std::move(clusters)) {
    if (clusters_ != nullptr) {
        if (clusters_->size() != size) {
            throw InvalidArgument(fmt::format("{} rows and clusters of {} patches; it must be as many", size,
                                              clusters_->size()));
        }
        columns_ += static_cast<std::uint32_t>(clusters_->nodes().size());
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
    const RowBlock& block = blocks_[i / block_rows];
    const std::uint32_t local = i % block_rows;
    const std::size_t begin = block.begin[local];
    const std::size_t count = block.begin[local + 1] - begin;
    return {.columns = std::span(block.columns).subspan(begin, count),
            .values = std::span(block.values).subspan(begin, count),
            .visibility = block.visibility.empty() ? std::span<const std::uint8_t>()
                                                   : std::span(block.visibility).subspan(begin, count),
            .environment = block.environment[local],
            .blocked = block.blocked[local]};
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
    return entries() > 0 && std::all_of(blocks_.begin(), blocks_.end(), [](const RowBlock& block) {
               return block.visibility.size() == block.values.size();
           });
}

std::uint64_t FormFactorMatrix::entries() const noexcept {
    std::uint64_t count = 0;
    for (const RowBlock& block : blocks_) {
        count += block.columns.size();
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
    return bytes;
}

void FormFactorMatrix::set_block(RowBlock block) {
    check_shape(block, size_);
    for (std::uint32_t local = 0; local < block.rows(); ++local) {
        check_row(block, local, columns_);
    }
    blocks_[block.first_row / block_rows] = std::move(block);
}

std::vector<RowBlock> FormFactorMatrix::take_blocks() {
    return std::exchange(blocks_, FormFactorMatrix(size_).blocks_);
}

} // namespace hemi
