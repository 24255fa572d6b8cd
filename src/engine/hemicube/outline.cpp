#include "engine/hemicube/outline.hpp"

#include "core/parallel_for.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hemi {

namespace {

/// A binary tree over vertices, split at medians, to find those near a segment: as fast where vertices crowd
/// in a large scene as where they are spread evenly.
class VertexTree {
public:
    struct Vertex {
        Vec3 position;
        std::uint32_t index;
    };

    explicit VertexTree(std::vector<Vertex> vertices) : vertices_(std::move(vertices)) {
        nodes_.reserve(4 * (vertices_.size() / leaf + 1));
        if (!vertices_.empty()) {
            split(0, static_cast<std::uint32_t>(vertices_.size()));
        }
    }

    /// Calls `visit(vertex)` for all vertices within `distance` of the segment, and for some others.
    template <typename Visit>
    void near_segment(const Vec3& a, const Vec3& b, double distance, const Visit& visit) const {
        const Vec3 inverse = 1.0 / (b - a);
        std::uint32_t at = 0;
        while (at < nodes_.size()) { // depth first; a node that is missed is skipped with all below it
            const Node& node = nodes_[at];
            if (!is_near(node.bounds, a, inverse, distance)) {
                at = node.after;
                continue;
            }
            for (std::uint32_t k = node.first; k < node.end; ++k) {
                visit(vertices_[k]);
            }
            ++at;
        }
    }

private:
    static constexpr std::uint32_t leaf = 8;

    struct Node {
        Bounds bounds;
        std::uint32_t first = 0, end = 0; ///< vertices of a leaf
        std::uint32_t after = 0;          ///< the node that follows all below this one
    };

    /// Whether the segment from a to a + 1 / inverse meets the box, made larger by `distance` on all sides.
    static bool is_near(const Bounds& box, const Vec3& a, const Vec3& inverse, double distance) {
        double enter = 0.0;
        double leave = 1.0;
        for (int axis = 0; axis < 3; ++axis) {
            const double low = box.lower[axis] - distance - a[axis];
            const double high = box.upper[axis] + distance - a[axis];
            if (std::isinf(inverse[axis])) {
                if (low > 0.0 || high < 0.0) {
                    return false;
                }
                continue;
            }
            const double t0 = low * inverse[axis];
            const double t1 = high * inverse[axis];
            enter = std::max(enter, std::min(t0, t1));
            leave = std::min(leave, std::max(t0, t1));
        }
        return enter <= leave;
    }

    void split(std::uint32_t first, std::uint32_t end) {
        const std::size_t node = nodes_.size();
        nodes_.emplace_back();
        Bounds bounds;
        for (std::uint32_t k = first; k < end; ++k) {
            bounds.add(vertices_[k].position);
        }
        nodes_[node].bounds = bounds;
        if (end - first <= leaf) {
            nodes_[node].first = first;
            nodes_[node].end = end;
        } else {
            const Vec3 extent = bounds.upper - bounds.lower;
            const int axis =
                extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
            const std::uint32_t middle = first + (end - first) / 2;
            std::nth_element(
                vertices_.begin() + first, vertices_.begin() + middle, vertices_.begin() + end,
                [axis](const Vertex& u, const Vertex& v) { return u.position[axis] < v.position[axis]; });
            split(first, middle);
            split(middle, end);
        }
        nodes_[node].after = static_cast<std::uint32_t>(nodes_.size());
    }

