#include "hemi/display/lightmap.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>

namespace hemi {

namespace {

constexpr std::uint32_t smallest_size = 16;
constexpr std::uint32_t largest_size = 16384;
/// Repeated texels around a rectangle: smaller levels of a texture mix some of them in.
constexpr std::uint32_t padding = 2;

/// Which corner of a quadrilateral lies at (0, 0), (1, 0), (0, 1) and (1, 1) of its rectangle.
using CornerOrder = std::array<std::uint32_t, 4>;
constexpr std::array<CornerOrder, 8> corner_orders{{{0, 1, 3, 2},
                                                    {1, 0, 2, 3},
                                                    {3, 2, 0, 1},
                                                    {2, 3, 1, 0},
                                                    {0, 3, 1, 2},
                                                    {3, 0, 2, 1},
                                                    {1, 2, 0, 3},
                                                    {2, 1, 3, 0}}};

/// A rectangle of patches, row by row.
struct Chart {
    std::uint32_t first = 0; ///< patch
    std::uint32_t columns = 1;
    std::uint32_t rows = 1;
    CornerOrder order = corner_orders[0];
    bool triangle = false;
    std::uint32_t x = 0; ///< of its padding, texels
    std::uint32_t y = 0;

    [[nodiscard]] std::uint32_t patch(std::uint32_t column, std::uint32_t row) const {
        return first + row * columns + column;
    }
    /// With padding, at so many texels a patch.
    [[nodiscard]] std::uint32_t width(std::uint32_t texels) const {
        return columns * texels + 1 + 2 * padding;
    }
    [[nodiscard]] std::uint32_t height(std::uint32_t texels) const { return rows * texels + 1 + 2 * padding; }
};

class Builder {
public:
    Builder(const PatchMesh& mesh, std::span<const float> radiosity) : mesh_(mesh), radiosity_(radiosity) {
        for (std::uint32_t s = 0; s < mesh.surfaces().size(); ++s) {
            const std::uint32_t patches = mesh.patches_per_side(s);
            for (std::uint32_t first = mesh.first_patch(s); first < mesh.first_patch(s + 1);
                 first += patches) {
                add_side(s, first, patches);
            }
        }
        by_height_.resize(charts_.size());
        std::iota(by_height_.begin(), by_height_.end(), std::size_t{0});
        std::stable_sort(by_height_.begin(), by_height_.end(), [this](std::size_t a, std::size_t b) {
            return std::pair(charts_[a].rows, charts_[a].columns) >
                   std::pair(charts_[b].rows, charts_[b].columns);
        });
    }

    /// In shelves; the tallest first.
    /// @return whether they fit
    bool pack(std::uint32_t size, std::uint32_t texels) {
        std::uint32_t x = 0;
        std::uint32_t y = 0;
        std::uint32_t shelf = 0;
        for (const std::size_t k : by_height_) {
            Chart& chart = charts_[k];
            const std::uint32_t width = chart.width(texels);
            const std::uint32_t height = chart.height(texels);
            if (x + width > size) {
                x = 0;
                y += shelf;
                shelf = 0;
            }
            if (width > size || y + height > size) {
                return false;
            }
            chart.x = x;
            chart.y = y;
            x += width;
            shelf = std::max(shelf, height);
        }
        return true;
    }

    [[nodiscard]] Lightmap draw(std::uint32_t size, std::uint32_t texels) const {
        Lightmap map{size, texels, std::vector<float>(std::size_t{size} * size * 3, 0.0F),
                     std::vector<float>(std::size_t{mesh_.size()} * 8, 0.0F)};
        for (const Chart& chart : charts_) {
            put_coordinates(chart, map);
            put_texels(chart, map);
        }
        return map;
    }

private:
    void add_side(std::uint32_t s, std::uint32_t first, std::uint32_t patches) {
        const bool triangle = mesh_.surfaces()[s].vertex_count == 3;
        const Grid grid = mesh_.grid(s);
        if (!triangle && mesh_.parts(s).empty() && std::size_t{grid.u} * grid.v == patches) {
            for (const CornerOrder& order : corner_orders) {
                const Chart whole{first, grid.u, grid.v, order, false, 0, 0};
                if (is_joined(whole)) {
                    charts_.push_back(whole);
                    return;
                }
            }
        }
        for (std::uint32_t i = first; i < first + patches; ++i) {
            charts_.push_back({i, 1, 1, corner_orders[0], mesh_.corners(i).count == 3, 0, 0});
        }
    }

    [[nodiscard]] std::array<float, 3> value(std::uint32_t patch, std::uint32_t corner) const {
        const std::size_t at = (std::size_t{patch} * 4 + corner) * 3;
        return {radiosity_[at], radiosity_[at + 1], radiosity_[at + 2]};
    }

    /// Whether two corners are one, with one value.
    [[nodiscard]] bool is_same(std::uint32_t a, std::uint32_t of_a, std::uint32_t b,
                               std::uint32_t of_b) const {
        constexpr float rounding = 1e-5F;
        const double near = 1e-6 * glm::distance(mesh_.corners(a).points[0], mesh_.corners(a).points[2]);
        if (glm::distance(mesh_.corners(a).points[of_a], mesh_.corners(b).points[of_b]) > near) {
            return false;
        }
        const std::array<float, 3> one = value(a, of_a);
        const std::array<float, 3> other = value(b, of_b);
        for (std::size_t c = 0; c < 3; ++c) {
            if (std::abs(one[c] - other[c]) > rounding * std::max(std::abs(one[c]), std::abs(other[c]))) {
                return false;
            }
        }
        return true;
    }

