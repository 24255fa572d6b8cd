#include "scene/rectangles.hpp"

namespace hemi {

Rectangle take_rectangle(Cells& cells) {
    Rectangle taken;
    taken.row = cells.begin()->first[0];
    taken.column = cells.begin()->first[1];
    const auto row_is_free = [&](std::uint32_t row) {
        for (std::uint32_t k = 0; k < taken.columns; ++k) {
            if (!cells.contains({row, taken.column + k})) {
                return false;
            }
        }
        return true;
    };
    while (cells.contains({taken.row, taken.column + taken.columns})) {
        ++taken.columns;
    }
    while (row_is_free(taken.row + taken.rows)) {
        ++taken.rows;
    }
    for (std::uint32_t row = 0; row < taken.rows; ++row) {
        for (std::uint32_t column = 0; column < taken.columns; ++column) {
            taken.cells.push_back(cells.extract({taken.row + row, taken.column + column}).mapped());
        }
    }
    return taken;
}

} // namespace hemi
