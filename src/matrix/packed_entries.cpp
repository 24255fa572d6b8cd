#include "hemi/matrix/packed_entries.hpp"

#include <algorithm>

namespace hemi {

namespace {

std::size_t bytes_of_step(std::uint32_t step) {
    return (static_cast<std::size_t>(std::bit_width(step | 1U)) + 6) / 7;
}

} // namespace

PackedEntries::PackedEntries(std::span<const std::uint32_t> columns, std::span<const float> values,
                             std::span<const std::uint8_t> visibility)
    : size_(static_cast<std::uint32_t>(columns.size())), has_visibility_(!visibility.empty()) {
    std::size_t bytes = bytes_a_value * values.size() + visibility.size();
    std::uint32_t before = 0;
    for (const std::uint32_t column : columns) {
        bytes += bytes_of_step(column - before);
        before = column;
    }
    bytes_.resize(bytes);
    for (std::uint32_t k = 0; k < size_; ++k) {
        set_value(k, values[k]);
    }
    const auto codes = bytes_.begin() + static_cast<std::ptrdiff_t>(bytes_a_value * values.size());
    auto at = std::copy(visibility.begin(), visibility.end(), codes);
    before = 0;
    for (const std::uint32_t column : columns) {
        std::uint32_t step = column - before;
        for (; step >= 128; step >>= 7U) {
            *at++ = static_cast<std::uint8_t>(step & 127U) | 128U;
        }
        *at++ = static_cast<std::uint8_t>(step);
        before = column;
    }
}

void PackedEntries::unpack(std::uint32_t* columns, float* values, std::uint8_t* visibility) const {
    const std::uint8_t* step = steps();
    std::uint32_t column = 0;
    for (std::uint32_t k = 0; k < size_; ++k) {
        column += next_step(step);
        columns[k] = column;
    }
    const std::uint8_t* const packed = bytes_.data();
    for (std::uint32_t k = 0; k < size_; ++k) {
        values[k] = value_at(packed + bytes_a_value * k);
    }
    if (has_visibility_) {
        std::copy_n(codes(), size_, visibility);
    }
}

double PackedEntries::sum() const {
    double sum = 0.0;
    for (std::uint32_t k = 0; k < size_; ++k) {
        sum += static_cast<double>(value(k));
    }
    return sum;
}

void PackedEntries::set_value(std::uint32_t k, float value) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(std::max(0.0F, value));
    constexpr std::uint32_t half = 1U << (dropped_bits - 1U);
    constexpr std::uint32_t largest = (1U << (8U * bytes_a_value)) - 1U;
    const std::uint32_t code =
        bits + half < smallest ? 0 : std::min(largest, ((bits + half - smallest) >> dropped_bits) + 1U);
    std::uint8_t* const at = &bytes_[bytes_a_value * k];
    at[0] = static_cast<std::uint8_t>(code);
    at[1] = static_cast<std::uint8_t>(code >> 8U);
    at[2] = static_cast<std::uint8_t>(code >> 16U);
}

} // namespace hemi
