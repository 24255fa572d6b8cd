#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"
#include "io/formats/chunk_file.hpp"
#include "io/formats/json_node.hpp"

#include <cstdint>
#include <string_view>
#include <vector>

/// A block of rows as one chunk: first row, rows (32 bits each), entries, visibilities (64 bits each), then
/// the arrays of RowBlock: begin, environment, blocked, columns, values, visibility, known.
namespace hemi::io {

void write_row_block(const ByteSink& sink, std::string_view tag, const RowBlock& block);

/// Takes the whole payload. What the block says is for FormFactorMatrix::set_block to judge.
/// @throws InputError if the payload is not what write_row_block writes.
[[nodiscard]] RowBlock take_row_block(Payload& payload);

/// Puts the block of a whole payload into a matrix.
/// @param first_row  where it must start
/// @throws InputError if it is no sound block, or another one
void set_row_block(Payload payload, FormFactorMatrix& matrix, std::uint32_t first_row);

/// First rows of the blocks that have a known row.
[[nodiscard]] std::vector<std::uint32_t> known_blocks(const FormFactorMatrix& matrix);
/// The same from a file's description.
/// @param size  rows of the matrix
/// @throws InputError unless they are first rows of blocks and ascend
[[nodiscard]] std::vector<std::uint32_t> read_first_rows(const JsonNode& list, std::uint32_t size);

/// One area a row, as a whole payload.
/// @throws InputError unless all are finite and not negative
[[nodiscard]] std::vector<double> read_areas(Payload payload, std::uint32_t size);

} // namespace hemi::io
