#include "cli/arguments/option_values.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

namespace hemi::cli {

namespace {

[[noreturn]] void refuse(std::string_view option, const std::string& text, std::string_view wanted) {
    throw InvalidArgument(fmt::format("{} {}: must be {}", option, text.empty() ? "''" : text, wanted));
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    while (true) {
        const std::size_t end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) {
            return parts;
        }
        text.remove_prefix(end + 1);
    }
}

std::vector<double> to_numbers(std::string_view text) {
    std::vector<double> values;
    for (const std::string_view part : split(text, ',')) {
        const auto value = to_number(part);
        if (!value) {
            return {};
        }
        values.push_back(*value);
    }
    return values;
}

Vec3 to_vector(const std::vector<double>& values) {
    return {values[0], values[1], values[2]};
}

/// Bytes that a unit stands for; 0 if there is no such unit.
double memory_unit(std::string unit) {
    std::transform(unit.begin(), unit.end(), unit.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (unit.empty() || unit == "b") {
        return 1.0;
    }
    const std::size_t power = std::string_view("kmgt").find(unit[0]);
    if (power == std::string_view::npos) {
        return 0.0;
    }
    const std::string_view rest = std::string_view(unit).substr(1);
    if (rest.empty() || rest == "ib") {
        return std::pow(1024.0, static_cast<double>(power + 1));
    }
    return rest == "b" ? std::pow(1000.0, static_cast<double>(power + 1)) : 0.0;
}

std::string join(std::span<const std::string> words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i) {
        text += i == 0 ? "" : i + 1 == words.size() ? " or " : ", ";
        text += words[i];
    }
    return text;
}

} // namespace

std::optional<double> to_number(std::string_view text) {
    double value = 0.0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
        return std::nullopt;
    }
    return value;
}

double parse_number(std::string_view option, const std::string& text) {
    const auto value = to_number(text);
    if (!value) {
        refuse(option, text, "a number");
    }
    return *value;
}

double parse_positive(std::string_view option, const std::string& text) {
    const auto value = to_number(text);
    if (!value || !(*value > 0.0)) {
        refuse(option, text, "a number above 0");
    }
    return *value;
}

double parse_share(std::string_view option, const std::string& text) {
    const bool percent = text.ends_with('%');
    return parse_positive(option, percent ? text.substr(0, text.size() - 1) : text) * (percent ? 0.01 : 1.0);
}

std::uint64_t parse_whole(std::string_view option, const std::string& text, std::uint64_t lower,
                          std::uint64_t upper) {
    std::uint64_t value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc{} || end != text.data() + text.size() || value < lower || value > upper) {
        refuse(option, text,
               upper == std::numeric_limits<std::uint64_t>::max()
                   ? fmt::format("a whole number from {}", lower)
                   : fmt::format("a whole number, {} to {}", lower, upper));
    }
    return value;
}

std::uint32_t parse_index(std::string_view option, const std::string& text, std::uint32_t lower,
                          std::uint32_t upper) {
    return static_cast<std::uint32_t>(parse_whole(option, text, lower, upper));
}

double parse_duration(std::string_view option, const std::string& text) {
    const std::size_t digits = std::min(text.find_first_not_of("0123456789."), text.size());
    const auto value = to_number(std::string_view(text).substr(0, digits));
    const std::string unit = text.substr(digits);
    const double seconds = unit.empty() || unit == "s"    ? 1.0
                           : unit == "m" || unit == "min" ? 60.0
                           : unit == "h"                  ? 3600.0
                                                          : 0.0;
    if (!value || !(*value * seconds > 0.0)) {
        refuse(option, text, "a time such as 60s, 5m or 1h");
    }
    return *value * seconds;
}

std::uint64_t parse_memory(std::string_view option, const std::string& text) {
    const std::size_t digits = std::min(text.find_first_not_of("0123456789."), text.size());
    const auto value = to_number(std::string_view(text).substr(0, digits));
    const double unit = memory_unit(text.substr(digits));
    if (!value || unit == 0.0 || *value * unit < 1.0 || *value * unit > 1e18) {
        refuse(option, text, "an amount of memory such as 512M, 2G or 1.5GiB");
    }
    return static_cast<std::uint64_t>(*value * unit);
}

