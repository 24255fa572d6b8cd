#include "io/meshes/face_builder.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hemi::io {

namespace {
constexpr double largest_coordinate = 1e70; // as polygon_defect() has it; here before areas are taken
}

FaceBuilder::FaceBuilder(const std::filesystem::path& path, bool skip_degenerate)
    : file_(path.string()), skip_degenerate_(skip_degenerate) {
    mesh_.path = path;
}

void FaceBuilder::reserve(std::uint64_t faces, std::uint64_t most) {
    mesh_.surfaces.reserve(std::min(faces, most));
}

std::uint32_t FaceBuilder::group(const std::string& name) {
    const auto [entry, is_new] = groups_.emplace(name, static_cast<std::uint32_t>(mesh_.groups.size()));
    if (is_new) {
        mesh_.groups.push_back(name);
    }
    return entry->second;
}

std::uint32_t FaceBuilder::material(const std::string& name, std::size_t line) {
    const auto [entry, is_new] = materials_.emplace(name, static_cast<std::uint32_t>(mesh_.materials.size()));
    if (is_new) {
        mesh_.materials.push_back({name, line});
    }
    return entry->second;
}

void FaceBuilder::add(std::span<const Vec3> corners, std::uint32_t group, std::uint32_t material,
                      FacePlace place) {
    ++faces_;
    corners_.clear();
    for (const Vec3& corner : corners) {
        for (int axis = 0; axis < 3; ++axis) {
            if (!(std::abs(corner[axis]) < largest_coordinate)) {
                refuse(fmt::format("coordinate {}; must be finite and below {:g} in size", corner[axis],
                                   largest_coordinate),
                       place);
            }
        }
        if (corners_.empty() || corner != corners_.back()) {
            corners_.push_back(corner);
        }
    }
    while (corners_.size() > 1 && corners_.front() == corners_.back()) {
        corners_.pop_back();
    }
    if (corners_.size() <= 4) {
        if (accept(has_no_area(corners_) ? "zero area" : polygon_defect(corners_), place)) {
            add_surface(corners_, group, material);
        }
        return;
    }
    if (accept(many_corners_defect(corners_), place)) {
        pieces_.clear();
        cut_into_pieces(corners_, pieces_);
        for (const PolygonPiece& piece : pieces_) {
            add_surface({piece.points.data(), piece.count}, group, material);
        }
        ++split_;
    }
}

FaceMesh FaceBuilder::finish(const std::string& what, Diagnostics& diagnostics) {
    if (skipped_ > 0) {
        diagnostics.warn(first_skipped_.line > 0
                             ? fmt::format("{}:{}: {} faces without area left out, the first one here", file_,
                                           first_skipped_.line, skipped_)
                             : fmt::format("{}: {} faces without area left out, the first one is face {}",
                                           file_, skipped_, first_skipped_.number));
    }
    if (split_ > 0) {
        diagnostics.warn(fmt::format(
            "{}: {} faces of more than 4 vertices cut into quadrilaterals and triangles", file_, split_));
    }
    if (mesh_.surfaces.empty()) {
        throw InputError(fmt::format("{}: no faces; a scene needs at least one ({})", file_, what));
    }
    return std::move(mesh_);
}

/// Whether to use a face with that defect, or none.
bool FaceBuilder::accept(const std::optional<std::string>& defect, FacePlace place) {
    if (!defect) {
        return true;
    }
    if (!skip_degenerate_ || !has_no_area(corners_)) {
        refuse(*defect, place);
    }
    first_skipped_ = skipped_ == 0 ? place : first_skipped_;
    ++skipped_;
    return false;
}

void FaceBuilder::refuse(const std::string& defect, FacePlace place) const {
    if (place.line > 0) {
        throw ParseError(file_, place.line, 0, fmt::format("face: {}", defect));
    }
    throw InputError(fmt::format("{}: face {}: {}", file_, place.number, defect));
}

void FaceBuilder::add_surface(std::span<const Vec3> polygon, std::uint32_t group, std::uint32_t material) {
    Surface& surface = mesh_.surfaces.emplace_back();
    std::copy(polygon.begin(), polygon.end(), surface.vertices.begin());
    surface.vertex_count = static_cast<std::uint32_t>(polygon.size());
    surface.group = group;
    surface.material = material;
}

} // namespace hemi::io
