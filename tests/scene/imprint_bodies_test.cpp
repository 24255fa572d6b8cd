// What is left of faces of rooms with sheets through bodies, against areas from clipped polygons.

#include "hemi/scene/imprint.hpp"

#include "support/dice.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

using test::Dice;

namespace {

Surface face(const std::vector<Vec3>& corners, bool two_sided) {
    Surface surface;
    surface.vertex_count = static_cast<std::uint32_t>(corners.size());
    std::copy(corners.begin(), corners.end(), surface.vertices.begin());
    surface.two_sided = two_sided;
    return surface;
}

/// Area that is left of each surface.
std::vector<double> areas_left(const std::vector<Surface>& surfaces, double patch_size) {
    Scene scene;
    scene.materials.push_back({"", {0.5}, {0.0}});
    scene.groups = {"all"};
    scene.surfaces = surfaces;
    Subdivision subdivision;
    subdivision.patch_size = patch_size;
    const auto cut = imprint(scene, subdivision);
    const PatchMesh mesh = cut ? PatchMesh(cut->scene) : PatchMesh(scene, subdivision);
    std::vector<double> areas(surfaces.size(), 0.0);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const std::uint32_t surface = mesh.surface_of()[i];
        areas[cut ? cut->face_of[surface] : surface] += mesh.areas()[i];
    }
    return areas;
}

/// A box that is turned about the vertical.
struct Box {
    Vec3 middle; ///< of its foot
    Vec3 along;  ///< half its length
    Vec3 across;
    double height;
    bool bottom;

    [[nodiscard]] Vec3 corner(int x, int y, int z) const {
        return middle + (x != 0 ? along : -along) + (y != 0 ? across : -across) +
               Vec3(0.0, 0.0, z != 0 ? height : 0.0);
    }
    [[nodiscard]] std::vector<std::vector<Vec3>> faces() const {
        std::vector<std::vector<Vec3>> result{
            {corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)},
            {corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)},
            {corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1)},
            {corner(1, 1, 0), corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1)},
            {corner(0, 1, 0), corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1)}};
        if (bottom) {
            result.push_back({corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0), corner(1, 0, 0)});
        }
        return result;
    }
    /// The part of a convex polygon that is within the box.
    [[nodiscard]] std::vector<Vec3> part_of(std::vector<Vec3> polygon) const {
        for (const auto& [normal, at] :
             {std::pair(along, middle + along), std::pair(-along, middle - along),
              std::pair(across, middle + across), std::pair(-across, middle - across),
              std::pair(Vec3(0, 0, 1), corner(0, 0, 1)), std::pair(Vec3(0, 0, -1), middle)}) {
            std::vector<Vec3> left;
            for (std::size_t k = 0; k < polygon.size(); ++k) {
                const Vec3& here = polygon[k];
                const Vec3& next = polygon[(k + 1) % polygon.size()];
                const double a = glm::dot(here - at, normal);
                const double b = glm::dot(next - at, normal);
                if (a <= 0.0) {
                    left.push_back(here);
                }
                if ((a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)) {
                    left.push_back(here + a / (a - b) * (next - here));
                }
            }
            polygon = std::move(left);
        }
        return polygon;
    }
};

double area_of(const std::vector<Vec3>& polygon) {
    return polygon.size() < 3 ? 0.0 : glm::length(area_vector(polygon));
}

/// Area of a polygon outside of boxes, from the `first` one on: of parts of parts, each taken from the rest.
double area_outside(const std::vector<Vec3>& polygon, std::span<const Box> boxes) {
    double area = area_of(polygon);
    for (std::size_t k = 0; k < boxes.size() && area > 0.0; ++k) {
        const std::vector<Vec3> within = boxes[k].part_of(polygon);
        area -= within.size() < 3 ? 0.0 : area_outside(within, boxes.first(k));
    }
    return area;
}

/// A room of 2 x 2 x 1 with things in it, and the area that is free of each face.
class Furnished {
public:
    explicit Furnished(std::span<const Box> boxes) {
        for (std::vector<Vec3> wall : room.faces()) {
            std::reverse(wall.begin(), wall.end());
            add(wall, area_outside(wall, boxes), false);
        }
        std::vector<Box> others(boxes.begin(), boxes.end());
        for (const Box& box : boxes) {
            others.erase(others.begin());
            const auto faces = box.faces();
            for (std::size_t f = 0; f < faces.size(); ++f) { // of which the sixth stands on the floor
                add(faces[f], f == 5 ? 0.0 : area_outside(faces[f], others), false);
            }
            others.push_back(box);
        }
        boxes_ = std::move(others);
    }

    void add_sheet(const std::vector<Vec3>& corners) {
        add(corners, 2.0 * area_outside(corners, boxes_), true);
    }