std::array<std::uint32_t, 2> parse_picture_size(std::string_view option, const std::string& text) {
    if (text == "HD" || text == "hd") {
        return {1920, 1080};
    }
    if (text == "4K" || text == "4k") {
        return {3840, 2160};
    }
    const std::size_t cross = text.find('x');
    if (cross == std::string::npos) {
        refuse(option, text, "WIDTHxHEIGHT in pixels, such as 800x600, or HD or 4K");
    }
    std::array<std::uint32_t, 2> size{};
    const std::array<std::string, 2> parts{text.substr(0, cross), text.substr(cross + 1)};
    for (std::size_t i = 0; i < 2; ++i) {
        const auto [end, problem] =
            std::from_chars(parts[i].data(), parts[i].data() + parts[i].size(), size[i]);
        if (problem != std::errc{} || end != parts[i].data() + parts[i].size() || size[i] < 1 ||
            size[i] > 16384) {
            refuse(option, text, "WIDTHxHEIGHT in pixels, each 1 to 16384, such as 800x600");
        }
    }
    return size;
}

std::array<std::uint8_t, 3> parse_colour(std::string_view option, const std::string& text) {
    constexpr std::uint8_t middle = 0x80;
    if (text == "black") {
        return {0, 0, 0};
    }
    if (text == "white") {
        return {255, 255, 255};
    }
    if (text == "grey") {
        return {middle, middle, middle};
    }
    std::array<std::uint8_t, 3> colour{};
    bool sound = text.size() == 7 && text[0] == '#';
    for (std::size_t c = 0; c < 3 && sound; ++c) {
        const char* const first = text.data() + 1 + 2 * c;
        const auto [end, problem] = std::from_chars(first, first + 2, colour[c], 16);
        sound = problem == std::errc{} && end == first + 2;
    }
    if (!sound) {
        refuse(option, text, "environment, black, white, grey, or a colour as #RRGGBB");
    }
    return colour;
}

std::vector<std::string> parse_list(const std::string& text) {
    std::vector<std::string> words;
    for (const std::string_view word : split(text, ',')) {
        words.emplace_back(word);
    }
    return words;
}

CameraOption parse_camera(std::string_view option, const std::string& text) {
    constexpr std::string_view wanted =
        "EYE:TARGET[:UP][:FOV], such as 0,-3,1:0,0,1 or 0,-3,1:0,0,1:0,0,1:40";
    const std::vector<std::string_view> parts = split(text, ':');
    if (parts.size() < 2 || parts.size() > 4) {
        refuse(option, text, wanted);
    }
    CameraOption camera;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::vector<double> values = to_numbers(parts[i]);
        if (values.size() == 1 && i >= 2 && !camera.fov) {
            camera.fov = values[0];
        } else if (values.size() != 3 || (i >= 2 && (camera.up || camera.fov))) {
            refuse(option, text, wanted);
        } else if (i == 0) {
            camera.eye = to_vector(values);
        } else if (i == 1) {
            camera.target = to_vector(values);
        } else {
            camera.up = to_vector(values);
        }
    }
    if (camera.fov && !(*camera.fov > 0.0 && *camera.fov < 180.0)) {
        refuse(option, text, "given with a field of view above 0 and below 180 degrees");
    }
    if (camera.eye == camera.target) {
        refuse(option, text, "given with an eye and a target that differ");
    }
    return camera;
}

std::size_t parse_choice(std::string_view option, const std::string& text,
                         std::span<const std::string> known) {
    const auto found = std::find(known.begin(), known.end(), text);
    if (found != known.end()) {
        return static_cast<std::size_t>(found - known.begin());
    }
    std::string message = fmt::format("{} {}: must be {}", option, text.empty() ? "''" : text, join(known));
    if (const auto nearest = nearest_word(text, known)) {
        message += fmt::format("; did you mean {}?", *nearest);
    }
    throw InvalidArgument(message);
}

} // namespace hemi::cli
