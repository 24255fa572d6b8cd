#include "hemi/io/scene_reader.hpp"

#include "hemi/scene/patch_mesh.hpp"
#include "io_fixtures.hpp"

namespace hemi::io_test {

namespace {

const std::string square = "V 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\n";

/// Two facing unit squares and a smaller one between them.
const std::string obstructed = "T Two squares with an obstruction\n"
                               "! a comment\n"
                               "C encl=0 list=3\n"
                               "F 3\n" +
                               square +
                               "V 5 0. 0. 1.\nV 6 1 0 1\nv 7 1.e0 1 1\nV 8 0 1 1\n"
                               "V 9 0 0 .5 ! behind the data\nV 10 .5 0 .5\nV 11 .5 .5 .5\nV 12 0 .5 .5\n"
                               "! # v1 v2 v3 v4 base cmb emit name\n"
                               "S 1  1  2  3  4 0 0 0.5  low\n"
                               "s 2  7  6  5  8 0 0 0.75 high / the upper one\n"
                               "O 3  9 10 11  0\n"
                               "End of data\nanything\n";

Scene read(const Folder& folder, const std::string& text, Diagnostics* diagnostics = nullptr,
           const io::SceneReaderOptions& options = {}) {
    Diagnostics unused;
    return io::read_scene(folder.write("room.vs3", text), options,
                          diagnostics != nullptr ? *diagnostics : unused);
}

} // namespace

TEST_CASE("View3D reader: surfaces keep order, name and orientation, and reflectance is 1 - emissivity",
          "[io]") {
    const Folder folder;
    const Scene scene = read(folder, obstructed);
    REQUIRE(scene.name == "Two squares with an obstruction");
    REQUIRE(scene.channels == std::vector<std::string>{"grey"});
    REQUIRE(scene.environment == std::vector<double>{0.0});
    REQUIRE(scene.enclosure == Enclosure::open);
    REQUIRE(scene.groups == std::vector<std::string>{"low", "high", "obstruction"});
    REQUIRE(scene.surfaces.size() == 3);
    REQUIRE(scene.surfaces[1].vertices[0] == Vec3(1, 1, 1));
    REQUIRE(area_vector(scene.surfaces[1].polygon()).z == -1.0);
    REQUIRE(scene.surfaces[2].vertex_count == 3);
    REQUIRE(scene.materials == std::vector<Material>{{"emissivity 0.5", {0.5}, {0.0}},
                                                     {"emissivity 0.75", {0.25}, {0.0}},
                                                     {"obstruction", {0.0}, {0.0}}});
}

TEST_CASE("View3D reader: an obstruction is black on both sides, and comes after the surfaces", "[io]") {
    const Folder folder;
    const Scene scene = read(folder, obstructed);
    REQUIRE(scene.surfaces[2].two_sided);
    REQUIRE_FALSE(scene.surfaces[0].two_sided);
    REQUIRE(scene.materials[scene.surfaces[2].material].reflectance == std::vector<double>{0.0});
    const PatchMesh mesh(scene);
    REQUIRE(mesh.size() == 4);
    REQUIRE(mesh.group(2) == 2);
    REQUIRE(mesh.is_back(3));
}

TEST_CASE("View3D reader: combined surfaces are one group, and enclosures are declared", "[io]") {
    const Folder folder;
    const Scene scene = read(folder, "C ENCL = 1, maxu=8\n" + square +
                                         "S 1 1 2 3 0 0 0 .9 floor\nS 2 1 3 4 0 0 1 .8 rest\n"
                                         "S 3 4 3 2 1 0 0 .8\n");
    REQUIRE(scene.enclosure == Enclosure::closed);
    REQUIRE(scene.groups == std::vector<std::string>{"floor", "surface_3"});
    REQUIRE(scene.surfaces[1].group == 0);
    REQUIRE(scene.materials[scene.surfaces[1].material].name == "emissivity 0.8");
    REQUIRE(read(folder, square + "S 1 1 2 3 0 0 0 .9 a\n").enclosure == Enclosure::automatic);
}

TEST_CASE("View3D reader: what changes a meaning is told as a warning", "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    const Scene scene = read(folder,
                             "C emit=1 row=2 maxD=3\n" + square +
                                 "S 1 1 2 3 0 0 0 0 south wall\nS 2 1 3 4 0 0 0 1 b c\n"
                                 "S 3 1 1 2 0 0 0 1 line\nS 4 1 2 3 4 0 0 1 d\n",
                             &diagnostics, {.two_sided_groups = {"b"}});
    REQUIRE(diagnostics.warnings().size() == 6);
    const std::vector<std::vector<std::string>> parts{
        {"room.vs3:1: emit = 1", "`hemi exchange` has them", "form factors are without it"},
        {"room.vs3:1: row = 2 is not used"},
        {"room.vs3:1: the control word \"maxD\" is not known and not used"},
        {"room.vs3:6: emissivity 0 taken as 0.001"},
        {"room.vs3:6: \"wall\" after the name is not used; a name is one word"},
        {"room.vs3:8: 1 surface without area left out"}};
    for (std::size_t k = 0; k < parts.size(); ++k) {
        INFO(k);
        const auto& warnings = diagnostics.warnings();
        REQUIRE(std::any_of(warnings.begin(), warnings.end(), [&](const std::string& warning) {
            return std::all_of(parts[k].begin(), parts[k].end(), [&](const std::string& part) {
                return warning.find(part) != std::string::npos;
            });
        }));
    }
    REQUIRE(scene.surfaces.size() == 3);
    REQUIRE(scene.surfaces[1].two_sided);
    REQUIRE(scene.groups.back() == "d");
}

