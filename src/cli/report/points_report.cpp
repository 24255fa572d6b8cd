#include "cli/report/points_report.hpp"

#include "hemi/core/black_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace hemi::cli {

namespace {

constexpr double not_there = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t planes = 6;
constexpr double percent = 100.0;
constexpr std::array<const char*, planes> plane_names{"plane_up",   "plane_down",  "plane_right",
                                                      "plane_left", "plane_front", "plane_back"};

double kelvin(double exitance) {
    return std::isfinite(exitance) ? black_body_temperature(exitance) : not_there;
}

/// Of a sphere, or of a person where one is asked for; not a number of planes.
double mean_radiant_temperature(const Receiver& point, const PointValues& values, std::size_t k,
                                const PointsAsked& asked) {
    if (point.normal) {
        return not_there;
    }
    if (!asked.posture) {
        return kelvin(values.surroundings[k]);
    }
    return person_radiant_temperature(plane_exitances(values, k, asked.body), *asked.posture, asked.faces);
}

/// Every so many-th value.
std::vector<double> every(const std::vector<double>& all, std::size_t first, std::size_t step) {
    std::vector<double> result;
    for (std::size_t k = first; k < all.size(); k += step) {
        result.push_back(all[k]);
    }
    return result;
}

bool any_with(std::span<const Receiver> points, bool normal) {
    return std::any_of(points.begin(), points.end(),
                       [normal](const Receiver& point) { return point.normal.has_value() == normal; });
}

Json vector_json(const Vec3& v) {
    return {v.x, v.y, v.z};
}

} // namespace

PointColumns point_columns(std::span<const Receiver> points, const PointValues& values,
                           const PointsAsked& asked) {
    PointColumns columns;
    const auto add = [&columns](std::string name, std::vector<double> of_points) {
        columns.names.push_back(std::move(name));
        columns.values.push_back(std::move(of_points));
    };
    for (std::size_t c = 0; c < values.channels; ++c) {
        add(values.channels == asked.channels.size() ? "irradiance_" + asked.channels[c] : "irradiance",
            every(values.irradiance, c, values.channels));
    }
    for (std::size_t c = 0; c < asked.horizontal.size(); ++c) {
        std::vector<double> factors = every(values.irradiance, c, values.channels);
        for (double& factor : factors) {
            factor *= percent / asked.horizontal[c];
        }
        add(asked.horizontal.size() == 1 ? "daylight_factor" : "daylight_factor_" + asked.channels[c],
            std::move(factors));
    }
    add("sky", values.sky);
    add("below_horizon", values.below_horizon);
    add("blocked", values.blocked);
    if (asked.heat && any_with(points, false)) {
        std::vector<double> temperatures;
        for (std::size_t k = 0; k < points.size(); ++k) {
            temperatures.push_back(mean_radiant_temperature(points[k], values, k, asked));
        }
        add("mean_radiant_temperature", std::move(temperatures));
    }
    if (asked.heat && any_with(points, true)) {
        std::vector<double> temperatures;
        for (std::size_t k = 0; k < points.size(); ++k) {
            temperatures.push_back(points[k].normal ? kelvin(values.surroundings[k]) : not_there);
        }
        add("plane_radiant_temperature", std::move(temperatures));
    }
    for (std::size_t d = 0; asked.posture && d < planes; ++d) {
        std::vector<double> temperatures;
        for (std::size_t k = 0; k < points.size(); ++k) {
            temperatures.push_back(kelvin(plane_exitances(values, k, asked.body)[d]));
        }
        add(plane_names[d], std::move(temperatures));
    }
    for (std::size_t g = 0; g < asked.groups.size(); ++g) {
        add("factor_" + asked.groups[g], every(values.factors, g, values.groups));
    }
    return columns;
}

io::TextTable point_table(std::span<const Receiver> points, const PointColumns& columns) {
    const bool normals = any_with(points, true);
    io::TextTable table;
    table.columns = {"x", "y", "z"};
    if (normals) {
        table.columns.insert(table.columns.end(), {"nx", "ny", "nz"});
    }
    table.columns.insert(table.columns.end(), columns.names.begin(), columns.names.end());
    const auto cell = [](double value) {
        return std::isfinite(value) ? fmt::format("{}", value) : std::string();
    };
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Vec3& at = points[k].position;
        const Vec3 normal = points[k].normal.value_or(Vec3(not_there));
        std::vector<std::string> row{cell(at.x), cell(at.y), cell(at.z)};
        if (normals) {
            row.insert(row.end(), {cell(normal.x), cell(normal.y), cell(normal.z)});
        }
        for (const std::vector<double>& values : columns.values) {
            row.push_back(cell(values[k]));
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

Json points_json(std::span<const Receiver> points, const PointValues& values, const PointsAsked& asked) {
    Json positions = Json::array();
    Json normals = Json::array();
    Json temperatures = Json::array();
    Json plane_temperatures = Json::array();
    Json six = Json::array();
    for (std::size_t k = 0; k < points.size(); ++k) {
        positions.push_back(vector_json(points[k].position));
        normals.push_back(points[k].normal ? vector_json(*points[k].normal) : Json());
        temperatures.push_back(mean_radiant_temperature(points[k], values, k, asked)); // null of planes
        plane_temperatures.push_back(points[k].normal ? kelvin(values.surroundings[k]) : not_there);
        if (asked.posture) {
            Json of_point = Json::array();
            for (const double exitance : plane_exitances(values, k, asked.body)) {
                of_point.push_back(kelvin(exitance));
            }
            six.push_back(std::move(of_point));
        }
    }
    Json json{{"points", std::move(positions)},
              {"normals", std::move(normals)},
              {"channels", asked.channels},
              {"irradiance", rows_json(values.irradiance, values.channels)},
              {"sky", values.sky},
              {"below_horizon", values.below_horizon},
              {"blocked", values.blocked}};
    if (!asked.groups.empty()) {
        json["groups"] = asked.groups;
        json["factors"] = rows_json(values.factors, values.groups);
    }
    if (asked.heat) {
        json["mean_radiant_temperature"] = std::move(temperatures);
        json["plane_radiant_temperature"] = std::move(plane_temperatures);
    }
    if (!asked.horizontal.empty()) {
        std::vector<double> factors = values.irradiance;
        for (std::size_t k = 0; k < factors.size(); ++k) {
            factors[k] *= percent / asked.horizontal[k % values.channels];
        }
        json["daylight_factor"] = rows_json(factors, values.channels);
        json["horizontal"] = asked.horizontal;
    }
    if (asked.posture) {
        json["posture"] = to_word(*asked.posture);
        json["absorptance"] = {{"short_wave", asked.body.short_wave}, {"long_wave", asked.body.long_wave}};
        json["planes"] = std::move(six);
    }
    return json;
}

} // namespace hemi::cli