    [[nodiscard]] bool is_joined(const Chart& chart) const {
        const CornerOrder& order = chart.order;
        for (std::uint32_t row = 0; row < chart.rows; ++row) {
            for (std::uint32_t column = 0; column < chart.columns; ++column) {
                const std::uint32_t here = chart.patch(column, row);
                if (column + 1 < chart.columns) {
                    const std::uint32_t right = chart.patch(column + 1, row);
                    if (!is_same(here, order[1], right, order[0]) ||
                        !is_same(here, order[3], right, order[2])) {
                        return false;
                    }
                }
                if (row + 1 < chart.rows) {
                    const std::uint32_t above = chart.patch(column, row + 1);
                    if (!is_same(here, order[2], above, order[0]) ||
                        !is_same(here, order[3], above, order[1])) {
                        return false;
                    }
                }
            }
        }
        return true;
    }

    void put_coordinates(const Chart& chart, Lightmap& map) const {
        for (std::uint32_t row = 0; row < chart.rows; ++row) {
            for (std::uint32_t column = 0; column < chart.columns; ++column) {
                for (std::uint32_t node = 0; node < 4; ++node) {
                    const std::uint32_t corner = corner_of(chart, node);
                    const std::size_t at =
                        (std::size_t{chart.patch(column, row)} * 4 + corner) * std::size_t{2};
                    const auto place = [&](std::uint32_t start, std::uint32_t step) {
                        const double texel =
                            start + padding + 0.5 + static_cast<double>(map.patch_size) * step;
                        return static_cast<float>(texel / map.size);
                    };
                    map.coordinates[at] = place(chart.x, column + node % 2);
                    map.coordinates[at + 1] = place(chart.y, row + node / 2);
                }
            }
        }
    }

    /// Corner of a patch at a node of its cell; the fourth of a triangle is its third again.
    [[nodiscard]] static std::uint32_t corner_of(const Chart& chart, std::uint32_t node) {
        constexpr std::array<std::uint32_t, 4> of_triangle{0, 1, 2, 3};
        return chart.triangle ? of_triangle[node] : chart.order[node];
    }

    /// Values at the nodes of a patch's cell; the one beyond a triangle makes it a plane.
    [[nodiscard]] std::array<std::array<float, 3>, 4> nodes(const Chart& chart, std::uint32_t patch) const {
        std::array<std::array<float, 3>, 4> values{};
        for (std::uint32_t node = 0; node < 4; ++node) {
            values[node] = value(patch, corner_of(chart, node));
        }
        for (std::size_t c = 0; c < 3 && chart.triangle; ++c) {
            values[3][c] = values[1][c] + values[2][c] - values[0][c];
        }
        return values;
    }

    void put_texels(const Chart& chart, Lightmap& map) const {
        const std::uint32_t across = chart.columns * map.patch_size;
        const std::uint32_t upwards = chart.rows * map.patch_size;
        const auto inside = [](std::uint32_t texel, std::uint32_t last) {
            return std::min(texel < padding ? 0 : texel - padding, last);
        };
        for (std::uint32_t y = 0; y < chart.height(map.patch_size); ++y) {
            for (std::uint32_t x = 0; x < chart.width(map.patch_size); ++x) {
                const std::uint32_t right = inside(x, across);
                const std::uint32_t up = inside(y, upwards);
                const std::uint32_t column = std::min(right / map.patch_size, chart.columns - 1);
                const std::uint32_t row = std::min(up / map.patch_size, chart.rows - 1);
                const auto values = nodes(chart, chart.patch(column, row));
                const float u =
                    static_cast<float>(right - column * map.patch_size) / static_cast<float>(map.patch_size);
                const float v =
                    static_cast<float>(up - row * map.patch_size) / static_cast<float>(map.patch_size);
                const std::size_t at = (std::size_t{chart.y + y} * map.size + chart.x + x) * 3;
                for (std::size_t c = 0; c < 3; ++c) {
                    map.texels[at + c] =
                        std::max(0.0F, (1.0F - v) * ((1.0F - u) * values[0][c] + u * values[1][c]) +
                                           v * ((1.0F - u) * values[2][c] + u * values[3][c]));
                }
            }
        }
    }

    const PatchMesh& mesh_;
    std::span<const float> radiosity_;
    std::vector<Chart> charts_;
    std::vector<std::size_t> by_height_;
};

} // namespace

Lightmap make_lightmap(const PatchMesh& mesh, std::span<const float> radiosity, std::uint32_t size) {
    constexpr std::uint32_t most_texels = 256; // a patch
    if (radiosity.size() != std::size_t{mesh.size()} * 12) {
        throw InvalidArgument(fmt::format("lightmap: {} radiosities for {} patches; must be 12 for each",
                                          radiosity.size(), mesh.size()));
    }
    if (size < smallest_size || size > largest_size) {
        throw InvalidArgument(
            fmt::format("lightmap: {} texels; must be {} to {}", size, smallest_size, largest_size),
            {"lightmap"});
    }
    Builder builder(mesh, radiosity);
    if (!builder.pack(size, 1)) {
        std::uint32_t enough = size;
        while (enough < largest_size && !builder.pack(enough, 1)) {
            enough = std::min(2 * enough, largest_size);
        }
        throw InvalidArgument(
            builder.pack(enough, 1)
                ? fmt::format("lightmap: {} patches do not fit into {} texels; {} are enough", mesh.size(),
                              size, enough)
                : fmt::format("lightmap: {} patches do not fit into {} texels; larger patches do",
                              mesh.size(), enough),
            {"lightmap"});
    }
    std::uint32_t fits = 1;
    std::uint32_t beyond = most_texels + 1;
    while (beyond - fits > 1) {
        const std::uint32_t middle = fits + (beyond - fits) / 2;
        (builder.pack(size, middle) ? fits : beyond) = middle;
    }
    (void)builder.pack(size, fits);
    return builder.draw(size, fits);
}

} // namespace hemi
