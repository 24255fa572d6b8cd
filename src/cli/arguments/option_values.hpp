#pragma once

#include "hemi/core/geometry.hpp"
#include "hemi/core/names.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Values of options: text to numbers, with messages that name the option, the value and what would be right.
/// All throw InvalidArgument.
namespace hemi::cli {

/// A finite number, or nothing where the text is anything else; throws nothing.
[[nodiscard]] std::optional<double> to_number(std::string_view text);
/// A finite number.
[[nodiscard]] double parse_number(std::string_view option, const std::string& text);
/// A finite number above zero.
[[nodiscard]] double parse_positive(std::string_view option, const std::string& text);
/// The same, or per cent: "1%".
[[nodiscard]] double parse_share(std::string_view option, const std::string& text);
/// A whole number from `lower` to `upper`.
[[nodiscard]] std::uint64_t parse_whole(std::string_view option, const std::string& text, std::uint64_t lower,
                                        std::uint64_t upper);
/// The same, of what is counted by 32 bits.
[[nodiscard]] std::uint32_t parse_index(std::string_view option, const std::string& text, std::uint32_t lower,
                                        std::uint32_t upper = std::numeric_limits<std::uint32_t>::max() - 1);
/// A time in seconds: a number, with s, m (or min) or h behind it, or bare. Above 0.
[[nodiscard]] double parse_duration(std::string_view option, const std::string& text);
/// Memory: a number and K, M, G or T (powers of 1024, as KiB …), KB, MB … (powers of 1000), or bytes.
[[nodiscard]] std::uint64_t parse_memory(std::string_view option, const std::string& text);
/// WIDTHxHEIGHT in pixels, each 1 to 16384; HD is 1920x1080, 4K is 3840x2160.
[[nodiscard]] std::array<std::uint32_t, 2> parse_picture_size(std::string_view option,
                                                              const std::string& text);
/// A colour: black, white, grey or #RRGGBB, sRGB.
[[nodiscard]] std::array<std::uint8_t, 3> parse_colour(std::string_view option, const std::string& text);
/// Comma-separated words.
[[nodiscard]] std::vector<std::string> parse_list(const std::string& text);

/// What `--camera` says; what it leaves out comes from the scene.
struct CameraOption {
    Vec3 eye{0.0};
    Vec3 target{0.0};
    std::optional<Vec3> up;
    std::optional<double> fov;
};
/// EYE:TARGET[:UP][:FOV] — three numbers with commas for a point or direction, one number for the angle.
[[nodiscard]] CameraOption parse_camera(std::string_view option, const std::string& text);

/// Index of `text` in `known`; any other word is refused with the nearest known one.
[[nodiscard]] std::size_t parse_choice(std::string_view option, const std::string& text,
                                       std::span<const std::string> known);
/// The enumerator whose word is `text`; any other word is refused with the nearest known one.
template <class Enum>
[[nodiscard]] Enum parse_choice(std::string_view option, const std::string& text) {
    return Names<Enum>::table[parse_choice(option, text, words<Enum>())].value;
}

} // namespace hemi::cli
