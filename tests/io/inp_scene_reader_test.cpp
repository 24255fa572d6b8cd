#include "hemi/io/scene_reader.hpp"

#include "io_fixtures.hpp"

namespace hemi::io_test {

namespace {

const std::string nodes = "*NODE\n1, 0, 0, 0\n2, 1., 0\n3, 1, 1.0D0,\n4, 0, 1, 0\n5, 2, 0\n6, 2, 1\n";

Scene read(const Folder& folder, const std::string& text, Diagnostics* diagnostics = nullptr) {
    Diagnostics unused;
    return io::read_scene(folder.write("room.inp", text), {}, diagnostics != nullptr ? *diagnostics : unused);
}

std::vector<std::string> groups_of(const Scene& scene) {
    std::vector<std::string> groups;
    for (const Surface& surface : scene.surfaces) {
        groups.push_back(scene.groups[surface.group]);
    }
    return groups;
}

} // namespace

TEST_CASE("Abaqus reader: shells are surfaces in the group of their surface, else of their set", "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    const Scene scene =
        read(folder,
             "*Heading\n** a comment\n*Node, nset=all\n" + nodes.substr(nodes.find('\n') + 1) +
                 "*Element, type=S4R, elset=Floor\n1, 1, 2, 3, 4\n2, 2, 5, 6, 3\n"
                 "*ELEMENT, TYPE=STRI65\n3, 1, 2, 3, 4,\n 5, 6\n*ELEMENT, TYPE=S3\n4, 1, 2, 3\n5, 1, 2, 4\n"
                 "*ELEMENT, TYPE=C3D4\n9, 1, 2, 3, 5\n10, 1, 2, 3,\n6\n*ELSET, ELSET=\"odd ones\"\n3, 4\n"
                 "*SURFACE, NAME=Window, TYPE=ELEMENT\nFLOOR, SNEG\n*STEP\n*STATIC\n1., 1.\n*END STEP\n",
             &diagnostics);
    REQUIRE(groups_of(scene) ==
            std::vector<std::string>{"Window", "Window", "odd ones", "odd ones", "default"});
    CHECK(area_vector(scene.surfaces[0].polygon()).z == -1.0);
    CHECK(area_vector(scene.surfaces[2].polygon()).z == 0.5);
    REQUIRE(diagnostics.warnings().size() == 2);
    require_parts(diagnostics.warnings()[0], {"room.inp:19: 2 elements of type \"C3D4\" left out"});
    require_parts(diagnostics.warnings()[1], {"1 element of second order taken as plane"});
}

TEST_CASE("Abaqus reader: parts are placed by their instances, with sets and surfaces of the assembly",
          "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    const Scene scene = read(
        folder,
        "*PART, NAME=plate\n" + nodes +
            "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n2, 2, 5, 6, 3\n*ELSET, ELSET=both, GENERATE\n1, 2\n*END PART\n"
            "*ASSEMBLY, NAME=a\n*INSTANCE, NAME=low, PART=Plate\n*END INSTANCE\n*INSTANCE, NAME=high, "
            "PART=plate\n"
            "0, 0, 3\n0, 0, 3, 0, 1, 3, 180\n*END INSTANCE\n*ELSET, ELSET=lamp, INSTANCE=high\n2,\n"
            "*SURFACE, NAME=shine\nlamp, SPOS\n*END ASSEMBLY\n",
        &diagnostics);
    CHECK(diagnostics.warnings().empty());
    REQUIRE(groups_of(scene) == std::vector<std::string>{"both", "both", "both", "shine"});
    CHECK(area_vector(scene.surfaces[1].polygon()).z == 1.0);
    CHECK(area_vector(scene.surfaces[3].polygon()).z == Approx(-1.0));
    const Vec3 corner = scene.surfaces[3].vertices[1]; // (2, 0, 0), turned round to the other side
    CHECK(glm::distance(corner, Vec3(-2, 0, 3)) < 1e-15);
}

