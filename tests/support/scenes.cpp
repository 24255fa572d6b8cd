#include "support/scenes.hpp"
#include "support/places.hpp"

#include "hemi/io/scene_reader.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <stdexcept>

namespace hemi::test {

Scene empty_scene() {
    Scene scene;
    scene.materials = {{"grey", {0.5}, {0.0}}};
    return scene;
}

void add_polygon(Scene& scene, const std::string& group, std::vector<Vec3> polygon, Grid patches) {
    Surface surface;
    surface.vertex_count = static_cast<std::uint32_t>(polygon.size());
    std::copy(polygon.begin(), polygon.end(), surface.vertices.begin());
    surface.group = scene.group_index(group);
    surface.patches = patches;
    scene.surfaces.push_back(surface);
}

namespace {

struct Face {
    const char* name;
    std::array<int, 4> corners; ///< bit k of a corner: upper along axis k; counter-clockwise from outside
};
constexpr std::array<Face, 6> box_faces{{{"x0", {0, 4, 6, 2}},
                                         {"x1", {1, 3, 7, 5}},
                                         {"y0", {0, 1, 5, 4}},
                                         {"y1", {2, 6, 7, 3}},
                                         {"z0", {0, 2, 3, 1}},
                                         {"z1", {4, 5, 7, 6}}}};

Vec3 box_corner(const Vec3& lower, const Vec3& upper, int bits) {
    return {(bits & 1) != 0 ? upper.x : lower.x, (bits & 2) != 0 ? upper.y : lower.y,
            (bits & 4) != 0 ? upper.z : lower.z};
}

std::vector<Vec3> box_face(const Vec3& lower, const Vec3& upper, const Face& face, bool inward) {
    std::vector<Vec3> polygon;
    for (const int corner : face.corners) {
        polygon.push_back(box_corner(lower, upper, corner));
    }
    if (inward) {
        std::reverse(polygon.begin(), polygon.end());
    }
    return polygon;
}

Vec3 turned(const Vec3& point, const Vec3& about, double angle) {
    const Vec3 offset = point - about;
    return about + Vec3(std::cos(angle) * offset.x - std::sin(angle) * offset.y,
                        std::sin(angle) * offset.x + std::cos(angle) * offset.y, offset.z);
}

/// Cuts a parallelogram into cells, as faces of their own: quadrilaterals, or pairs of triangles.
void add_lattice(Scene& scene, const std::string& group, const std::vector<Vec3>& corners, int nu, int nv,
                 bool triangles) {
    const auto at = [&](int i, int j) {
        return corners[0] + (corners[1] - corners[0]) * (static_cast<double>(i) / nu) +
               (corners[3] - corners[0]) * (static_cast<double>(j) / nv);
    };
    for (int j = 0; j < nv; ++j) {
        for (int i = 0; i < nu; ++i) {
            if (triangles) {
                add_polygon(scene, group, {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
                add_polygon(scene, group, {at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            } else {
                add_polygon(scene, group, {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
            }
        }
    }
}

template <typename Move>
Scene with_vertices(Scene scene, const Move& move) {
    for (Surface& surface : scene.surfaces) {
        for (std::uint32_t c = 0; c < surface.vertex_count; ++c) {
            surface.vertices[c] = move(surface.vertices[c]);
        }
    }
    return scene;
}

} // namespace

void add_block(Scene& scene, const std::string& group, const Vec3& lower, const Vec3& upper,
               std::uint32_t cells) {
    for (const Face& face : box_faces) {
        add_polygon(scene, group, box_face(lower, upper, face, false), {cells, cells});
    }
}

void add_room(Scene& scene, const Vec3& lower, const Vec3& upper, std::uint32_t cells) {
    for (const Face& face : box_faces) {
        add_polygon(scene, face.name, box_face(lower, upper, face, true), {cells, cells});
    }
}

Scene room_with_blocks(std::uint32_t cells) {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.2, 1.0, 0.8), cells);
    add_block(scene, "block", Vec3(0.6, 0.15, 0.0), Vec3(1.05, 0.6, 0.3), std::max(1u, cells / 2));
    const std::size_t first = scene.surfaces.size();
    add_block(scene, "floating", Vec3(0.15, 0.4, 0.35), Vec3(0.5, 0.7, 0.6), std::max(1u, cells / 3));
    for (std::size_t s = first; s < scene.surfaces.size(); ++s) {
        for (Vec3& vertex : scene.surfaces[s].vertices) {
            vertex = turned(vertex, Vec3(0.325, 0.55, 0.0), 0.4);
        }
    }
    return scene;
}

bool under_block(const Vec3& point) {
    return point.x > 0.6 && point.x < 1.05 && point.y > 0.15 && point.y < 0.6 && point.z == 0.0;
}

Scene tapered_box(std::uint32_t cells) {
    Scene scene = empty_scene();
    const std::array<Vec3, 8> corner{Vec3(0, 0, 0),     Vec3(1, 0, 0),     Vec3(0, 1, 0),
                                     Vec3(1, 1, 0),     Vec3(0.2, 0.2, 1), Vec3(0.7, 0.2, 1),
                                     Vec3(0.2, 0.8, 1), Vec3(0.7, 0.8, 1)};
    for (const Face& face : box_faces) {
        std::vector<Vec3> polygon;
        for (const int c : face.corners) {
            polygon.push_back(corner[static_cast<std::size_t>(c)]);
        }
        std::reverse(polygon.begin(), polygon.end());
        add_polygon(scene, face.name, polygon, {cells, cells + 1});
    }
    return scene;
}

Scene lattice_room() {
    Scene scene = empty_scene();
    const Vec3 upper(1.2, 1.0, 0.8);
    for (std::size_t f = 0; f < box_faces.size(); ++f) {
        add_lattice(scene, box_faces[f].name, box_face(Vec3(0.0), upper, box_faces[f], true), 8, 6,
                    f % 2 == 0);
    }
    return scene;
}

Scene t_junction_room() {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0, 1.3, 0.7), 4);
    std::erase_if(scene.surfaces, [&](const Surface& s) { return scene.groups[s.group] == "z1"; });
    // Uneven strips: their corners lie in the middle of the walls' upper edges, at values that do not round
    // well.
    const std::array<double, 5> cuts{0.0, 0.1, 1.0 / 3.0, 0.77, 1.0};
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        add_polygon(scene, "z1",
                    {Vec3(cuts[k], 0, 0.7), Vec3(cuts[k], 1.3, 0.7), Vec3(cuts[k + 1], 1.3, 0.7),
                     Vec3(cuts[k + 1], 0, 0.7)},
                    {3, 2});
    }
    return scene;
}

Scene two_rooms() {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0), 5);
    std::erase_if(scene.surfaces, [&](const Surface& s) { return scene.groups[s.group] == "z1"; });
    add_polygon(scene, "z1", {Vec3(0, 0, 1), Vec3(0, 0.4, 1), Vec3(1, 0.4, 1), Vec3(1, 0, 1)}, {3, 5});
    add_polygon(scene, "z1", {Vec3(0, 0.4, 1), Vec3(0, 1, 1), Vec3(1, 1, 1), Vec3(1, 0.4, 1)}, {3, 5});
    add_room(scene, Vec3(1.0, 0.0, 0.0), Vec3(2.0, 1.0, 1.0), 5);
    return scene;
}

