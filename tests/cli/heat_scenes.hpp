#pragma once

#include "cli/program.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

/// What tests of heat and of heat exchange share.
namespace hemi::cli_test {

constexpr double sigma = 5.670374419e-8;

/// `words`, and a device on which rows come fast.
inline Words on_cpu(Words words) {
    words.insert(words.end(), {"--device", "cpu", "--jobs", "1", "--no-estimate"});
    return words;
}

/// A box seen from inside, one patch a face: bottom and top have temperatures, the sides are adiabatic.
inline Json box(double x, double y, double z, int n = 1) {
    const auto polygon = [&](std::vector<std::array<double, 3>> unit) {
        Json points = Json::array();
        for (const auto& p : unit) {
            points.push_back({p[0] * x, p[1] * y, p[2] * z});
        }
        return points;
    };
    return {{"hemi", 1},
            {"materials",
             {{"bottom", {{"emissivity", 0.9}}},
              {"top", {{"emissivity", 0.75}}},
              {"side", {{"emissivity", 0.5}}}}},
            {"surfaces",
             {face("bottom", "bottom", polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}), n),
              face("top", "top", polygon({{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}), n),
              face("left", "side", polygon({{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}), n),
              face("right", "side", polygon({{1, 0, 0}, {1, 0, 1}, {1, 1, 1}, {1, 1, 0}}), n),
              face("front", "side", polygon({{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}), n),
              face("back", "side", polygon({{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}), n)}},
            {"groups",
             {{"bottom", {{"temperature", 550}}},
              {"top", {{"temperature", 300}}},
              {"left", {{"heat_flux", 0}}},
              {"right", {{"heat_flux", 0}}},
              {"front", {{"heat_flux", 0}}},
              {"back", {{"power", 0}}}}},
            {"enclosure", "closed"}};
}

/// Between opposite rectangles a x b at distance c.
inline double opposite(double a, double b, double c) {
    const double x = a / c;
    const double y = b / c;
    const double x1 = std::sqrt(1.0 + x * x);
    const double y1 = std::sqrt(1.0 + y * y);
    return 2.0 / (std::numbers::pi * x * y) *
           (std::log(x1 * y1 / std::sqrt(1.0 + x * x + y * y)) + x * y1 * std::atan(x / y1) +
            y * x1 * std::atan(y / x1) - x * std::atan(x) - y * std::atan(y));
}

/// F of the box's faces (bottom, top, left, right, front, back); neighbours from closure and reciprocity:
/// three unknowns a_xy, a_xz, a_yz, exchange areas of a face with each of two pairs of neighbours.
inline std::vector<std::vector<double>> box_factors(double x, double y, double z) {
    const double xy = x * y;
    const double yz = y * z;
    const double xz = x * z;
    // What a face leaves for its neighbours, half of it to either side.
    const double b = 0.5 * xy * (1.0 - opposite(x, y, z));
    const double l = 0.5 * yz * (1.0 - opposite(y, z, x));
    const double f = 0.5 * xz * (1.0 - opposite(x, z, y));
    // b = bl + bf, l = bl + lf, f = bf + lf.
    const double bl = 0.5 * (b + l - f);
    const double bf = 0.5 * (b + f - l);
    const double lf = 0.5 * (l + f - b);
    const double areas[6] = {xy, xy, yz, yz, xz, xz};
    const double own[3] = {opposite(x, y, z), opposite(y, z, x), opposite(x, z, y)};
    std::vector<std::vector<double>> factors(6, std::vector<double>(6, 0.0));
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 6; ++j) {
            if (i / 2 == j / 2) {
                factors[i][j] = i == j ? 0.0 : own[i / 2];
                continue;
            }
            const std::size_t kinds =
                i / 2 + j / 2; // 1: bottom and left, 2: bottom and front, 3: left and front
            factors[i][j] = (kinds == 1 ? bl : kinds == 2 ? bf : lf) / areas[i];
        }
    }
    return factors;
}

/// Solves A x = b.
inline std::vector<double> solve(std::vector<std::vector<double>> a, std::vector<double> b) {
    const std::size_t n = b.size();
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k; i < n; ++i) {
            pivot = std::abs(a[i][k]) > std::abs(a[pivot][k]) ? i : pivot;
        }
        std::swap(a[k], a[pivot]);
        std::swap(b[k], b[pivot]);
        for (std::size_t i = 0; i < n; ++i) {
            if (i != k) {
                const double factor = a[i][k] / a[k][k];
                for (std::size_t j = k; j < n; ++j) {
                    a[i][j] -= factor * a[k][j];
                }
                b[i] -= factor * b[k];
            }
        }
    }
    for (std::size_t k = 0; k < n; ++k) {
        b[k] /= a[k][k];
    }
    return b;
}

/// MOOSE's cavity as a duct of length 1, whose ends do not count: rows come from a file.
inline Json cavity() {
    Json scene = box(1, 1, 2);
    scene["surfaces"] = {scene["surfaces"][0], scene["surfaces"][3], scene["surfaces"][1],
                         scene["surfaces"][2]};
    scene["materials"]["bottom"]["emissivity"] = 1;
    scene["groups"].erase("front");
    scene["groups"].erase("back");
    return scene;
}

inline std::string cavity_factors() {
    const double ends = std::sqrt(5.0) - 2.0;
    const double sides = (std::sqrt(5.0) - 1.0) / 2.0;
    const double to_side = (1.0 - ends) / 2.0;
    const double to_end = (1.0 - sides) / 2.0;
    const double rows[4][4] = {{0.0, to_side, ends, to_side},
                               {to_end, 0.0, to_end, sides},
                               {ends, to_side, 0.0, to_side},
                               {to_end, sides, to_end, 0.0}};
    std::string text = "i,j,F\n";
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
            if (i != j) {
                char line[64];
                std::snprintf(line, sizeof line, "%d,%d,%.17g\n", i, j, rows[i][j]);
                text += line;
            }
        }
    }
    return text;
}

} // namespace hemi::cli_test
