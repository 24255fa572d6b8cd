#include "display/orbit_camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hemi {

namespace {

Vec3 any_perpendicular(const Vec3& direction) {
    const Vec3 other = std::abs(direction.y) < 0.9 ? Vec3(0.0, 1.0, 0.0) : Vec3(1.0, 0.0, 0.0);
    return glm::normalize(other - glm::dot(other, direction) * direction);
}

/// The same view with `up` of unit length and perpendicular to it.
Camera squared(Camera camera) {
    const Vec3 forward = glm::normalize(camera.target - camera.eye);
    const Vec3 up = camera.up - glm::dot(camera.up, forward) * forward;
    camera.up =
        glm::length(up) > 1e-9 * glm::length(camera.up) ? glm::normalize(up) : any_perpendicular(forward);
    return camera;
}

/// `point` turned by `angle` about the unit vector `axis` through the origin (Rodrigues).
Vec3 turned(const Vec3& point, const Vec3& axis, double angle) {
    return std::cos(angle) * point + std::sin(angle) * glm::cross(axis, point) +
           (1.0 - std::cos(angle)) * glm::dot(axis, point) * axis;
}

double half_fov(const Camera& camera) {
    return camera.fov * std::numbers::pi / 360.0;
}

/// Height of the picture in scene units at the depth of `point`.
double view_height(const Camera& camera, const Vec3& point) {
    const double depth = glm::dot(point - camera.eye, glm::normalize(camera.target - camera.eye));
    return 2.0 * std::tan(half_fov(camera)) * depth;
}

} // namespace

OrbitCamera::OrbitCamera(const Camera& home, const Bounds& bounds)
    : home_(home), bounds_(bounds), camera_(home) {
    upward_ = glm::length(home.up) > 0.0 ? glm::normalize(home.up) : Vec3(0.0, 0.0, 1.0);
    grab(home.target);
}

ViewRay OrbitCamera::ray(double x, double y) const {
    const Camera view = squared(camera_);
    const Vec3 forward = glm::normalize(view.target - view.eye);
    const double scale = 2.0 * std::tan(half_fov(view));
    const Vec3 aside = scale * (x * glm::cross(forward, view.up) + y * view.up);
    if (view.orthographic) {
        const double before = glm::length(bounds_.centre() - view.eye) + bounds_.diagonal();
        return {view.eye + glm::length(view.target - view.eye) * aside - before * forward, forward};
    }
    return {view.eye, forward + aside};
}

std::optional<std::array<std::array<double, 2>, 2>> OrbitCamera::line(const Vec3& a, const Vec3& b) const {
    const Camera view = squared(camera_);
    const Vec3 forward = glm::normalize(view.target - view.eye);
    const Vec3 right = glm::cross(forward, view.up);
    std::array<Vec3, 2> ends{a - view.eye, b - view.eye};
    if (view.orthographic) {
        const double height = view_height(view, view.target);
        std::array<std::array<double, 2>, 2> seen{};
        for (std::size_t k = 0; k < 2; ++k) {
            seen[k] = {glm::dot(ends[k], right) / height, glm::dot(ends[k], view.up) / height};
        }
        return seen;
    }
    const double nearest = 1e-5 * bounds_.diagonal();
    std::array<double, 2> depths{glm::dot(ends[0], forward), glm::dot(ends[1], forward)};
    if (depths[0] < nearest && depths[1] < nearest) {
        return std::nullopt;
    }
    for (std::size_t k = 0; k < 2; ++k) {
        if (depths[k] < nearest) {
            const double share = (nearest - depths[k]) / (depths[1 - k] - depths[k]);
            ends[k] += share * (ends[1 - k] - ends[k]);
            depths[k] = nearest;
        }
    }
    const double scale = 0.5 / std::tan(half_fov(view));
    std::array<std::array<double, 2>, 2> places{};
    for (std::size_t k = 0; k < 2; ++k) {
        places[k] = {scale * glm::dot(ends[k], right) / depths[k],
                     scale * glm::dot(ends[k], view.up) / depths[k]};
    }
    return places;
}

void OrbitCamera::grab(const Vec3& pivot) {
    start_ = camera_;
    grabbed_ = squared(camera_);
    pivot_ = pivot;
}

