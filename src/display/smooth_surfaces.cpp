#include "display/smooth_surfaces.hpp"

#include "core/welder.hpp"
#include "display/point_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace hemi {

namespace {

struct Edge {
    std::uint32_t low;
    std::uint32_t high;
    std::uint32_t patch;
    bool operator<(const Edge& other) const {
        return std::pair(low, high) != std::pair(other.low, other.high)
                   ? std::pair(low, high) < std::pair(other.low, other.high)
                   : patch < other.patch;
    }
};

} // namespace

SmoothSurfaces::SmoothSurfaces(const PatchMesh& mesh, bool across_materials)
    : across_materials_(across_materials) {
    looks_.reserve(mesh.size());
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        looks_.push_back({mesh.normal(patch), mesh.material(patch), mesh.group(patch)});
    }
    weld(mesh);
    connect();
    divide(mesh);
    keep_true_hanging(mesh);
}

bool SmoothSurfaces::continues(std::uint32_t a, std::uint32_t b) const {
    static const double limit = std::cos(crease_angle * std::numbers::pi / 180.0);
    const Appearance& one = looks_[a];
    const Appearance& other = looks_[b];
    return (across_materials_ || (one.material == other.material && one.group == other.group)) &&
           glm::dot(one.normal, other.normal) >= limit;
}

bool SmoothSurfaces::continues_at(std::uint32_t v, std::uint32_t a, std::uint32_t b) const {
    if (!continues(a, b)) {
        return false;
    }
    const auto sector = [&](std::uint32_t patch) {
        const auto around = patches_at(v);
        const auto at = std::lower_bound(around.begin(), around.end(), patch) - around.begin();
        return sectors_[first_incident_[v] + static_cast<std::size_t>(at)];
    };
    return sectors_.empty() || sector(a) == sector(b);
}

void SmoothSurfaces::weld(const PatchMesh& mesh) {
    tolerance_ = std::max(weld_tolerance * mesh.bounds().diagonal(), mesh.rounding());
    Welder welder(tolerance_);
    corners_.resize(std::size_t{mesh.size()} * 4);
    counts_.resize(mesh.size());
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        const PatchCorners corners = mesh.corners(patch);
        counts_[patch] = static_cast<std::uint8_t>(corners.count);
        for (std::size_t k = 0; k < corners.count; ++k) {
            corners_[std::size_t{patch} * 4 + k] = welder.add(corners.points[k]);
        }
        if (corners.count == 3) {
            corners_[std::size_t{patch} * 4 + 3] = corners_[std::size_t{patch} * 4 + 2];
        }
    }
    vertices_ = welder.points();
}

void SmoothSurfaces::connect() {
    const auto patch_count = static_cast<std::uint32_t>(counts_.size());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> meetings; // vertex, patch
    std::vector<Edge> edges;
    meetings.reserve(corners_.size());
    edges.reserve(corners_.size());
    for (std::uint32_t patch = 0; patch < patch_count; ++patch) {
        const auto ring = corners(patch);
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const std::uint32_t from = ring[k];
            const std::uint32_t to = ring[(k + 1) % ring.size()];
            meetings.emplace_back(from, patch);
            if (from != to) {
                edges.push_back({std::min(from, to), std::max(from, to), patch});
            }
        }
    }
    std::sort(edges.begin(), edges.end());

    // An edge that two patches of a smooth surface share whole has no vertex of that surface in its middle;
    // only the others, a surface's outline, are searched for T-junctions.
    const PointTree tree(vertices_);
    std::vector<std::uint32_t> found;
    for (std::size_t first = 0; first < edges.size();) {
        std::size_t last = first + 1;
        while (last < edges.size() && edges[last].low == edges[first].low &&
               edges[last].high == edges[first].high) {
            ++last;
        }
        found.clear();
        bool searched = false;
        for (std::size_t i = first; i < last; ++i) {
            bool shared = false;
            for (std::size_t j = first; j < last && !shared; ++j) {
                shared = j != i && continues(edges[i].patch, edges[j].patch);
            }
            if (shared) {
                continue;
            }
            if (!searched) {
                tree.near_segment(vertices_[edges[i].low], vertices_[edges[i].high], tolerance_, found);
                searched = true;
            }
            for (const std::uint32_t vertex : found) {
                if (vertex != edges[i].low && vertex != edges[i].high) {
                    meetings.emplace_back(vertex, edges[i].patch);
                    add_hanging(vertex, edges[i].patch, edges[i].low, edges[i].high);
                }
            }
        }
        first = last;
    }

    std::sort(meetings.begin(), meetings.end());
    meetings.erase(std::unique(meetings.begin(), meetings.end()), meetings.end());
    first_incident_.assign(vertices_.size() + 1, 0);
    incident_.reserve(meetings.size());
    for (const auto& [vertex, patch] : meetings) {
        ++first_incident_[vertex + 1];
        incident_.push_back(patch);
    }
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        first_incident_[v + 1] += first_incident_[v];
    }
}