Scene open_corner() {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0), 5);
    std::erase_if(scene.surfaces, [&](const Surface& s) { return scene.groups[s.group][1] == '1'; });
    return scene;
}

Scene two_plates(bool split) {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)});
    if (split) {
        add_polygon(scene, "left", {Vec3(0, 0, 0), Vec3(0, 0.5, 0), Vec3(0, 0.5, 1), Vec3(0, 0, 1)});
        add_polygon(scene, "right", {Vec3(0, 0.5, 0), Vec3(0, 1, 0), Vec3(0, 1, 1), Vec3(0, 0.5, 1)});
    } else {
        add_polygon(scene, "wall", {Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0, 1, 1), Vec3(0, 0, 1)});
    }
    for (Surface& surface : scene.surfaces) {
        surface.patches.reset();
    }
    return scene;
}

Scene facing_square(double distance) {
    Scene scene = empty_scene();
    const double e = 0.01;
    const double h = 0.5 * distance;
    add_polygon(scene, "small", {Vec3(-e, -e, 0), Vec3(e, -e, 0), Vec3(e, e, 0), Vec3(-e, e, 0)});
    add_polygon(scene, "square",
                {Vec3(-h, -h, distance), Vec3(-h, h, distance), Vec3(h, h, distance), Vec3(h, -h, distance)});
    return scene;
}

