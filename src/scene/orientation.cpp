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

std::vector<Edge> edges_of(const Scene& scene) {
    std::unordered_map<std::array<double, 3>, std::uint32_t, HashPoint> numbers;
    const auto number_of = [&numbers](const Vec3& point) {
        // Zero of either sign is one place.
        const std::array<double, 3> key{point.x + 0.0, point.y + 0.0, point.z + 0.0};
        return numbers.emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second;
    };
    std::vector<Edge> edges;
    for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
        const Surface& surface = scene.surfaces[s];
        for (std::uint32_t k = 0; !surface.two_sided && k < surface.vertex_count; ++k) {
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

Bodies find_bodies(const Scene& scene) {
    const std::vector<Edge> edges = edges_of(scene);
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
        if (scene.surfaces[seed].two_sided || body_of[seed] != none) {
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

} // namespace

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
