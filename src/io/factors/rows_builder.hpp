#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace hemi::io {

/// A matrix of known rows without balance, made row by row.
class RowsBuilder {
public:
    explicit RowsBuilder(std::uint32_t rows) : matrix_(rows) { begin_block(); }

    /// An entry of the present row; in any order. @param value  finite, not negative
    void add(std::uint32_t column, float value) { entries_.emplace_back(column, value); }
    /// Ends the present row. The first column that it has twice, if there is one: the row is then not used.
    [[nodiscard]] std::optional<std::uint32_t> end_row();

    [[nodiscard]] FormFactorMatrix take() { return std::move(matrix_); }

private:
    void begin_block();

    FormFactorMatrix matrix_;
    RowBlock block_;
    std::uint32_t row_ = 0;
    std::vector<std::pair<std::uint32_t, float>> entries_;
};

} // namespace hemi::io
