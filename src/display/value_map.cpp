#include "hemi/display/value_map.hpp"

#include "display/colour_scale.hpp"
#include "display/legend.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hemi {

namespace {

constexpr std::uint32_t widest = 800;
constexpr std::uint32_t largest_cell = 32;
constexpr std::uint8_t paper = 255;

/// Display linear to the sRGB curve, 8 bits. Source: IEC 61966-2-1.
std::uint8_t encoded(float linear) {
    const double x = std::clamp(static_cast<double>(linear), 0.0, 1.0);
    const double curved = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255.0 * curved));
}

/// The map with a legend below it.
ValueMap with_legend(const ValueMap& map, const ColourScale& scale, const std::string& title,
                     const std::array<bool, 2>& beyond) {
    const Picture legend = legend_strip(map.width, scale, title, beyond);
    ValueMap both{legend.width, map.height + legend.height, {}};
    both.rgb.assign(std::size_t{both.width} * map.height * 3, paper);
    for (std::uint32_t y = 0; y < map.height; ++y) {
        std::copy_n(map.rgb.begin() + std::ptrdiff_t{y} * map.width * 3, std::size_t{map.width} * 3,
                    both.rgb.begin() + std::ptrdiff_t{y} * both.width * 3);
    }
    both.rgb.insert(both.rgb.end(), legend.srgb.begin(), legend.srgb.end());
    return both;
}

} // namespace

ValueMap make_value_map(std::span<const GridValues> grids, const std::array<double, 2>& range,
                        const std::optional<std::string>& legend) {
    if (!(range[0] < range[1])) {
        throw InvalidArgument(fmt::format("map: from {} to {}; the range must ascend", range[0], range[1]));
    }
    std::uint32_t columns = 0;
    std::uint32_t rows = 0;
    for (const GridValues& grid : grids) {
        columns = std::max(columns, grid.columns);
        rows += grid.rows + (rows > 0 ? 1 : 0); // a row between grids
        if (grid.cell.size() != grid.values.size() ||
            std::any_of(grid.cell.begin(), grid.cell.end(),
                        [&](std::uint32_t cell) { return cell >= grid.columns * grid.rows; })) {
            throw InvalidArgument(fmt::format("map: {} values for {} cells of a grid of {} x {}",
                                              grid.values.size(), grid.cell.size(), grid.columns, grid.rows));
        }
    }
    if (columns == 0 || rows == 0) {
        throw InvalidArgument("map: no cells");
    }
    const std::uint32_t side = std::clamp(widest / columns, 1u, largest_cell);
    ValueMap map{columns * side, rows * side, {}};
    map.rgb.assign(std::size_t{map.width} * map.height * 3, paper);
    const ColourScale scale{range[0], range[1], false};
    std::array<bool, 2> beyond{false, false};
    std::uint32_t above = 0; // rows of grids before
    for (const GridValues& grid : grids) {
        for (std::size_t k = 0; k < grid.cell.size(); ++k) {
            if (!std::isfinite(grid.values[k])) {
                continue;
            }
            beyond[0] = beyond[0] || grid.values[k] < range[0];
            beyond[1] = beyond[1] || grid.values[k] > range[1];
            const std::array<float, 3> colour = scale_colour(scale.position(grid.values[k]));
            const std::uint32_t column = grid.cell[k] % grid.columns;
            const std::uint32_t row = above + grid.rows - 1 - grid.cell[k] / grid.columns;
            for (std::uint32_t y = row * side; y < (row + 1) * side; ++y) {
                for (std::uint32_t x = column * side; x < (column + 1) * side; ++x) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        map.rgb[(std::size_t{y} * map.width + x) * 3 + c] = encoded(colour[c]);
                    }
                }
            }
        }
        above += grid.rows + 1;
    }
    return legend ? with_legend(map, scale, *legend, beyond) : map;
}

} // namespace hemi
