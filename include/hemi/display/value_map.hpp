#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi {

/// An 8-bit sRGB picture.
struct ValueMap {
    std::uint32_t width = 0;       ///< pixels
    std::uint32_t height = 0;      ///< pixels
    std::vector<std::uint8_t> rgb; ///< rows from the top, 3 bytes a pixel
};

/// Values on a grid of cells.
struct GridValues {
    std::uint32_t columns = 0;       ///< from the left
    std::uint32_t rows = 0;          ///< from the bottom
    std::vector<std::uint32_t> cell; ///< of every value: column + columns·row
    std::vector<double> values;      ///< not a number: as where there is none
};

/// False colours of grids, one above the other and the first at the top: from dark violet at the lowest value
/// over blue and green to yellow at the highest, white where there is none. A cell is a square of as many
/// pixels as make the widest grid 800 wide at most, up to 32. The legend stands below, as pictures of false
/// colours have it; < and > at its ends say that there are values beyond.
/// @param grids  at least one, with cells
/// @param range  values of the darkest and of the brightest colour
/// @param legend title of the legend, ASCII, and ² and °; none: there is no legend
/// @throws InvalidArgument for cells that are not there, as many values as cells, no cells, and a range that
///   does not ascend
[[nodiscard]] ValueMap make_value_map(std::span<const GridValues> grids, const std::array<double, 2>& range,
                                      const std::optional<std::string>& legend = std::nullopt);

} // namespace hemi
