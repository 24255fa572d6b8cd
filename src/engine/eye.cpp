#include "engine/eye.hpp"

#include <cmath>
#include <numbers>

namespace hemi {

namespace {

std::uint64_t splitmix(std::uint64_t value) {
    value += 0x9E3779B97F4A7C15u;
    value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9u;
    value = (value ^ (value >> 27)) * 0x94D049BB133111EBu;
    return value ^ (value >> 31);
}

} // namespace

std::vector<EyePoint> make_eye_points(const PatchMesh& mesh) {
    std::vector<EyePoint> eyes(mesh.size());
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        eyes[patch] = {mesh.centres()[patch], mesh.normal(patch), mesh.surface_of()[patch]};
    }
    return eyes;
}

EyeFrame::EyeFrame(const Vec3& normal, std::uint32_t patch, std::uint64_t seed) : z(normal) {
    // The axis least along the normal gives a well-conditioned tangent.
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
        if (std::abs(normal[k]) < std::abs(normal[axis])) {
            axis = k;
        }
    }
    Vec3 other(0.0);
    other[axis] = 1.0;
    const Vec3 tangent = glm::normalize(glm::cross(other, normal));
    const Vec3 bitangent = glm::cross(normal, tangent);
    const std::uint64_t hash = splitmix(splitmix(seed) ^ patch);
    const double angle = static_cast<double>(hash >> 11) * 0x1p-53 * 2.0 * std::numbers::pi;
    x = std::cos(angle) * tangent + std::sin(angle) * bitangent;
    y = glm::cross(z, x);
}

Vec3 face_direction(int face, double right, double up) {
    switch (face) {
    case 0:
        return {right, up, 1.0};
    case 1:
        return {1.0, right, up};
    case 2:
        return {-right, 1.0, up};
    case 3:
        return {-1.0, -right, up};
    default:
        return {right, -1.0, up};
    }
}

} // namespace hemi
