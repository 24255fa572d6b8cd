#include "engine/hemicube/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

namespace hemi {

namespace {

constexpr std::uint32_t none = 0xFFFFFFFFu;

struct CellKey {
    std::int32_t i, j;
    bool operator==(const CellKey&) const = default;
    auto operator<=>(const CellKey& other) const {
        return j != other.j ? j <=> other.j : i <=> other.i; // row by row
    }
};
struct CellKeyHash {
    std::size_t operator()(const CellKey& key) const noexcept {
        return (static_cast<std::size_t>(static_cast<std::uint32_t>(key.i)) * 0x9E3779B97F4A7C15u) ^
               (static_cast<std::size_t>(static_cast<std::uint32_t>(key.j)) * 0xC2B2AE3D27D4EB4Fu);
    }
};

/// Frame of a lattice: cell (i, j) has corners origin + i·u + j·v and so on; u x v points to the front.
struct Frame {
    Vec3 origin, u, v;
    Vec3 dual_u, dual_v, normal; ///< dual_u·u = 1, dual_u·v = 0
    double slack = 0.0;          ///< length by which vertices may be off
    bool triangles = false;

    Frame(const Vec3& o, const Vec3& du, const Vec3& dv, bool split, const TouchingTolerance& tolerance)
        : origin(o), u(du), v(dv), slack(0.5 * tolerance.at(std::min(glm::length(du), glm::length(dv)))),
          triangles(split) {
        const Vec3 cross = glm::cross(u, v);
        const double squared = glm::dot(cross, cross);
        normal = cross / std::sqrt(squared);
        dual_u = glm::cross(v, cross) / squared;
        dual_v = glm::cross(cross, u) / squared;
    }

    /// Lattice coordinates of a point, if it is a lattice point.
    [[nodiscard]] std::optional<CellKey> snap(const Vec3& point) const {
        const Vec3 offset = point - origin;
        const double i = glm::dot(offset, dual_u);
        const double j = glm::dot(offset, dual_v);
        if (!(std::abs(i) < 1e6 && std::abs(j) < 1e6) ||
            glm::length(offset - std::round(i) * u - std::round(j) * v) > slack) {
            return std::nullopt;
        }
        return CellKey{static_cast<std::int32_t>(std::lround(i)), static_cast<std::int32_t>(std::lround(j))};
    }
};

/// Where a surface lies on a lattice.
struct Placement {
    CellKey cell;
    std::uint32_t half = 0; ///< triangles: 0 lower left, 1 upper right
    bool swapped = false;   ///< the surface's own u runs along the lattice's v
};

/// One lattice while it grows: which surface is in which cell, which vertex at which lattice point.
struct Region {
    std::unordered_map<CellKey, std::array<std::uint32_t, 2>, CellKeyHash> cells;
    std::unordered_map<CellKey, std::uint32_t, CellKeyHash> points;
};

class LatticeFinder {
public:
    LatticeFinder(const PatchMesh& mesh, std::span<const std::array<std::uint32_t, 4>> surface_vertices,
                  std::span<const Vec3> positions, const TouchingTolerance& tolerance)
        : mesh_(mesh), vertices_(surface_vertices), positions_(positions), tolerance_(tolerance) {}

    std::vector<MergedLattice> run() {
        build_adjacency();
        taken_.assign(vertices_.size(), false);
        for (std::uint32_t seed = 0; seed < vertices_.size(); ++seed) {
            if (!taken_[seed] && usable(seed)) {
                grow(seed);
            }
        }
        return std::move(found_);
    }

private:
    [[nodiscard]] std::uint32_t count(std::uint32_t s) const { return mesh_.surfaces()[s].vertex_count; }
    [[nodiscard]] const Vec3& at(std::uint32_t s, std::uint32_t corner) const {
        return positions_[vertices_[s][corner % count(s)]];
    }

    /// Parallelograms and triangles with patches of one size; others are drawn as they are.
    [[nodiscard]] bool usable(std::uint32_t s) const {
        if (!mesh_.parts(s).empty()) {
            return false;
        }
        if (count(s) == 3) {
            return true;
        }
        const Vec3 gap = at(s, 0) - at(s, 1) + at(s, 2) - at(s, 3);
        const double edge = std::min(glm::length(at(s, 1) - at(s, 0)), glm::length(at(s, 3) - at(s, 0)));
        return glm::length(gap) <= tolerance_.at(edge);
    }

