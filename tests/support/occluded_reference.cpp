#include "support/occluded_reference.hpp"

#include "support/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace hemi::test {

namespace {

/// Points this close to a plane lie in it: the scenes are of unit size.
constexpr double rounding = 1e-12;

Vec3 turned(const Vec3& point, const Vec3& centre, const Vec3& axis, double angle) { // Rodrigues
    const Vec3 p = point - centre;
    const Vec3 unit = glm::normalize(axis);
    return centre + std::cos(angle) * p + std::sin(angle) * glm::cross(unit, p) +
           (1.0 - std::cos(angle)) * glm::dot(unit, p) * unit;
}

} // namespace

/// Patch j as patch i sees it.
struct OccludedReference::Target {
    std::uint32_t patch = 0;
    ConvexPolygon polygon; ///< what of it is in front of i
    Vec3 centre{0.0};      ///< with `radius`: a sphere round it
    double radius = 0.0;
    double unoccluded = 0.0;
    double hidden = 0.0;
    bool seen = false; ///< by at least one point
};

OccludedReference::OccludedReference(const PatchMesh& mesh, const std::vector<std::string>& bodies,
                                     std::size_t points)
    : mesh_(mesh), points_(points), body_of_(mesh.size(), bodies.size()) {
    if (bodies.size() > 2) {
        throw std::invalid_argument("OccludedReference: at most two bodies");
    }
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        const auto found = std::find(mesh.groups().begin(), mesh.groups().end(), bodies[k]);
        if (found == mesh.groups().end()) {
            throw std::invalid_argument("OccludedReference: no group " + bodies[k]);
        }
        const auto group = static_cast<std::uint32_t>(found - mesh.groups().begin());
        bodies_.push_back(make_body(mesh, group));
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            if (mesh.group(i) == group) {
                body_of_[i] = k;
            }
        }
    }
    planes_.reserve(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        planes_.push_back(plane_of(mesh.corners(i).polygon()));
    }
}

OccludedReference::Body OccludedReference::make_body(const PatchMesh& mesh, std::uint32_t group) {
    Body body;
    for (const Surface& surface : mesh.surfaces()) {
        if (surface.group != group) {
            continue;
        }
        std::vector<Vec3> corners(surface.polygon().begin(), surface.polygon().end());
        body.faces.push_back({corners, plane_of(corners)});
        if (surface.two_sided) {
            std::reverse(corners.begin(), corners.end());
            body.faces.push_back({corners, plane_of(corners)});
        }
    }
    // Every edge runs from a to b on one face and from b to a on another.
    for (std::size_t left = 0; left < body.faces.size(); ++left) {
        const auto& l = body.faces[left].corners;
        for (std::size_t k = 0; k < l.size(); ++k) {
            const Vec3& a = l[k];
            const Vec3& b = l[(k + 1) % l.size()];
            for (std::size_t right = left + 1; right < body.faces.size(); ++right) {
                const auto& r = body.faces[right].corners;
                for (std::size_t m = 0; m < r.size(); ++m) {
                    if (glm::length(r[m] - b) < rounding &&
                        glm::length(r[(m + 1) % r.size()] - a) < rounding) {
                        body.edges.push_back({a, b, left, right});
                    }
                }
            }
        }
    }
    return body;
}

std::vector<Plane> OccludedReference::shadow(const Body& body, const Vec3& point) {
    std::vector<Plane> planes;
    std::vector<bool> seen(body.faces.size());
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
        const Plane& plane = body.faces[f].plane;
        seen[f] = plane.height(point) > rounding;
        if (seen[f]) {
            planes.push_back({-plane.normal, -plane.offset}); // the shadow is behind the face
        }
    }
    for (const Edge& edge : body.edges) {
        if (seen[edge.left] == seen[edge.right]) {
            continue;
        }
        const Vec3 across = glm::cross(edge.a - point, edge.b - point);
        const Vec3 normal = glm::normalize(seen[edge.left] ? -across : across);
        planes.push_back({normal, glm::dot(normal, point)});
    }
    return planes;
}