    void check(double patch_size) const {
        INFO("patch size " << patch_size);
        const std::vector<double> left = areas_left(surfaces_, patch_size);
        for (std::size_t f = 0; f < left.size(); ++f) {
            INFO("face " << f);
            CHECK(left[f] == Approx(free_[f]).margin(1e-6));
        }
    }

private:
    static constexpr Box room{{1.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 1.0, true};

    void add(const std::vector<Vec3>& corners, double area, bool two_sided) {
        surfaces_.push_back(face(corners, two_sided));
        free_.push_back(area);
    }

    std::vector<Box> boxes_;
    std::vector<Surface> surfaces_;
    std::vector<double> free_;
};

Furnished with_sheets_through_boxes(std::uint32_t seed) {
    Dice dice(seed);
    std::vector<Box> boxes(static_cast<std::size_t>(1 + dice.pick(3)));
    for (Box& box : boxes) {
        const double turn = dice.pick(2) * dice(0.0, 1.5);
        const Vec3 along(std::cos(turn), std::sin(turn), 0.0);
        box = {Vec3(dice(0.7, 1.3), dice(0.7, 1.3), 0.0), dice(0.05, 0.4) * along,
               dice(0.05, 0.4) * Vec3(-along.y, along.x, 0.0), dice(0.1, 0.8), dice.pick(2) == 0};
    }
    Furnished result(boxes);
    for (int k = 1 + dice.pick(3); k > 0; --k) {
        const double turn = dice(0.0, 3.0);
        const double lean = dice(-1.0, 1.0); // of two metres upwards
        const double base = dice.pick(2) * dice(0.0, 0.4);
        const Vec3 middle(dice(0.7, 1.3), dice(0.7, 1.3), base);
        const Vec3 along = dice(0.1, 0.6) * Vec3(std::cos(turn), std::sin(turn), 0.0);
        const Vec3 up = dice(0.1, 0.55) * Vec3(-lean * std::sin(turn), lean * std::cos(turn), 1.0);
        result.add_sheet({middle - along, middle + along, middle + along + up, middle - along + up});
    }
    return result;
}

} // namespace

TEST_CASE("Imprint: of a body with a tilted sheet through it nothing is left inside", "[imprint]") {
    // Under the sheet, parts of the floor see more of it than of the box.
    const bool bottom = GENERATE(false, true);
    const std::vector<Box> boxes{{{0.85, 1.35, 0.0}, {0.25, 0.0, 0.0}, {0.0, 0.25, 0.0}, 0.3, bottom}};
    Furnished room(boxes);
    room.add_sheet({{1.5, 0.7, 0.0}, {0.5, 1.3, 0.0}, {0.6, 1.5, 1.0}, {1.6, 0.9, 1.0}});
    for (const double size : {5.0, 0.45, 0.4, 0.3, 0.2}) {
        room.check(size);
    }
}

TEST_CASE("Imprint: of a body over a sheet that stands beside its faces nothing is left inside",
          "[imprint]") {
    const std::vector<Box> boxes{{{0.85, 1.35, 0.0}, {0.25, 0.0, 0.0}, {0.0, 0.25, 0.0}, 0.3, false}};
    Furnished room(boxes);
    room.add_sheet({{0.7, 1.2, 0.1}, {1.0, 1.2, 0.1}, {1.0, 1.5, 0.15}, {0.7, 1.5, 0.15}}); // touches nothing
    room.add_sheet({{0.7, 1.2, 0.2}, {1.0, 1.2, 0.2}, {1.0, 1.5, 0.25}, {0.7, 1.5, 0.25}});
    room.check(0.4);
}

TEST_CASE("Imprint: what is inside of bodies is left out, whichever sheets pass through them", "[imprint]") {
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        INFO("seed " << seed);
        const Furnished room = with_sheets_through_boxes(seed);
        room.check(5.0);
        room.check(0.4);
    }
}

TEST_CASE("Imprint: a room of sheets within the shell of a house stays, with its floor", "[imprint]") {
    const Box shell{{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, 2.0, false};
    const Box inner{{0.0, 0.0, 0.0}, {1.8, 0.0, 0.0}, {0.0, 1.8, 0.0}, 1.8, false};
    std::vector<Surface> surfaces{
        face({{-9.0, -9.0, 0.0}, {9.0, -9.0, 0.0}, {9.0, 9.0, 0.0}, {-9.0, 9.0, 0.0}}, false)};
    for (const std::vector<Vec3>& wall : shell.faces()) {
        surfaces.push_back(face(wall, false));
    }
    for (const std::vector<Vec3>& wall : inner.faces()) {
        surfaces.push_back(face(wall, true));
    }
    // A partition, so that all faces within are cut.
    surfaces.push_back(face({{0.3, -1.8, 0.0}, {0.3, 1.8, 0.0}, {0.3, 1.8, 1.8}, {0.3, -1.8, 1.8}}, true));
    const std::vector<double> left = areas_left(surfaces, 0.9);
    CHECK(left[0] == Approx(18.0 * 18.0 - 4.0 * 4.0 + 3.6 * 3.6)); // none between the walls
    CHECK(left[6] == Approx(3.6 * 3.6));                           // of the ceiling one side
    CHECK(left[11] == Approx(2.0 * 3.6 * 1.8));
}

} // namespace hemi
