#include "hemi/scene/orientation.hpp"

#include "core/box_tree.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace hemi {

namespace {

/// An edge of a face: its ends in ascending order, and whether the face runs along it that way.
struct Edge {
    std::uint32_t low;
    std::uint32_t high;
    std::uint32_t surface;
    std::uint32_t corner; ///< of the face, where the edge begins
    bool ascending;
};

/// Faces that hang together by edges.
struct Body {
    std::vector<std::uint32_t> surfaces;
    bool watertight = true;
    bool has_two_sides = true; ///< unlike a Moebius strip
    Vec3 gap_points{0.0};      ///< sum of the ends of edges that belong to one face
    std::size_t gaps = 0;
    double volume = 0.0; ///< positive: the faces, each turned as `against` says, look outwards
    Bounds bounds;
};

struct Bodies {
    std::vector<Body> all;
    std::vector<bool> against; ///< for every surface: turned against the first of its body
};

struct HashPoint {
    std::size_t operator()(const std::array<double, 3>& point) const {
        std::uint64_t hash = 0;
        for (const double value : point) {
            hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x9E3779B97F4A7C15u;
            hash ^= hash >> 29;
        }
        return hash;
    }
};

/// @param two_sided  of faces of that kind alone
std::vector<Edge> edges_of(const Scene& scene, bool two_sided) {
    std::unordered_map<std::array<double, 3>, std::uint32_t, HashPoint> numbers;
    const auto number_of = [&numbers](const Vec3& point) {
        // Zero of either sign is one place.
        const std::array<double, 3> key{point.x + 0.0, point.y + 0.0, point.z + 0.0};
        return numbers.emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second;
    };
    std::vector<Edge> edges;
    for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
        const Surface& surface = scene.surfaces[s];
        for (std::uint32_t k = 0; surface.two_sided == two_sided && k < surface.vertex_count; ++k) {
            const std::uint32_t from = number_of(surface.vertices[k]);
            const std::uint32_t to = number_of(surface.vertices[(k + 1) % surface.vertex_count]);
            edges.push_back({std::min(from, to), std::max(from, to), s, k, from < to});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.surface) < std::tie(b.low, b.high, b.surface);
    });
    return edges;
}

/// Six times the volume between a face and a point.
double six_volumes(const Surface& surface, const Vec3& from) {
    double sum = 0.0;
    for (std::uint32_t k = 1; k + 1 < surface.vertex_count; ++k) {
        sum += glm::dot(surface.vertices[0] - from,
                        glm::cross(surface.vertices[k] - from, surface.vertices[k + 1] - from));
    }
    return sum;
}

void measure(Body& body, const Scene& scene, const std::vector<bool>& against) {
    for (const std::uint32_t s : body.surfaces) {
        for (const Vec3& vertex : scene.surfaces[s].polygon()) {
            body.bounds.add(vertex);
        }
    }
    const Vec3 from = body.gaps > 0 ? body.gap_points / static_cast<double>(body.gaps) : body.bounds.centre();
    for (const std::uint32_t s : body.surfaces) {
        body.volume += (against[s] ? -1.0 : 1.0) * six_volumes(scene.surfaces[s], from) / 6.0;
    }
    const double size = body.bounds.diagonal();
    body.volume = std::abs(body.volume) > 1e-9 * size * size * size ? body.volume : 0.0;
}