Scene rotated(Scene scene) {
    const Vec3 axis = glm::normalize(Vec3(1.0, 2.0, 3.0));
    const double angle = 1.1;
    return with_vertices(std::move(scene), [&](const Vec3& p) { // Rodrigues
        return std::cos(angle) * p + std::sin(angle) * glm::cross(axis, p) +
               (1.0 - std::cos(angle)) * glm::dot(axis, p) * axis;
    });
}

Scene scaled(Scene scene, double factor) {
    return with_vertices(std::move(scene), [=](const Vec3& p) { return factor * p; });
}

Scene moved(Scene scene, const Vec3& by) {
    return with_vertices(std::move(scene), [=](const Vec3& p) { return p + by; });
}

Scene reversed(Scene scene) {
    std::reverse(scene.surfaces.begin(), scene.surfaces.end());
    return scene;
}

std::string data_path(const std::string& name) {
    return std::string(HEMI_TEST_DATA) + "/" + name;
}

Scene read_case(const std::string& file) {
    Diagnostics diagnostics;
    return io::read_scene(data_path("cases/" + file), {}, diagnostics);
}

std::vector<ExactCase> exact_cases() {
    std::ifstream file(data_path("cases/cases.json"));
    const nlohmann::json cases = nlohmann::json::parse(file).at("cases");
    struct Limit {
        std::string title;
        std::uint32_t patches_per_face;
        double error;
    };
    // About 1.5 times the measured error; it comes of the one eye point a patch and falls with the
    // square of the patches' edges.
    const std::map<std::string, Limit> limits{
        {"unit_cube", {"unit cube", 256, 2e-4}},
        {"parallel_d0.1", {"parallel squares at distance 0.1", 256, 5e-3}},
        {"parallel_d1", {"parallel squares at distance 1", 256, 2e-4}},
        {"perp_1_1", {"squares with a common edge", 256, 1e-4}},
        {"perp_apart", {"perpendicular plates, apart", 256, 2e-5}},
        {"discs_64gon", {"discs (64-gons)", 4, 3e-3}},
        {"concentric_spheres", {"concentric spheres", 4, 4e-3}},
        {"occluded_corner", {"a square behind an obstacle", 256, 2e-4}},
        {"sphere_interior", {"inside of a sphere", 4, 1e-3}},
        {"needle_triangle", {"needle triangle, 1000 : 1, above a plate", 256, 1e-3}},
        {"far_patch", {"patch of solid angle 1e-6 sr", 256, 5e-6}},
        {"box_scale1e-6", {"closed box 1 x 0.7 x 0.1 in micrometres", 256, 4e-3}},
        {"box_scale1e6", {"closed box 1 x 0.7 x 0.1 in megametres", 256, 4e-3}}};
    std::vector<ExactCase> result;
    for (const auto& entry : cases) {
        ExactCase exact;
        exact.name = entry.at("name");
        exact.file = entry.at("file");
        exact.title = limits.at(exact.name).title;
        exact.patches_per_face = limits.at(exact.name).patches_per_face;
        exact.one_point_limit = limits.at(exact.name).error;
        for (const auto& pair : entry.at("pairs")) {
            exact.pairs.push_back({pair.at("from"), pair.at("to"), pair.at("expected")});
        }
        result.push_back(std::move(exact));
    }
    return result;
}

double GroupTable::factor(const std::string& from, const std::string& to) const {
    const auto index = [this](const std::string& name) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) {
            throw std::runtime_error("no group " + name);
        }
        return static_cast<std::size_t>(found - names.begin());
    };
    return factors.factors[index(from) * names.size() + index(to)];
}

GroupTable by_group(const PatchMesh& mesh, const FormFactorMatrix& factors) {
    std::vector<std::uint32_t> group_of(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        group_of[i] = mesh.group(i);
    }
    return {mesh.groups(),
            group_factors(factors, mesh.areas(), group_of, static_cast<std::uint32_t>(mesh.groups().size()))};
}

} // namespace hemi::test
