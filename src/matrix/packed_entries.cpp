#include "hemi/matrix/packed_entries.hpp"

#include <algorithm>
#include <vector>

namespace hemi {

namespace {

/// In as many bytes as it takes, 7 bits in each, the lowest first.
void append_number(std::vector<std::uint8_t>& bytes, std::uint32_t number) {
    for (; number >= 128; number >>= 7U) {
        bytes.push_back(static_cast<std::uint8_t>(number & 127U) | 128U);
    }
    bytes.push_back(static_cast<std::uint8_t>(number));
}

} // namespace

PackedEntries::PackedEntries(std::span<const std::uint32_t> columns, std::span<const float> values,
                             std::span<const std::uint8_t> visibility)
    : size_(static_cast<std::uint32_t>(columns.size())), has_visibility_(!visibility.empty()) {
    std::vector<std::uint8_t> steps(size_);
    std::uint32_t before = 0;
    std::uint32_t last_large = 0;
    for (std::uint32_t k = 0; k < size_; ++k) {
        const std::uint32_t step = columns[k] - before;
        before = columns[k];
        steps[k] = static_cast<std::uint8_t>(step);
        if (step > 255) {
            append_number(steps, k - last_large);
            append_number(steps, step >> 8U);
            last_large = k;
        }
    }
    bytes_.resize(bytes_a_value * values.size() + visibility.size() + steps.size());
    for (std::uint32_t k = 0; k < size_; ++k) {
        set_value(k, values[k]);
    }
    const auto codes = bytes_.begin() + static_cast<std::ptrdiff_t>(bytes_a_value * values.size());
    std::copy(steps.begin(), steps.end(), std::copy(visibility.begin(), visibility.end(), codes));
}

void PackedEntries::unpack(std::uint32_t* columns, float* values, std::uint8_t* visibility) const {
    visit_columns([columns](std::uint32_t k, std::uint32_t column) { columns[k] = column; });
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
