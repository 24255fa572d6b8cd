#include "viewer/navigator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace hemi::viewer {

namespace {

/// How far a hand turns the scene: a drag over the height of the picture is half a turn.
constexpr double radians_per_height = std::numbers::pi;
/// Change of the distance by one notch of the wheel, and by a drag over the height of the picture.
constexpr double zoom_per_notch = 0.85;
constexpr double zoom_per_height = 0.05;
/// A press and release with less way between is a click, pixels.
constexpr double click_way = 4.0;

} // namespace

Navigator::Navigator(Controls controls, std::shared_ptr<const PatchMesh> mesh, const Camera& home)
    : controls_(controls), mesh_(std::move(mesh)), orbit_(home, mesh_->bounds()) {}

void Navigator::exchange(std::shared_ptr<const PatchMesh> mesh, const Camera& home) {
    const Camera here = orbit_.camera();
    mesh_ = std::move(mesh);
    orbit_ = OrbitCamera(home, mesh_->bounds());
    orbit_.place(here);
    let_go();
}

double Navigator::aspect() const {
    return static_cast<double>(std::max(view_[0], 1U)) / std::max(view_[1], 1U);
}

Navigator::Point Navigator::on_screen(Point pixel) const {
    const double height = std::max(view_[1], 1U);
    return {(pixel.x - 0.5 * view_[0]) / height, 0.5 - pixel.y / height};
}

ViewRay Navigator::ray_under_cursor() const {
    const Point place = on_screen(cursor_);
    return orbit_.ray(place.x, place.y);
}

std::optional<VisiblePoint> Navigator::surface_under_cursor(bool backs) const {
    const ViewRay ray = ray_under_cursor();
    return visible_point(*mesh_, ray.origin, ray.direction, backs, cut_);
}

Vec3 Navigator::point_under_cursor() const {
    if (const auto point = surface_under_cursor()) {
        return point->position;
    }
    const ViewRay ray = ray_under_cursor();
    const Vec3 forward = glm::normalize(camera().target - camera().eye);
    return ray.origin + glm::dot(camera().target - ray.origin, forward) * ray.direction;
}

Navigator::Motion Navigator::motion_of(const ButtonEvent& event) const {
    if (event.button == Button::right) {
        return Motion::zoom;
    }
    if (controls_ == Controls::blender) {
        if (event.button == Button::left) {
            return Motion::none;
        }
        return event.shift ? Motion::pan : (event.control ? Motion::zoom : Motion::orbit);
    }
    return event.button == Button::middle || event.shift ? Motion::pan : Motion::orbit;
}

bool Navigator::on_cursor(const CursorEvent& event) {
    cursor_ = {event.x, event.y};
    if (!button_) {
        return false;
    }
    const double way = std::hypot(cursor_.x - pressed_at_.x, cursor_.y - pressed_at_.y);
    dragging_ = dragging_ || way >= click_way;
    if (!dragging_ || motion_ == Motion::none) {
        return false;
    }
    const Point from = on_screen(pressed_at_);
    const Point to = on_screen(cursor_);
    if (motion_ == Motion::pan) {
        orbit_.pan(to.x - from.x, to.y - from.y);
    } else if (motion_ == Motion::orbit) {
        orbit_.orbit(radians_per_height * (to.x - from.x), radians_per_height * (from.y - to.y));
    } else {
        orbit_.zoom(std::pow(zoom_per_height, to.y - from.y));
    }
    return true;
}

std::optional<std::array<double, 2>> Navigator::on_button(const ButtonEvent& event) {
    if (event.pressed) {
        button_ = event.button;
        motion_ = motion_of(event);
        pressed_at_ = cursor_;
        dragging_ = false;
        // Off the scene one turns about the target, not about a place in empty space.
        const auto point = surface_under_cursor();
        orbit_.grab(motion_ != Motion::orbit ? point_under_cursor()
                    : walking_               ? camera().eye
                    : point                  ? point->position
                                             : camera().target);
        return std::nullopt;
    }
    if (button_ != event.button) {
        return std::nullopt;
    }
    button_.reset();
    if (dragging_ || event.button != Button::left || motion_ == Motion::pan) {
        return std::nullopt;
    }
    return std::array{cursor_.x, cursor_.y};
}

bool Navigator::on_scroll(const ScrollEvent& event) {
    if (button_) {
        return false;
    }
    orbit_.grab(point_under_cursor());
    orbit_.zoom(std::pow(zoom_per_notch, event.amount));
    return true;
}

} // namespace hemi::viewer