/// @param two_sided  faces of that kind alone
Bodies find_bodies(const Scene& scene, bool two_sided = false) {
    const std::vector<Edge> edges = edges_of(scene, two_sided);
    struct Neighbour {
        std::uint32_t surface;
        bool opposed;
    };
    std::vector<std::vector<Neighbour>> neighbours(scene.surfaces.size());
    std::vector<Edge> rims;    // of one face
    std::vector<Edge> crowded; // of more than two
    for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
        while (end < edges.size() && edges[end].low == edges[first].low &&
               edges[end].high == edges[first].high) {
            ++end;
        }
        if (end - first == 2) {
            const Edge& a = edges[first];
            const Edge& b = edges[first + 1];
            const bool opposed = a.ascending == b.ascending;
            neighbours[a.surface].push_back({b.surface, opposed});
            neighbours[b.surface].push_back({a.surface, opposed});
            continue;
        }
        std::vector<Edge>& others = end - first == 1 ? rims : crowded;
        others.insert(others.end(), edges.begin() + static_cast<std::ptrdiff_t>(first),
                      edges.begin() + static_cast<std::ptrdiff_t>(end));
    }
    Bodies bodies;
    bodies.against.assign(scene.surfaces.size(), false);
    constexpr std::uint32_t none = ~0u;
    std::vector<std::uint32_t> body_of(scene.surfaces.size(), none);
    for (std::uint32_t seed = 0; seed < scene.surfaces.size(); ++seed) {
        if (scene.surfaces[seed].two_sided != two_sided || body_of[seed] != none) {
            continue;
        }
        const auto index = static_cast<std::uint32_t>(bodies.all.size());
        Body& body = bodies.all.emplace_back();
        body.surfaces.push_back(seed);
        body_of[seed] = index;
        for (std::size_t k = 0; k < body.surfaces.size(); ++k) {
            const std::uint32_t from = body.surfaces[k];
            for (const Neighbour& next : neighbours[from]) {
                const bool against = bodies.against[from] != next.opposed;
                if (body_of[next.surface] == none) {
                    body_of[next.surface] = index;
                    bodies.against[next.surface] = against;
                    body.surfaces.push_back(next.surface);
                } else if (bodies.against[next.surface] != against) {
                    body.has_two_sides = false;
                }
            }
        }
    }
    for (const Edge& edge : crowded) {
        bodies.all[body_of[edge.surface]].watertight = false;
    }
    for (const Edge& edge : rims) {
        Body& body = bodies.all[body_of[edge.surface]];
        body.watertight = false;
        body.gap_points += scene.surfaces[edge.surface].vertices[edge.corner];
        ++body.gaps;
    }
    for (Body& body : bodies.all) {
        measure(body, scene, bodies.against);
    }
    return bodies;
}

/// How often a watertight body winds around a point: 1 inside, 0 outside, between them on it.
double winding(const Body& body, const Bodies& bodies, const Scene& scene, const Vec3& point) {
    double angle = 0.0;
    for (const std::uint32_t s : body.surfaces) {
        const Surface& surface = scene.surfaces[s];
        for (std::uint32_t k = 1; k + 1 < surface.vertex_count; ++k) {
            const Vec3 a = surface.vertices[0] - point;
            const Vec3 b = surface.vertices[k] - point;
            const Vec3 c = surface.vertices[k + 1] - point;
            const double la = glm::length(a);
            const double lb = glm::length(b);
            const double lc = glm::length(c);
            const double above = glm::dot(a, glm::cross(b, c));
            const double below =
                la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
            angle += (bodies.against[s] ? -2.0 : 2.0) * std::atan2(above, below);
        }
    }
    return std::abs(angle) / (4.0 * std::numbers::pi);
}

/// Whether the middle of a few of a body's faces is within another: some may lie on it.
bool is_within(const Body& body, const Body& other, const Bodies& bodies, const Scene& scene) {
    const double slack = 1e-9 * other.bounds.diagonal();
    for (int axis = 0; axis < 3; ++axis) {
        if (body.bounds.lower[axis] < other.bounds.lower[axis] - slack ||
            body.bounds.upper[axis] > other.bounds.upper[axis] + slack) {
            return false;
        }
    }
    constexpr std::size_t most = 9;
    const std::size_t step = (body.surfaces.size() + most - 1) / most;
    std::vector<double> windings;
    for (std::size_t k = 0; k < body.surfaces.size(); k += step) {
        windings.push_back(
            winding(other, bodies, scene, area_centroid(scene.surfaces[body.surfaces[k]].polygon())));
    }
    std::sort(windings.begin(), windings.end());
    return windings[windings.size() / 2] > 0.75;
}

bool can_be_decided(const Body& body) {
    return body.has_two_sides && body.volume != 0.0;
}

/// Finds watertight bodies that others may be within.
class Containers {
public:
    explicit Containers(const Bodies& bodies) {
        Bounds all;
        for (const Body& body : bodies.all) {
            if (body.watertight && can_be_decided(body)) {
                bodies_.push_back(&body);
                boxes_.push_back(body.bounds);
                all.add(body.bounds.lower);
                all.add(body.bounds.upper);
            }
        }
        slack_ = boxes_.empty() ? 0.0 : 1e-9 * all.diagonal();
        tree_.emplace(boxes_);
    }

    /// In how many the body is.
    [[nodiscard]] std::size_t around(const Body& body, const Bodies& bodies, const Scene& scene) const {
        std::size_t count = 0;
        const Bounds near{body.bounds.lower - slack_, body.bounds.upper + slack_};
        tree_->overlapping(near, [&](std::uint32_t index) {
            const Body& other = *bodies_[index];
            count += &other != &body && std::abs(other.volume) > std::abs(body.volume) &&
                             is_within(body, other, bodies, scene)
                         ? 1
                         : 0;
        });
        return count;
    }

private:
    std::vector<const Body*> bodies_;
    std::vector<Bounds> boxes_;
    std::optional<BoxTree> tree_;
    double slack_ = 0.0;
};

