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

std::vector<Bounds> boxes(std::span<const Occluder> occluders) {
    std::vector<Bounds> result;
    result.reserve(occluders.size());
    for (const Occluder& occluder : occluders) {
        result.push_back(bounds_of(occluder.corners));
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
    : occluders_(with_images(std::move(occluders), symmetry, image_corners_)), tree_(boxes(occluders_)),
      slack_(slack) {}

Sight Surroundings::look(std::uint32_t face, const Vec3& eye, std::span<const Vec3> rays) const {
    Sight sight;
    for (const Vec3& ray : rays) {
        double nearest = std::numeric_limits<double>::infinity();
        const Occluder* seen = nullptr;
        tree_.along(eye, ray, [&](std::uint32_t index) {
            const Occluder& other = occluders_[index];
            const double distance =
                glm::dot(other.corners[0] - eye, other.normal) / glm::dot(other.normal, ray);
            if ((other.face != face || other.image) && distance > 0.0 && distance < nearest &&
                contains(other.corners, other.normal, eye + distance * ray, slack_)) {
                nearest = distance;
                seen = &other;
            }
        });
        const bool from_behind = seen != nullptr && glm::dot(seen->normal, ray) > 0.0;
        if (seen != nullptr && !(from_behind ? seen->back : seen->front)) {
            ++sight.backs;
        } else if (seen == nullptr || seen->piece == Occluder::whole) {
            sight.open = true;
            break;
        } else {
            sight.sides.push_back({seen->face, seen->piece, from_behind});
        }
    }
    return sight;
}

} // namespace hemi
