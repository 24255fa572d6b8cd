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

std::vector<std::uint32_t> slice_rows(std::span<const RowBlock> blocks) {
    constexpr std::uint64_t max_slices = 16;
    constexpr std::uint64_t min_entries = 1 << 18; // in a slice; below, a thread costs more than it gains
    std::uint64_t entries = 0;
    for (const RowBlock& block : blocks) {
        entries += block.columns.size();
    }
    const std::uint64_t slices = std::clamp<std::uint64_t>(entries / min_entries, 1, max_slices);
    std::vector<std::uint32_t> cuts{0};
    std::uint64_t before = 0;
    for (const RowBlock& block : blocks) {
        if (cuts.size() < slices && before * slices >= cuts.size() * entries) {
            cuts.push_back(block.first_row);
        }
        before += block.columns.size();
    }
    cuts.push_back(blocks.empty() ? 0 : blocks.back().first_row + blocks.back().rows());
    return cuts;
}

} // namespace hemi
