#include "hemi/io/scene_reader.hpp"

#include "hemi/scene/patch_mesh.hpp"
#include "io_fixtures.hpp"

#include <cmath>

namespace hemi::io_test {

namespace {

constexpr const char* cube_obj =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "g bottom\nf 1 4 3 2\ng top\nf 5 6 7 8\ng sides\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n"
    "f 4 1 5 8\n";

/// A scene with its materials and surfaces left open.
std::string scene(const std::string& surfaces,
                  const std::string& materials = R"("white": {"reflectance": 0.7})",
                  const std::string& more = "") {
    return R"({"hemi": 1, "materials": {)" + materials + R"(}, "surfaces": [)" + surfaces + "]" + more + "}";
}

const std::string square = R"({"material": "white", "polygon": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]]})";

/// The square with other members.
std::string square_with(const std::string& members) {
    return "{" + members + ", " + square.substr(1);
}

Scene read(const Folder& folder, const std::string& text, Diagnostics* diagnostics = nullptr,
           const io::SceneReaderOptions& options = {}) {
    Diagnostics unused;
    return io::read_scene(folder.write("room.json", text), options,
                          diagnostics != nullptr ? *diagnostics : unused);
}

struct Bad {
    std::string text;
    std::vector<std::string> parts;
};

void require_refused(const std::vector<Bad>& table) {
    const Folder folder;
    folder.write("cube.obj", cube_obj);
    for (const Bad& bad : table) {
        INFO(bad.text);
        std::vector<std::string> parts = bad.parts;
        parts.push_back("room.json:");
        require_parts(message_of<InputError>([&] { read(folder, bad.text); }), parts);
    }
}

} // namespace

TEST_CASE("JSON reader: everything the format has arrives in the scene", "[io]") {
    const Folder folder;
    folder.write("cube.obj", cube_obj);
    const Scene result = read(folder, R"({ "hemi": 1, "name": "Raum ä", "channels": ["short", "long"],
      "materials": { "white": {"reflectance": [0.7, 0.1]}, "lamp": {"reflectance": 0, "exitance": [18.4, 8.0]} },
      "surfaces": [
        {"name": "floor", "material": "white", "polygon": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "patches": [16, 8]},
        {"material": "lamp", "polygon": [[0,0,1],[1,0,1],[0,1,1]], "patches": 3, "two_sided": true},
        {"name": "pot", "material": "white", "mesh": "cube.obj", "patches": 2} ],
      "patch_size": 0.1, "enclosure": "closed", "environment": {"exitance": [3, 4]},
      "camera": {"eye": [0.5,-1.4,0.5], "target": [0.5,0.5,0.5], "up": [0,1,1], "fov": 30} })");
    REQUIRE(result.name == "Raum ä");
    REQUIRE(result.channels == std::vector<std::string>{"short", "long"});
    REQUIRE(result.materials ==
            std::vector<Material>{{"white", {0.7, 0.1}, {0, 0}}, {"lamp", {0, 0}, {18.4, 8.0}}});
    REQUIRE(result.groups == std::vector<std::string>{"floor", "surface_1", "pot"});
    REQUIRE(result.surfaces.size() == 8);
    REQUIRE(result.surfaces[0].patches == Grid{16, 8});
    REQUIRE(result.surfaces[0].vertices[2] == Vec3(1, 1, 0));
    REQUIRE_FALSE(result.surfaces[0].two_sided);
    REQUIRE(result.surfaces[1].patches == Grid{3, 3});
    REQUIRE(result.surfaces[1].vertex_count == 3);
    REQUIRE(result.surfaces[1].material == 1);
    REQUIRE(result.surfaces[1].two_sided);
    REQUIRE(result.surfaces[7].group == 2);
    REQUIRE(result.surfaces[7].patches == Grid{2, 2});
    REQUIRE(result.patch_size == 0.1);
    REQUIRE(result.enclosure == Enclosure::closed);
    REQUIRE(result.environment == std::vector<double>{3, 4});
    REQUIRE(result.camera->eye == Vec3(0.5, -1.4, 0.5));
    REQUIRE(result.camera->up == Vec3(0, 1, 1));
    REQUIRE(result.camera->fov == 30);
}