TEST_CASE("View3D reader: what is wrong is named with its line, its value and what would be right", "[io]") {
    struct Bad {
        std::string text;
        std::vector<std::string> parts;
    };
    const std::vector<Bad> table{
        {"", {"room.vs3: no surfaces; a scene needs at least one"}},
        {square, {"room.vs3: no surfaces"}},
        {"End\n" + square + "S 1 1 2 3 4 0 0 .9 a\n", {"no surfaces"}},
        {"F 3a\n", {":1: F \"3a\"; must be 3"}},
        {"F 2\n", {":1: F \"2\""}},
        {"F\n", {":1: F \"\""}},
        {"Q 1\n", {":1: \"Q\"; a line begins with T, C, F, V, S, O, E or !"}},
        {"V1 0 0 0\n", {":1: \"V1\"; a line begins with"}},
        {"X 1 2\n", {":1: X: coordinate transformations are not supported"}},
        {square + "M 1 1 2 3 4 1 0 .9 a\n", {":5: M: masking surfaces are not supported"}},
        {square + "n 1 1 2 3 4 1 0 .9 a\n", {":5: n: null surfaces are not supported"}},
        {"V 2 0 0 0\n", {":1: vertex number \"2\"; must be 1, the next one"}},
        {"V 4000000000 0 0 0\n", {":1: vertex number \"4000000000\"; must be 1"}},
        {"V 1 0 0\n", {":1: vertex 1: z \"\"; must be a number"}},
        {"V 1 0 0,5 0\n", {":1: vertex 1: y \"0,5\""}},
        {"V 1 nan 0 0\n", {":1: vertex 1: x \"nan\""}},
        {"V 1 0 0 1e400\n", {":1: vertex 1: z \"1e400\""}},
        {"S 1 1 2 3 4 0 0 .9 a\n" + square, {":1: surface 1: vertex 1 of 4 is \"1\"; must be from 1 to 0"}},
        {square + "S 2 1 2 3 4 0 0 .9 a\n", {":5: surface number \"2\"; must be 1"}},
        {square + "S 1 1 2 3 5 0 0 .9 a\n", {":5: surface 1: vertex 4 of 4 is \"5\"", "or 0 for a triangle"}},
        {square + "S 1 0 2 3 4 0 0 .9 a\n", {":5: surface 1: vertex 1 of 4 is \"0\"; must be from 1 to 4"}},
        {square + "S 1 1 -2 3 4 0 0 .9 a\n", {":5: surface 1: vertex 2 of 4 is \"-2\""}},
        {square + "S 1 1 2 3\n", {":5: surface 1: vertex 4 of 4 is \"\""}},
        {square + "S 1 1 2 3 4\n", {":5: surface 1: base \"\"; must be a whole number"}},
        {square + "S 1 1 2 3 4 0 0\n", {":5: surface 1: emissivity \"\""}},
        {square + "S 1 1 2 3 4 0 0 1.5 a\n", {":5: surface 1: emissivity \"1.5\"; must be a number from 0"}},
        {square + "S 1 1 2 3 4 0 0 name .9\n", {":5: surface 1: emissivity \"name\""}},
        {square + "S 1 1 2 3 4 7 0 .9 a\n", {":5: surface 1: base 7; must be the number of another"}},
        {square + "S 1 1 2 3 4 1 0 .9 a\n", {":5: surface 1: base 1; must be the number of another"}},
        {square + "V 5 3 0 0\nS 1 1 2 3 4 0 0 .9 a\nS 2 1 5 3 0 1 0 .9 b\n",
         {":6: surface 1: edges that cross each other, or a hole that does not lie in it"}},
        {square + "S 1 1 2 3 4 0 1 .9 a\n", {":5: surface 1: cmb 1; must be the number of an earlier"}},
        {square + "S 1 1 2 3 0 0 0 .9 a\nS 2 1 3 4 0 0 1 .9 b\nS 3 1 2 4 0 0 2 .9 c\n",
         {":7: surface 3: cmb 2, which is itself combined"}},
        {square + "S 1 1 1 2 2 0 0 .9 a\n", {"room.vs3: the scene has no surfaces"}},
        {square + "S 1 1 2 4 3 0 0 .9 a\n", {":5: surface 1: zero area, since its edges cross"}},
        {square + "S 1 1 2 3 4 0 0 .9 a\nO 1 1 2 3 0\n", {":6: obstruction number \"1\"; must be 2"}},
        {square + "O 1 1 2 3 4\nS 2 1 2 3 4 0 0 .9 a\n", {":6: S after the first O"}},
        {"C encl\n", {":1: encl = \"\"; must be a number"}},
        {"C encl=yes\n", {":1: encl = \"yes\"; must be a number"}},
    };
    const Folder folder;
    for (const Bad& bad : table) {
        INFO(bad.text);
        require_parts(message_of<InputError>([&] { (void)read(folder, bad.text); }), bad.parts);
    }
    require_parts(message_of<InvalidArgument>([&] {
                      (void)read(folder, square + "S 1 1 2 3 4 0 0 .9 floor\n", nullptr,
                                 {.two_sided_groups = {"flor"}});
                  }),
                  {"no group \"flor\" to make two-sided; did you mean \"floor\"?"});
}

TEST_CASE("View3D reader: a file cut anywhere is read as far as it makes sense, or refused", "[io]") {
    const Folder folder;
    for (std::size_t length = 0; length < obstructed.size(); ++length) {
        INFO(length);
        try {
            const Scene scene = read(folder, obstructed.substr(0, length));
            REQUIRE(scene.surfaces.size() <= 3);
        } catch (const InputError& error) {
            require_parts(error.what(), {"room.vs3:"});
        }
    }
}

} // namespace hemi::io_test
