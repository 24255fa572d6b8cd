#include "engine/outline.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace hemi {

namespace {

/// Vertices in the cells of a coarse grid, to find those near a segment.
class VertexGrid {
public:
    VertexGrid(std::span<const Vec3> positions, const std::vector<bool>& used, double tolerance) {
        std::size_t count = 0;
        for (std::size_t v = 0; v < positions.size(); ++v) {
            if (used[v]) {
                bounds_.add(positions[v]);
                ++count;
            }
        }
        const double cells = std::clamp(std::cbrt(static_cast<double>(count)), 1.0, 64.0);
        cell_ = std::max(bounds_.diagonal() / cells, 4.0 * tolerance);
        for (std::size_t v = 0; v < positions.size(); ++v) {
            if (used[v]) {
                cells_[key(coordinates(positions[v]))].push_back(static_cast<std::uint32_t>(v));
            }
        }
    }

    /// Vertices in all cells that a segment passes or nearly touches; may hold some twice.
    void near_segment(const Vec3& a, const Vec3& b, std::vector<std::uint32_t>& found) const {
        found.clear();
        const auto from = coordinates(a);
        const auto to = coordinates(b);
        // Cells of the segment's box; walked along its longest axis so that only a thin tube is visited.
        int axis = 0;
        for (int k = 1; k < 3; ++k) {
            if (std::abs(b[k] - a[k]) > std::abs(b[axis] - a[axis])) {
                axis = k;
            }
        }
        const int step = to[axis] >= from[axis] ? 1 : -1;
        for (int slab = from[axis] - step;; slab += step) {
            // The part of the segment in this slab and its neighbours' halves.
            const double low = bounds_.lower[axis] + cell_ * (slab - 1);
            const double high = low + 3.0 * cell_;
            const double length = b[axis] - a[axis];
            double t0 = 0.0;
            double t1 = 1.0;
            if (std::abs(length) > 0.0) {
                t0 = std::clamp((low - a[axis]) / length, 0.0, 1.0);
                t1 = std::clamp((high - a[axis]) / length, 0.0, 1.0);
            }
            const auto c0 = coordinates(a + t0 * (b - a));
            const auto c1 = coordinates(a + t1 * (b - a));
            std::array<int, 3> lower{};
            std::array<int, 3> upper{};
            for (std::size_t k = 0; k < 3; ++k) {
                lower[k] = std::min(c0[k], c1[k]) - 1;
                upper[k] = std::max(c0[k], c1[k]) + 1;
            }
            lower[static_cast<std::size_t>(axis)] = upper[static_cast<std::size_t>(axis)] = slab;
            for (int x = lower[0]; x <= upper[0]; ++x) {
                for (int y = lower[1]; y <= upper[1]; ++y) {
                    for (int z = lower[2]; z <= upper[2]; ++z) {
                        if (const auto cell = cells_.find(key({x, y, z})); cell != cells_.end()) {
                            found.insert(found.end(), cell->second.begin(), cell->second.end());
                        }
                    }
                }
            }
            if (slab == to[axis] + step) {
                break;
            }
        }
    }

private:
    [[nodiscard]] std::array<int, 3> coordinates(const Vec3& point) const {
        std::array<int, 3> result{};
        for (int k = 0; k < 3; ++k) {
            result[static_cast<std::size_t>(k)] =
                static_cast<int>(std::floor((point[k] - bounds_.lower[k]) / cell_));
        }
        return result;
    }
    static std::uint64_t key(const std::array<int, 3>& c) {
        const auto bits = [](int value) { return static_cast<std::uint64_t>(value + 1024) & 0x1FFFFFu; };
        return (bits(c[0]) << 42) | (bits(c[1]) << 21) | bits(c[2]);
    }

    Bounds bounds_;
    double cell_ = 1.0;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

double cross(const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c) {
    return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

double squared_length(const OutlinePoint& a, const OutlinePoint& b) {
    return (b.u - a.u) * (b.u - a.u) + (b.v - a.v) * (b.v - a.v);
}

} // namespace

void insert_touching_vertices(std::vector<Outline>& outlines, std::span<const Vec3> positions,
                              const TouchingTolerance& tolerance) {
    std::vector<bool> used(positions.size(), false);
    for (const Outline& outline : outlines) {
        for (std::size_t c = 0; c < outline.size(); ++c) {
            used[outline[c].vertex] = true;
        }
    }
    const VertexGrid grid(positions, used, tolerance.largest());

    std::vector<std::uint32_t> candidates;
    std::vector<std::pair<double, std::uint32_t>> touching;
    for (Outline& outline : outlines) {
        Outline refined;
        for (std::size_t c = 0; c < outline.size(); ++c) {
            const OutlinePoint& from = outline[c];
            const OutlinePoint& to = outline[(c + 1) % outline.size()];
            refined.push_back(from);
            const Vec3& a = positions[from.vertex];
            const Vec3 along = positions[to.vertex] - a;
            const double length_squared = glm::dot(along, along);
            if (!(length_squared > 0.0)) {
                continue; // corners closer than the welding tolerance
            }
            const double slack = tolerance.at(std::sqrt(length_squared));
            grid.near_segment(a, positions[to.vertex], candidates);
            touching.clear();
            for (const std::uint32_t v : candidates) {
                if (v == from.vertex || v == to.vertex) {
                    continue;
                }
                const Vec3 offset = positions[v] - a;
                const double t = glm::dot(offset, along) / length_squared;
                const Vec3 gap = offset - t * along;
                if (t > 0.0 && t < 1.0 && glm::dot(gap, gap) <= slack * slack) {
                    touching.emplace_back(t, v);
                }
            }
            std::sort(touching.begin(), touching.end());
            touching.erase(std::unique(touching.begin(), touching.end()), touching.end());
            for (const auto& [t, v] : touching) {
                refined.push_back({v, from.u + t * (to.u - from.u), from.v + t * (to.v - from.v)});
            }
        }
        outline = std::move(refined);
    }
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
