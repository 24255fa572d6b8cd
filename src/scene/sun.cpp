#include "hemi/scene/sun.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

namespace hemi {

namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// Reads a text from its beginning.
class TimeText {
public:
    explicit TimeText(std::string_view text) : text_(text) {}

    /// That many digits.
    std::optional<int> digits(std::size_t count) {
        if (text_.size() < count) {
            return std::nullopt;
        }
        int value = 0;
        for (const char letter : text_.substr(0, count)) {
            if (letter < '0' || letter > '9') {
                return std::nullopt;
            }
            value = 10 * value + (letter - '0');
        }
        text_.remove_prefix(count);
        return value;
    }
    bool skip(char letter) {
        const bool there = text_.starts_with(letter);
        text_.remove_prefix(there ? 1 : 0);
        return there;
    }
    /// Digits behind a point.
    double fraction() {
        double value = 0.0;
        double place = 0.1;
        for (auto digit = digits(1); digit; digit = digits(1)) {
            value += place * *digit;
            place *= 0.1;
        }
        return value;
    }
    [[nodiscard]] bool at_end() const { return text_.empty(); }

private:
    std::string_view text_;
};

/// A moment in UTC.
struct Moment {
    double days = 0.0;    ///< since 2000-01-01 12:00
    double minutes = 0.0; ///< of the day
};

/// Hours and minutes as minutes, or nothing.
std::optional<double> read_clock(TimeText& text) {
    const auto hours = text.digits(2);
    if (!hours || *hours > 23 || !text.skip(':')) {
        return std::nullopt;
    }
    const auto minutes = text.digits(2);
    if (!minutes || *minutes > 59) {
        return std::nullopt;
    }
    return 60.0 * *hours + *minutes;
}

std::optional<Moment> read_time(TimeText text) {
    const auto year = text.digits(4);
    const bool dashed = text.skip('-');
    const auto month = text.digits(2);
    const bool twice = text.skip('-');
    const auto day = text.digits(2);
    if (!year || !month || !day || !dashed || !twice) {
        return std::nullopt;
    }
    const std::chrono::year_month_day date{std::chrono::year(*year),
                                           std::chrono::month(static_cast<unsigned>(*month)),
                                           std::chrono::day(static_cast<unsigned>(*day))};
    if (!date.ok() || !text.skip('T')) {
        return std::nullopt;
    }
    const auto clock = read_clock(text);
    if (!clock) {
        return std::nullopt;
    }
    double minutes = *clock;
    if (text.skip(':')) {
        const auto seconds = text.digits(2);
        if (!seconds || *seconds > 59) {
            return std::nullopt;
        }
        minutes += (*seconds + (text.skip('.') ? text.fraction() : 0.0)) / 60.0;
    }
    if (!text.skip('Z')) {
        const bool east = text.skip('+');
        if (!east && !text.skip('-')) {
            return std::nullopt;
        }
        const auto offset = read_clock(text);
        if (!offset) {
            return std::nullopt;
        }
        minutes += east ? -*offset : *offset;
    }
    if (!text.at_end()) {
        return std::nullopt;
    }
    constexpr double minutes_a_day = 1440.0;
    const std::chrono::sys_days epoch =
        std::chrono::sys_days(std::chrono::year(2000) / std::chrono::January / 1);
    const double midnight = static_cast<double>((std::chrono::sys_days(date) - epoch).count()) - 0.5;
    return Moment{midnight + minutes / minutes_a_day, minutes};
}

/// What the air lifts the sun by, degrees.
double refraction(double elevation) {
    if (elevation > 85.0) {
        return 0.0;
    }
    double seconds = 0.0;
    const double tangent = std::tan(elevation * degree);
    if (elevation > 5.0) {
        seconds = 58.1 / tangent - 0.07 / std::pow(tangent, 3.0) + 0.000086 / std::pow(tangent, 5.0);
    } else if (elevation > -0.575) {
        seconds =
            1735.0 + elevation * (-518.2 + elevation * (103.4 + elevation * (-12.79 + elevation * 0.711)));
    } else {
        seconds = -20.772 / tangent;
    }
    return seconds / 3600.0;
}

/// The sun among the stars.
struct Ephemeris {
    double declination = 0.0;      ///< radians
    double equation_of_time = 0.0; ///< minutes
};

Ephemeris ephemeris(double centuries) {
    const double t = centuries;
    const double mean_longitude = (280.46646 + t * (36000.76983 + t * 0.0003032)) * degree;
    const double anomaly = (357.52911 + t * (35999.05029 - 0.0001537 * t)) * degree;
    const double eccentricity = 0.016708634 - t * (0.000042037 + 0.0000001267 * t);
    const double centre =
        (std::sin(anomaly) * (1.914602 - t * (0.004817 + 0.000014 * t)) +
         std::sin(2.0 * anomaly) * (0.019993 - 0.000101 * t) + std::sin(3.0 * anomaly) * 0.000289) *
        degree;
    const double node = (125.04 - 1934.136 * t) * degree;
    const double longitude = mean_longitude + centre - (0.00569 + 0.00478 * std::sin(node)) * degree;
    const double mean_obliquity =
        23.0 + (26.0 + (21.448 - t * (46.815 + t * (0.00059 - t * 0.001813))) / 60.0) / 60.0;
    const double obliquity = (mean_obliquity + 0.00256 * std::cos(node)) * degree;
    const double y = std::pow(std::tan(0.5 * obliquity), 2.0);
    const double angle = y * std::sin(2.0 * mean_longitude) - 2.0 * eccentricity * std::sin(anomaly) +
                         4.0 * eccentricity * y * std::sin(anomaly) * std::cos(2.0 * mean_longitude) -
                         0.5 * y * y * std::sin(4.0 * mean_longitude) -
                         1.25 * eccentricity * eccentricity * std::sin(2.0 * anomaly);
    return {std::asin(std::sin(obliquity) * std::sin(longitude)), 4.0 * angle / degree};
}

void check_range(const char* name, double value, double largest) {
    if (!(std::abs(value) <= largest)) {
        throw InvalidArgument(
            fmt::format("{} {}; must be in [-{}, {}] degrees", name, value, largest, largest));
    }
}

} // namespace