    static std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
        return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
    }

    void build_adjacency() {
        for (std::uint32_t s = 0; s < vertices_.size(); ++s) {
            for (std::uint32_t c = 0; c < count(s); ++c) {
                edges_.push_back({edge_key(vertices_[s][c], vertices_[s][(c + 1) % count(s)]), s});
            }
        }
        std::sort(edges_.begin(), edges_.end());
    }

    template <typename Visit>
    void for_neighbours(std::uint32_t s, const Visit& visit) const {
        for (std::uint32_t c = 0; c < count(s); ++c) {
            const std::uint64_t key = edge_key(vertices_[s][c], vertices_[s][(c + 1) % count(s)]);
            auto entry = std::lower_bound(edges_.begin(), edges_.end(), std::pair{key, 0u});
            for (; entry != edges_.end() && entry->first == key; ++entry) {
                if (entry->second != s) {
                    visit(entry->second);
                }
            }
        }
    }

    [[nodiscard]] Frame frame_of(std::uint32_t s) const {
        if (count(s) == 4) {
            return {at(s, 0), at(s, 1) - at(s, 0), at(s, 3) - at(s, 0), false, tolerance_};
        }
        // The longest edge is the cells' diagonal; the corner opposite to it is the lower left one.
        std::uint32_t corner = 0;
        double longest = -1.0;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const double length = glm::length(at(s, c + 2) - at(s, c + 1));
            if (length > longest * (1.0 + 1e-6)) {
                longest = length;
                corner = c;
            }
        }
        return {at(s, corner), at(s, corner + 1) - at(s, corner), at(s, corner + 2) - at(s, corner), true,
                tolerance_};
    }

    [[nodiscard]] std::optional<Placement> place(const Frame& frame, std::uint32_t s) const {
        if ((count(s) == 3) != frame.triangles || glm::dot(mesh_.surface_normal(s), frame.normal) < 0.5) {
            return std::nullopt;
        }
        std::array<CellKey, 4> keys{};
        for (std::uint32_t c = 0; c < count(s); ++c) {
            const auto key = frame.snap(at(s, c));
            if (!key) {
                return std::nullopt;
            }
            keys[c] = *key;
        }
        Placement placement;
        placement.cell = keys[0];
        CellKey upper = keys[0];
        for (std::uint32_t c = 1; c < count(s); ++c) {
            placement.cell = {std::min(placement.cell.i, keys[c].i), std::min(placement.cell.j, keys[c].j)};
            upper = {std::max(upper.i, keys[c].i), std::max(upper.j, keys[c].j)};
        }
        if (upper.i - placement.cell.i != 1 || upper.j - placement.cell.j != 1) {
            return std::nullopt;
        }
        if (frame.triangles) {
            // The missing corner of the cell tells which half this is; only two are cut the right way.
            int sum = 0;
            for (std::uint32_t c = 0; c < 3; ++c) {
                sum += (keys[c].i - placement.cell.i) + (keys[c].j - placement.cell.j);
            }
            const bool has_lower =
                keys[0] == placement.cell || keys[1] == placement.cell || keys[2] == placement.cell;
            if (keys[0] == keys[1] || keys[1] == keys[2] || keys[2] == keys[0]) {
                return std::nullopt;
            }
            if (sum == 2 && has_lower) {
                placement.half = 0;
            } else if (sum == 4 && !has_lower) {
                placement.half = 1;
            } else {
                return std::nullopt;
            }
        } else {
            placement.swapped = keys[1].i == keys[0].i;
        }
        return placement;
    }

    [[nodiscard]] static Grid oriented(Grid grid, bool swapped) {
        return swapped ? Grid{grid.v, grid.u} : grid;
    }