std::vector<OccludedReference::Target> OccludedReference::targets(std::uint32_t i) const {
    const PatchCorners from = mesh_.corners(i);
    std::vector<Target> result;
    for (std::uint32_t j = 0; j < mesh_.size(); ++j) {
        const PatchCorners to = mesh_.corners(j);
        const auto below = [](std::span<const Vec3> polygon, const Plane& plane) {
            return std::none_of(polygon.begin(), polygon.end(),
                                [&](const Vec3& corner) { return plane.height(corner) > rounding; });
        };
        if (below(to.polygon(), planes_[i]) || below(from.polygon(), planes_[j])) {
            continue;
        }
        Target target;
        target.patch = j;
        target.polygon = ConvexPolygon(to.polygon());
        target.polygon.clip(planes_[i]);
        if (target.polygon.empty()) {
            continue;
        }
        target.centre = mesh_.centres()[j];
        for (const Vec3& corner : to.polygon()) {
            target.radius = std::max(target.radius, glm::length(corner - target.centre));
        }
        target.unoccluded = exchange_area(from.polygon(), to.polygon()) / mesh_.areas()[i];
        result.push_back(target);
    }
    return result;
}

std::vector<double> OccludedReference::row(std::uint32_t i) const {
    std::vector<Target> all = targets(i);
    const Vec3 normal = planes_[i].normal;
    for (const QuadraturePoint& at : gauss_points(mesh_.corners(i).polygon(), points_)) {
        std::vector<std::vector<Plane>> shadows(bodies_.size());
        for (std::size_t k = 0; k < bodies_.size(); ++k) {
            if (k != body_of_[i]) { // what is in front of a convex body's face is not hidden by that body
                shadows[k] = shadow(bodies_[k], at.position);
            }
        }
        for (Target& target : all) {
            if (planes_[target.patch].height(at.position) <= 0.0) {
                continue;
            }
            // The parts in the shadows of one body, of the other and of both.
            std::array<ConvexPolygon, 2> part;
            for (std::size_t k = 0; k < bodies_.size(); ++k) {
                if (k == body_of_[i] || k == body_of_[target.patch]) {
                    continue;
                }
                const bool outside =
                    std::any_of(shadows[k].begin(), shadows[k].end(), [&](const Plane& plane) {
                        return plane.height(target.centre) < -target.radius;
                    });
                if (outside) {
                    continue;
                }
                part[k] = target.polygon;
                for (const Plane& plane : shadows[k]) {
                    part[k].clip({plane.normal, plane.offset - rounding});
                }
            }
            double hidden = 0.0;
            for (const ConvexPolygon& polygon : part) {
                hidden += polygon.empty() ? 0.0 : point_factor(at.position, normal, polygon);
            }
            if (!part[0].empty() && !part[1].empty()) {
                for (const Plane& plane : shadows[1]) {
                    part[0].clip(plane);
                }
                hidden -= part[0].empty() ? 0.0 : point_factor(at.position, normal, part[0]);
            }
            target.hidden += at.weight * hidden;
            target.seen = target.seen || hidden == 0.0 ||
                          hidden < (1.0 - 1e-9) * point_factor(at.position, normal, target.polygon);
        }
    }
    std::vector<double> factors(mesh_.size(), 0.0);
    for (const Target& target : all) {
        if (target.seen) {
            factors[target.patch] = std::max(0.0, target.unoccluded - target.hidden);
        }
    }
    return factors;
}

Scene room_with_turned_boxes(std::uint32_t walls, std::uint32_t first, std::uint32_t second) {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0), walls);
    struct Box {
        const char* name;
        Vec3 centre, half, axis;
        double angle;
        std::uint32_t cells;
    };
    for (const Box& box :
         {Box{"first", Vec3(0.32, 0.36, 0.33), Vec3(0.17, 0.13, 0.15), Vec3(1.0, 2.0, 3.0), 0.7, first},
          Box{"second", Vec3(0.68, 0.62, 0.66), Vec3(0.15, 0.19, 0.16), Vec3(-2.0, 1.0, 1.0), 1.1, second}}) {
        const std::size_t begin = scene.surfaces.size();
        add_block(scene, box.name, box.centre - box.half, box.centre + box.half, box.cells);
        for (std::size_t s = begin; s < scene.surfaces.size(); ++s) {
            for (Vec3& vertex : scene.surfaces[s].vertices) {
                vertex = turned(vertex, box.centre, box.axis, box.angle);
            }
        }
    }
    scene.enclosure = Enclosure::closed;
    return scene;
}

Scene coarse_room_with_turned_boxes() {
    return room_with_turned_boxes(12, 4, 5);
}

Scene fine_room_with_turned_boxes() {
    return room_with_turned_boxes(28, 9, 10);
}