SunPosition sun_position(double latitude, double longitude, const std::string& time) {
    check_range("latitude", latitude, 90.0);
    check_range("longitude", longitude, 180.0);
    const std::optional<Moment> moment = read_time(TimeText(time));
    if (!moment) {
        throw InvalidArgument(fmt::format("time \"{}\"; must be a date and a time with its offset, such as "
                                          "2026-06-21T12:00:00+02:00, or with Z for UTC",
                                          time));
    }
    constexpr double days_a_century = 36525.0;
    const Ephemeris sun = ephemeris(moment->days / days_a_century);
    const double solar_minutes = moment->minutes + sun.equation_of_time + 4.0 * longitude;
    const double hour_angle = (0.25 * solar_minutes - 180.0) * degree;
    const double north = latitude * degree;
    const double height = std::sin(north) * std::sin(sun.declination) +
                          std::cos(north) * std::cos(sun.declination) * std::cos(hour_angle);
    const double elevation = std::asin(std::min(1.0, std::max(-1.0, height))) / degree;
    const double from_south = std::atan2(std::sin(hour_angle) * std::cos(sun.declination),
                                         std::cos(hour_angle) * std::sin(north) * std::cos(sun.declination) -
                                             std::sin(sun.declination) * std::cos(north));
    return {std::fmod(from_south / degree + 540.0, 360.0), elevation + refraction(elevation)};
}

Vec3 sky_direction(double azimuth, double elevation, double north, UpAxis up) {
    const double around = (azimuth + north) * degree;
    const double above = elevation * degree;
    return turned_upright(
        {std::sin(around) * std::cos(above), std::cos(around) * std::cos(above), std::sin(above)}, up);
}

} // namespace hemi
