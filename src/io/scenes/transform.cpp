#include "io/scenes/transform.hpp"

#include <cmath>
#include <numbers>

namespace hemi::io {

namespace {

struct Turn {
    double cosine;
    double sine;
};

/// Exact for multiples of 90 degrees, so that boxes stay boxes.
Turn turn(double degrees) {
    const double within = std::remainder(degrees, 360.0);
    const double quarters = within / 90.0;
    if (quarters == std::floor(quarters)) {
        const int quarter = static_cast<int>(quarters);
        return {quarter == 0 ? 1.0 : std::abs(quarter) == 2 ? -1.0 : 0.0, quarter % 2 == 0 ? 0.0 : quarters};
    }
    const double radians = within * std::numbers::pi / 180.0;
    return {std::cos(radians), std::sin(radians)};
}

Vec3 rotated(Vec3 p, const Vec3& degrees) {
    const Turn x = turn(degrees.x);
    p = {p.x, x.cosine * p.y - x.sine * p.z, x.sine * p.y + x.cosine * p.z};
    const Turn y = turn(degrees.y);
    p = {y.cosine * p.x + y.sine * p.z, p.y, y.cosine * p.z - y.sine * p.x};
    const Turn z = turn(degrees.z);
    return {z.cosine * p.x - z.sine * p.y, z.sine * p.x + z.cosine * p.y, p.z};
}

} // namespace

Placement::Placement(const Transform& transform)
    : columns_{rotated({transform.scale.x, 0.0, 0.0}, transform.degrees),
               rotated({0.0, transform.scale.y, 0.0}, transform.degrees),
               rotated({0.0, 0.0, transform.scale.z}, transform.degrees)},
      translate_(transform.translate) {}

Vec3 Placement::operator()(const Vec3& point) const {
    return point.x * columns_[0] + point.y * columns_[1] + point.z * columns_[2] + translate_;
}

} // namespace hemi::io
