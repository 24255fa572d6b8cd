#include "matrix/pairs.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hemi {

void check_areas(const FormFactorMatrix& factors, std::span<const double> areas) {
    if (areas.size() != factors.size()) {
        throw InvalidArgument(
            fmt::format("{} areas for {} rows of form factors", areas.size(), factors.size()));
    }
    for (std::size_t i = 0; i < areas.size(); ++i) {
        const bool is_gone = areas[i] == 0.0 && factors.row(static_cast<std::uint32_t>(i)).columns.empty();
        if ((!(areas[i] > 0.0) && !is_gone) || !std::isfinite(areas[i])) {
            throw InvalidArgument(fmt::format(
                "patch {}: area {}; it must be finite and above 0, or 0 of an empty row", i, areas[i]));
        }
    }
}

namespace {

/// @param count  entries of a block by its position
template <class Count>
std::vector<std::uint32_t> cut(std::span<const RowBlock> blocks, const Count& count) {
    constexpr std::uint64_t max_slices = 16;
    constexpr std::uint64_t min_entries = 1 << 18; // in a slice; below, a thread costs more than it gains
    std::uint64_t entries = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        entries += count(b);
    }
    const std::uint64_t slices = std::clamp<std::uint64_t>(entries / min_entries, 1, max_slices);
    std::vector<std::uint32_t> cuts{0};
    std::uint64_t before = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        if (cuts.size() < slices && before * slices >= cuts.size() * entries) {
            cuts.push_back(blocks[b].first_row);
        }
        before += count(b);
    }
    cuts.push_back(blocks.empty() ? 0 : blocks.back().first_row + blocks.back().rows());
    return cuts;
}

} // namespace

std::vector<std::uint32_t> slice_rows(std::span<const RowBlock> blocks) {
    return cut(blocks, [blocks](std::size_t b) { return blocks[b].columns.size(); });
}

std::vector<std::uint32_t> slice_rows(const FormFactorMatrix& factors) {
    return cut(factors.blocks(), [&factors](std::size_t b) { return factors.entries(b); });
}

} // namespace hemi
