#include "io/meshes/face_builder.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hemi::io {

FaceBuilder::FaceBuilder(const std::filesystem::path& path, const SceneReaderOptions& options)
    : file_(path.string()), mender_(options, "face") {
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
    const auto defect = mender_.mend(corners, [&place] {
        return FaceSpot{place.line, fmt::format("face {}", place.number)};
    });
    if (defect) {
        refuse(*defect, place);
    }
    for (const PolygonPiece& piece : mender_.pieces()) {
        Surface& surface = mesh_.surfaces.emplace_back();
        surface.vertices = piece.points;
        surface.vertex_count = piece.count;
        surface.continues = &piece != mender_.pieces().data();
        surface.group = group;
        surface.material = material;
    }
}

FaceMesh FaceBuilder::finish(const std::string& what, Diagnostics& diagnostics) {
    mender_.tell(file_, diagnostics);
    if (mesh_.surfaces.empty()) {
        throw InputError(fmt::format("{}: no faces{}; a scene needs at least one ({})", file_,
                                     faces_ > 0 ? " with an area" : "", what));
    }
    return std::move(mesh_);
}

void FaceBuilder::refuse(const std::string& defect, FacePlace place) const {
    if (place.line > 0) {
        throw ParseError(file_, place.line, 0, fmt::format("face: {}", defect));
    }
    throw InputError(fmt::format("{}: face {}: {}", file_, place.number, defect));
}

} // namespace hemi::io
