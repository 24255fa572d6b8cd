#pragma once

#include "hemi/core/row_memory.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace hemi {

/// Factors of a row with ascending columns, packed: the columns by differences, most of which take a byte,
/// the factors in 24 bits, and codes of visibility. What was packed once is packed to the same again.
/// Factors up to 1 are kept within 2e-6 of themselves, and are 0 below 2^-63, 1.1e-19.
class PackedEntries {
public:
    /// Factors from here on cannot be packed.
    static constexpr float too_large = 2.0F;

    PackedEntries() = default;
    /// @param columns     ascending
    /// @param values      as many, from 0 to below too_large
    /// @param visibility  as many, or none
    PackedEntries(std::span<const std::uint32_t> columns, std::span<const float> values,
                  std::span<const std::uint8_t> visibility);

    /// Number of entries.
    [[nodiscard]] std::uint32_t size() const noexcept { return size_; }
    /// Memory that they take.
    [[nodiscard]] std::size_t bytes() const noexcept { return bytes_.size(); }
    /// Whether there are codes of visibility.
    [[nodiscard]] bool has_visibility() const noexcept { return has_visibility_; }

    /// Unpacks all.
    /// @param columns     size() of them are written
    /// @param values      likewise
    /// @param visibility  likewise if there are codes
    void unpack(std::uint32_t* columns, float* values, std::uint8_t* visibility) const;
    /// Calls `visit(column, value, visibility)` for every entry; the code is 0 where there is none.
    template <class Visit>
    void visit(const Visit& visit) const {
        visit_columns([&](std::uint32_t k, std::uint32_t column) {
            visit(column, value(k), has_visibility_ ? codes()[k] : std::uint8_t{0});
        });
    }
    /// Sets every factor to `change(value, visibility)`, from 0 to below too_large.
    template <class Change>
    void change_values(const Change& change) {
        for (std::uint32_t k = 0; k < size_; ++k) {
            set_value(k, change(value(k), has_visibility_ ? codes()[k] : std::uint8_t{0}));
        }
    }
    /// Sum of the factors, in double, in their order.
    [[nodiscard]] double sum() const;

private:
    // A float without its sign, with 6 of 8 bits of the exponent and 18 of 23 of the mantissa. 0 is 0.
    static constexpr std::uint32_t dropped_bits = 5;
    static constexpr std::uint32_t smallest = (127U - 63U) << 23U; // 2^-63, as a float's bits
    static constexpr std::size_t bytes_a_value = 3;

    /// A number in as many bytes as it takes, 7 bits in each, the lowest first.
    static std::uint32_t next_number(const std::uint8_t*& at) {
        std::uint32_t number = *at & 127U;
        for (std::uint32_t shift = 7; (*at++ & 128U) != 0; shift += 7) {
            number |= (*at & 127U) << shift;
        }
        return number;
    }
    /// Calls `visit(k, column)` for every entry. Steps from column to column lie as their lower 8 bits, all;
    /// then, of each that has more bits, how many entries after the last such one it stands, and these bits.
    template <class Visit>
    void visit_columns(const Visit& visit) const {
        const std::uint8_t* const step = steps();
        const std::uint8_t* large = step + size_;
        const std::uint8_t* const end = bytes_.data() + bytes_.size();
        std::uint32_t column = 0;
        for (std::uint32_t k = 0; k < size_;) {
            const std::uint32_t stop = large != end ? k + next_number(large) : size_;
            for (; k < stop; ++k) {
                column += step[k];
                visit(k, column);
            }
            column += large != end ? next_number(large) << 8U : 0U;
        }
    }
    static float value_of(std::uint32_t code) {
        return code == 0 ? 0.0F : std::bit_cast<float>(smallest + ((code - 1U) << dropped_bits));
    }
    // Values lie as their upper 16 bits, all, and their lower 8, all: they are unpacked many at a time.
    static float value_at(const std::uint8_t* upper, const std::uint8_t* lower, std::size_t k) {
        std::uint16_t bits = 0;
        std::memcpy(&bits, upper + sizeof(bits) * k, sizeof(bits));
        return value_of(std::uint32_t{bits} << 8U | lower[k]);
    }
    [[nodiscard]] float value(std::uint32_t k) const { return value_at(bytes_.data(), lower(), k); }
    void set_value(std::uint32_t k, float value);
    [[nodiscard]] const std::uint8_t* lower() const { return bytes_.data() + 2 * std::size_t{size_}; }
    [[nodiscard]] const std::uint8_t* codes() const { return bytes_.data() + bytes_a_value * size_; }
    [[nodiscard]] const std::uint8_t* steps() const { return codes() + (has_visibility_ ? size_ : 0); }

    std::uint32_t size_ = 0;
    bool has_visibility_ = false;
    RowArray<std::uint8_t> bytes_; ///< values, codes of visibility, steps
};

} // namespace hemi