void OrbitCamera::orbit(double across, double up) {
    camera_ = start_;
    const Vec3 forward = glm::normalize(grabbed_.target - grabbed_.eye);
    const Vec3 right = glm::cross(forward, grabbed_.up);
    // Height of the view above the horizon; exact at the poles, where up and not forward tells.
    const double height = std::atan2(glm::dot(forward, upward_), glm::dot(grabbed_.up, upward_));
    const double pole = 0.5 * std::numbers::pi;
    const double tip = std::abs(height) <= pole ? std::clamp(height - up, -pole, pole) - height : -up;
    if (across == 0.0 && tip == 0.0) {
        return;
    }
    const auto move = [&](const Vec3& v) { return turned(turned(v, right, tip), upward_, -across); };
    camera_.eye = pivot_ + move(grabbed_.eye - pivot_);
    camera_.target = pivot_ + move(grabbed_.target - pivot_);
    camera_.up = move(grabbed_.up);
}

void OrbitCamera::pan(double x, double y) {
    camera_ = start_;
    const Vec3 forward = glm::normalize(grabbed_.target - grabbed_.eye);
    const double scale = std::max(view_height(grabbed_, grabbed_.orthographic ? grabbed_.target : pivot_),
                                  1e-6 * bounds_.diagonal());
    const Vec3 shift = scale * (x * glm::cross(forward, grabbed_.up) + y * grabbed_.up);
    camera_.eye -= shift;
    camera_.target -= shift;
}

void OrbitCamera::zoom(double factor) {
    camera_ = start_;
    if (factor == 1.0) {
        return;
    }
    // Never so near or far that the view's direction drowns in rounding.
    const double distance = glm::length(start_.eye - start_.target);
    const double nearest = 1e-6 * bounds_.diagonal();
    const double farthest = 1e4 * bounds_.diagonal();
    const double limited =
        std::clamp(factor, std::min(1.0, nearest / distance), std::max(1.0, farthest / distance));
    camera_.eye = pivot_ + limited * (start_.eye - pivot_);
    camera_.target = pivot_ + limited * (start_.target - pivot_);
}

void OrbitCamera::walk(double ahead, double right) {
    const Vec3 forward = glm::normalize(camera_.target - camera_.eye);
    const Vec3 across = glm::cross(forward, camera_.up); // level, as the turntable never rolls over
    Vec3 level = forward - glm::dot(forward, upward_) * upward_;
    if (!(glm::length(level) > 1e-6)) { // straight down: what is up in the picture lies ahead
        level = camera_.up - glm::dot(camera_.up, upward_) * upward_;
    }
    const Vec3 way = ahead * glm::normalize(level) + right * glm::normalize(across);
    camera_.eye += way;
    camera_.target += way;
    grab(camera_.target);
}

void OrbitCamera::frame_all(double aspect) {
    const Vec3 forward = glm::normalize(camera_.target - camera_.eye);
    const double radius = bounds_.diagonal() > 0.0 ? 0.5 * bounds_.diagonal() : 1.0;
    const double half = std::min(half_fov(camera_), std::atan(aspect * std::tan(half_fov(camera_))));
    camera_.target = bounds_.empty() ? Vec3(0.0) : bounds_.centre();
    camera_.eye = camera_.target - radius / std::sin(half) * forward;
    grab(camera_.target);
}

void OrbitCamera::reset() {
    camera_ = home_;
    grab(camera_.target);
}

void OrbitCamera::set_orthographic(bool orthographic) {
    camera_.orthographic = orthographic;
    grab(camera_.target);
}

void OrbitCamera::set_fov(double degrees) {
    camera_.fov = std::clamp(degrees, smallest_fov, largest_fov);
    grab(camera_.target);
}

void OrbitCamera::place(const Camera& camera) {
    camera_ = camera;
    grab(camera_.target);
}

void OrbitCamera::look_along(Axis axis, bool opposite, double aspect) {
    // Seen from the front the scene's x axis points right where its upward axis allows.
    Vec3 right = Vec3(1.0, 0.0, 0.0) - upward_.x * upward_;
    right = glm::length(right) > 0.1 ? glm::normalize(right) : any_perpendicular(upward_);
    const Vec3 ahead = glm::cross(upward_, right);
    const Vec3 towards = axis == Axis::front ? ahead : (axis == Axis::right ? -right : -upward_);
    const Vec3 forward = opposite ? -towards : towards;
    camera_.up = axis == Axis::top ? ahead : upward_;
    camera_.eye = camera_.target - forward;
    frame_all(aspect);
}

} // namespace hemi
