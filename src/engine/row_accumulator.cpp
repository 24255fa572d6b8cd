#include "engine/row_accumulator.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace hemi {

namespace {

/// Bit k is set where row[k] differs from row[k + 1], for k in [0, 64).
std::uint64_t changes_of_64(const std::uint32_t* row) {
    std::uint64_t mask = 0;
#if defined(__SSE2__)
    for (int k = 0; k < 64; k += 4) {
        const __m128i here = _mm_loadu_si128(reinterpret_cast<const __m128i*>(row + k));
        const __m128i next = _mm_loadu_si128(reinterpret_cast<const __m128i*>(row + k + 1));
        const int same = _mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(here, next)));
        mask |= static_cast<std::uint64_t>(~same & 0xF) << k;
    }
#else
    for (int k = 0; k < 64; ++k) {
        mask |= static_cast<std::uint64_t>(row[k] != row[k + 1]) << k;
    }
#endif
    return mask;
}

} // namespace

RowAccumulator::RowAccumulator(const DeltaFormFactors& weights, std::span<const std::uint32_t> item_of_id,
                               std::uint32_t patches)
    : weights_(weights), item_of_id_(item_of_id), identity_(true), sums_(item_first_patch + patches),
      touched_((sums_.size() + 7) / 8 * 8), columns_(patches), values_(patches) {
    for (std::uint32_t id = 0; id < item_of_id.size() && identity_; ++id) {
        identity_ = item_of_id[id] == id;
    }
}

void RowAccumulator::add(const std::uint32_t* ids) {
    if (identity_) {
        add_rows<true>(ids);
    } else {
        add_rows<false>(ids);
    }
}

template <bool identity>
void RowAccumulator::add_rows(const std::uint32_t* ids) {
    const std::uint32_t resolution = weights_.resolution();
    // Local copies, so that the compiler need not fear that a sum overwrites them.
    const std::uint32_t* const item_of_id = item_of_id_.data();
    std::uint32_t* const sums = sums_.data();
    std::uint8_t* const touched = touched_.data();
    for (std::uint32_t y = 0; y < weights_.rows(); ++y) {
        const std::uint32_t* const row = ids + std::size_t{y} * resolution;
        const std::uint32_t* const prefix = weights_.prefix_row(y).data();
        std::uint32_t before = prefix[0];
        const auto end_run = [&](std::uint32_t last) {
            const std::uint32_t item = identity ? row[last] : item_of_id[row[last]];
            const std::uint32_t upto = prefix[last + 1];
            sums[item] += upto - before;
            touched[item] = 1; // a byte, not a bit: neighbours would wait for each other's
            before = upto;
        };
        std::uint32_t x = 0;
        // The comparison reads one texel past the 64, so the row's last texel is left to the loop below.
        for (; x + 64 < resolution; x += 64) {
            for (std::uint64_t mask = changes_of_64(row + x); mask != 0; mask &= mask - 1) {
                end_run(x + static_cast<std::uint32_t>(std::countr_zero(mask)));
            }
        }
        for (; x + 1 < resolution; ++x) {
            if (row[x] != row[x + 1]) {
                end_run(x);
            }
        }
        end_run(resolution - 1);
    }
}

RowView RowAccumulator::take() {
    constexpr double unit = 1.0 / DeltaFormFactors::total;
    RowView row;
    row.environment = sums_[item_nothing] * unit;
    row.blocked = sums_[item_blocked] * unit;
    sums_[item_nothing] = sums_[item_blocked] = 0;
    touched_[item_nothing] = touched_[item_blocked] = 0;
    double sum = 0.0;
    std::size_t entries = 0;
    for (std::size_t first = 0; first < touched_.size(); first += 8) {
        std::uint64_t flags = 0;
        std::memcpy(&flags, touched_.data() + first, sizeof flags);
        if (flags == 0) {
            continue;
        }
        for (std::size_t item = first; item < first + 8; ++item) {
            if (touched_[item] == 0) {
                continue;
            }
            touched_[item] = 0;
            const auto value = static_cast<float>(sums_[item] * unit);
            columns_[entries] = static_cast<std::uint32_t>(item - item_first_patch);
            values_[entries] = value;
            entries += sums_[item] != 0 ? 1 : 0; // 0: only texels too small to weigh anything
            sums_[item] = 0;
            sum += static_cast<double>(value);
        }
    }
    row.columns = {columns_.data(), entries};
    row.values = {values_.data(), entries};
    // Rounding to float costs some 1e-8 of the row's sum; entries large enough not to notice take it back.
    double missing = 1.0 - row.environment - row.blocked - sum;
    for (std::size_t k = 0; k < entries && missing != 0.0; ++k) {
        const auto value = static_cast<double>(values_[k]);
        if (value > 1e3 * std::abs(missing)) {
            values_[k] = static_cast<float>(value + missing);
            missing -= static_cast<double>(values_[k]) - value;
        }
    }
    // What they cannot take, the larger of the shares that are doubles can; a share of exactly zero says
    // something and stays, and none may vanish or turn negative.
    double& taker = row.blocked > row.environment ? row.blocked : row.environment;
    if (taker > 0.0) {
        if (missing < -0.5 * taker) {
            float& largest =
                *std::max_element(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(entries));
            const float lower = std::nextafter(largest, 0.0f);
            missing += static_cast<double>(largest) - static_cast<double>(lower);
            largest = lower;
        }
        taker += missing;
    }
    return row;
}

} // namespace hemi