/// Unit directions in which the rim of a patch leaves a vertex that is on it.
std::array<Vec3, 2> SmoothSurfaces::rims(std::uint32_t v, std::uint32_t patch) const {
    const auto ring = corners(patch);
    const auto towards = [&](std::uint32_t other) { return glm::normalize(vertices_[other] - vertices_[v]); };
    const auto at = std::find(ring.begin(), ring.end(), v) - ring.begin();
    const auto count = static_cast<std::ptrdiff_t>(ring.size());
    if (at < count) {
        return {towards(ring[static_cast<std::size_t>((at + count - 1) % count)]),
                towards(ring[static_cast<std::size_t>((at + 1) % count)])};
    }
    std::array<Vec3, 2> best{Vec3(0.0), Vec3(0.0)}; // of the edge that it is in the middle of
    double straightest = 2.0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const std::uint32_t next = ring[(k + 1) % ring.size()];
        if (next == ring[k]) {
            continue;
        }
        const std::array<Vec3, 2> ends{towards(ring[k]), towards(next)};
        const double bend = glm::dot(ends[0], ends[1]);
        if (bend < straightest) {
            straightest = bend;
            best = ends;
        }
    }
    return best;
}

/// Finds where something stands between patches that continue one another.
void SmoothSurfaces::divide(const PatchMesh& mesh) {
    constexpr std::size_t most = 64; // the foot of a sheet is not where as many meet
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
        const auto around = patches_at(v);
        if (around.size() > 2 && around.size() <= most) {
            find_sectors(mesh, v);
        }
    }
}

void SmoothSurfaces::find_sectors(const PatchMesh& mesh, std::uint32_t v) {
    constexpr double same_direction = 1.0 - 1e-9;
    const auto around = patches_at(v);
    std::vector<std::array<Vec3, 2>> rays;
    for (const std::uint32_t patch : around) {
        rays.push_back(rims(v, patch));
    }
    const auto has_rim = [&](std::size_t k, const Vec3& ray) {
        return glm::dot(rays[k][0], ray) > same_direction || glm::dot(rays[k][1], ray) > same_direction;
    };
    const auto stands_on = [&](std::size_t q, std::size_t a, const Vec3& ray) {
        const Vec3 up = mesh.centres()[around[q]] - vertices_[v];
        return !continues(around[a], around[q]) && has_rim(q, ray) &&
               glm::dot(up, looks_[around[a]].normal) > 1e-3 * glm::length(up);
    };
    std::vector<std::uint8_t> sector(around.size());
    std::iota(sector.begin(), sector.end(), std::uint8_t{0});
    bool is_divided = false;
    for (std::size_t a = 0; a < around.size(); ++a) {
        for (std::size_t b = a + 1; b < around.size(); ++b) {
            if (!continues(around[a], around[b])) {
                continue;
            }
            for (const Vec3& ray : rays[a]) {
                if (!has_rim(b, ray)) {
                    continue;
                }
                bool blocked = false;
                for (std::size_t q = 0; q < around.size() && !blocked; ++q) {
                    blocked = stands_on(q, a, ray);
                }
                is_divided = is_divided || blocked;
                if (!blocked) {
                    std::replace(sector.begin(), sector.end(), sector[b], sector[a]);
                }
            }
        }
    }
    if (is_divided) {
        sectors_.resize(incident_.size(), 0);
        std::copy(sector.begin(), sector.end(),
                  sectors_.begin() + static_cast<std::ptrdiff_t>(first_incident_[v]));
    }
}

/// Leaves those that a larger patch interpolates: not where patches of other grids meet by chance, none of
/// which is the larger one.
void SmoothSurfaces::keep_true_hanging(const PatchMesh& mesh) {
    constexpr double in_plane = 1.0 - 1e-9;
    std::vector<std::uint8_t> hangs(vertices_.size(), 0);
    std::erase_if(hanging_, [&](const Hanging& hanging) {
        const auto around = patches_at(hanging.vertex);
        const bool is_corner_beside = std::any_of(around.begin(), around.end(), [&](std::uint32_t patch) {
            const auto ring = corners(patch);
            return patch != hanging.patch && continues_at(hanging.vertex, hanging.patch, patch) &&
                   glm::dot(looks_[patch].normal, looks_[hanging.patch].normal) > in_plane &&
                   std::find(ring.begin(), ring.end(), hanging.vertex) != ring.end();
        });
        hangs[hanging.vertex] = is_corner_beside ? 1 : hangs[hanging.vertex];
        return !is_corner_beside;
    });
    std::erase_if(hanging_, [&](const Hanging& hanging) {
        return mesh.parts(mesh.surface_of()[hanging.patch]).empty() &&
               (hangs[hanging.from] != 0 || hangs[hanging.to] != 0);
    });
    const auto length = [this](const Hanging& hanging) {
        return glm::distance(vertices_[hanging.from], vertices_[hanging.to]);
    };
    std::stable_sort(hanging_.begin(), hanging_.end(),
                     [&length](const Hanging& a, const Hanging& b) { return length(a) > length(b); });
}

void SmoothSurfaces::add_hanging(std::uint32_t vertex, std::uint32_t patch, std::uint32_t from,
                                 std::uint32_t to) {
    const Vec3 edge = vertices_[to] - vertices_[from];
    hanging_.push_back({vertex, patch, from, to,
                        glm::dot(vertices_[vertex] - vertices_[from], edge) / glm::dot(edge, edge)});
}

} // namespace hemi
