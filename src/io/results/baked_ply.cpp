#include "hemi/core/error.hpp"
#include "hemi/io/baked_mesh_file.hpp"
#include "io/formats/binary_output.hpp"
#include "io/results/baked_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace hemi::io {

namespace {

std::uint8_t srgb(double linear) {
    const double value = std::clamp(linear, 0.0, 1.0);
    const double encoded = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255.0 * encoded));
}

std::uint64_t count_vertices(const PatchMesh& mesh) {
    std::uint64_t vertices = 0;
    for (const std::uint32_t surface : mesh.surface_of()) {
        vertices += mesh.surfaces()[surface].vertex_count;
    }
    return vertices;
}

} // namespace

void write_baked_ply(const std::filesystem::path& path, const PatchMesh& mesh,
                     std::span<const float> radiosity, double exposure) {
    check_baked(mesh, radiosity, exposure);
    const std::uint64_t vertices = count_vertices(mesh);
    if (vertices > std::numeric_limits<std::uint32_t>::max()) {
        throw InvalidArgument(fmt::format("{} vertices; a .ply counts them with 32 bits", vertices));
    }
    BinaryOutput file(path);
    file.text(fmt::format("ply\nformat binary_little_endian 1.0\n"
                          "comment hemi " HEMI_VERSION ": colours are sRGB of {} times radiosity, W/m2\n"
                          "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
                          "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                          "property float radiosity_red\nproperty float radiosity_green\n"
                          "property float radiosity_blue\n"
                          "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
                          exposure, vertices, mesh.size()));
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const PatchCorners corners = mesh.corners(i);
        for (std::size_t c = 0; c < corners.count; ++c) {
            for (int axis = 0; axis < 3; ++axis) {
                file.put(corners.points[c][axis]);
            }
            const auto value = radiosity.subspan((std::size_t{i} * 4 + c) * 3, 3);
            for (const float channel : value) {
                file.put(srgb(exposure * static_cast<double>(channel)));
            }
            for (const float channel : value) {
                file.put(channel);
            }
        }
    }
    std::uint32_t first = 0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::uint32_t count = mesh.surfaces()[mesh.surface_of()[i]].vertex_count;
        file.put(static_cast<std::uint8_t>(count));
        for (std::uint32_t c = 0; c < count; ++c) {
            file.put(first + c);
        }
        first += count;
    }
    file.commit();
}

} // namespace hemi::io
