#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace hemi::io {

/// The number whose bytes, in that order, begin at `data`.
template <class Number>
[[nodiscard]] Number load(const char* data, std::endian order) {
    std::array<char, sizeof(Number)> bytes;
    std::memcpy(bytes.data(), data, bytes.size());
    if (order != std::endian::native) {
        std::reverse(bytes.begin(), bytes.end());
    }
    return std::bit_cast<Number>(bytes);
}

} // namespace hemi::io
