#include "hemi/matrix/form_factors.hpp"

#include "core/parallel_for.hpp"
#include "hemi/core/error.hpp"
#include "hemi/matrix/product.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hemi {

namespace {

/// Adds up rows of parts.
class RowMerger {
public:
    RowMerger(const FormFactors& factors, std::span<const double> areas,
              std::span<const std::vector<std::uint32_t>> parts_of)
        : factors_(factors), areas_(areas), parts_of_(parts_of), sums_(areas.size(), 0.0) {}

    void add_row(std::uint32_t patch, RowBlock& block) {
        const std::vector<std::uint32_t>& parts = parts_of_[patch];
        const bool known = std::all_of(parts.begin(), parts.end(),
                                       [this](std::uint32_t part) { return factors_.matrix.known(part); });
        double environment = 0.0;
        const bool is_left = areas_[patch] > 0.0;
        double blocked = is_left ? 0.0 : 1.0;
        for (const std::uint32_t part :
             known&& is_left ? std::span<const std::uint32_t>(parts) : std::span<const std::uint32_t>()) {
            const double share = factors_.areas[part] / areas_[patch];
            const RowView row = factors_.matrix.row(part);
            visit_sources(factors_.matrix, row, [&](std::uint32_t source, double factor) {
                const std::uint32_t column = factors_.parts.patch_of[source];
                if (sums_[column] == 0.0 && factor > 0.0) {
                    columns_.push_back(column);
                }
                sums_[column] += share * factor;
            });
            environment += share * row.environment;
            blocked += share * row.blocked;
        }
        std::sort(columns_.begin(), columns_.end());
        columns_.erase(std::unique(columns_.begin(), columns_.end()), columns_.end());
        for (const std::uint32_t column : columns_) {
            block.columns.push_back(column);
            block.values.push_back(static_cast<float>(std::exchange(sums_[column], 0.0)));
        }
        columns_.clear();
        block.begin.push_back(block.columns.size());
        block.environment.push_back(known ? environment : 0.0);
        block.blocked.push_back(known ? blocked : 0.0);
        block.known.push_back(known ? 1 : 0);
    }

private:
    const FormFactors& factors_;
    std::span<const double> areas_;
    std::span<const std::vector<std::uint32_t>> parts_of_;
    std::vector<double> sums_; ///< of every patch; 0 but for `columns_`
    std::vector<std::uint32_t> columns_;
};

} // namespace

FormFactors merge_parts(FormFactors factors) {
    const PatchParts& parts = factors.parts;
    if (!parts.any()) {
        return factors;
    }
    if (parts.patch_of.size() != factors.matrix.size()) {
        throw InvalidArgument(fmt::format("{} parts for {} rows; must be one for each", parts.patch_of.size(),
                                          factors.matrix.size()));
    }
    std::vector<double> areas = areas_of_patches(parts, factors.areas);
    std::vector<std::vector<std::uint32_t>> parts_of(parts.patches());
    for (std::uint32_t part = 0; part < factors.matrix.size(); ++part) {
        parts_of[parts.patch_of[part]].push_back(part);
    }
    FormFactorMatrix matrix(parts.patches());
    std::vector<RowBlock> blocks((std::size_t{parts.patches()} + FormFactorMatrix::block_rows - 1) /
                                 FormFactorMatrix::block_rows);
    parallel_for(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
        RowMerger merger(factors, areas, parts_of);
        for (std::size_t b = begin; b < end; ++b) {
            RowBlock& block = blocks[b];
            block.first_row = static_cast<std::uint32_t>(b) * FormFactorMatrix::block_rows;
            block.begin.push_back(0);
            for (std::uint32_t patch = block.first_row;
                 patch < std::min(block.first_row + FormFactorMatrix::block_rows, parts.patches()); ++patch) {
                merger.add_row(patch, block);
            }
        }
    });
    for (RowBlock& block : blocks) {
        matrix.set_block(std::move(block));
    }
    if (factors.error) {
        factors.error->rows = means_of_patches(parts, factors.areas, factors.error->rows);
    }
    factors.matrix = std::move(matrix);
    factors.areas = std::move(areas);
    factors.group_of = parts.group_of;
    factors.touching.clear();
    factors.reference = FormFactorMatrix(0);
    factors.parts = {};
    factors.cuts = {};
    return factors;
}

} // namespace hemi