    std::vector<Vertex> vertices_; ///< in the order of the leaves
    std::vector<Node> nodes_;      ///< in depth-first order
};

double cross(const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c) {
    return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

double squared_length(const OutlinePoint& a, const OutlinePoint& b) {
    return (b.u - a.u) * (b.u - a.u) + (b.v - a.v) * (b.v - a.v);
}

/// Inserts the vertices of the tree that lie on the outline's edges.
void refine(Outline& outline, std::span<const Vec3> positions, const VertexTree& tree,
            const TouchingTolerance& tolerance) {
    std::vector<std::pair<double, std::uint32_t>> touching;
    Outline refined;
    for (std::size_t c = 0; c < outline.size(); ++c) {
        const OutlinePoint& from = outline[c];
        const OutlinePoint& to = outline[(c + 1) % outline.size()];
        refined.push_back(from);
        const Vec3& a = positions[from.vertex];
        const Vec3& b = positions[to.vertex];
        const Vec3 along = b - a;
        const double length_squared = glm::dot(along, along);
        if (!(length_squared > 0.0)) {
            continue; // corners closer than the welding tolerance
        }
        const double slack = tolerance.at(std::sqrt(length_squared));
        touching.clear();
        tree.near_segment(a, b, 2.0 * slack, [&](const VertexTree::Vertex& v) {
            if (v.index == from.vertex || v.index == to.vertex) {
                return;
            }
            const Vec3 offset = v.position - a;
            const double t = glm::dot(offset, along) / length_squared;
            const Vec3 gap = offset - t * along;
            if (t > 0.0 && t < 1.0 && glm::dot(gap, gap) <= slack * slack) {
                touching.emplace_back(t, v.index);
            }
        });
        std::sort(touching.begin(), touching.end());
        for (const auto& [t, v] : touching) {
            refined.push_back({v, from.u + t * (to.u - from.u), from.v + t * (to.v - from.v)});
        }
    }
    outline = std::move(refined);
}

} // namespace

void insert_touching_vertices(std::vector<Outline>& outlines, std::span<const Vec3> positions,
                              const TouchingTolerance& tolerance) {
    std::vector<bool> used(positions.size(), false);
    for (const Outline& outline : outlines) {
        for (const OutlinePoint& corner : outline) {
            used[corner.vertex] = true;
        }
    }
    std::vector<VertexTree::Vertex> vertices;
    vertices.reserve(positions.size());
    for (std::uint32_t v = 0; v < positions.size(); ++v) {
        if (used[v]) {
            vertices.push_back({positions[v], v});
        }
    }
    const VertexTree tree(std::move(vertices));

    constexpr std::size_t at_once = 4096;
    parallel_for(outlines.size(), at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            refine(outlines[k], positions, tree, tolerance);
        }
    });
}

std::vector<std::array<std::uint32_t, 3>> triangulate(const Outline& outline) {
    std::vector<std::uint32_t> rest(outline.size());
    double remaining = 0.0;
    for (std::uint32_t i = 0; i < rest.size(); ++i) {
        rest[i] = i;
        if (i >= 1 && i + 1 < rest.size()) {
            remaining += cross(outline[0], outline[i], outline[i + 1]);
        }
    }
    const double least = 1e-12 * remaining;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    triangles.reserve(outline.size() - 2);
    // Cut off the best-shaped ear again and again, but never one that leaves only corners on a line behind.
    while (rest.size() >= 3) {
        std::size_t best = rest.size();
        double best_quality = 0.0;
        double best_area = 0.0;
        for (std::size_t k = 0; k < rest.size(); ++k) {
            const OutlinePoint& a = outline[rest[(k + rest.size() - 1) % rest.size()]];
            const OutlinePoint& b = outline[rest[k]];
            const OutlinePoint& c = outline[rest[(k + 1) % rest.size()]];
            const double area = cross(a, b, c);
            if (area <= least || (rest.size() > 3 && remaining - area <= least)) {
                continue;
            }
            const double quality =
                area / (squared_length(a, b) + squared_length(b, c) + squared_length(c, a));
            if (quality > best_quality * (1.0 + 1e-12)) {
                best = k;
                best_quality = quality;
                best_area = area;
            }
        }
        if (best == rest.size()) {
            break;
        }
        triangles.push_back(
            {rest[(best + rest.size() - 1) % rest.size()], rest[best], rest[(best + 1) % rest.size()]});
        remaining -= best_area;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(best));
    }
    return triangles;
}

} // namespace hemi