/// What is in and around the bodies of a scene.
class Inhabitants {
public:
    Inhabitants(const Scene& scene, const Bodies& bodies)
        : scene_(scene), bodies_(bodies), body_of_(scene.surfaces.size(), none) {
        for (std::uint32_t b = 0; b < bodies.all.size(); ++b) {
            for (const std::uint32_t s : bodies.all[b].surfaces) {
                body_of_[s] = b;
            }
        }
        for (const Surface& surface : scene.surfaces) {
            Bounds& box = boxes_.emplace_back();
            for (const Vec3& vertex : surface.polygon()) {
                box.add(vertex);
                all_.add(vertex);
            }
        }
        tree_.emplace(boxes_);
    }

    /// Whether other faces are within the body, or may be in part.
    [[nodiscard]] bool any_within(std::uint32_t b) const {
        const Body& body = bodies_.all[b];
        const double slack = slack_of(body);
        std::vector<std::uint32_t> inside_box;
        bool crosses = false;
        tree_->overlapping({body.bounds.lower + slack, body.bounds.upper - slack}, [&](std::uint32_t s) {
            if (body_of_[s] != b) {
                crosses = crosses || !contains(body.bounds, boxes_[s], slack);
                inside_box.push_back(s);
            }
        });
        return crosses || most_winding(body, inside_box) > 0.75;
    }

    /// Whether there are other faces, and all are within the body or on it.
    [[nodiscard]] bool all_within(std::uint32_t b) const {
        const Body& body = bodies_.all[b];
        if (!contains(body.bounds, all_, slack_of(body))) {
            return false;
        }
        std::vector<std::uint32_t> others;
        for (std::uint32_t s = 0; s < boxes_.size(); ++s) {
            if (body_of_[s] != b) {
                others.push_back(s);
            }
        }
        return !others.empty() && least_winding(body, others) > 0.25;
    }

    /// Whether the body is all there is, and no face of it sees another from outside.
    [[nodiscard]] bool is_alone_and_convex(std::uint32_t b) const {
        const Body& body = bodies_.all[b];
        if (body.surfaces.size() != scene_.surfaces.size()) {
            return false;
        }
        const Vec3 centre = body.bounds.centre();
        std::vector<Vec3> corners;
        for (const Surface& surface : scene_.surfaces) {
            corners.insert(corners.end(), surface.polygon().begin(), surface.polygon().end());
        }
        const std::size_t step = (body.surfaces.size() + most_tested - 1) / most_tested;
        for (std::size_t k = 0; k < body.surfaces.size(); k += step) {
            const std::span<const Vec3> polygon = scene_.surfaces[body.surfaces[k]].polygon();
            Vec3 outwards = glm::normalize(area_vector(polygon));
            outwards *= glm::dot(polygon[0] - centre, outwards) < 0.0 ? -1.0 : 1.0;
            for (const Vec3& corner : corners) {
                if (glm::dot(corner - polygon[0], outwards) > 1e-6 * body.bounds.diagonal()) {
                    return false;
                }
            }
        }
        return true;
    }

private:
    static constexpr std::uint32_t none = ~0u;
    static constexpr std::size_t most_tested = 32; // faces; the rest are taken to be like those

    static double slack_of(const Body& body) { return 1e-6 * body.bounds.diagonal(); }

    static bool contains(const Bounds& outer, const Bounds& inner, double slack) {
        for (int axis = 0; axis < 3; ++axis) {
            if (inner.lower[axis] < outer.lower[axis] - slack ||
                inner.upper[axis] > outer.upper[axis] + slack) {
                return false;
            }
        }
        return true;
    }

    [[nodiscard]] std::vector<double> windings(const Body& body, std::span<const std::uint32_t> faces) const {
        std::vector<double> result;
        const std::size_t step = (faces.size() + most_tested - 1) / most_tested;
        for (std::size_t k = 0; k < faces.size(); k += step) {
            result.push_back(
                winding(body, bodies_, scene_, area_centroid(scene_.surfaces[faces[k]].polygon())));
        }
        return result;
    }
    [[nodiscard]] double most_winding(const Body& body, std::span<const std::uint32_t> faces) const {
        const std::vector<double> all = windings(body, faces);
        return all.empty() ? 0.0 : *std::max_element(all.begin(), all.end());
    }
    [[nodiscard]] double least_winding(const Body& body, std::span<const std::uint32_t> faces) const {
        const std::vector<double> all = windings(body, faces);
        return all.empty() ? 1.0 : *std::min_element(all.begin(), all.end());
    }

