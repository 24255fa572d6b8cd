#include "core/box_tree.hpp"
#include "hemi/core/error.hpp"
#include "hemi/pipeline/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace hemi {

namespace {

constexpr double most_points = 0x1p26;
/// Normals of one plane differ by less (one minus the cosine).
constexpr double same_way = 1e-9;
/// Directions of sides that differ by less, radians, are one.
constexpr double same_side = 1e-6;

/// Faces in one plane.
struct Faces {
    Vec3 normal{0.0};
    Vec3 at{0.0};
    std::vector<std::uint32_t> surfaces;
};

std::vector<Faces> planes_of(const PatchMesh& mesh, std::uint32_t group) {
    const double tolerance = mesh.rounding() + 1e-6 * mesh.bounds().diagonal();
    std::vector<Faces> planes;
    for (std::uint32_t s = 0; s < mesh.surfaces().size(); ++s) {
        const Surface& surface = mesh.surfaces()[s];
        if (surface.group != group) {
            continue;
        }
        const Vec3& normal = mesh.surface_normal(s);
        const auto found = std::find_if(planes.begin(), planes.end(), [&](const Faces& faces) {
            return glm::dot(faces.normal, normal) > 1.0 - same_way &&
                   std::abs(glm::dot(surface.vertices[0] - faces.at, faces.normal)) <= tolerance;
        });
        Faces& faces = found != planes.end() ? *found : planes.emplace_back();
        if (faces.surfaces.empty()) {
            faces.normal = normal;
            faces.at = surface.vertices[0];
        }
        faces.surfaces.push_back(s);
    }
    return planes;
}

std::vector<Bounds> bounds_of(const PatchMesh& mesh, const Faces& faces) {
    std::vector<Bounds> bounds(faces.surfaces.size());
    for (std::size_t k = 0; k < bounds.size(); ++k) {
        for (const Vec3& corner : mesh.surfaces()[faces.surfaces[k]].polygon()) {
            bounds[k].add(corner);
        }
    }
    return bounds;
}

/// A rectangle about the faces of a plane.
struct Rectangle {
    Vec3 u{0.0}, v{0.0};
    double u_low = std::numeric_limits<double>::infinity();
    double v_low = std::numeric_limits<double>::infinity();
    double u_high = -u_low;
    double v_high = -v_low;

    [[nodiscard]] double area() const { return (u_high - u_low) * (v_high - v_low); }
};

Rectangle about(const PatchMesh& mesh, const Faces& faces, const Vec3& u) {
    Rectangle rectangle;
    rectangle.u = u;
    rectangle.v = glm::cross(faces.normal, u);
    for (const std::uint32_t s : faces.surfaces) {
        for (const Vec3& corner : mesh.surfaces()[s].polygon()) {
            const double along = glm::dot(corner - faces.at, rectangle.u);
            const double across = glm::dot(corner - faces.at, rectangle.v);
            rectangle.u_low = std::min(rectangle.u_low, along);
            rectangle.u_high = std::max(rectangle.u_high, along);
            rectangle.v_low = std::min(rectangle.v_low, across);
            rectangle.v_high = std::max(rectangle.v_high, across);
        }
    }
    return rectangle;
}

/// The smallest one along a side of a face, the first where several are.
Rectangle smallest_about(const PatchMesh& mesh, const Faces& faces) {
    // Angles count from the horizontal: of faces along the axes, u is an axis.
    const Vec3 level = glm::cross(Vec3(0.0, 0.0, 1.0), faces.normal);
    const Vec3 zero = glm::length(level) > 1e-6 ? glm::normalize(level) : Vec3(1.0, 0.0, 0.0);
    const Vec3 x = glm::normalize(zero - glm::dot(zero, faces.normal) * faces.normal);
    const Vec3 y = glm::cross(faces.normal, x);
    constexpr double quarter = 0.5 * std::numbers::pi;
    std::set<std::int64_t> angles; // of sides, a quarter turn apart being one
    for (const std::uint32_t s : faces.surfaces) {
        const auto polygon = mesh.surfaces()[s].polygon();
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Vec3 side = polygon[(k + 1) % polygon.size()] - polygon[k];
            double angle = std::fmod(std::atan2(glm::dot(side, y), glm::dot(side, x)), quarter);
            angle += angle < 0.0 ? quarter : 0.0;
            const auto whole = static_cast<std::int64_t>(std::llround(angle / same_side));
            angles.insert(whole == std::llround(quarter / same_side) ? 0 : whole);
        }
    }
    Rectangle smallest;
    double area = std::numeric_limits<double>::infinity();
    for (const std::int64_t whole : angles) {
        const double angle = static_cast<double>(whole) * same_side;
        const Rectangle rectangle = about(mesh, faces, std::cos(angle) * x + std::sin(angle) * y);
        if (rectangle.area() < area * (1.0 - 1e-9)) {
            area = rectangle.area();
            smallest = rectangle;
        }
    }
    return smallest;
}

/// Number of points along a length.
double count_along(double length, double spacing) {
    return std::max(1.0, std::floor(length / spacing * (1.0 + 1e-9)));
}

} // namespace

PointGrid make_point_grid(const PatchMesh& mesh, std::uint32_t group, double spacing, double height) {
    if (!(spacing > 0.0 && std::isfinite(spacing))) {
        throw InvalidArgument(fmt::format("grid: spacing {}; must be above 0", spacing));
    }
    if (!std::isfinite(height)) {
        throw InvalidArgument("grid: the height is not a finite number");
    }
    PointGrid grid;
    double total = 0.0;
    for (const Faces& faces : planes_of(mesh, group)) {
        const Rectangle rectangle = smallest_about(mesh, faces);
        const double columns = count_along(rectangle.u_high - rectangle.u_low, spacing);
        const double rows = count_along(rectangle.v_high - rectangle.v_low, spacing);
        total += columns * rows;
        if (total > most_points) {
            throw InvalidArgument(fmt::format("grid: a spacing of {} makes {:.3g} points or more; at most "
                                              "{:.0f} are allowed",
                                              spacing, total, most_points));
        }
        PointGrid::Plane plane{static_cast<std::uint32_t>(columns),
                               static_cast<std::uint32_t>(rows),
                               rectangle.u,
                               rectangle.v,
                               {}};
        const double tolerance = mesh.rounding() + 1e-6 * spacing;
        const BoxTree tree(bounds_of(mesh, faces));
        const auto first = [spacing](double low, double high, double count) {
            return 0.5 * (low + high) - 0.5 * (count - 1.0) * spacing;
        };
        const double u_first = first(rectangle.u_low, rectangle.u_high, columns);
        const double v_first = first(rectangle.v_low, rectangle.v_high, rows);
        for (std::uint32_t row = 0; row < plane.rows; ++row) {
            for (std::uint32_t column = 0; column < plane.columns; ++column) {
                const Vec3 place =
                    faces.at + (u_first + column * spacing) * plane.u + (v_first + row * spacing) * plane.v;
                bool on_face = false;
                tree.overlapping({place - Vec3(tolerance), place + Vec3(tolerance)}, [&](std::uint32_t k) {
                    on_face =
                        on_face ||
                        distance_to_polygon(place, mesh.surfaces()[faces.surfaces[k]].polygon()) <= tolerance;
                });
                if (on_face) {
                    plane.cell.push_back(column + plane.columns * row);
                    grid.points.push_back({place + height * faces.normal, faces.normal, no_surface});
                }
            }
        }
        grid.planes.push_back(std::move(plane));
    }
    return grid;
}

} // namespace hemi