TEST_CASE("JSON reader: what is left out has its default", "[io]") {
    const Folder folder;
    const Scene grey = read(folder, scene(square));
    REQUIRE(grey.name == "room");
    REQUIRE(grey.channels == std::vector<std::string>{"grey"});
    REQUIRE(grey.environment == std::vector<double>{0});
    REQUIRE_FALSE(grey.patch_size.has_value());
    REQUIRE_FALSE(grey.camera.has_value());
    REQUIRE(grey.enclosure == Enclosure::automatic);
    const std::vector<std::string> colours{"red", "green", "blue"};
    REQUIRE(read(folder, scene(square, R"("white": {"reflectance": 0.5, "exitance": [1,2,3]})")).channels ==
            colours);
    const Scene sky = read(folder, scene(square, R"("white": {"reflectance": 0.5})",
                                         R"(, "environment": {"exitance": [1,2,3]})"));
    REQUIRE(sky.channels == colours);
    REQUIRE(sky.materials[0].reflectance == std::vector<double>{0.5, 0.5, 0.5});
}

TEST_CASE("JSON reader: a camera stands upright in a scene whose upward axis is y", "[io]") {
    const Folder folder;
    const auto up_of = [&](const std::string& more) {
        return read(folder, scene(square, R"("white": {"reflectance": 0.5})",
                                  R"(, "camera": {"eye": [0,1,-5], "target": [0,1,0]})" + more))
            .camera->up;
    };
    CHECK(up_of(R"(, "up": "y")") == Vec3(0, 1, 0));
    CHECK_THROWS_WITH(up_of(""), Catch::Contains("up is 0 or along the view"));
}

TEST_CASE("JSON reader: surfaces of one name form one group", "[io]") {
    const Folder folder;
    const Scene result = read(
        folder, scene(square_with(R"("name": "a")") + "," + square + "," + square_with(R"("name": "a")")));
    REQUIRE(result.groups == std::vector<std::string>{"a", "surface_1"});
    REQUIRE(result.surfaces[2].group == 0);
}

TEST_CASE("JSON reader: a mesh is scaled, then rotated about x, y, z, then moved, right angles are exact",
          "[io]") {
    const Folder folder;
    folder.write("flag.obj", "v 1 0 0\nv 3 0 0\nv 1 2 0\nf 1 2 3\n");
    const auto first = [&](const std::string& transform) {
        return read(folder,
                    scene(R"({"material": "white", "mesh": "flag.obj", "transform": )" + transform + "}"))
            .surfaces[0];
    };
    REQUIRE(first(R"({"scale": 2, "translate": [10, 0, 1]})").vertices[1] == Vec3(16, 0, 1));
    REQUIRE(first(R"({"rotate": [0, 0, 90]})").vertices[1] == Vec3(0, 3, 0));
    REQUIRE(first(R"({"rotate": [90, 0, 90]})").vertices[2] == Vec3(0, 1, 2));
    REQUIRE(first(R"({"rotate": [0, 90, 0]})").vertices[1] == Vec3(0, 0, -3));
    REQUIRE(first(R"({"rotate": [0, 0, -450], "scale": [1, 2, 3]})").vertices[2] == Vec3(4, -1, 0));
    const Vec3 tilted = first(R"({"rotate": [0, 0, 30]})").vertices[0];
    REQUIRE(tilted.x == Approx(std::cos(std::acos(-1.0) / 6)));
    REQUIRE(tilted.y == Approx(0.5));
}

TEST_CASE("JSON reader: a mesh that is mirrored keeps its front outward and its grid in place", "[io]") {
    const Folder folder;
    folder.write("cube.obj", cube_obj);
    const auto patches = [&](const std::string& scale) {
        const Scene result =
            read(folder, scene(R"({"material": "white", "mesh": "cube.obj", "patches": [3, 5],
            "transform": {"scale": )" +
                               scale + R"(, "translate": [-0.5, 0.25, 4]}})"));
        return PatchMesh(result);
    };
    for (const std::string scale : {"1", "[-1, 2, 1]", "-0.5", "[-1, -1, 3]"}) {
        const PatchMesh mesh = patches(scale);
        INFO(scale);
        REQUIRE(mesh.size() == 6 * 15);
        double volume = 0.0;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            volume += mesh.areas()[i] * glm::dot(mesh.normal(i), mesh.centres()[i]) / 3.0;
        }
        REQUIRE(volume > 0.0);
        const Grid grid = mesh.grid(0);
        REQUIRE(std::minmax(grid.u, grid.v) == std::minmax(3u, 5u));
    }
}

