#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

namespace hemi {

/// Cells of a grid that belong to no rectangle yet: by row and column, each with what stands for it.
using Cells = std::map<std::array<std::uint32_t, 2>, std::uint32_t>;

/// Cells that fill a rectangle of a grid.
struct Rectangle {
    std::uint32_t row = 0; ///< the first
    std::uint32_t column = 0;
    std::uint32_t rows = 1;
    std::uint32_t columns = 1;
    std::vector<std::uint32_t> cells; ///< what stands for each, row by row
};

/// Takes the largest rectangle that begins at the first cell, first along its row, out of the cells.
/// @param cells  one at least
[[nodiscard]] Rectangle take_rectangle(Cells& cells);

} // namespace hemi
