#include "hemi/engine/row_provider.hpp"

#include "engine/open_block.hpp"
#include "engine/row_sample.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/row_memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace hemi {

namespace {

void check_patches(std::span<const std::uint32_t> patches, std::uint32_t size) {
    for (std::size_t k = 0; k < patches.size(); ++k) {
        if (patches[k] >= size || (k > 0 && patches[k] <= patches[k - 1])) {
            throw InvalidArgument(
                fmt::format("row {} asked for; rows must ascend and be below {}", patches[k], size));
        }
    }
}

} // namespace

FormFactorMatrix compute_matrix(RowProvider& provider, std::span<const std::uint32_t> patches,
                                const Progress& progress) {
    const std::uint32_t size = provider.size();
    check_patches(patches, size);
    FormFactorMatrix matrix(size);
    std::map<std::uint32_t, OpenBlock> open_blocks;
    std::size_t done = 0;
    std::size_t expected_entries = 0; // of a block: what the last one had, and a little more

    provider.rows(patches, [&](std::uint32_t patch, const RowView& row) {
        const std::uint32_t first_row = patch - patch % FormFactorMatrix::block_rows;
        auto found = open_blocks.find(first_row);
        if (found == open_blocks.end()) {
            if (patch >= size || matrix.known(patch)) {
                throw Error(fmt::format("row {} of the form factors came twice or unasked", patch));
            }
            const std::uint32_t rows = std::min(FormFactorMatrix::block_rows, size - first_row);
            found = open_blocks
                        .emplace(first_row, OpenBlock(first_row, rows, rows_of_block(patches, first_row),
                                                      expected_entries))
                        .first;
        }
        OpenBlock& block = found->second;
        block.add(patch, row);
        if (block.complete()) {
            RowBlock finished = block.finish();
            expected_entries = finished.columns.size() + finished.columns.size() / 16;
            matrix.set_block(std::move(finished));
            open_blocks.erase(found);
        }
        ++done;
        if (progress && !progress(done, patches.size())) {
            throw Cancelled();
        }
    });
    if (done != patches.size()) {
        throw Error(fmt::format("{} gave {} of {} rows of the form factors", provider.renderer(), done,
                                patches.size()));
    }
    return matrix;
}

FormFactorMatrix compute_matrix(RowProvider& provider, const Progress& progress) {
    std::vector<std::uint32_t> patches(provider.size());
    std::iota(patches.begin(), patches.end(), 0u);
    return compute_matrix(provider, patches, progress);
}

std::uint64_t matrix_memory(double entries_per_row, std::uint64_t rows, std::uint32_t size) {
    const double in_memory = rows_are_in_file() ? 0.0 : entries_per_row * static_cast<double>(rows);
    const double bytes = in_memory * (sizeof(std::uint32_t) + sizeof(float)) +
                         static_cast<double>(FormFactorMatrix(size).memory_bytes());
    return static_cast<std::uint64_t>(memory_margin * bytes);
}

MatrixEstimate estimate_matrix(RowProvider& provider, std::span<const std::uint32_t> patches,
                               std::uint32_t samples) {
    check_patches(patches, provider.size());
    const RowSample sample =
        sample_rows(provider, patches, samples, [](const RowView& row) { return row.columns.size(); });
    return {sample.entries_per_row, matrix_memory(sample.entries_per_row, patches.size(), provider.size()),
            sample.seconds_per_row * static_cast<double>(patches.size())};
}

} // namespace hemi
