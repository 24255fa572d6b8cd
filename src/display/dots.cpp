#include "hemi/display/dots.hpp"

#include "display/false_colour_scale.hpp"
#include "display/legend.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace hemi {

namespace {

using DotColour = std::array<float, 3>;
using TriangleList = std::vector<std::array<Vec3, 3>>;

constexpr double share_of_scene = 0.0045;
constexpr double share_of_distance = 0.25;
/// So many have a rim, and are round.
constexpr std::size_t most_round = 500;
constexpr double rim_radius = 1.25;
constexpr DotColour without_column{0.9F, 0.9F, 0.9F};
constexpr DotColour without_value{0.16F, 0.16F, 0.16F};

/// Outwards, of radius 1.
TriangleList octahedron() {
    TriangleList result;
    for (int k = 0; k < 8; ++k) {
        const double x = (k & 1) != 0 ? -1.0 : 1.0;
        const double y = (k & 2) != 0 ? -1.0 : 1.0;
        const double z = (k & 4) != 0 ? -1.0 : 1.0;
        const Vec3 a(x, 0.0, 0.0);
        const Vec3 b(0.0, y, 0.0);
        const Vec3 c(0.0, 0.0, z);
        result.push_back(x * y * z > 0.0 ? std::array{a, b, c} : std::array{b, a, c});
    }
    return result;
}

/// The octahedron with every triangle cut in sixteen.
TriangleList ball() {
    TriangleList result = octahedron();
    for (int round = 0; round < 2; ++round) {
        TriangleList finer;
        for (const auto& [a, b, c] : result) {
            const Vec3 ab = glm::normalize(a + b);
            const Vec3 bc = glm::normalize(b + c);
            const Vec3 ca = glm::normalize(c + a);
            for (const std::array<Vec3, 3>& part :
                 {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
                finer.push_back(part);
            }
        }
        result = std::move(finer);
    }
    return result;
}

/// What is shown as `value`, display linear, where light is exposed and tone-mapped: the inverse of
/// resolve.frag's curve.
float before_display(float value, const PictureSettings& settings) {
    double x = std::clamp(static_cast<double>(value), 0.0, 0.98);
    if (settings.tone_mapping == ToneMapping::filmic) {
        const double a = 2.51 - 2.43 * x;
        const double b = 0.03 - 0.59 * x;
        const double c = -0.14 * x;
        x = (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
    }
    return static_cast<float>(settings.exposure > 0.0 ? x / settings.exposure : 0.0);
}

constexpr std::uint32_t of_no_group =
    std::numeric_limits<std::uint32_t>::max(); // groups are cut, dots are not

void add(PictureMesh& mesh, const Vec3& at, double radius, const TriangleList& shape, const DotColour& colour,
         bool inwards) {
    for (const std::array<Vec3, 3>& triangle : shape) {
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t corner = std::min<std::size_t>(k, 2);
            const Vec3 place = at + radius * triangle[inwards ? 2 - corner : corner] - mesh.origin;
            for (int axis = 0; axis < 3; ++axis) {
                mesh.positions.push_back(static_cast<float>(place[axis]));
            }
            mesh.corners.insert(mesh.corners.end(), colour.begin(), colour.end());
        }
        mesh.patches.insert(mesh.patches.end(), colour.begin(), colour.end());
        if (!mesh.groups.empty()) {
            mesh.groups.push_back(of_no_group);
        }
        ++mesh.without_outline;
    }
}

} // namespace

Dots make_dots(const PointTable& table, std::optional<std::size_t> column, const Bounds& scene) {
    Dots dots;
    dots.positions = table.positions;
    if (column) {
        if (*column >= table.columns.size()) {
            throw InvalidArgument(fmt::format("dots: column {} of {}", *column, table.columns.size()),
                                  {"column"});
        }
        const PointTable::Column& wanted = table.columns[*column];
        dots.shown.values = wanted.values;
        dots.shown.title = wanted.name;
        dots.shown.unit = wanted.unit;
        (void)scale_of(dots.shown); // whether there can be one
    }
    Bounds around;
    for (const Vec3& position : table.positions) {
        around.add(position);
    }
    const double apart =
        around.diagonal() / std::sqrt(std::max(1.0, static_cast<double>(table.positions.size())));
    dots.radius = share_of_scene * scene.diagonal();
    if (apart > 0.0) {
        dots.radius = std::min(dots.radius, share_of_distance * apart);
    }
    return dots;
}

PictureMesh with_dots(PictureMesh mesh, const Dots& dots, const PictureSettings& settings) {
    const bool round = dots.positions.size() <= most_round;
    const TriangleList shape = round ? ball() : octahedron();
    const bool coloured = !dots.shown.values.empty();
    const ColourScale scale = coloured ? scale_of(dots.shown) : ColourScale{};
    for (std::size_t k = 0; k < dots.positions.size(); ++k) {
        DotColour colour = without_column;
        if (coloured) {
            const double value = dots.shown.values[k];
            colour = std::isnan(value) ? without_value : scale_colour(scale.position(value), scale.map);
        }
        for (float& channel : colour) {
            channel = before_display(channel, settings);
        }
        add(mesh, dots.positions[k], dots.radius, shape, colour, false);
        // Of a shell that is turned inside out, what lies behind the ball is seen around it.
        if (round && !settings.backs) {
            add(mesh, dots.positions[k], rim_radius * dots.radius, shape, {0.0F, 0.0F, 0.0F}, true);
        }
        mesh.bounds.add(dots.positions[k]);
    }
    return mesh;
}

bool draw_dots_legend(Picture& picture, const Dots& dots, std::uint32_t below) {
    if (dots.shown.values.empty() || !dots.shown.legend) {
        return false;
    }
    const ColourScale scale = scale_of(dots.shown);
    return draw_legend(picture, legend_scale(dots.shown, scale), legend_title(dots.shown, scale, "no value"),
                       values_beyond(dots.shown, scale), below);
}

} // namespace hemi