StraddledRoom straddled_room(double covered) {
    const double border = 0.5 - 0.25 * covered;
    StraddledRoom room{empty_scene(), empty_scene()};
    const auto add_rest = [border](Scene& scene) {
        add_room(scene, Vec3(0.0), Vec3(1.0), 4);
        std::erase_if(scene.surfaces, [&](const Surface& s) { return scene.groups[s.group] == "z0"; });
        add_block(scene, "block", Vec3(border, 0.25, 0.0), Vec3(0.75, 0.75, 0.4), 2);
        scene.enclosure = Enclosure::closed;
    };
    const auto add_floor = [](Scene& scene, double from, double to, std::uint32_t cells) {
        add_polygon(scene, "z0", {Vec3(from, 0, 0), Vec3(to, 0, 0), Vec3(to, 1, 0), Vec3(from, 1, 0)},
                    {cells, 4});
    };
    add_rest(room.whole);
    add_floor(room.whole, 0.0, 1.0, 4);
    add_rest(room.cut);
    add_floor(room.cut, 0.0, 0.25, 1);
    add_floor(room.cut, 0.25, border, 1);
    add_floor(room.cut, border, 0.5, 1);
    add_floor(room.cut, 0.5, 1.0, 2);
    return room;
}

std::vector<std::uint32_t> parents(const PatchMesh& whole, const PatchMesh& cut) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t part = 0; part < cut.size(); ++part) {
        for (std::uint32_t i = 0; i < whole.size(); ++i) {
            if (glm::dot(whole.normal(i), cut.normal(part)) > 0.999 &&
                distance_to_polygon(cut.centres()[part], whole.corners(i).polygon()) < rounding) {
                result.push_back(i);
                break;
            }
        }
    }
    if (result.size() != cut.size()) {
        throw std::invalid_argument("parents: a patch is part of none");
    }
    return result;
}

std::vector<double> straddled_row(const PatchMesh& whole, const PatchMesh& cut,
                                  std::span<const std::uint32_t> parents, const OccludedReference& reference,
                                  std::uint32_t i) {
    const auto under_the_block = [&](std::uint32_t part) {
        for (const Surface& surface : cut.surfaces()) {
            if (cut.groups()[surface.group] == "block" &&
                glm::dot(area_vector(surface.polygon()), cut.normal(part)) < 0.0 &&
                distance_to_polygon(cut.centres()[part], surface.polygon()) < rounding) {
                return true;
            }
        }
        return false;
    };
    std::vector<double> row(whole.size(), 0.0);
    for (std::uint32_t part = 0; part < cut.size(); ++part) {
        if (parents[part] != i || under_the_block(part)) {
            continue;
        }
        const std::vector<double> factors = reference.row(part);
        for (std::uint32_t j = 0; j < cut.size(); ++j) {
            row[parents[j]] += cut.areas()[part] / whole.areas()[i] * factors[j];
        }
    }
    return row;
}

Scene room_with_sheet(double gap) {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0), 4);
    const double z = 0.25 * gap;
    add_polygon(scene, "sheet",
                {Vec3(0.3, 0.3, z), Vec3(0.55, 0.3, z), Vec3(0.55, 0.55, z), Vec3(0.3, 0.55, z)}, {2, 2});
    scene.surfaces.back().two_sided = true;
    scene.enclosure = Enclosure::closed;
    return scene;
}

std::vector<std::uint32_t> sampled_patches(const PatchMesh& mesh, std::uint32_t count) {
    std::vector<std::uint32_t> patches;
    for (std::uint32_t k = 0; k < count; ++k) {
        const double within = std::fmod(0.6180339887498949 * (k + 1), 1.0);
        patches.push_back(static_cast<std::uint32_t>((k + within) * mesh.size() / count));
    }
    patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
    return patches;
}

void RowErrors::add(std::uint32_t i, const RowView& row, const std::vector<double>& reference) {
    std::vector<double> found(reference.size(), 0.0);
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        found[row.columns[k]] = double{row.values[k]};
    }
    for (std::uint32_t j = 0; j < reference.size(); ++j) {
        const double error = std::abs(found[j] - reference[j]);
        if (error > max) {
            max = error;
            worst_i = i;
            worst_j = j;
        }
        if (reference[j] > 0.0) {
            squares_ += error * error;
            ++pairs;
        }
    }
    rms = pairs > 0 ? std::sqrt(squares_ / static_cast<double>(pairs)) : 0.0;
}

} // namespace hemi::test
