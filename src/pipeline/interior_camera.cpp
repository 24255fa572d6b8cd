#include "hemi/pipeline/picture.hpp"

#include "engine/rays/ray_tracer.hpp"
#include "hemi/scene/image_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hemi {

namespace {

// Places that are tried, along each side of the floor plan.
constexpr int places = 7;
// Shares of the bounds' sides: distance from the walls, and height of the eye.
constexpr double margin = 0.08;
constexpr double eye_height = 0.58;
// Rays in all directions, and what share of them must meet fronts.
constexpr int all_round = 160;
constexpr double closed_share = 0.95;
// Directions that are tried at every place, slightly downwards.
constexpr int directions = 48;
constexpr double downwards = 0.12;
constexpr double room_fov = 62.0; // degrees

class Room {
public:
    Room(const PatchMesh& mesh, UpAxis up) : mesh_(mesh), up_(up), tracer_(mesh) {}

    /// Whether fronts are all round a point.
    [[nodiscard]] bool closes_in(const Vec3& point) const {
        int fronts = 0;
        for (int k = 0; k < all_round; ++k) {
            // Points that wind about the sphere at the golden angle.
            const double z = 1.0 - (2.0 * k + 1.0) / all_round;
            const double angle = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
            const double radius = std::sqrt(1.0 - z * z);
            const Vec3 direction(radius * std::cos(angle), radius * std::sin(angle), z);
            fronts += tracer_.trace(point, direction).side == RayTracer::Side::front ? 1 : 0;
        }
        return fronts >= closed_share * all_round;
    }

    /// To what is met in a direction of unit length; 0 where nothing is.
    [[nodiscard]] double distance(const Vec3& from, const Vec3& direction) const {
        const RayTracer::Hit hit = tracer_.trace(from, direction);
        if (hit.side != RayTracer::Side::front) {
            return 0.0;
        }
        const Vec3 normal = mesh_.normal(hit.patch);
        return glm::dot(mesh_.centres()[hit.patch] - from, normal) / glm::dot(direction, normal);
    }

    /// How far one sees that way: the least of what is met ahead and to both sides.
    [[nodiscard]] double view(const Vec3& from, double angle) const {
        double least = distance(from, heading(angle));
        for (const double aside : {-0.25, 0.25}) {
            least = std::min(least, distance(from, heading(angle + aside)));
        }
        return least;
    }

    [[nodiscard]] Vec3 heading(double angle) const {
        return turned_upright(glm::normalize(Vec3(std::cos(angle), std::sin(angle), -downwards)), up_);
    }

private:
    const PatchMesh& mesh_;
    UpAxis up_;
    RayTracer tracer_;
};

} // namespace

std::optional<Camera> interior_camera(const PatchMesh& mesh, UpAxis up) {
    const ImageMesh images(mesh);
    const Room room(images.mesh(), up);
    const Bounds& bounds = images.mesh().bounds();
    const Vec3 size = bounds.upper - bounds.lower;
    std::optional<Camera> best;
    double farthest = 0.0;
    for (int j = 0; j < places; ++j) {
        for (int i = 0; i < places; ++i) {
            const auto along = [](int k) { return margin + (1.0 - 2.0 * margin) * k / (places - 1); };
            const Vec3 share = up == UpAxis::z ? Vec3(along(i), along(j), eye_height)
                                               : Vec3(along(i), eye_height, 1.0 - along(j));
            const Vec3 eye = bounds.lower + size * share;
            if (!room.closes_in(eye)) {
                continue;
            }
            for (int k = 0; k < directions; ++k) {
                const double angle = 2.0 * std::numbers::pi * k / directions;
                const double far = room.view(eye, angle);
                if (far > farthest * (1.0 + 1e-6)) { // of equal ones the first, whatever the rounding
                    farthest = far;
                    best = Camera{eye, eye + 0.5 * far * room.heading(angle),
                                  turned_upright({0.0, 0.0, 1.0}, up), room_fov};
                }
            }
        }
    }
    return best;
}

} // namespace hemi
