#pragma once

#include "hemi/engine/row_provider.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Estimates of memory have so much on top of what the sample shows: its own error, and blocks that grow.
inline constexpr double memory_margin = 1.2;

/// What some rows took, for what many will need.
struct RowSample {
    double entries_per_row = 0.0; ///< mean
    double seconds_per_row = 0.0;
};

/// Computes up to `samples` of the rows of `patches`, spread evenly, and throws them away.
/// @param count  entries of a row that count
template <class Row, class Count>
[[nodiscard]] RowSample sample_rows(BasicRowProvider<Row>& provider, std::span<const std::uint32_t> patches,
                                    std::uint32_t samples, const Count& count) {
    std::vector<std::uint32_t> sampled;
    const std::uint64_t number = std::min<std::uint64_t>(samples, patches.size());
    for (std::uint64_t k = 0; k < number; ++k) {
        sampled.push_back(patches[(2 * k + 1) * patches.size() / (2 * number)]);
    }
    if (sampled.empty()) {
        return {};
    }
    // The first row also pays for contexts and workers, which do not grow with the number of rows.
    provider.rows(std::span(sampled).first(1), [](std::uint32_t, const Row&) {});
    std::uint64_t entries = 0;
    const auto start = std::chrono::steady_clock::now();
    provider.rows(sampled, [&](std::uint32_t, const Row& row) { entries += count(row); });
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    const auto rows = static_cast<double>(sampled.size());
    return {static_cast<double>(entries) / rows, elapsed.count() / rows};
}

} // namespace hemi
