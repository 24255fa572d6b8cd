#include "hemi/core/text.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace hemi {

std::string count_text(std::uint64_t value) {
    const std::string digits = std::to_string(value);
    std::string text;
    for (std::size_t k = 0; k < digits.size(); ++k) {
        if (k > 0 && (digits.size() - k) % 3 == 0) {
            text += ',';
        }
        text += digits[k];
    }
    return text;
}

std::string number_text(double value) {
    return fmt::format("{:.6g}", value);
}

std::string memory_text(std::uint64_t bytes) {
    constexpr std::array<const char*, 5> units{"B", "KiB", "MiB", "GiB", "TiB"};
    double value = static_cast<double>(bytes);
    std::size_t unit = 0;
    while (value >= 1024.0 && unit + 1 < units.size()) {
        value /= 1024.0;
        ++unit;
    }
    return fmt::format("{:.{}f} {}", value, unit == 0 || value >= 100.0 ? 0 : 1, units[unit]);
}

std::string seconds_text(double seconds) {
    if (seconds >= 120.0) {
        const auto whole = static_cast<long long>(std::lround(seconds));
        return whole >= 3600 ? fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60)
                             : fmt::format("{} min {:02} s", whole / 60, whole % 60);
    }
    return fmt::format("{:.{}f} s", seconds, seconds < 10.0 ? 2 : 1);
}

std::string plural(std::uint64_t count, std::string_view one, std::string_view many) {
    return fmt::format("{} {}", count_text(count), count == 1 ? one : many);
}

std::string printable(std::string_view text, bool keep_line_ends) {
    std::string result(text);
    for (char& letter : result) {
        const bool control = static_cast<unsigned char>(letter) < 0x20 || letter == 0x7F;
        if (control && !(keep_line_ends && letter == '\n')) {
            letter = '?';
        }
    }
    return result;
}

} // namespace hemi