TEST_CASE("JSON reader: a mesh without name or material brings its own groups and MTL materials", "[io]") {
    const Folder folder;
    folder.write("lib.mtl", "newmtl red\nKd 0.8 0.1 0.1\nKe 1 2 3\nnewmtl white\nKd 0.1 0.1 0.1\n");
    folder.write(
        "two.obj",
        "mtllib lib.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\ng a\nusemtl red\nf 1 2 3\ng b\nusemtl white\nf 3 2 1\n");
    folder.write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Scene result =
        read(folder,
             scene(R"({"mesh": "two.obj"}, {"mesh": "bare.obj"}, {"mesh": "two.obj", "material": "white"})"));
    REQUIRE(result.channels.size() == 3);
    REQUIRE(result.groups == std::vector<std::string>{"a", "b", "default"});
    REQUIRE(result.materials == std::vector<Material>{{"white", {0.7, 0.7, 0.7}, {0, 0, 0}},
                                                      {"red", {0.8, 0.1, 0.1}, {1, 2, 3}},
                                                      {"default", {0.5, 0.5, 0.5}, {0, 0, 0}}});
    REQUIRE(result.surfaces[0].material == 1);
    REQUIRE(result.surfaces[1].material == 0); // the scene's own "white" counts before the MTL's
    REQUIRE(result.surfaces[2].material == 2);
    REQUIRE(result.surfaces[3].material == 0);
}