TEST_CASE("Abaqus reader: what is wrong is named with its line, its value and what would be right", "[io]") {
    struct Bad {
        std::string text;
        std::vector<std::string> parts;
    };
    const std::string quad = "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n";
    const std::vector<Bad> table{
        {"", {"room.inp: no faces; a scene needs at least one (shell elements)"}},
        {nodes, {"room.inp: no faces"}},
        {"1, 2, 3\n", {":1: \"1, 2, 3\"; an Abaqus file begins with a keyword"}},
        {"*NODE\nx, 0, 0, 0\n", {":2: node \"x\"; must be a whole number"}},
        {"*NODE\n1, 0, nan, 0\n", {":2: \"nan\"; must be a finite number"}},
        {"*NODE\n1, 0\n1, 1\n", {":3: node 1 is there twice"}},
        {"*NODE, SYSTEM=C\n", {":1: nodes in the system \"C\"; must be R, rectangular"}},
        {"*SYSTEM\n", {":1: *SYSTEM is not supported"}},
        {"*INCLUDE, INPUT=a.inp\n", {":1: *INCLUDE is not supported"}},
        {"*ELEMENT\n", {":1: *ELEMENT without TYPE="}},
        {nodes + "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 7\n",
         {":9: element 1: node \"7\"; must be the number of one of the 6"}},
        {nodes + "*ELEMENT, TYPE=S4\n1, 1, 2, 3\n", {":9: element 1 with 3 nodes; a S4 has 4"}},
        {nodes + "*ELEMENT, TYPE=S3\n1, 1, 2, 3, 4\n", {":9: \"4\" after the nodes; a S3 has 3"}},
        {nodes + quad + "1, 2, 5, 6, 3\n", {":10: element 1 is there twice"}},
        {nodes + quad + "*ELSET\n1\n", {":10: *ELSET without ELSET="}},
        {nodes + quad + "*ELSET, ELSET=a, GENERATE\n1, 2, 0\n", {":11: elements 1 to 2 by 0; must ascend"}},
        {nodes + quad + "*ELSET, ELSET=a, GENERATE\n1, 4000000000\n", {":11: elements 1 to 4000000000 by 1"}},
        {"*INSTANCE, NAME=a, PART=b\n", {":1: part \"b\"; there is no *PART of that name"}},
        {"*PART, NAME=b\n*INSTANCE, NAME=a, PART=b\n0\n1, 1, 1, 1, 1, 1, 3\n",
         {":4: the two points of the axis"}},
        {"*ELSET, ELSET=a, ELSET\n*PART\n", {"*ELSET without ELSET="}},
        {"*PART, NAME=b\n*INSTANCE, NAME=a, PART=b\n*INSTANCE, NAME=A, PART=b\n",
         {":3: instance \"A\" is there twice"}},
    };
    const Folder folder;
    REQUIRE_NOTHROW(read(folder, nodes + quad));
    for (const Bad& bad : table) {
        INFO(bad.text);
        require_parts(message_of<InputError>([&] { read(folder, bad.text); }), bad.parts);
    }
}

TEST_CASE("Abaqus reader: sets of sets that grow without end are refused", "[io]") {
    const Folder folder;
    std::string text = nodes + "*ELEMENT, TYPE=S4, ELSET=s0\n1, 1, 2, 3, 4\n";
    for (int k = 0; k < 40; ++k) {
        text += "*ELSET, ELSET=s" + std::to_string(k + 1) + "\ns" + std::to_string(k) + ", s" +
                std::to_string(k) + ", s" + std::to_string(k) + ", s" + std::to_string(k) + "\n";
    }
    require_parts(message_of<ParseError>([&] { read(folder, text); }), {"elements in sets"});
}

TEST_CASE(
    "Abaqus reader: parts placed again and again are refused, a set named again in a surface counts once",
    "[io]") {
    const Folder folder;
    std::string part = nodes + "*ELEMENT, TYPE=S4, ELSET=all\n";
    for (int k = 1; k <= 2'100; ++k) {
        part += std::to_string(k) + ", 1, 2, 3, 4\n";
    }
    std::string surface = part + "*SURFACE, NAME=shine\n";
    std::string placed = "*PART, NAME=p\n" + part + "*END PART\n";
    for (int k = 0; k < 10'000; ++k) {
        surface += "all, SPOS\n";
        placed += "*INSTANCE, NAME=i" + std::to_string(k) + ", PART=p\n";
    }
    CHECK(read(folder, surface).groups == std::vector<std::string>{"shine"});
    require_parts(message_of<ParseError>([&] { read(folder, placed); }),
                  {"more than 10000000 elements and instances in all"});
}

} // namespace hemi::io_test
