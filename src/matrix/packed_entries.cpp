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
    const std::uint8_t* const end = bytes_.data() + bytes_.size();
    std::uint32_t column = 0;
    for (std::uint32_t k = 0; k < size_;) {
        std::uint64_t next = ~std::uint64_t{0};
        if (end - step >= static_cast<std::ptrdiff_t>(sizeof(next))) {
            std::memcpy(&next, step, sizeof(next));
        }
        if ((next & 0x8080808080808080U) == 0) { // as many steps of a byte each
            for (std::size_t b = 0; b < sizeof(next); ++b) {
                column += *step++;
                columns[k++] = column;
            }
        } else {
            column += next_step(step);
            columns[k++] = column;
        }
    }
    const std::uint8_t* const upper = bytes_.data();
    const std::uint8_t* const low = lower();
    const std::size_t count = size_;
    for (std::size_t k = 0; k < count; ++k) {
        values[k] = value_at(upper, low, k);
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
    const auto upper = static_cast<std::uint16_t>(code >> 8U);
    std::memcpy(&bytes_[sizeof(upper) * k], &upper, sizeof(upper));
    bytes_[2 * std::size_t{size_} + k] = static_cast<std::uint8_t>(code);
}

} // namespace hemi
