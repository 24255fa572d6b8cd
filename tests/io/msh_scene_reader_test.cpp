#include "hemi/io/scene_reader.hpp"

#include "io_fixtures.hpp"

#include <numeric>

namespace hemi::io_test {

namespace {

const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string nodes = "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0.5 0.5 1e-1\n$EndNodes\n";

std::string elements(const std::vector<std::string>& lines) {
    std::string text = "$Elements\n" + std::to_string(lines.size()) + "\n";
    for (const std::string& line : lines) {
        text += line + "\n";
    }
    return text + "$EndElements\n";
}

Scene read(const Folder& folder, const std::string& text, Diagnostics* diagnostics = nullptr,
           const io::SceneReaderOptions& options = {}) {
    Diagnostics unused;
    return io::read_scene(folder.write("room.msh", text), options,
                          diagnostics != nullptr ? *diagnostics : unused);
}

} // namespace

TEST_CASE("Gmsh reader: triangles and quadrilaterals are surfaces in the file's order, in the group of their "
          "physical surface",
          "[io]") {
    const Folder folder;
    const Scene scene =
        read(folder, head + "$PhysicalNames\n3\n1 7 \"edge\"\n2 7 \"floor of \"it\"\"\n3 8 \"air\"\n" +
                         "$EndPhysicalNames\n" + nodes +
                         elements({"1 2 2 7 1 1 2 5", "2 3 2 8 1 1 2 3 4", "3 2 3 7 2 0 2 3 5",
                                   "4 2 2 0 6 3 4 5", "5 2 0 4 1 5"}));
    REQUIRE(scene.name == "room");
    REQUIRE(scene.groups ==
            std::vector<std::string>{"floor of \"it\"", "physical_8", "surface_6", "default"});
    std::vector<std::uint32_t> groups;
    for (const Surface& surface : scene.surfaces) {
        groups.push_back(surface.group);
    }
    REQUIRE(groups == std::vector<std::uint32_t>{0, 1, 0, 2, 3});
    REQUIRE(scene.surfaces[1].vertex_count == 4);
    REQUIRE(scene.surfaces[1].vertices[2] == Vec3(1, 1, 0));
    REQUIRE(scene.surfaces[0].vertices[2] == Vec3(0.5, 0.5, 0.1));
    REQUIRE(scene.materials[1] == Material{"physical_8", {0.5}, {0.0}});
    REQUIRE(scene.surfaces[2].material == 0);
}

TEST_CASE("Gmsh reader: node numbers may be any, in any order", "[io]") {
    const Folder folder;
    for (const std::string numbers : {"3 2 1", "1 3 2", "18446744073709551615 7 1000000"}) {
        INFO(numbers);
        const std::size_t first = numbers.find(' ');
        const std::size_t second = numbers.find(' ', first + 1);
        const Scene scene = read(folder, head + "$Nodes\n3\n" + numbers.substr(0, first) + " 0 0 0\n" +
                                             numbers.substr(first + 1, second - first - 1) + " 1 0 0\n" +
                                             numbers.substr(second + 1) + " 0 1 0\n$EndNodes\n" +
                                             elements({"1 2 2 1 1 " + numbers}));
        REQUIRE(scene.surfaces[0].vertices[1] == Vec3(1, 0, 0));
        REQUIRE(scene.surfaces[0].vertices[2] == Vec3(0, 1, 0));
    }
}

TEST_CASE("Gmsh reader: points, lines, volumes and other sections are left out with one warning each",
          "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    const Scene scene = read(folder,
                             head + "$Comments\n$x\n$EndComments\n" + nodes +
                                 elements({"1 15 2 1 1 1", "2 1 2 1 1 1 2", "3 1 2 1 1 2 3",
                                           "4 4 2 1 1 1 2 3 5", "5 2 2 1 1 1 2 3"}) +
                                 "$NodeData\n1\n\"T\"\n$EndNodeData\n",
                             &diagnostics);
    REQUIRE(scene.surfaces.size() == 1);
    REQUIRE(diagnostics.warnings().size() == 4);
    require_parts(diagnostics.warnings()[0], {"room.msh:23: the section \"$NodeData\" is not used"});
    require_parts(diagnostics.warnings()[1], {"room.msh:17: 1 point left out, the first one here"});
    require_parts(diagnostics.warnings()[2], {"room.msh:18: 2 lines left out"});
    require_parts(diagnostics.warnings()[3], {"room.msh:20: 1 volume element left out"});
}

