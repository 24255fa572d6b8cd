#include "hemi/display/picture_cut.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace hemi {

namespace {

constexpr std::string_view axes = "xyz";

std::optional<double> to_finite(std::string_view text) {
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data(), end, value);
    return error == std::errc() && last == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// "x" or "A,B,C"; not of unit length.
std::optional<Vec3> direction_of(std::string_view text) {
    Vec3 direction(0.0);
    if (text.size() == 1 && axes.find(text[0]) != std::string_view::npos) {
        direction[static_cast<int>(axes.find(text[0]))] = 1.0;
        return direction;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t end = std::min(text.find(','), text.size());
        const std::optional<double> value = to_finite(text.substr(0, end));
        if (!value || (axis < 2) == (end == text.size())) {
            return std::nullopt;
        }
        direction[axis] = *value;
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return direction;
}

} // namespace

ClipPlane parse_clip_plane(const std::string& text) {
    constexpr double rounding = 1e-12;
    const std::size_t sign = std::min(text.find_first_of("<>"), text.size());
    const std::optional<Vec3> direction = direction_of(std::string_view(text).substr(0, sign));
    const std::optional<double> limit =
        sign < text.size() ? to_finite(std::string_view(text).substr(sign + 1)) : std::nullopt;
    const double length = direction ? glm::length(*direction) : 0.0;
    if (!limit || !(length > 0.0) || !std::isfinite(length)) {
        throw InvalidArgument(fmt::format(
            "{}: must be what is shown, such as x<1.5, z>0 or, of 0.6 x + 0.8 y, 0.6,0.8,0<1.5", text));
    }
    // A length that is 1 but for rounding stays, so that a plane that was written is read as it was.
    const double divisor = std::abs(length - 1.0) > rounding ? length : 1.0;
    const double side = text[sign] == '<' ? divisor : -divisor;
    return {*direction / side + Vec3(0.0), *limit / side + 0.0}; // no -0
}

std::string clip_plane_text(const ClipPlane& plane) {
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 along(0.0);
        along[axis] = 1.0;
        const char name = axes[static_cast<std::size_t>(axis)];
        if (plane.normal == along) {
            return fmt::format("{}<{}", name, plane.offset);
        }
        if (plane.normal == -along) {
            return fmt::format("{}>{}", name, 0.0 - plane.offset);
        }
    }
    return fmt::format("{},{},{}<{}", plane.normal.x, plane.normal.y, plane.normal.z, plane.offset);
}

std::uint32_t group_by_name(std::span<const std::string> groups, const std::string& name,
                            const std::string& what) {
    const auto found = std::find(groups.begin(), groups.end(), name);
    if (found == groups.end()) {
        throw InvalidArgument(
            fmt::format("{} {}: there is no such group{}", what, name, did_you_mean_or_list(name, groups)));
    }
    return static_cast<std::uint32_t>(found - groups.begin());
}

} // namespace hemi
