#include "hemi/io/scene_reader.hpp"

#include "io_fixtures.hpp"

namespace hemi::io_test {

namespace {

const std::string square = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\n";

Scene read(const Folder& folder, const std::string& text, Diagnostics* diagnostics = nullptr) {
    Diagnostics unused;
    return io::read_scene(folder.write("room.bdf", text), {}, diagnostics != nullptr ? *diagnostics : unused);
}

/// A line of fields of one width, each at the right of its own.
std::string line(const std::string& name, std::size_t width, const std::vector<std::string>& fields) {
    std::string text = name + std::string(8 - name.size(), ' ');
    for (const std::string& field : fields) {
        text += std::string(width - std::min(width, field.size()), ' ') + field;
    }
    return text + "\n";
}

std::vector<std::string> groups_of(const Scene& scene) {
    std::vector<std::string> groups;
    for (const Surface& surface : scene.surfaces) {
        groups.push_back(scene.groups[surface.group]);
    }
    return groups;
}

} // namespace

TEST_CASE("Nastran reader: small, large and free fields say the same, numbers with and without an E",
          "[io]") {
    const std::array<Vec3, 4> expected{Vec3(0, 0, 1.5e-3), Vec3(1, 0, 1.5e-3), Vec3(1, 10, 1.5e-3),
                                       Vec3(-0.5, 10, 1.5e-3)};
    const std::string small = line("GRID", 8, {"1", "", "0.", "0.", "1.5-3", "0"}) +
                              line("GRID", 8, {"2     ", "", "1.0   ", "0.0", ".0015"}) +
                              line("GRID", 8, {"3", "0", "1.+0", "1.+1", "1.5E-3 $ the third"}) +
                              line("GRID", 8, {"4", "", "-.5", "10.", "1.5d-03"}) +
                              line("CQUAD4", 8, {"10", "7", "1", "2", "3", "4", ".1"});
    const std::string large = line("GRID*", 16, {"1", "", "0.", "0."}) + line("*", 16, {"1.5-03"}) +
                              line("GRID*", 16, {"2      ", "", "1.", "0."}) + line("*", 16, {"0.0015"}) +
                              line("GRID*", 16, {"3", "0", "1.0", "1.0+1"}) + line("*", 16, {"1.5D-3"}) +
                              line("GRID*", 16, {"4", "", "-.5", "10."}).substr(0, 72) + "*GR4\n" +
                              line("*GR4", 16, {"1.5E-03"}) + line("CQUAD4*", 16, {"10", "7", "1", "2"}) +
                              line("*", 16, {"3", "4"});
    const std::string free_fields =
        "grid,1,,0.,0.,1.5-3\nGRID , 2, , 1. , 0. , +1.5-3\nGRID*,3,,1.,10.,*\n*,0.0015\n"
        "GRID,4,0,-5.-1,1.+1,15.-4\nCQUAD4,10,7,1,2,3,4\n";
    const std::string tabs =
        "GRID\t1\t\t0.\t0.\t1.5-3\nGRID\t2\t0\t1.\t0.\t1.5-3\nGRID\t3\t\t1.\t10.\t1.5-3\n"
        "GRID\t4\t\t-.5\t10.\t1.5-3\nCQUAD4\t10\t7\t1\t2\t3\t4\n";
    const Folder folder;
    for (const std::string& text : {small, large, free_fields, tabs}) {
        INFO(text);
        const Scene scene = read(folder, text);
        REQUIRE(scene.surfaces.size() == 1);
        CHECK(scene.surfaces[0].vertices == expected);
        CHECK(scene.groups == std::vector<std::string>{"PID 7"});
    }
}

TEST_CASE("Nastran reader: shells are surfaces in the group of their property, others are left out", "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    const Scene scene =
        read(folder,
             "SOL 101\nCEND\nTITLE = a, b\nBEGIN BULK\n$ shells\nCQUAD4,1,20,1,2,3,4\n"
             "PSHELL,20,1,.1\nMAT1,1,2.1+5,,.3\nCTRIA3,2,3,1,2,3\nCTRIAR,3,,1,2,4\n" +
                 square +
                 "CQUADR,4,3,4,3,2,1\n"
                 "CQUAD8         5       3       1       2       3       4       1       2+E\n"
                 "+E             3       4\n"
                 "CTRIA6,6,20,1,2,3,,,\n+,,,\nCTETRA,7,1,1,2,3,4\nCTETRA,8,1,1,2,3,4,+X\n"
                 "+X,1,2,3\nCORD2R,1,,1,2,3\nENDDATA\nCQUAD4,1,20,1,2,3,4\nnonsense\n",
             &diagnostics);
    CHECK(groups_of(scene) ==
          std::vector<std::string>{"PID 20", "PID 3", "PID 3", "PID 3", "PID 3", "PID 20"});
    CHECK(area_vector(scene.surfaces[0].polygon()).z == 1.0);
    CHECK(area_vector(scene.surfaces[3].polygon()).z == -1.0);
    CHECK(scene.surfaces[4].vertex_count == 4);
    CHECK(scene.surfaces[5].vertex_count == 3);
    CHECK(scene.materials == std::vector<Material>{{"default", {0.5}, {0.0}}});
    REQUIRE(diagnostics.warnings().size() == 2);
    require_parts(diagnostics.warnings()[0], {"room.bdf:20: 2 elements CTETRA left out, the first one here"});
    require_parts(diagnostics.warnings()[1], {"2 elements of second order taken as plane"});
    folder.write("other.nas", square + "CTRIA3,1,,1,2,3\n");
    CHECK(io::read_scene(folder / "other.nas").groups == std::vector<std::string>{"PID 1"});
}

TEST_CASE("Nastran reader: what is wrong is named with its line, its value and what would be right", "[io]") {
    struct Bad {
        std::string text;
        std::vector<std::string> parts;
    };
    const std::vector<Bad> table{
        {"", {"room.bdf: no faces; a scene needs at least one (shell elements)"}},
        {"BEGIN BULK\nENDDATA\n", {"room.bdf: no faces"}},
        {square + "CQUAD4,1,1,1,2,3,9\n",
         {":5: element 1: node 9; must be the number of one of the 4 GRIDs"}},
        {square + "CQUAD4,1,1,1,2,3\n", {":5: CQUAD4: node \"\"; must be a whole number above 0"}},
        {square + "CTRIA3,x,1,1,2,3\n", {":5: CTRIA3: element \"x\"; must be a whole number above 0"}},
        {square + "CTRIA3,1,-1,1,2,3\n", {":5: CTRIA3: property \"-1\"; must be"}},
        {square + "CTRIA3,1,1,1,2,3\nCTRIA3,1,1,1,2,4\n", {":6: element 1 is in line 5, too"}},
        {square + "GRID,1,,0.,0.,1.\n", {":5: node 1 is in line 1, too, in another place"}},
        {"GRID,1,,0.,abc,0.\n", {":1: GRID: \"abc\"; must be a finite number"}},
        {"GRID,1,,0.,1.+400,0.\n", {":1: GRID: \"1.+400\"; must be a finite number"}},
        {"GRID,1,,0.,1.+1.+1.+1.+1.+1.+1.+1.+1.+1.+1.+1.+,0.\n", {":1: GRID: \"1.+1.+"}},
        {"GRID,1,,0.,nan,0.\n", {":1: GRID: \"nan\"; must be a finite number"}},
        {"GRID,0,,0.,0.,0.\n", {":1: GRID: node \"0\"; must be a whole number above 0"}},
        {"GRID,1,3,0.,0.,0.\n", {":1: GRID in the coordinate system \"3\" (CP); must be 0"}},
        {"GRDSET,,6\n", {":1: GRDSET in the coordinate system \"6\" (CP); must be 0"}},
        {"INCLUDE 'a.bdf'\n", {":1: INCLUDE is not supported; put the file's contents here"}},
        {"+A,1\n", {":1: \"+A,1\" goes on from no line"}},
        {square + "CQUAD4,1,1,1,2,,,,,+A\n+B,3,4\n", {":6: goes on as \"+B\", the line before as \"+A\""}},
        {"GRID,1,,0.,0.,0.,0,0,0,+A,7\n", {":1: \"7\" after 8 fields"}},
    };
    const Folder folder;
    REQUIRE_NOTHROW(read(folder, square + "CQUAD4,1,1,1,2,3,4\nGRID,1,,0.,0.,0.\n"));
    for (const Bad& bad : table) {
        INFO(bad.text);
        require_parts(message_of<InputError>([&] { read(folder, bad.text); }), bad.parts);
    }
}

TEST_CASE("Nastran reader: a file cut anywhere is read or refused", "[io]") {
    const Folder folder;
    const std::string whole = "BEGIN BULK\n" + line("GRID*", 16, {"1", "", "0.", "0."}) +
                              line("*", 16, {"0.-3"}) + square.substr(square.find('\n') + 1) +
                              "CQUAD4,1,2,1,2,3,4\nCTRIA3,2,2,2,3,4\nENDDATA\n";
    std::size_t sound = 0;
    for (std::size_t length = 0; length < whole.size(); ++length) {
        INFO(length);
        try {
            sound += read(folder, whole.substr(0, length)).surfaces.size() > 0 ? 1 : 0;
        } catch (const InputError& error) {
            require_parts(error.what(), {"room.bdf"});
        }
    }
    CHECK(sound > 8);
    CHECK(sound < 40);
}

} // namespace hemi::io_test
