#include "engine/hemicube/row_accumulator.hpp"

#include "engine/hemicube/texel_runs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace hemi {

namespace {

/// Bit k is set where sums[k] is not 0, for k in [0, 64).
std::uint64_t nonzeros_of_64(const std::uint32_t* sums) {
    std::uint64_t mask = 0;
#if defined(__SSE2__)
    const __m128i zero = _mm_setzero_si128();
    const auto zeros_of_4 = [&](int k) {
        return _mm_cmpeq_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(sums + k)), zero);
    };
    for (int k = 0; k < 64; k += 16) {
        const __m128i low = _mm_packs_epi32(zeros_of_4(k), zeros_of_4(k + 4));
        const __m128i high = _mm_packs_epi32(zeros_of_4(k + 8), zeros_of_4(k + 12));
        const int zeros = _mm_movemask_epi8(_mm_packs_epi16(low, high));
        mask |= static_cast<std::uint64_t>(~zeros & 0xFFFF) << k;
    }
#else
    for (int k = 0; k < 64; ++k) {
        mask |= static_cast<std::uint64_t>(sums[k] != 0) << k;
    }
#endif
    return mask;
}

} // namespace

RowAccumulator::RowAccumulator(std::span<const std::uint32_t> item_of_id, std::uint32_t patches)
    : item_of_id_(item_of_id), identity_(true),
      sums_((std::size_t{item_first_patch} + patches + 511) / 512 * 512), touched_(sums_.size() / 64),
      columns_(patches), values_(patches) {
    for (std::uint32_t id = 0; id < item_of_id.size() && identity_; ++id) {
        identity_ = item_of_id[id] == id;
    }
}

void RowAccumulator::add(const std::uint32_t* ids, const DeltaFormFactors& weights) {
    if (identity_) {
        add_rows<true>(ids, weights);
    } else {
        add_rows<false>(ids, weights);
    }
    total_ += weights.sum();
}

template <bool identity>
void RowAccumulator::add_rows(const std::uint32_t* ids, const DeltaFormFactors& weights) {
    const std::uint32_t resolution = weights.resolution();
    // Local copies, so that the compiler need not fear that a sum overwrites them.
    const std::uint32_t* const item_of_id = item_of_id_.data();
    std::uint32_t* const sums = sums_.data();
    std::uint8_t* const touched = touched_.data();
    for (std::uint32_t y = 0; y < weights.rows(); ++y) {
        const std::uint32_t* const row = ids + std::size_t{y} * resolution;
        const std::uint32_t* const prefix = weights.prefix_row(y).data();
        std::uint32_t before = prefix[0];
        const auto end_run = [&](std::uint32_t last) {
            const std::uint32_t item = identity ? row[last] : item_of_id[row[last]];
            const std::uint32_t upto = prefix[last + 1];
            sums[item] += upto - before;
            touched[item / 64] = 1;
            before = upto;
        };
        for_each_run_end(row, resolution, end_run);
    }
}

void RowAccumulator::add_tiles(std::span<const std::uint32_t> ids, const TileWeights& weights) {
    if (identity_) {
        add_all_tiles<true>(ids, weights);
    } else {
        add_all_tiles<false>(ids, weights);
    }
    total_ += weights.sum;
}

template <bool identity>
void RowAccumulator::add_all_tiles(std::span<const std::uint32_t> ids, const TileWeights& weights) {
    const std::uint32_t* const item_of_id = item_of_id_.data();
    std::uint32_t* const sums = sums_.data();
    std::uint8_t* const touched = touched_.data();
    sum_by_id<std::uint32_t>(ids, weights.weight, weights.tile_weight,
                             [=](std::uint32_t id, std::uint32_t weight) {
                                 const std::uint32_t item = identity ? id : item_of_id[id];
                                 sums[item] += weight;
                                 touched[item / 64] = 1;
                             });
}

RowView RowAccumulator::take() {
    const double unit = 1.0 / std::exchange(total_, 0u);
    RowView row;
    row.environment = sums_[item_nothing] * unit;
    row.blocked = sums_[item_blocked] * unit;
    sums_[item_nothing] = sums_[item_blocked] = 0;
    double sum = 0.0;
    std::size_t entries = 0;
    const auto take_block = [&](std::size_t first) {
        for (std::uint64_t mask = nonzeros_of_64(sums_.data() + first); mask != 0; mask &= mask - 1) {
            const std::size_t item = first + static_cast<std::size_t>(std::countr_zero(mask));
            const auto value = static_cast<float>(sums_[item] * unit);
            columns_[entries] = static_cast<std::uint32_t>(item - item_first_patch);
            values_[entries] = value;
            ++entries;
            sums_[item] = 0;
            sum += static_cast<double>(value);
        }
    };
    for (std::size_t block = 0; block < touched_.size(); block += sizeof(std::uint64_t)) {
        std::uint64_t any = 0;
        std::memcpy(&any, touched_.data() + block, sizeof any);
        if (any == 0) {
            continue;
        }
        for (std::size_t k = block; k < block + sizeof any; ++k) {
            if (std::exchange(touched_[k], std::uint8_t{0}) != 0) {
                take_block(64 * k);
            }
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