    void grow(std::uint32_t seed) {
        const Frame frame = frame_of(seed);
        const Grid grid = mesh_.grid(seed);
        const bool two_sided = mesh_.surfaces()[seed].two_sided;
        Region region;
        std::vector<std::uint32_t> queue{seed};
        std::vector<std::uint32_t> members;
        while (!queue.empty()) {
            const std::uint32_t s = queue.back();
            queue.pop_back();
            if (taken_[s] || !usable(s) || mesh_.surfaces()[s].two_sided != two_sided) {
                continue;
            }
            const auto placement = place(frame, s);
            if (!placement || oriented(mesh_.grid(s), placement->swapped) != grid) {
                continue;
            }
            auto& cell = region.cells.try_emplace(placement->cell, std::array{none, none}).first->second;
            if (cell[placement->half] != none) {
                continue; // a twin lies on it
            }
            cell[placement->half] = s;
            taken_[s] = true;
            members.push_back(s);
            for (std::uint32_t c = 0; c < count(s); ++c) {
                region.points.try_emplace(*frame.snap(at(s, c)), vertices_[s][c]);
            }
            for_neighbours(s, [&](std::uint32_t other) {
                if (!taken_[other]) {
                    queue.push_back(other);
                }
            });
        }
        if (members.size() > 1) {
            cut_into_rectangles(region, frame, grid);
        }
    }

    void cut_into_rectangles(Region& region, const Frame& frame, Grid grid) {
        std::vector<CellKey> order;
        for (const auto& [key, halves] : region.cells) {
            if (halves[0] != none && (!frame.triangles || halves[1] != none)) {
                order.push_back(key);
            }
        }
        std::sort(order.begin(), order.end());
        std::unordered_map<CellKey, bool, CellKeyHash> open;
        for (const CellKey& key : order) {
            open[key] = true;
        }
        const auto is_open = [&](std::int32_t i, std::int32_t j) {
            const auto entry = open.find({i, j});
            return entry != open.end() && entry->second;
        };
        for (const CellKey& key : order) {
            if (!is_open(key.i, key.j)) {
                continue;
            }
            std::int32_t width = 1;
            while (is_open(key.i + width, key.j) && (width + 1) * static_cast<std::int64_t>(grid.u) < 65536) {
                ++width;
            }
            std::int32_t height = 1;
            const auto row_open = [&](std::int32_t j) {
                for (std::int32_t i = 0; i < width; ++i) {
                    if (!is_open(key.i + i, j)) {
                        return false;
                    }
                }
                return true;
            };
            while (row_open(key.j + height) && (height + 1) * static_cast<std::int64_t>(grid.v) < 65536) {
                ++height;
            }
            add_rectangle(region, key, width, height, frame.triangles, grid);
            for (std::int32_t j = 0; j < height; ++j) {
                for (std::int32_t i = 0; i < width; ++i) {
                    open[{key.i + i, key.j + j}] = false;
                }
            }
        }
    }

    void add_rectangle(const Region& region, CellKey key, std::int32_t width, std::int32_t height, bool split,
                       Grid grid) {
        MergedLattice lattice;
        for (std::int32_t j = 0; j < height; ++j) {
            for (std::int32_t i = 0; i < width; ++i) {
                for (const std::uint32_t s : region.cells.at({key.i + i, key.j + j})) {
                    if (s != none) {
                        lattice.surfaces.push_back(s);
                    }
                }
            }
        }
        if (lattice.surfaces.size() < 2) {
            return;
        }
        lattice.vertices = {region.points.at(key), region.points.at({key.i + width, key.j}),
                            region.points.at({key.i + width, key.j + height}),
                            region.points.at({key.i, key.j + height})};
        lattice.cells = {static_cast<std::uint32_t>(width) * grid.u,
                         static_cast<std::uint32_t>(height) * grid.v};
        lattice.split = split;
        found_.push_back(std::move(lattice));
    }

    const PatchMesh& mesh_;
    std::span<const std::array<std::uint32_t, 4>> vertices_;
    std::span<const Vec3> positions_;
    TouchingTolerance tolerance_;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> edges_;
    std::vector<bool> taken_;
    std::vector<MergedLattice> found_;
};

} // namespace

std::vector<MergedLattice> find_lattices(const PatchMesh& mesh,
                                         std::span<const std::array<std::uint32_t, 4>> surface_vertices,
                                         std::span<const Vec3> positions,
                                         const TouchingTolerance& tolerance) {
    return LatticeFinder(mesh, surface_vertices, positions, tolerance).run();
}

} // namespace hemi