TEST_CASE("Gmsh reader: blank lines and line ends of CR LF do not matter, faces without area are left out",
          "[io]") {
    const Folder folder;
    std::string text = "\r\n";
    for (const char c : head + nodes + elements({"1 2 2 1 1 1 2 3", "", "2 2 2 1 1 1 2 2"})) {
        text += c == '\n' ? "\r\n" : std::string(1, c);
    }
    text.replace(text.find("$Elements\r\n3"), 12, "$Elements\r\n2");
    require_parts(message_of<ParseError>([&] { read(folder, text, nullptr, {.strict = true}); }),
                  {"room.msh:17: face: zero area"});
    Diagnostics diagnostics;
    REQUIRE(read(folder, text, &diagnostics, {.two_sided_groups = {"physical_1"}}).surfaces.size() == 1);
    require_parts(diagnostics.warnings().at(0), {"room.msh:17: 1 face without area left out"});
}

TEST_CASE("Gmsh reader: in a JSON scene, materials of the physical surfaces' names are theirs", "[io]") {
    const Folder folder;
    folder.write("room.msh", head + "$PhysicalNames\n2\n2 1 \"walls\"\n2 2 \"lamp\"\n$EndPhysicalNames\n" +
                                 nodes + elements({"1 2 2 1 1 1 2 3", "2 2 2 2 1 1 3 4", "3 2 2 3 1 3 4 5"}));
    Diagnostics diagnostics;
    const Scene scene = io::read_scene(
        folder.write("room.json", R"({"hemi": 1, "materials": {"lamp": {"reflectance": 0, "exitance": 2}},
                                      "surfaces": [{"mesh": "room.msh", "patches": 2}]})"),
        {}, diagnostics);
    REQUIRE(diagnostics.warnings().empty());
    REQUIRE(scene.groups == std::vector<std::string>{"walls", "lamp", "physical_3"});
    REQUIRE(scene.materials[scene.surfaces[0].material] == Material{"walls", {0.5}, {0.0}});
    REQUIRE(scene.materials[scene.surfaces[1].material] == Material{"lamp", {0.0}, {2.0}});
    REQUIRE(scene.surfaces[2].patches == Grid{2, 2});
}