    const Scene& scene_;
    const Bodies& bodies_;
    std::vector<std::uint32_t> body_of_; ///< of every surface
    std::vector<Bounds> boxes_;          ///< of every surface
    Bounds all_;
    std::optional<BoxTree> tree_;
};

/// Bodies times faces of the largest one: some seconds.
constexpr double most_work = 2e7;

} // namespace

OneSidedBodies make_bodies_one_sided(Scene& scene, const std::vector<bool>& groups) {
    const Bodies bodies = find_bodies(scene, true);
    OneSidedBodies result;
    const auto is_meant = [&](const Body& body) {
        return body.watertight && can_be_decided(body) &&
               std::all_of(body.surfaces.begin(), body.surfaces.end(),
                           [&](std::uint32_t s) { return groups[scene.surfaces[s].group]; });
    };
    std::size_t largest = 0;
    std::size_t meant = 0;
    for (const Body& body : bodies.all) {
        largest = std::max(largest, body.surfaces.size());
        meant += is_meant(body) ? 1 : 0;
    }
    if (meant == 0 || static_cast<double>(meant) * static_cast<double>(largest) > most_work) {
        return result;
    }
    const Containers containers(bodies);
    const Inhabitants inhabitants(scene, bodies);
    std::vector<std::uint32_t> inwards;
    std::vector<std::uint32_t> outwards;
    for (std::uint32_t b = 0; b < bodies.all.size(); ++b) {
        if (!is_meant(bodies.all[b])) {
            continue;
        }
        if (containers.around(bodies.all[b], bodies, scene) > 0) {
            if (!inhabitants.any_within(b)) {
                outwards.push_back(b);
            }
        } else if (inhabitants.all_within(b) || inhabitants.is_alone_and_convex(b)) {
            inwards.push_back(b);
        }
    }
    const auto turn = [&](std::uint32_t b, bool out) {
        const Body& body = bodies.all[b];
        const bool first_turns = (body.volume > 0.0) != out;
        for (const std::uint32_t s : body.surfaces) {
            scene.surfaces[s].two_sided = false;
            if (bodies.against[s] != first_turns) {
                turn_round(scene.surfaces[s]);
            }
            ++result.faces;
        }
    };
    for (const std::uint32_t b : inwards) {
        turn(b, false);
    }
    for (const std::uint32_t b : outwards) {
        turn(b, true);
    }
    result.inwards = inwards.size();
    result.outwards = outwards.size();
    return result;
}

void turn_round(Surface& surface) {
    std::reverse(surface.vertices.begin() + 1, surface.vertices.begin() + surface.vertex_count);
    if (surface.patches) {
        std::swap(surface.patches->u, surface.patches->v);
    }
}

OrientedFaces orient(Scene& scene, Orientation orientation) {
    OrientedFaces result;
    if (orientation == Orientation::as_read) {
        return result;
    }
    const Bodies bodies = find_bodies(scene);
    const Containers containers(bodies);
    std::vector<bool> turn(scene.surfaces.size(), false);
    for (const Body& body : bodies.all) {
        if (!can_be_decided(body)) {
            result.undecided += body.surfaces.size();
            continue;
        }
        const bool swapped = containers.around(body, bodies, scene) % 2 == 1;
        const bool outwards = (orientation == Orientation::out) != swapped;
        const bool first_turns = (body.volume > 0.0) != outwards;
        for (const std::uint32_t s : body.surfaces) {
            turn[s] = bodies.against[s] != first_turns;
        }
    }
    for (std::size_t s = 0; s < turn.size(); ++s) {
        if (turn[s]) {
            turn_round(scene.surfaces[s]);
            ++result.turned;
        }
    }
    return result;
}

std::vector<std::uint32_t> turned_against_others(const Scene& scene) {
    const Bodies bodies = find_bodies(scene);
    std::vector<std::uint32_t> found;
    for (const Body& body : bodies.all) {
        if (!body.watertight || !can_be_decided(body)) {
            continue;
        }
        const auto against = static_cast<std::size_t>(std::count_if(
            body.surfaces.begin(), body.surfaces.end(), [&](std::uint32_t s) { return bodies.against[s]; }));
        const bool most = 2 * against > body.surfaces.size();
        for (const std::uint32_t s : body.surfaces) {
            if (bodies.against[s] != most) {
                found.push_back(s);
            }
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

} // namespace hemi
