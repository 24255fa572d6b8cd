#include "hemi/io/scene_reader.hpp"
#include "hemi/scene/scene.hpp"
#include "io_fixtures.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace hemi::io_test {

namespace {

Scene read(const Folder& folder, const std::string& name, const std::string& text,
           Diagnostics* diagnostics = nullptr, const io::SceneReaderOptions& options = {}) {
    Diagnostics unused;
    return io::read_scene(folder.write(name, text), options, diagnostics != nullptr ? *diagnostics : unused);
}

/// Sum of the area vectors: what is folded over takes from its length.
Vec3 area(const Scene& scene) {
    return std::accumulate(scene.surfaces.begin(), scene.surfaces.end(), Vec3(0.0),
                           [](const Vec3& sum, const Surface& s) { return sum + area_vector(s.polygon()); });
}

double sum_of_areas(const Scene& scene) {
    return std::accumulate(
        scene.surfaces.begin(), scene.surfaces.end(), 0.0,
        [](double sum, const Surface& s) { return sum + glm::length(area_vector(s.polygon())); });
}

std::string vertices_of(const std::vector<Vec3>& points) {
    std::string text;
    for (const Vec3& point : points) {
        text += fmt::format("v {} {} {}\n", point.x, point.y, point.z);
    }
    return text;
}

std::string face_of(std::size_t corners) {
    std::string text = "f";
    for (std::size_t k = 1; k <= corners; ++k) {
        text += fmt::format(" {}", k);
    }
    return text + "\n";
}

std::string json(const std::string& surface) {
    return R"({"hemi": 1, "materials": {"white": {"reflectance": 0.5}}, "surfaces": [{"material": "white", )" +
           surface + "}]}";
}

} // namespace

TEST_CASE("mended faces: a strip converter's faces without area are left out, and the rest is whole",
          "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    // A closed cube of 12 triangles, with three more whose corners repeat or lie in a line.
    const std::string cube =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv 0.5 0 0\n"
        "f 1 2 3\nf 1 3 4\nf 5 7 6\nf 5 8 7\nf 1 6 2\nf 1 5 6\nf 1 1 5\nf 2 7 3\nf 2 6 7\n"
        "f 3 8 4\nf 3 7 8\nf 1 9 2\nf 3 4 3\nf 4 5 1\nf 4 8 5\n";
    const Scene scene = read(folder, "cube.obj", cube, &diagnostics);
    CHECK(scene.surfaces.size() == 12);
    CHECK(sum_of_areas(scene) == Approx(6.0));
    REQUIRE(diagnostics.warnings().size() == 1);
    require_parts(diagnostics.warnings()[0],
                  {"cube.obj:16: 3 faces without area left out, the first one here"});
    require_parts(message_of<ParseError>([&] { read(folder, "cube.obj", cube, nullptr, {.strict = true}); }),
                  {"cube.obj:16: face: zero area"});
}

TEST_CASE(
    "mended faces: a quadrilateral out of plane becomes two triangles, along the diagonal that bends it less",
    "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    const std::string text = vertices_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.2}, {0, 1, 0}}) + face_of(4);
    const Scene scene = read(folder, "quad.obj", text, &diagnostics);
    REQUIRE(scene.surfaces.size() == 2);
    REQUIRE(diagnostics.warnings().size() == 1);
    require_parts(diagnostics.warnings()[0], {"quad.obj:5: 1 face out of plane cut into triangles"});
    CHECK(glm::distance(area(scene), area_vector(std::vector<Vec3>{
                                         {0, 0, 0}, {1, 0, 0}, {1, 1, 0.2}, {0, 1, 0}})) < 1e-15);
    require_parts(message_of<ParseError>([&] { read(folder, "quad.obj", text, nullptr, {.strict = true}); }),
                  {"quad.obj:5: face: not planar"});
    // Between the ends of a long hip roof the slope is 1 in 3; to both sides of its ridge it would be 1 in 1.
    const Scene ridge =
        read(folder, "ridge.obj", vertices_of({{0, 0, 0}, {3, -1, -1}, {6, 0, 0}, {3, 1, -1}}) + face_of(4));
    REQUIRE(ridge.surfaces.size() == 2);
    for (const Surface& surface : ridge.surfaces) {
        CHECK(area_vector(surface.polygon()).z > 0.0);
        CHECK(std::abs(glm::normalize(area_vector(surface.polygon())).z) == Approx(3.0 / std::sqrt(10.0)));
    }
}

