#include "io/factors/row_block_chunk.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hemi::io {

void write_row_block(const ByteSink& sink, std::string_view tag, const RowBlock& block) {
    const std::uint32_t rows = block.rows();
    const std::uint64_t entries = block.columns.size();
    const std::uint64_t visibilities = block.visibility.size();
    write_chunk(sink, tag,
                {bytes_of(block.first_row), bytes_of(rows), bytes_of(entries), bytes_of(visibilities),
                 bytes_of(block.begin), bytes_of(block.environment), bytes_of(block.blocked),
                 bytes_of(block.columns), bytes_of(block.values), bytes_of(block.visibility),
                 bytes_of(block.known)});
}

RowBlock take_row_block(Payload& payload) {
    RowBlock block;
    block.first_row = payload.take<std::uint32_t>();
    const auto rows = payload.take<std::uint32_t>();
    const auto entries = payload.take<std::uint64_t>();
    const auto visibilities = payload.take<std::uint64_t>();
    block.begin = payload.take_array<std::uint64_t>(std::uint64_t{rows} + 1);
    block.environment = payload.take_array<double>(rows);
    block.blocked = payload.take_array<double>(rows);
    block.columns = payload.take_array<std::uint32_t, RowAllocator<std::uint32_t>>(entries);
    block.values = payload.take_array<float, RowAllocator<float>>(entries);
    block.visibility = payload.take_array<std::uint8_t, RowAllocator<std::uint8_t>>(visibilities);
    block.known = payload.take_array<std::uint8_t>(rows);
    payload.expect_end();
    if (std::any_of(block.known.begin(), block.known.end(), [](std::uint8_t known) { return known > 1; })) {
        payload.fail(fmt::format("rows from {}: marks of known rows other than 0 and 1", block.first_row));
    }
    return block;
}

void set_row_block(Payload payload, FormFactorMatrix& matrix, std::uint32_t first_row) {
    RowBlock block = take_row_block(payload);
    if (block.first_row != first_row) {
        payload.fail(fmt::format("starts at row {}, where row {} must come", block.first_row, first_row));
    }
    try {
        matrix.set_block(std::move(block));
    } catch (const InvalidArgument& error) {
        payload.fail(error.what());
    }
}

std::vector<std::uint32_t> known_blocks(const FormFactorMatrix& matrix) {
    std::vector<std::uint32_t> first_rows;
    for (const RowBlock& block : matrix.blocks()) {
        if (std::find(block.known.begin(), block.known.end(), 1) != block.known.end()) {
            first_rows.push_back(block.first_row);
        }
    }
    return first_rows;
}

std::vector<std::uint32_t> read_first_rows(const JsonNode& list, std::uint32_t size) {
    std::vector<std::uint32_t> first_rows;
    for (std::size_t k = 0; k < list.size(); ++k) {
        const std::uint64_t first_row = list.element(k).integer(std::numeric_limits<std::uint32_t>::max());
        if (first_row >= size || first_row % FormFactorMatrix::block_rows != 0 ||
            (k > 0 && first_row <= first_rows[k - 1])) {
            list.element(k).expect("the first row of a block, in ascending order");
        }
        first_rows.push_back(static_cast<std::uint32_t>(first_row));
    }
    return first_rows;
}

std::vector<double> read_areas(Payload payload, std::uint32_t size) {
    std::vector<double> areas = payload.take_array<double>(size);
    payload.expect_end();
    for (const double area : areas) {
        if (!(area >= 0.0) || !std::isfinite(area)) {
            payload.fail(fmt::format("an area of {}; must be finite and not negative", area));
        }
    }
    return areas;
}

} // namespace hemi::io
