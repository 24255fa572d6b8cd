#include "scene/surroundings.hpp"

#include "scene/convex_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace hemi {

namespace {

constexpr int directions = 64;
/// After so many that are not inside of bodies, what sees whole faces is taken to be outside.
constexpr int few = 4;

/// Where a ray passes through the surface of a body.
struct Crossing {
    double distance;
    bool leaves;
};

/// Whether the ray leaves more bodies somewhere than it has entered up to there: then it begins in one.
bool is_inside(std::vector<Crossing>& crossings) {
    std::sort(crossings.begin(), crossings.end(),
              [](const Crossing& a, const Crossing& b) { return a.distance < b.distance; });
    int bodies = 0;
    return std::any_of(crossings.begin(), crossings.end(), [&](const Crossing& crossing) {
        bodies += crossing.leaves ? -1 : 1;
        return bodies < 0;
    });
}

std::vector<Bounds> boxes(std::span<const Occluder> occluders, double slack) {
    std::vector<Bounds> result;
    result.reserve(occluders.size());
    for (const Occluder& occluder : occluders) {
        result.push_back(bounds_of(occluder.corners, slack));
    }
    return result;
}

/// The occluders and those of all images.
/// @param corners  gets those of images, and keeps them
std::vector<Occluder> with_images(std::vector<Occluder> occluders, const std::optional<Symmetry>& symmetry,
                                  std::vector<std::vector<Vec3>>& corners) {
    if (!symmetry) {
        return occluders;
    }
    const SceneImages images = images_of(*symmetry);
    const std::size_t own = occluders.size();
    for (std::size_t k = 1; k < images.all.size(); ++k) {
        for (std::size_t index = 0; index < own; ++index) {
            Occluder image = occluders[index];
            std::vector<Vec3>& there = corners.emplace_back();
            for (const Vec3& corner : image.corners) {
                there.push_back(images.all[k](corner));
            }
            if (images.all[k].mirrors()) {
                std::reverse(there.begin(), there.end());
            }
            image.corners = there;
            image.normal = images.all[k].direction(image.normal);
            image.image = true;
            occluders.push_back(image);
        }
    }
    return occluders;
}

} // namespace

std::vector<Vec3> hemisphere(const Vec3& normal) {
    const Vec3 beside = std::abs(normal.x) < 0.5 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
    const Vec3 u = glm::normalize(glm::cross(normal, beside));
    const Vec3 v = glm::cross(normal, u);
    std::vector<Vec3> result;
    for (int k = 0; k < directions; ++k) {
        const double height = (k + 0.5) / directions;
        const double round = k * std::numbers::pi * (3.0 - std::sqrt(5.0)); // the golden angle
        const double out = std::sqrt(1.0 - height * height);
        result.push_back(height * normal + out * (std::cos(round) * u + std::sin(round) * v));
    }
    return result;
}

Surroundings::Surroundings(std::vector<Occluder> occluders, double slack,
                           const std::optional<Symmetry>& symmetry)
    : occluders_(with_images(std::move(occluders), symmetry, image_corners_)),
      tree_(boxes(occluders_, slack)), slack_(slack) {}

Sight Surroundings::look(std::uint32_t face, const Vec3& eye, std::span<const Vec3> rays) const {
    Sight sight;
    std::vector<Crossing> bodies;
    for (const Vec3& ray : rays) {
        double nearest = std::numeric_limits<double>::infinity();
        const Occluder* seen = nullptr;
        bodies.clear();
        tree_.along(eye, ray, [&](std::uint32_t index) {
            const Occluder& other = occluders_[index];
            const double along = glm::dot(other.normal, ray);
            const double distance = glm::dot(other.corners[0] - eye, other.normal) / along;
            if ((other.face == face && !other.image) || !(distance > 0.0 && std::isfinite(distance)) ||
                !contains(other.corners, other.normal, eye + distance * ray, slack_)) {
                return;
            }
            if (distance < nearest) {
                nearest = distance;
                seen = &other;
            }
            if (!other.sheet) {
                // Of faces in one plane a body is entered first: what stands there is not left by the other.
                bodies.push_back({along > 0.0 ? distance : distance + 2.0 * slack_ / along, along > 0.0});
            }
        });
        if (seen == nullptr) {
            sight.open = true;
            break;
        }
        if (!contains(seen->corners, seen->normal, eye + nearest * ray, -slack_)) {
            continue; // at its border, where it may be behind what it touches
        }
        sight.inside += is_inside(bodies) ? 1 : 0;
        const bool from_behind = glm::dot(seen->normal, ray) > 0.0;
        if (!(from_behind ? seen->back : seen->front)) {
            ++sight.backs;
        } else if (seen->piece != Occluder::whole) {
            sight.sides.push_back({seen->face, seen->piece, from_behind});
        } else {
            sight.wholes.push_back(seen->face);
            const int outside = sight.directions() - sight.inside;
            if (outside > few && outside > 3 * sight.inside) {
                sight.open = true;
                break;
            }
        }
    }
    return sight;
}

} // namespace hemi