TEST_CASE("mended faces: a planarity of one's own keeps quadrilaterals that are nearly plane", "[io]") {
    const Folder folder;
    const std::string text = vertices_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.001}, {0, 1, 0}}) + face_of(4);
    Diagnostics diagnostics;
    CHECK(read(folder, "quad.obj", text, &diagnostics).surfaces.size() == 2);
    const Scene whole = read(folder, "quad.obj", text, &diagnostics, {.planarity = 0.001});
    REQUIRE(whole.surfaces.size() == 1);
    CHECK_FALSE(polygon_defect(whole.surfaces[0].polygon()).has_value());
    CHECK(sum_of_areas(whole) == Approx(1.0).epsilon(1e-6));
    require_parts(diagnostics.warnings().at(1), {"quad.obj:5: 1 face off plane by up to", "0.001"});
    const std::string nearly = vertices_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 4e-6}, {0, 1, 0}}) + face_of(4);
    CHECK(read(folder, "quad.obj", nearly).surfaces.size() == 1);
    CHECK(read(folder, "quad.obj", nearly, nullptr, {.planarity = 1e-7}).surfaces.size() == 2);
    CHECK_THROWS_AS(read(folder, "quad.obj", nearly, nullptr, {.planarity = 0.0}), InvalidArgument);
}

