#include "hemi/pipeline/coarse_mesh.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/scene/imprint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace hemi {

namespace {

/// Patches that a refinement begins with, about: few enough to cost little, enough to see where the light is.
constexpr double first_patches = 400.0;

/// As many patches of size 1 as a surface is cut into, but for rounding; see grid_for_size().
double patches_of_unit_size(const Surface& surface) {
    const auto& p = surface.vertices;
    const auto longest = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
        return std::max(glm::distance(p[a], p[b]), glm::distance(p[c], p[d]));
    };
    const double one_side = surface.vertex_count == 3
                                ? std::pow(std::max(longest(0, 1, 1, 2), glm::distance(p[2], p[0])), 2.0)
                                : longest(0, 1, 2, 3) * longest(1, 2, 3, 0);
    return (surface.two_sided ? 2.0 : 1.0) * one_side;
}

} // namespace

CoarseMesh coarse_mesh(const Scene& scene, bool with_imprint) {
    double patches = 0.0;
    for (const Surface& surface : scene.surfaces) {
        patches += patches_of_unit_size(surface);
    }
    const double size = std::sqrt(patches / first_patches);
    const auto shines = [&](const Surface& surface) {
        const std::vector<double>& exitance = scene.materials[surface.material].exitance;
        return std::any_of(exitance.begin(), exitance.end(), [](double value) { return value > 0.0; });
    };
    const auto lamps = std::count_if(scene.surfaces.begin(), scene.surfaces.end(), shines);
    // Borders of shadows are as right as what shines has patches, since each of them gets a few shadow rays
    // only; many lamps make up for one another.
    constexpr double most_cells = 4.0;
    const auto cells = static_cast<std::uint32_t>(std::clamp(
        std::sqrt(first_patches / static_cast<double>(std::max<std::ptrdiff_t>(lamps, 1))), 1.0, most_cells));
    Subdivision even;
    even.patch_size = size;
    PatchMesh as_read(scene, even);
    Scene coarse = scene;
    for (std::uint32_t s = 0; s < coarse.surfaces.size(); ++s) {
        const Grid grid = as_read.grid(s);
        const std::uint32_t least = shines(coarse.surfaces[s]) ? cells : 1;
        coarse.surfaces[s].patches = Grid{std::max(least, grid.u), std::max(least, grid.v)};
    }
    as_read = PatchMesh(coarse);
    if (auto cut = imprint(coarse, {}, with_imprint)) {
        return {PatchMesh(cut->scene), as_read.whole_faces().mesh, std::move(cut->parts)};
    }
    return {as_read, as_read, {}};
}

PatchParts parts_of_faces(const PatchMesh& mesh, const CoarseMesh& begin, const PatchMesh& faces) {
    for (std::uint32_t face = 0; face < faces.surfaces().size(); ++face) {
        if (faces.patches_per_side(face) != 1) {
            throw InvalidArgument(fmt::format("parts of faces: face {} has {}", face,
                                              plural(faces.patches_per_side(face), "patch", "patches")));
        }
    }
    std::vector<std::uint32_t> face_of; // of surfaces, into those of `faces`
    for (const Surface& surface : begin.as_read.surfaces()) {
        const auto next = face_of.empty() ? 0 : face_of.back() + 1;
        face_of.push_back(surface.continues && next > 0 ? next - 1 : next);
    }
    PatchParts result;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::uint32_t s = mesh.surface_of()[i];
        const std::uint32_t first =
            begin.mesh.first_patch(s) + (mesh.is_back(i) ? begin.mesh.patches_per_side(s) : 0);
        const std::uint32_t patch = begin.parts.any() ? begin.parts.patch_of[first] : first;
        result.patch_of.push_back(faces.first_patch(face_of[begin.as_read.surface_of()[patch]]) +
                                  (begin.as_read.is_back(patch) ? 1 : 0));
    }
    for (std::uint32_t face = 0; face < faces.size(); ++face) {
        result.group_of.push_back(faces.group(face));
    }
    return result;
}

} // namespace hemi
