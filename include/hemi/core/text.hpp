#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace hemi {

/// 12345678 as 12,345,678.
[[nodiscard]] std::string count_text(std::uint64_t value);
/// Six significant digits.
[[nodiscard]] std::string number_text(double value);
/// Bytes as B, KiB, MiB, GiB or TiB.
[[nodiscard]] std::string memory_text(std::uint64_t bytes);
/// Seconds as ms, s, min or h.
[[nodiscard]] std::string seconds_text(double seconds);
/// "1 patch", "2 patches".
[[nodiscard]] std::string plural(std::uint64_t count, std::string_view one, std::string_view many);

/// `text` with control characters as "?": names in files must not command a terminal.
[[nodiscard]] std::string printable(std::string_view text, bool keep_line_ends = false);

} // namespace hemi