TEST_CASE("mended faces: concave faces keep their area and their side, wherever and however large they are",
          "[io]") {
    const Folder folder;
    const std::vector<Vec3> ell{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
    for (const double scale : {1e-6, 1.0, 1e6}) {
        for (const Vec3& shift : {Vec3(0.0), Vec3(1e5, -1e5, 1e5) * scale}) {
            std::vector<Vec3> points;
            for (const Vec3& point : ell) {
                points.emplace_back(shift + scale * point);
            }
            Diagnostics diagnostics;
            const Scene scene = read(folder, "ell.obj", vertices_of(points) + face_of(6), &diagnostics);
            CHECK(scene.surfaces.size() <= 3); // joined
            CHECK(sum_of_areas(scene) == Approx(3.0 * scale * scale));
            CHECK(area(scene).z == Approx(3.0 * scale * scale));
            require_parts(diagnostics.warnings().at(0), {"ell.obj:7: 1 face that is not convex cut"});
        }
    }
    // A star of 40 points, and one that a spiral makes of two arms.
    std::vector<Vec3> star;
    for (int k = 0; k < 80; ++k) {
        const double angle = std::numbers::pi * k / 40;
        star.emplace_back((k % 2 == 0 ? 2.0 : 1.0) * Vec3(std::cos(angle), 0.0, std::sin(angle)));
    }
    const double right = 80 * 0.5 * 2.0 * std::sin(std::numbers::pi / 40);
    const Scene cut = read(folder, "star.obj", vertices_of(star) + face_of(80));
    CHECK(sum_of_areas(cut) == Approx(right));
    CHECK(area(cut).y == Approx(-right));
    for (const Surface& surface : cut.surfaces) {
        REQUIRE_FALSE(polygon_defect(surface.polygon()).has_value());
    }
}

TEST_CASE("mended faces: outlines that cross themselves everywhere, and spikes, take little time",
          "[io][slow]") {
    // By the cube of the number of corners it would be minutes.
    const Folder folder;
    std::vector<Vec3> points;
    std::uint32_t state = 1;
    for (int k = 0; k < 4'000; ++k) {
        const auto random = [&state] { return (state = state * 1664525u + 1013904223u) / 4294967296.0; };
        const double x = random();
        points.emplace_back(x, random(), 0.0);
    }
    require_parts(
        message_of<ParseError>([&] { read(folder, "a.obj", vertices_of(points) + face_of(points.size())); }),
        {"a.obj:4001: face: edges that cross each other"});
    points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    constexpr int far = 100'000; // a square with a spike, from whose tip the outline begins
    std::string face = fmt::format("f {}", far + 4);
    for (int k = far - 1; k > 0; --k) {
        face += fmt::format(" {}", k + 4);
    }
    face += " 1 2 3 4 1";
    for (int k = 1; k <= far; ++k) {
        points.emplace_back(-k, 0, 0);
        face += k < far ? fmt::format(" {}", k + 4) : "\n";
    }
    CHECK(area(read(folder, "a.obj", vertices_of(points) + face)) == Vec3(0, 0, 1));
}

TEST_CASE("mended faces: holes are cut out of JSON polygons, also at the border and next to each other",
          "[io]") {
    const Folder folder;
    const std::string wall = R"("polygon": [[0,0,0], [4,0,0], [4,0,3], [0,0,3]], "holes": )";
    const auto areas = [&](const std::string& holes) {
        Diagnostics diagnostics;
        const Scene scene = read(folder, "wall.json", json(wall + holes), &diagnostics);
        CHECK(diagnostics.warnings().empty());
        CHECK(area(scene).y == Approx(-sum_of_areas(scene)));
        return sum_of_areas(scene);
    };
    CHECK(areas("[[[1,0,1], [2,0,1], [2,0,2], [1,0,2]]]") == Approx(11.0));
    CHECK(areas("[[[1,0,2], [2,0,2], [2,0,1], [1,0,1]]]") == Approx(11.0)); // the other way round
    CHECK(areas("[[[1,0,1], [2,0,1], [2,0,2], [1,0,2]], [[2,0,1], [3,0,1], [3,0,2], [2,0,2]]]") ==
          Approx(10.0));
    CHECK(areas("[[[1,0,0], [2,0,0], [2,0,2], [1,0,2]]]") == Approx(10.0)); // a door
    CHECK(areas("[]") == Approx(12.0));
    const auto refusal = [&](const std::string& holes) {
        return message_of<InputError>([&] { read(folder, "wall.json", json(wall + holes)); });
    };
    require_parts(refusal("[[[1,0,1], [5,0,1], [5,0,2], [1,0,2]]]"),
                  {"wall.json: surfaces[0].polygon: edges that cross", "a hole that does not lie in it"});
    require_parts(refusal("[[[1,0,1], [3,0,1], [3,0,2]], [[1,0,1], [3,0,1], [3,0,2]]]"),
                  {"a hole that does not lie"});
    require_parts(refusal("[[[1,0.5,1], [2,0.5,1], [2,0.5,2]]]"),
                  {"a hole that is 0.5 off the face's plane"});
}

TEST_CASE("mended faces: a subsurface of View3D is cut out of its base", "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    const Scene scene =
        read(folder, "wall.vs3",
             "F 3\nV 1 0 0 0\nV 2 4 0 0\nV 3 4 0 3\nV 4 0 0 3\nV 5 1 0 1\nV 6 2 0 1\nV 7 2 0 2\n"
             "V 8 1 0 2\nS 1 1 2 3 4 0 0 .9 wall\nS 2 5 6 7 8 1 0 .8 window\n",
             &diagnostics);
    CHECK(diagnostics.warnings().empty());
    double wall = 0.0;
    double window = 0.0;
    for (const Surface& surface : scene.surfaces) {
        (scene.groups[surface.group] == "wall" ? wall : window) +=
            glm::length(area_vector(surface.polygon()));
    }
    CHECK(wall == Approx(11.0));
    CHECK(window == Approx(1.0));
}

TEST_CASE("mended faces: JSON polygons of many corners, each piece subdivided as the surface says", "[io]") {
    const Folder folder;
    const Scene scene = read(
        folder, "floor.json",
        json(
            R"("polygon": [[0,0,0],[2,0,0],[2,1,0],[1,1,0],[1,2,0],[0,2,0]], "patches": [2, 3], "flip": true)"));
    CHECK(area(scene).z == Approx(-3.0));
    for (const Surface& surface : scene.surfaces) {
        REQUIRE(surface.patches.has_value());
        CHECK(surface.patches->u * surface.patches->v == (surface.vertex_count == 3 ? 9u : 6u));
    }
}

TEST_CASE("readers: comments in JSON, byte order marks, and UTF-16 by its name", "[io]") {
    const Folder folder;
    const std::string mark = "\xEF\xBB\xBF";
    const std::string polygon = json(R"("polygon": [[0,0,0],[1,0,0],[1,1,0]] // a triangle
                                        /* of one patch */)");
    CHECK(read(folder, "a.json", mark + polygon).surfaces.size() == 1);
    CHECK(read(folder, "a.vs3", mark + "F 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 0 1 0\nS 1 1 2 3 0 0 0 .9 a\n")
              .surfaces.size() == 1);
    CHECK(
        read(
            folder, "a.stl",
            mark +
                "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
                "endfacet\nendsolid\n")
            .surfaces.size() == 1);
    CHECK(read(folder, "a.ply",
               mark + "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
              .surfaces.size() == 1);
    CHECK(read(folder, "a.vtk",
               mark + "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n"
                      "0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n")
              .surfaces.size() == 1);
    for (const std::string name : {"a.json", "a.obj", "a.vs3", "a.msh"}) {
        require_parts(message_of<InputError>([&] { read(folder, name, std::string("\xFF\xFE{\0", 4)); }),
                      {name, "text in UTF-16; save it as UTF-8"});
    }
}

TEST_CASE("OBJ reader: materials as people have them: Kd 1, names that are missing, folders by backslashes",
          "[io]") {
    const Folder folder;
    std::filesystem::create_directory(folder / "map");
    folder.write("map/m.mtl", "newmtl white\nKd 1 1 1\nnewmtl grey\nKd 0.5\n");
    const std::string text =
        "mtllib map\\m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl white\nf 1 2 3\nusemtl gray\nf 1 2 3\n";
    Diagnostics diagnostics;
    const Scene scene = read(folder, "a.obj", text, &diagnostics);
    CHECK(scene.materials[scene.surfaces[0].material] == Material{"white", {0.99, 0.99, 0.99}, {0, 0, 0}});
    CHECK(scene.materials[scene.surfaces[1].material] == Material{"gray", {0.5, 0.5, 0.5}, {0, 0, 0}});
    REQUIRE(diagnostics.warnings().size() == 2);
    require_parts(diagnostics.warnings()[0],
                  {"a.obj:7: unknown material \"gray\"; did you mean \"grey\"?; reflectance 0.5"});
    require_parts(diagnostics.warnings()[1], {"a.obj: reflectance 0.99 instead of Kd 1 in white"});
    require_parts(message_of<InputError>([&] { read(folder, "a.obj", text, nullptr, {.strict = true}); }),
                  {"m.mtl:1: material \"white\": Kd 1"});
}

} // namespace hemi::io_test
