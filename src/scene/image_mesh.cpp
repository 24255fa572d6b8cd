#include "hemi/scene/image_mesh.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hemi {

namespace {

/// The other way round about its first vertex: what was along u is along v.
Surface turned_round(Surface surface) {
    std::reverse(surface.vertices.begin() + 1, surface.vertices.begin() + surface.vertex_count);
    return surface;
}

} // namespace

/// Number of the cell that cell `local` of a side becomes on the surface with u and v exchanged; of a part,
/// the number of its cell.
std::uint32_t PatchMesh::mirrored(std::uint32_t s, std::uint32_t local) const {
    const auto [u, v] = grid_coordinates(first_patch_[s] + local);
    const GridPart part = parts(s).empty() ? GridPart{0, 0, local} : parts(s)[local];
    const double fine_u = std::ldexp(u, static_cast<int>(part.level_u));
    const double fine_v = std::ldexp(v, static_cast<int>(part.level_v));
    const auto across = static_cast<std::uint32_t>(fine_u);
    const auto along = static_cast<std::uint32_t>(fine_v);
    if (surfaces_[s].vertex_count == 3) {
        const std::uint32_t n = grids_[s].u << part.level_u;
        const bool upright = fine_u - across < 0.5;
        return across * (2 * n - across) + 2 * along + (upright ? 0 : 1);
    }
    return across * (grids_[s].v << part.level_v) + along;
}

PatchMesh PatchMesh::with_images(const SceneImages& images) const {
    if (std::uint64_t{size()} * images.all.size() >= std::uint64_t{1} << 31) {
        throw InvalidArgument(fmt::format("{} images of {} patches are 2^31 patches or more; choose larger "
                                          "patches or fewer images",
                                          images.all.size(), size()));
    }
    PatchMesh all;
    all.groups_ = groups_;
    for (const Isometry& image : images.all) {
        const bool mirrors = image.mirrors();
        for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
            Surface surface = surfaces_[s];
            Grid grid = grids_[s];
            std::vector<GridPart> list(parts(s).begin(), parts(s).end());
            if (mirrors) {
                surface = turned_round(surface);
                std::swap(grid.u, grid.v);
                for (std::uint32_t local = 0; local < list.size(); ++local) {
                    list[local].cell = mirrored(s, local);
                    std::swap(list[local].level_u, list[local].level_v);
                }
            }
            for (std::uint32_t k = 0; k < surface.vertex_count; ++k) {
                surface.vertices[k] = image(surface.vertices[k]);
                all.bounds_.add(surface.vertices[k]);
            }
            all.surfaces_.push_back(surface);
            all.grids_.push_back(grid);
            if (!parts_.empty()) {
                all.parts_.push_back(std::move(list));
            }
        }
    }
    all.measure();
    return all;
}

ImageMesh::ImageMesh(const PatchMesh& mesh) : mesh_(mesh) {
    if (!mesh.symmetry()) {
        return;
    }
    images_ = images_of(*mesh.symmetry());
    all_ = mesh.with_images(images_);
    const std::uint32_t size = mesh.size();
    original_.resize(all_->size());
    patch_.resize(all_->size());
    for (std::uint32_t image = 0; image < images_.all.size(); ++image) {
        const bool mirrors = images_.all[image].mirrors();
        for (std::uint32_t i = 0; i < size; ++i) {
            const std::uint32_t s = mesh.surface_of()[i];
            std::uint32_t patch = i;
            if (mirrors && mesh.parts(s).empty()) { // parts keep their order
                const std::uint32_t first =
                    mesh.first_patch(s) + (mesh.is_back(i) ? mesh.patches_per_side(s) : 0);
                patch = first + mesh.mirrored(s, i - first);
            }
            patch_[std::size_t{image} * size + i] = image * size + patch;
            original_[std::size_t{image} * size + patch] = i;
        }
    }
}

} // namespace hemi
