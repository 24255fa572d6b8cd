#pragma once

#include <bit>
#include <cstdint>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace hemi {

/// Bit k is set where row[k] differs from row[k + 1], for k in [0, 64); with `row_ends` nothing beyond
/// row[63] is read, and bit 63 is set.
template <bool row_ends>
[[nodiscard]] inline std::uint64_t changes_of_64(const std::uint32_t* row) {
    std::uint64_t mask = row_ends ? std::uint64_t{1} << 63 : 0;
    constexpr int end = row_ends ? 63 : 64;
    int k = 0;
#if defined(__SSE2__)
    for (; k + 4 <= end; k += 4) {
        const __m128i here = _mm_loadu_si128(reinterpret_cast<const __m128i*>(row + k));
        const __m128i next = _mm_loadu_si128(reinterpret_cast<const __m128i*>(row + k + 1));
        const int same = _mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(here, next)));
        mask |= static_cast<std::uint64_t>(~same & 0xF) << k;
    }
#endif
    for (; k < end; ++k) {
        mask |= static_cast<std::uint64_t>(row[k] != row[k + 1]) << k;
    }
    return mask;
}

/// Calls `end_run(last)` with the last texel of every run of equal ids in a row, in order.
template <typename EndRun>
void for_each_run_end(const std::uint32_t* row, std::uint32_t resolution, const EndRun& end_run) {
    const auto end_runs = [&](std::uint32_t first, std::uint64_t mask) {
        for (; mask != 0; mask &= mask - 1) {
            end_run(first + static_cast<std::uint32_t>(std::countr_zero(mask)));
        }
    };
    std::uint32_t x = 0;
    for (; x + 64 < resolution; x += 64) {
        end_runs(x, changes_of_64<false>(row + x));
    }
    if (x + 64 == resolution) {
        end_runs(x, changes_of_64<true>(row + x));
        return;
    }
    for (; x + 1 < resolution; ++x) {
        if (row[x] != row[x + 1]) {
            end_run(x);
        }
    }
    end_run(resolution - 1);
}

} // namespace hemi
