#include "io/factors/row_block_chunk.hpp"

#include <fmt/format.h>

#include <algorithm>

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
    block.columns = payload.take_array<std::uint32_t>(entries);
    block.values = payload.take_array<float>(entries);
    block.visibility = payload.take_array<std::uint8_t>(visibilities);
    block.known = payload.take_array<std::uint8_t>(rows);
    payload.expect_end();
    if (std::any_of(block.known.begin(), block.known.end(), [](std::uint8_t known) { return known > 1; })) {
        payload.fail(fmt::format("rows from {}: marks of known rows other than 0 and 1", block.first_row));
    }
    return block;
}

} // namespace hemi::io