TEST_CASE("JSON reader: two meshes that mean different things by one material are refused", "[io]") {
    const Folder folder;
    for (const std::string name : {"a", "b"}) {
        folder.write(name + ".mtl", name == "a" ? "newmtl m\nKd 0.2\n" : "newmtl m\nKd 0.3\n");
        folder.write(name + ".obj",
                     "mtllib " + name + ".mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    }
    const std::string meshes = R"({"mesh": "a.obj"}, {"mesh": "b.obj"})";
    require_parts(message_of<InputError>([&] { read(folder, scene(meshes)); }),
                  {"room.json: surfaces[1].mesh: material \"m\" has other values"});
    REQUIRE(read(folder, scene(meshes, R"("m": {"reflectance": 0.4})")).materials.size() == 1);
    const std::string spectral = scene(R"({"mesh": "a.obj"})", "", R"(, "channels": ["x"])");
    REQUIRE(read(folder, spectral).materials[0].reflectance == std::vector<double>{0.2});
    folder.write("a.mtl", "newmtl m\nKd 0.2 0.3 0.4\n");
    require_parts(message_of<InputError>([&] { read(folder, spectral); }),
                  {"a.mtl:1", "0.2, 0.3, 0.4", "1 channels (x)"});
}

TEST_CASE("JSON reader: surfaces without area are left out with a warning, or refused by --strict", "[io]") {
    const Folder folder;
    const std::string text =
        scene(square + R"(, {"material": "white", "polygon": [[0,0,0],[1,0,0],[2,0,0]]})");
    require_parts(message_of<InputError>([&] { read(folder, text, nullptr, {.strict = true}); }),
                  {"room.json: surfaces[1].polygon: zero area"});
    Diagnostics diagnostics;
    REQUIRE(read(folder, text, &diagnostics).surfaces.size() == 1);
    REQUIRE(diagnostics.warnings().size() == 1);
    require_parts(diagnostics.warnings()[0], {"room.json: 1 surface without area", "surfaces[1]"});
}

TEST_CASE("JSON reader: syntax errors carry line and column", "[io]") {
    const Folder folder;
    const auto place = [&](const std::string& text) {
        try {
            read(folder, text);
        } catch (const ParseError& error) {
            return std::make_pair(error.line(), error.column());
        }
        return std::make_pair(std::size_t{0}, std::size_t{0});
    };
    using Place = std::pair<std::size_t, std::size_t>;
    REQUIRE(place("{\n  \"hemi\": 1,\n  oops") == Place{3, 3});
    REQUIRE(place("{\"hemi\": 1") == Place{1, 11});
    REQUIRE(place("") == Place{1, 1});
    REQUIRE(place("{\"hemi\":\n 1e999}").first == 2);
    REQUIRE(place("{\"a\": \"\xFF\"}").first == 1);
    // In words of its own, not those of the library that reads it.
    const auto message = [&](const std::string& text) {
        return message_of<ParseError>([&] { (void)read(folder, text); });
    };
    require_parts(message("{\"hemi\": nan}"), {":1:", "unexpected \"", "no sound JSON"});
    require_parts(message("{\"hemi\": 1"), {"the text ends here"});
    require_parts(message("{\"hemi\": 1e999}"), {"1e999; no number can be as large"});
}

TEST_CASE("JSON reader: a surface is in the group that it names, else in the one of its name", "[io]") {
    const Folder folder;
    const Scene read_back =
        read(folder, scene(square_with(R"("name": "a")") + "," + square_with(R"("name": "b", "group": "a")") +
                           "," + square_with(R"("group": "c")")));
    REQUIRE(read_back.groups == std::vector<std::string>{"a", "c"});
    REQUIRE(read_back.surfaces[1].group == 0);
    REQUIRE(read_back.surfaces[2].group == 1);
}

TEST_CASE("JSON reader: what is wrong is named with its place, its value and what would be right", "[io]") {
    const std::string white = R"("white": {"reflectance": 0.7})";
    require_refused({
        {"[]", {"an array of 0; must be an object"}},
        {"{}", {"\"hemi\": 1 is missing"}},
        {R"({"hemi": 2, "surfaces": []})", {"hemi: 2; must be 1"}},
        {R"({"hemi": "1", "surfaces": []})", {"hemi: \"1\"; must be 1"}},
        {R"({"hemi": 1})", {"\"surfaces\" is missing"}},
        {R"({"hemi": 1, "materials": {"m": {"reflectance": 0.5}}, "surfaces": [{"name": "a\u0000b", "material": "m", "polygon": [[0,0,0], [1,0,0], [0,1,0]]}]})",
         {"surfaces[0].name: \"a?b\"; must be a string without zero characters"}},
        {R"({"hemi": 1, "surfaces": []})", {"surfaces: no surfaces"}},
        {R"({"hemi": 1, "surfaces": {}})", {"surfaces: an object; must be an array"}},
        {R"({"hemi": 1, "surfases": []})", {"unknown key \"surfases\"; did you mean \"surfaces\"?"}},
        {R"({"hemi": 1, "hemi": 1})", {"key \"hemi\" is given twice"}},
        {scene("7"), {"surfaces[0]: 7; must be an object"}},
        {scene(square_with(R"("material": "x")")), {"surfaces[0]: key \"material\" is given twice"}},
        {scene(square_with(R"("patchs": 3)")),
         {"surfaces[0]: unknown key \"patchs\"; did you mean \"patches\"?"}},
        {scene(square_with(R"("zzzzzz": 3)")),
         {"surfaces[0]: unknown key \"zzzzzz\"; there is name, group, material"}},
        {scene(R"({"material": "white"})"), {"surfaces[0]: neither \"polygon\" nor \"mesh\""}},
        {scene(square_with(R"("mesh": "cube.obj")")), {"surfaces[0]: both \"polygon\" and \"mesh\""}},
        {scene(square_with(R"("transform": {})")), {"surfaces[0]: \"transform\" belongs to a mesh"}},
        {scene(square + R"(, {"material": "white", "polygon": [[0,0,0],[1,0,0]]})"),
         {"surfaces[1].polygon: 2 vertices; a polygon needs 3 or more"}},
        {scene(square_with(R"("holes": [[[0,0,0],[1,0,0]]])")), {"surfaces[0].holes[0]: 2 vertices"}},
        {scene(square_with(R"("holes": 3)")), {"surfaces[0].holes: 3; must be an array"}},
        {scene(square_with(R"("flip": 1)")), {"surfaces[0].flip: 1; must be true or false"}},
        {scene(R"({"material": "white", "polygon": [[0,0,0],[1,0],[1,1,0]]})"),
         {"surfaces[0].polygon[1]: an array of 2; must be three numbers [x, y, z]"}},
        {scene(R"({"material": "white", "polygon": [[0,0,0],[1,0,"x"],[1,1,0]]})"),
         {"surfaces[0].polygon[1][2]: \"x\"; must be a number"}},
        {scene(R"({"material": "white", "polygon": [[0,0,0],[1,0,0],[0,1,0],[1,1,0]]})"),
         {"surfaces[0].polygon: zero area, since its edges cross each other"}},
        {scene(R"({"material": "white", "polygon": [[0,0,0],[1,0,0],[1e200,1,0],[0,1,0]]})"),
         {"surfaces[0].polygon"}},
        {scene(R"({"polygon": [[0,0,0],[1,0,0],[1,1,0]]})"), {"surfaces[0]: \"material\" is missing"}},
        {scene(R"({"material": "wihte", "polygon": [[0,0,0],[1,0,0],[1,1,0]]})"),
         {"surfaces[0].material: unknown material \"wihte\"; did you mean \"white\"?"}},
        {scene(R"({"material": 3, "polygon": [[0,0,0],[1,0,0],[1,1,0]]})"),
         {"surfaces[0].material: 3; must be a string"}},
        {scene(square_with(R"("name": "")")), {"surfaces[0].name: \"\"; must be a string that is not empty"}},
        {scene(square_with(R"("patches": 0)")), {"surfaces[0].patches: 0; must be a whole number from 1"}},
        {scene(square_with(R"("patches": 2.5)")), {"surfaces[0].patches: 2.5"}},
        {scene(square_with(R"("patches": [2, -1])")), {"surfaces[0].patches[1]: -1"}},
        {scene(square_with(R"("patches": [2, 2, 2])")),
         {"surfaces[0].patches: an array of 3; must be one number, or two"}},
        {scene(R"({"material": "white", "polygon": [[0,0,0],[1,0,0],[1,1,0]], "patches": [2, 3]})"),
         {"surfaces[0].patches: [2, 3] for a triangle; must be n or [n, n]"}},
        {scene(square_with(R"("two_sided": 1)")), {"surfaces[0].two_sided: 1; must be true or false"}},
        {scene(square, R"("white": {"reflectance": 1})"),
         {"materials.white.reflectance: 1; must be at least 0 and below 1"}},
        {scene(square, R"("white": {"reflectance": [0.1, -0.2, 0.3]})"),
         {"materials.white.reflectance[1]: -0.2"}},
        {scene(square, R"("white": {"reflectance": [0.1, 0.2]})"),
         {"materials.white.reflectance: 2 values", "1 (grey)"}},
        {scene(square, R"("white": {"reflectance": 0, "exitance": -5})"),
         {"materials.white.exitance: -5; must not be negative"}},
        {scene(square, R"("white": {"reflectance": null})"),
         {"materials.white.reflectance: null; must be a number"}},
        {scene(square, R"("white": {})"), {"materials.white: \"reflectance\" is missing"}},
        {scene(square, R"("white": {"reflectanse": 0})"),
         {"materials.white: unknown key", "did you mean \"reflectance\"?"}},
        {scene(square, R"("white": 0.5)"), {"materials.white: 0.5; must be an object"}},
        {scene(square, R"("white": {"reflectance": 1e999})"), {"1e999"}},
        {scene(square, white, R"(, "channels": [])"), {"channels: no channels"}},
        {scene(square, white, R"(, "channels": ["a", "a"])"), {"channels[1]: \"a\" is given twice"}},
        {scene(square, white, R"(, "channels": ["a", 1])"), {"channels[1]: 1; must be a string"}},
        {scene(square, white, R"(, "patch_size": 0)"), {"patch_size: 0; must be a positive number"}},
        {scene(square, white, R"(, "enclosure": "shut")"),
         {"enclosure: \"shut\"; must be \"closed\", \"open\" or \"auto\""}},
        {scene(square, white, R"(, "environment": {"exitance": [1, 2]})"),
         {"environment.exitance: 2 values"}},
        {scene(square, white, R"(, "environment": {"radiance": 1})"),
         {"environment: unknown key \"radiance\""}},
        {scene(square, white, R"(, "camera": {"eye": [0,0,0]})"), {"camera: \"target\" is missing"}},
        {scene(square, white, R"(, "camera": {"eye": [0,0,0], "target": [0,0,0]})"),
         {"camera: eye and target are the same"}},
        {scene(square, white, R"(, "camera": {"eye": [0,0,0], "target": [0,0,1]})"),
         {"camera: up is 0 or along the view"}},
        {scene(square, white, R"(, "camera": {"eye": [0,0,0], "target": [0,1,0], "fov": 180})"),
         {"camera.fov: 180"}},
        {scene(R"({"material": "white", "mesh": "cube.3ds"})"),
         {"surfaces[0].mesh: \"cube.3ds\"; must be the path of a mesh: .obj, .msh, .ply, .stl, .inp, .vtk, "
          ".vtp, .vtu, .bdf, .nas"}},
        {scene(R"({"material": "white", "mesh": "cube.obj", "transform": {"scale": 0}})"),
         {"surfaces[0].transform.scale: 0 makes a mesh flat"}},
        {scene(R"({"material": "white", "mesh": "cube.obj", "transform": {"rotation": 0}})"),
         {"surfaces[0].transform: unknown key \"rotation\"", "rotate"}},
        {std::string(100'000, '['), {"nested deeper than 64"}},
        {scene(square, white, R"(, "name": )" + std::string(200, '[')), {"nested deeper than 64"}},
    });
}

TEST_CASE("JSON reader: a mesh that is missing or broken is named by its own file", "[io]") {
    const Folder folder;
    folder.write("bad.obj", "v 0 0\n");
    require_parts(
        message_of<InputError>([&] { read(folder, scene(R"({"material": "white", "mesh": "no.obj"})")); }),
        {"no.obj: cannot be read: No such file"});
    require_parts(
        message_of<InputError>([&] { read(folder, scene(R"({"material": "white", "mesh": "bad.obj"})")); }),
        {"bad.obj:1: a vertex of 2 numbers; must have 3"});
}

TEST_CASE("JSON reader: meshes and MTL files outside the scene's folder are opened only when allowed",
          "[io]") {
    const Folder outside;
    const Folder folder;
    std::filesystem::create_directories(folder / "meshes");
    const std::string faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    outside.write("o.obj", faces);
    outside.write("m.mtl", "newmtl m\nKd 0.25\n");
    folder.write("shared.mtl", "newmtl m\nKd 0.25\n");
    folder.write("meshes/below.obj", "mtllib ../shared.mtl\n" + faces);
    folder.write("meshes/bad.obj", "mtllib " + (outside / "m.mtl").string() + "\n" + faces);
    std::filesystem::create_symlink(outside / "o.obj", folder / "link.obj");
    const auto read_mesh = [&](const std::string& name, bool allow) {
        Diagnostics unused;
        io::SceneReaderOptions options;
        options.allow_outside = allow;
        return io::read_scene(folder.write("room.json", scene(R"({"mesh": ")" + name + R"("})")), options,
                              unused);
    };
    REQUIRE(read_mesh("meshes/below.obj", false).materials.back().reflectance ==
            std::vector<double>{0.25, 0.25, 0.25});
    for (const std::string& name : {(outside / "o.obj").string(), std::string("link.obj"),
                                    "../" + (outside / "").parent_path().filename().string() + "/o.obj"}) {
        INFO(name);
        require_parts(message_of<InputError>([&] { (void)read_mesh(name, false); }),
                      {"room.json: surfaces[0].mesh: ", "; must be in the scene's folder or below it, "
                                                        "unless files outside it are allowed"});
        REQUIRE(read_mesh(name, true).surfaces.size() == 1);
    }
    require_parts(message_of<InputError>([&] { (void)read_mesh("meshes/bad.obj", false); }),
                  {"bad.obj:1: mtllib ", "m.mtl\"; must be in the scene's folder or below it"});
    REQUIRE(read_mesh("meshes/bad.obj", true).surfaces.size() == 1);
    const io::SceneReaderOptions none;
    Diagnostics unused;
    require_parts(
        message_of<InputError>([&] { (void)io::read_scene(folder / "meshes/bad.obj", none, unused); }),
        {"bad.obj:1: mtllib "});
}

} // namespace hemi::io_test
