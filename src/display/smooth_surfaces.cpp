#include "display/smooth_surfaces.hpp"

#include "core/welder.hpp"
#include "display/point_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
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

SmoothSurfaces::SmoothSurfaces(const PatchMesh& mesh) {
    looks_.reserve(mesh.size());
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        looks_.push_back({mesh.normal(patch), mesh.material(patch), mesh.group(patch)});
    }
    weld(mesh);
    connect(mesh);
}

bool SmoothSurfaces::continues(std::uint32_t a, std::uint32_t b) const {
    static const double limit = std::cos(crease_angle * std::numbers::pi / 180.0);
    const Appearance& one = looks_[a];
    const Appearance& other = looks_[b];
    return one.material == other.material && one.group == other.group &&
           glm::dot(one.normal, other.normal) >= limit;
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

void SmoothSurfaces::connect(const PatchMesh& mesh) {
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
                    if (!mesh.parts(mesh.surface_of()[edges[i].patch]).empty()) {
                        add_hanging(vertex, edges[i].patch, edges[i].low, edges[i].high);
                    }
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

    // Of other surfaces, whose vertices lie on the edge by chance or by another grid, neither interpolates.
    std::erase_if(hanging_, [&](const Hanging& hanging) {
        const auto around = patches_at(hanging.vertex);
        return std::none_of(around.begin(), around.end(), [&](std::uint32_t patch) {
            const auto ring = corners(patch);
            return mesh.surface_of()[patch] == mesh.surface_of()[hanging.patch] &&
                   std::find(ring.begin(), ring.end(), hanging.vertex) != ring.end();
        });
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
