#include "scene/joined_faces.hpp"

#include "core/welder.hpp"
#include "scene/duplicate_faces.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace hemi {

namespace {

constexpr std::uint32_t no_corner = 0xFFFFFFFFu;

/// Of the patches of face `front` in their order, those of face `back` with the same centres; nothing where
/// the faces are subdivided otherwise.
std::optional<std::vector<std::uint32_t>> opposite_patches(const PatchMesh& mesh, std::uint32_t front,
                                                           std::uint32_t back, double tolerance) {
    const std::uint32_t count = mesh.patches_per_side(back);
    if (mesh.patches_per_side(front) != count) {
        return std::nullopt;
    }
    Welder centres(tolerance);
    std::vector<std::uint32_t> patch_of; // of every centre
    for (std::uint32_t i = mesh.first_patch(back); i < mesh.first_patch(back) + count; ++i) {
        centres.add(mesh.centres()[i]);
        patch_of.resize(centres.points().size(), i);
    }
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = mesh.first_patch(front); i < mesh.first_patch(front) + count; ++i) {
        const std::uint32_t centre = centres.add(mesh.centres()[i]);
        if (centre >= patch_of.size()) {
            return std::nullopt;
        }
        result.push_back(patch_of[centre]);
    }
    return result;
}

} // namespace

WeldedFaces weld(const Scene& scene, double tolerance) {
    Welder welder(tolerance);
    WeldedFaces result;
    for (const Surface& surface : scene.surfaces) {
        std::array<std::uint32_t, 4>& corners = result.corners.emplace_back();
        corners.fill(no_corner);
        for (std::uint32_t k = 0; k < surface.vertex_count; ++k) {
            corners[k] = welder.add(surface.vertices[k]);
        }
    }
    result.vertex_count = welder.points().size();
    return result;
}

Joined join_back_to_back(const Scene& scene, const Subdivision& subdivision) {
    Joined result{scene};
    const std::vector<std::uint32_t> next = next_duplicates(scene);
    const double tolerance = contact_share * scene.bounds().diagonal();
    const WeldedFaces welded = weld(scene, tolerance);
    std::map<std::array<std::uint32_t, 4>, std::vector<std::uint32_t>> found; // by sorted corners
    result.scene.surfaces.clear();
    std::optional<PatchMesh> mesh; // where there is something to join
    for (std::uint32_t f = 0; f < scene.surfaces.size(); ++f) {
        const Surface& surface = scene.surfaces[f];
        if (next[f] != no_duplicate) {
            result.findings.push_back({Imprint::What::duplicate, f, next[f]});
            result.left_out += (surface.two_sided ? 2.0 : 1.0) * glm::length(area_vector(surface.polygon()));
            continue;
        }
        std::array<std::uint32_t, 4> key = welded.corners[f];
        std::sort(key.begin(), key.end());
        auto& there = found[key]; // indices of surfaces of the result
        std::optional<std::vector<std::uint32_t>> backs;
        const auto mate = std::find_if(there.begin(), there.end(), [&](std::uint32_t s) {
            const Surface& other = result.scene.surfaces[s];
            const bool alike = !surface.two_sided && !other.two_sided && other.material == surface.material &&
                               other.group == surface.group && other.heat == surface.heat &&
                               glm::dot(area_vector(other.polygon()), area_vector(surface.polygon())) < 0.0;
            if (!alike) {
                return false;
            }
            if (!mesh) {
                mesh.emplace(scene, subdivision);
            }
            backs = opposite_patches(*mesh, result.face_of[s], f, tolerance);
            return backs.has_value();
        });
        if (mate != there.end()) {
            result.scene.surfaces[*mate].two_sided = true;
            result.findings.push_back({Imprint::What::joined, f, result.face_of[*mate]});
            result.backs[*mate] = std::move(*backs);
            continue;
        }
        there.push_back(static_cast<std::uint32_t>(result.scene.surfaces.size()));
        result.scene.surfaces.push_back(surface);
        result.face_of.push_back(f);
        result.backs.emplace_back();
    }
    return result;
}

std::vector<std::uint32_t> patches_before(const Joined& joined, const PatchMesh& mesh,
                                          const PatchMesh& as_read) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        const std::uint32_t s = mesh.surface_of()[patch];
        const std::uint32_t place = patch - mesh.first_patch(s);
        result.push_back(mesh.is_back(patch) && !joined.backs[s].empty()
                             ? joined.backs[s][place - mesh.patches_per_side(s)]
                             : as_read.first_patch(joined.face_of[s]) + place);
    }
    return result;
}

} // namespace hemi
