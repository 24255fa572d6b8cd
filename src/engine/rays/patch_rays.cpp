#include "engine/rays/patch_rays.hpp"

#include "core/splitmix.hpp"
#include "engine/rays/sobol.hpp"

#include <cmath>
#include <numbers>

namespace hemi {

namespace {

/// A number of [0, 1) that is distributed as a straight line from `a` to `b`, from an evenly distributed one.
double linear_sample(double a, double b, double even) {
    const double root = std::sqrt(a * a + even * (b * b - a * a));
    return a + root > 0.0 ? even * (a + b) / (a + root) : 0.0;
}

/// A point of the polygon, evenly distributed over its area.
Vec3 area_sample(const BilinearMap& map, double u, double v) {
    const double s =
        2.0 * linear_sample(map.jacobian - map.jacobian_s, map.jacobian + map.jacobian_s, u) - 1.0;
    const double t = 2.0 * linear_sample(map.jacobian_at(s, -1.0), map.jacobian_at(s, 1.0), v) - 1.0;
    return map.point(s, t);
}

} // namespace

PatchRays::PatchRays(const PatchMesh& mesh, std::uint32_t patch, std::uint64_t seed)
    : frame_(mesh.normal(patch), patch, 0, seed), map_(mesh.corners(patch).polygon(), frame_.z) {
    std::uint64_t state = splitmix(splitmix(seed) ^ patch);
    for (std::uint32_t& bits : shift_) {
        state = splitmix(state);
        bits = static_cast<std::uint32_t>(state >> 32);
    }
}

PatchRays::Ray PatchRays::operator[](std::uint32_t index) const {
    const auto bits = sobol_point(index);
    std::array<double, 4> even{};
    for (std::size_t d = 0; d < even.size(); ++d) {
        even[d] = (static_cast<double>(bits[d] ^ shift_[d]) + 0.5) * 0x1p-32;
    }
    const double radius = std::sqrt(even[2]);
    const double angle = 2.0 * std::numbers::pi * even[3];
    return {area_sample(map_, even[0], even[1]), radius * std::cos(angle) * frame_.x +
                                                     radius * std::sin(angle) * frame_.y +
                                                     std::sqrt(1.0 - even[2]) * frame_.z};
}

} // namespace hemi
