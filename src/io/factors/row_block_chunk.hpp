#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"
#include "io/formats/chunk_file.hpp"

#include <cstdint>
#include <string_view>

/// A block of rows as one chunk: first row, rows (32 bits each), entries, visibilities (64 bits each), then
/// the arrays of RowBlock: begin, environment, blocked, columns, values, visibility, known.
namespace hemi::io {

void write_row_block(const ByteSink& sink, std::string_view tag, const RowBlock& block);

/// Takes the whole payload. What the block says is for FormFactorMatrix::set_block to judge.
/// @throws InputError if the payload is not what write_row_block writes.
[[nodiscard]] RowBlock take_row_block(Payload& payload);

} // namespace hemi::io