TEST_CASE("Gmsh reader: what is wrong is named with its line, its value and what would be right", "[io]") {
    struct Bad {
        std::string text;
        std::vector<std::string> parts;
    };
    const std::string good = elements({"1 2 2 1 1 1 2 3"});
    const std::vector<Bad> table{
        {"", {"room.msh:1: \"\"; a Gmsh file begins with $MeshFormat"}},
        {"solid x\n", {":1: \"solid x\"; a Gmsh file begins with"}},
        {"$NOD\n", {":1: MSH version 1; must be 4.1 or 2.2"}},
        {"$MeshFormat\n", {":1: cut short: the end of $MeshFormat is missing"}},
        {"$MeshFormat\n4.1 0 8\n", {":2: cut short: the end of $MeshFormat is missing"}},
        {"$MeshFormat\n4 0 8\n", {":2: MSH version \"4\"; must be 4.1 or 2.2 (gmsh -format msh41)"}},
        {"$MeshFormat\n2.2 1 8\n", {"room.msh: byte 20: no integer 1, by which a binary file"}},
        {"$MeshFormat\n2.2 1 4\n", {":2: data size \"4\"; must be 8"}},
        {"$MeshFormat\n2.2 2 8\n", {":2: file type \"2\"; must be 0 (ASCII) or 1 (binary)"}},
        {"$MeshFormat\n2.2 0 8\n$Nodes\n", {":3: \"$Nodes\"; must be $EndMeshFormat"}},
        {head, {"room.msh: no $Elements section"}},
        {head + "1 2 3\n", {":4: \"1 2 3\" between sections"}},
        {head + "$EndNodes\n", {":4: \"$EndNodes\" between sections"}},
        {head + "$ParametricNodes\n", {":4: cut short: the end of $ParametricNodes is missing"}},
        {head + "$Whatever\n1\n", {":5: cut short: the end of $Whatever is missing"}},
        {head + "$Nodes\nx\n", {":5: \"x\" in $Nodes; must be the number of its lines"}},
        {head + "$Nodes\n-1\n", {":5: \"-1\" in $Nodes"}},
        {head + "$Nodes\n99999999999999999999\n", {":5: \"99999999999999999999\" in $Nodes"}},
        {head + "$Nodes\n1000000000000\n",
         {":5: 1000000000000 lines in $Nodes of a file of 56 bytes; that cannot be"}},
        {head + "$Nodes\n2\n1 0 0 0\n", {":6: cut short: the end of $Nodes is missing"}},
        {head + "$Nodes\n1\n1 0 0 0\n2 0 0 0\n$EndNodes\n", {":7: \"2 0 0 0\"; must be $EndNodes"}},
        {head + "$Nodes\n1\na 0 0 0\n$EndNodes\n", {":6: node number \"a\""}},
        {head + "$Nodes\n1\n1 0 0\n$EndNodes\n", {":6: node 1: z \"\"; must be a finite number"}},
        {head + "$Nodes\n1\n1 0 nan 0\n$EndNodes\n", {":6: node 1: y \"nan\""}},
        {head + "$Nodes\n1\n1 0 0,5 0\n$EndNodes\n", {":6: node 1: y \"0,5\""}},
        {head + "$Nodes\n1\n1 0 0 0 0\n$EndNodes\n", {":6: \"0\" after the coordinates"}},
        {head + "$Nodes\n2\n1 0 0 0\n1 1 0 0\n$EndNodes\n", {":7: node 1 is there twice"}},
        {head + nodes + nodes, {":12: a second section of nodes"}},
        {head + nodes + good + good, {":16: a second $Elements section"}},
        {head + good + nodes, {":6: node \"1\"; must be the number of one of the 0 nodes"}},
        {head + nodes + "$Elements\n123456789\n", {":13: 123456789 lines in $Elements of a file of"}},
        {head + nodes + elements({"1 2"}), {":14: \"1 2\"; an element is its number, type, number of tags"}},
        {head + nodes + elements({"1 2 -1 1 2 3"}), {":14: \"1 2 -1 1 2 3\"; an element is"}},
        {head + nodes + elements({"1 77 2 1 1 1 2 3"}), {":14: element 1: type 77 is not supported"}},
        {head + nodes + elements({"1 16 2 1 1 1 2 3 4 5 1 2"}), {":14: node \"\""}},
        {head + nodes + elements({"1 2 3 1 1"}), {":14: element 1: tag 3 of 3 is \"\""}},
        {head + nodes + elements({"1 2 4000000000 1 1 1 2 3"}), {":14: element 1: tag 6 of 4000000000"}},
        {head + nodes + elements({"1 2 2 1 1 1 2"}), {":14: node \"\"; must be the number of one of the 5"}},
        {head + nodes + elements({"1 2 2 1 1 0 1 2"}), {":14: node \"0\""}},
        {head + nodes + elements({"1 2 2 1 1 1 2 6"}), {":14: node \"6\""}},
        {head + nodes + elements({"1 2 2 1 1 1 2 3 4"}), {":14: \"4\" after the nodes"}},
        {head + nodes + elements({"1 3 2 1 1 1 3 2 4"}), {":14: face: "}},
        {head + nodes + elements({"1 15 2 1 1 1"}), {"room.msh: no faces; a scene needs at least one"}},
        {head + nodes + elements({"1 2 2 1 1 1 2 3", "2 2 2 2 1 2 3 4", "3 2 2 2 1 2 3 1"}),
         {":16: the face of line 14 again; a face must be in one physical surface"}},
        {head + nodes + "$Elements\n1\n1 2 2 1 1 1 2 3\n", {":14: cut short: the end of $Elements"}},
        {head + "$PhysicalNames\n1\n2 1 walls\n$EndPhysicalNames\n",
         {":6: \"2 1 walls\"; must be dimension"}},
        {head + "$PhysicalNames\n1\n4 1 \"a\"\n$EndPhysicalNames\n", {":6: \"4 1 "}},
        {head + "$PhysicalNames\n1\n2 1 \"\"\n$EndPhysicalNames\n",
         {":6: physical surface 1 has an empty name"}},
        {head + "$PhysicalNames\n2\n2 1 \"a\"\n2 1 \"b\"\n$EndPhysicalNames\n",
         {":7: physical surface 1 is named twice"}},
        {head + nodes + good + "$PhysicalNames\n0\n", {":16: $PhysicalNames after $Elements"}},
    };
    const Folder folder;
    REQUIRE_NOTHROW(read(folder, head + nodes + good));
    for (const Bad& bad : table) {
        INFO(bad.text);
        require_parts(message_of<InputError>([&] { read(folder, bad.text); }), bad.parts);
    }
}

TEST_CASE("Gmsh reader: a file cut anywhere, and with any byte changed, is read or refused by name", "[io]") {
    const Folder folder;
    const std::string text = head + "$PhysicalNames\n1\n2 1 \"a\"\n$EndPhysicalNames\n" + nodes +
                             elements({"1 2 2 1 1 1 2 3", "2 3 2 1 1 1 2 3 4", "3 15 2 1 1 5"});
    for (std::size_t at = 0; at < text.size(); ++at) {
        for (const std::string& bad : {text.substr(0, at), text.substr(0, at) + "\377" + text.substr(at + 1),
                                       text.substr(0, at) + "9" + text.substr(at + 1),
                                       text.substr(0, at) + "\n" + text.substr(at + 1)}) {
            try {
                (void)read(folder, bad);
            } catch (const InputError& error) {
                require_parts(error.what(), {"room.msh"});
            }
        }
    }
}

} // namespace hemi::io_test
