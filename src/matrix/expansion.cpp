#include "hemi/matrix/expansion.hpp"

#include "core/parallel_for.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/row_memory.hpp"
#include "hemi/core/text.hpp"
#include "hemi/matrix/product.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace hemi {

namespace {

constexpr std::uint32_t rows_a_block = FormFactorMatrix::block_rows;
constexpr std::uint64_t entry_bytes = sizeof(std::uint32_t) + sizeof(float);

/// At most so many entries a row has by single patches.
std::uint64_t expanded_entries(const FormFactorMatrix& factors, const RowView& row) {
    std::uint64_t entries = 0;
    for (const std::uint32_t column : row.columns) {
        entries += column < factors.size() ? 1 : factors.clusters()->patches(column - factors.size()).size();
    }
    return std::min<std::uint64_t>(entries, factors.size());
}

/// Expands rows into a block, one after another.
class RowExpander {
public:
    explicit RowExpander(const FormFactorMatrix& factors) : factors_(factors), sums_(factors.size(), 0.0) {}

    void add_row(std::uint32_t i, RowBlock& block) {
        const RowView row = factors_.row(i);
        visit_sources(factors_, row, [this](std::uint32_t j, double factor) {
            if (factor > 0.0) {
                if (sums_[j] == 0.0) {
                    columns_.push_back(j);
                }
                sums_[j] += factor;
            }
        });
        std::sort(columns_.begin(), columns_.end());
        for (const std::uint32_t j : columns_) {
            block.columns.push_back(j);
            block.values.push_back(static_cast<float>(std::exchange(sums_[j], 0.0)));
        }
        columns_.clear();
        block.begin.push_back(block.columns.size());
        block.environment.push_back(row.environment);
        block.blocked.push_back(row.blocked);
        block.known.push_back(factors_.known(i) ? 1 : 0);
    }

private:
    const FormFactorMatrix& factors_;
    std::vector<double> sums_; ///< of every patch; 0 but for `columns_`
    std::vector<std::uint32_t> columns_;
};

} // namespace

FormFactorMatrix expand_clusters(const FormFactorMatrix& factors, std::uint64_t max_memory) {
    if (factors.clusters() == nullptr) {
        return factors;
    }
    const std::uint32_t size = factors.size();
    std::uint64_t entries = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
        entries += expanded_entries(factors, factors.row(i));
    }
    if (entries > max_memory / entry_bytes && !rows_are_in_file()) {
        throw OutOfMemory(
            fmt::format("far patches stand in clusters; factors of single patches would take up "
                        "to {}, and the limit is {}",
                        memory_text(entries * entry_bytes), memory_text(max_memory)),
            {"max-memory"});
    }
    std::vector<RowBlock> blocks((std::size_t{size} + rows_a_block - 1) / rows_a_block);
    constexpr std::size_t grain = 16; // an expander has a number for every patch
    parallel_for(blocks.size(), grain, [&](std::size_t begin, std::size_t end) {
        RowExpander expander(factors);
        for (std::size_t b = begin; b < end; ++b) {
            RowBlock& block = blocks[b];
            block.first_row = static_cast<std::uint32_t>(b) * rows_a_block;
            block.begin.push_back(0);
            const std::uint32_t last = std::min(size - block.first_row, rows_a_block) + block.first_row;
            std::uint64_t most = 0;
            for (std::uint32_t i = block.first_row; i < last; ++i) {
                most += expanded_entries(factors, factors.row(i));
            }
            block.columns.reserve(most);
            block.values.reserve(most);
            for (std::uint32_t i = block.first_row; i < last; ++i) {
                expander.add_row(i, block);
            }
            block.columns.shrink_to_fit();
            block.values.shrink_to_fit();
        }
    });
    FormFactorMatrix result(size);
    for (RowBlock& block : blocks) {
        result.set_block(std::move(block));
    }
    return result;
}

} // namespace hemi
