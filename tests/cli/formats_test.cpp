#include "cli/program.hpp"
#include "support/command.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <string>

using namespace hemi::cli_test;

namespace {

/// The cube of View3D's manual.
const std::string view3d_cube = "T A simple cube\nC encl=1 list=3\nF 3\n"
                                "V 1 0. 0. 0.\nV 2 1. 0. 0.\nV 3 1. 1. 0.\nV 4 0. 1. 0.\n"
                                "V 5 0. 0. 1.\nV 6 1. 0. 1.\nV 7 1. 1. 1.\nV 8 0. 1. 1.\n"
                                "S 1 1 2 3 4 0 0 0.50 zeq0\nS 2 1 4 8 5 0 0 0.50 xeq0\n"
                                "S 3 1 5 6 2 0 0 0.50 yeq0\nS 4 7 6 5 8 0 0 0.50 zeq1\n"
                                "S 5 7 3 2 6 0 0 0.50 xeq1\nS 6 7 8 4 3 0 0 0.50 yeq1\nEnd of data\n";

} // namespace

TEST_CASE("View3D input: the manual's cube gives the manual's factors", "[cli]") {
    const Directory directory;
    const std::string path = directory.write("cube.vs3", view3d_cube);
    const Outcome run = run_hemi(
        quick({"factors", path, "--by-group", "--json", "--patches-per-face", "64", "--preset", "default"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json json = run.json();
    CHECK(json["groups"] == Json({"zeq0", "xeq0", "yeq0", "zeq1", "xeq1", "yeq1"}));
    CHECK(json["factors"][0][3].get<double>() == Approx(0.199825).margin(1e-6));
    CHECK(json["factors"][0][1].get<double>() == Approx(0.200044).margin(1e-6));
    CHECK(run_hemi({"info", path, "--json"}).json()["enclosure"] == "closed");
}

TEST_CASE("View3D input: what an obstruction hides arrives there, and the rest balances", "[cli]") {
    const Directory directory;
    const std::string path = directory.write(
        "obstructed.vs3", "C encl=0\nF 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\nV 5 0 0 1\nV 6 1 0 1\n"
                          "V 7 1 1 1\nV 8 0 1 1\nV 9 -9 -9 .5\nV 10 9 -9 .5\nV 11 9 9 .5\nV 12 -9 9 .5\n"
                          "S 1 1 2 3 4 0 0 .5 low\nS 2 8 7 6 5 0 0 .5 high\nO 3 9 10 11 12\n");
    const Json json = run_hemi(quick({"factors", path, "--by-group", "--json"})).json();
    CHECK(json["groups"] == Json({"low", "high", "obstruction"}));
    CHECK(json["factors"][0][1] == 0.0);
    CHECK(json["factors"][0][2].get<double>() > 0.99);
    CHECK(json["factors"][1][2].get<double>() > 0.99);
    CHECK(json["blocked"] == Json({0.0, 0.0, 0.0}));
}

TEST_CASE("EnergyPlus input: view factors of a zone by the names of its surfaces and windows", "[cli]") {
    const Directory directory;
    Json model = Json::parse(R"({"GlobalGeometryRules": {"R": {"vertex_entry_direction": "Counterclockwise",
        "coordinate_system": "World"}}, "Zone": {"Cube": {}, "Other": {}}, "FenestrationSurface:Detailed": {"Pane": {
        "building_surface_name": "x1", "vertex_1_x_coordinate": 1, "vertex_1_y_coordinate": 0.25,
        "vertex_1_z_coordinate": 0.5, "vertex_2_x_coordinate": 1, "vertex_2_y_coordinate": 0.75,
        "vertex_2_z_coordinate": 0.5, "vertex_3_x_coordinate": 1, "vertex_3_y_coordinate": 0.75,
        "vertex_3_z_coordinate": 0.8}}})");
    for (int axis = 0; axis < 3; ++axis) {
        for (const int end : {0, 1}) {
            Json polygon = Json::array();
            for (int k = 0; k < 4; ++k) {
                std::array<double, 3> point{};
                const std::size_t a = static_cast<std::size_t>(axis);
                point[a] = end;
                point[(a + 1) % 3] = (end == 1 ? k == 1 || k == 2 : k >= 2) ? 1 : 0;
                point[(a + 2) % 3] = (end == 1 ? k >= 2 : k == 1 || k == 2) ? 1 : 0;
                polygon.push_back({{"vertex_x_coordinate", point[0]},
                                   {"vertex_y_coordinate", point[1]},
                                   {"vertex_z_coordinate", point[2]}});
            }
            const std::string name{"xyz"[axis], static_cast<char>('0' + end)};
            model["BuildingSurface:Detailed"][name] = {{"zone_name", "cube"}, {"vertices", polygon}};
        }
    }
    const std::string path = directory.write("model.epJSON", model);
    const std::string idf = directory.path("factors.idf");
    const Outcome run = run_hemi(quick(
        {"factors", path, "--zone", "CUBE", "-o", idf, "--patches-per-face", "64", "--preset", "default"}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    std::istringstream text(directory.read("factors.idf"));
    std::map<std::string, std::map<std::string, double>> factors;
    for (std::string line; std::getline(text, line);) {
        const std::size_t comma = line.find(',');
        const std::size_t second = line.find(',', comma + 1);
        if (line.starts_with("  ") && second != std::string::npos && line.find('!') == std::string::npos) {
            factors[line.substr(2, comma - 2)][line.substr(comma + 1, second - comma - 1)] =
                std::stod(line.substr(second + 1));
        }
    }
    CHECK(directory.read("factors.idf").find("BySurfaceName,\n  Cube,  !- Zone Name\n") != std::string::npos);
    REQUIRE(factors.size() == 7);
    for (const auto& [from, row] : factors) {
        INFO(from);
        REQUIRE(row.size() == 7);
        double sum = 0.0;
        for (const auto& [to, factor] : row) {
            sum += factor;
        }
        CHECK(sum == Approx(1.0).margin(1e-6));
        CHECK(row.at(from) == 0.0);
    }
    CHECK(factors["x0"]["x1"] + factors["x0"]["Pane"] == Approx(0.199825).margin(1e-5));
    CHECK(factors["z0"]["x1"] + factors["z0"]["Pane"] == Approx(0.200044).margin(1e-5));
    CHECK(factors["Pane"]["z0"] * 0.075 == Approx(factors["z0"]["Pane"]).margin(1e-6));
    const Outcome several = run_hemi({"info", path});
    CHECK(several.status == 2);
    CHECK(several.err_has("2 zones; one must be chosen (--zone NAME); there is Cube, Other"));
}

TEST_CASE("Bad input in an exchange format: exit status 3, with the file and the line", "[cli]") {
    const Directory directory;
    const std::string vs3 = directory.write("bad.vs3", "F 3\nV 1 0 0\n");
    const std::string glb =
        directory.write("bad.glb", std::string("glTF\2\0\0\0\377\377\377\377", 12) + std::string(20, ' '));
    const Outcome claim = run_hemi({"info", glb});
    CHECK(claim.status == 3);
    CHECK(claim.err_has("bad.glb: cut short: 32 bytes; its header says 4294967295"));
    for (const char* command : {"info", "factors", "check", "solve"}) {
        const Outcome run = run_hemi({command, vs3});
        INFO(command << ": " << run.err);
        CHECK(run.status == 3);
        CHECK(run.err_has("bad.vs3:2: vertex 1: z \"\"; must be a number"));
    }
}

TEST_CASE("View3D output: from a scene with its emissivities, from a .hff with a note", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.vs3", view3d_cube);
    REQUIRE(run_hemi(quick({"factors", scene, "-o", directory.path("F.txt")})).status == 0);
    const std::string text = directory.read("F.txt");
    CHECK(text.ends_with("\n0.5 0.5 0.5 0.5 0.5 0.5\n"));
    CHECK(std::count(text.begin(), text.end(), '\n') == 9);

    REQUIRE(run_hemi(quick({"factors", scene, "-o", directory.path("F.hff")})).status == 0);
    const Outcome convert = run_hemi({"convert", directory.path("F.hff"), directory.path("F.vf")});
    REQUIRE(convert.status == 0);
    CHECK(convert.err_has("emissivities are written as 0.999"));
    CHECK(directory.read("F.vf").size() == 32 + 4 * (6 + 36 + 6));
    REQUIRE(run_hemi({"convert", directory.path("F.hff"), directory.path("F.npz")}).status == 0);
    const Outcome bare = run_hemi({"convert", directory.path("F.npz"), directory.path("G.txt")});
    CHECK(bare.status == 2);
    CHECK(bare.err_has(".txt files hold areas, which"));
}

TEST_CASE("VTP: a solution with rows of F, and form factors of a scene", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    const std::string hres = directory.path("cube.hres");
    const std::string hff = directory.path("cube.hff");
    REQUIRE(run_hemi(quick({"solve", scene, "--result", hres, "--factors", hff})).status == 0);
    const std::string vtp = directory.path("cube.vtp");
    const Outcome run =
        run_hemi({"convert", hres, vtp, "--factors", hff, "--row", "0", "--row", "23", "--json"});
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json arrays = run.json()["arrays"];
    for (const char* name :
         {"radiosity", "irradiance", "exitance", "reflectance", "row_sum", "environment", "emissivity",
          "blocked", "row_error", "error", "error_factors", "error_patch_size", "F_0", "F_23"}) {
        INFO(name);
        CHECK(std::count(arrays.begin(), arrays.end(), Json(name)) == 1);
        CHECK(directory.read("cube.vtp").find(std::string(" Name=\"") + name + "\" ") != std::string::npos);
    }
    CHECK(directory.read("cube.vtp").find("NumberOfPolys=\"24\"") != std::string::npos);
    CHECK(run_hemi(quick({"factors", scene, "-o", directory.path("F.vtp")})).status == 0);
    CHECK(directory.read("F.vtp").find("Name=\"row_error\"") != std::string::npos);

    const auto refused = [](const Words& words, int status, const std::string& text) {
        const Outcome outcome = run_hemi(words);
        INFO(outcome.err);
        CHECK(outcome.status == status);
        CHECK(outcome.err_has(text));
    };
    const Outcome table = run_hemi({"convert", hres, directory.path("B.csv")});
    CHECK(table.status == 0);
    CHECK(table.err_has("not in "));
    CHECK(directory.read("B.csv").starts_with("index,group,area,cx,cy,cz,nx,ny,nz,exitance_"));
    refused({"convert", hres, directory.path("B.csv"), "--factors", hff, "--row", "1"}, 2,
            "are for a .hres that");
    refused({"convert", hff, vtp}, 2, "a .vtp needs the patches");
    refused({"convert", hres, directory.path("x.npz")}, 2, "can be written as .vtp");
    refused({"convert", hff, directory.path("x.npz"), "--factors", hff, "--row", "1"}, 2, "are for a .hres");
    refused({"convert", hres, vtp, "--factors", hff, "--row", "24"}, 2,
            "row 24: there are 24 rows, counted from 0 (--row)");
    refused({"convert", hres, vtp, "--row", "1"}, 2, "--factors");
    refused({"convert", hres, vtp, "--factors", hff, "--row", "3", "--row", "3"}, 2,
            "--row 3: is given twice");
    const std::string other = directory.path("other.hff");
    REQUIRE(run_hemi(quick({"factors", directory.write("other.json", cube(3)), "-o", other})).status == 0);
    refused({"convert", hres, vtp, "--factors", other, "--row", "1"}, 3,
            "other.hff: belongs to another geometry");
}

TEST_CASE("Bake: a scene and its stored solution give the same mesh, which hemi reads", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", open_cube(4, "open"));
    const std::string hres = directory.path("cube.hres");
    REQUIRE(run_hemi(quick({"solve", scene, "--result", hres})).status == 0);
    const Outcome baked = run_hemi(quick({"bake", scene, "-o", directory.path("a.glb"), "--json"}));
    INFO(baked.err);
    REQUIRE(baked.status == 0);
    CHECK(baked.json()["patches"] == 80);
    const Outcome again = run_hemi({"bake", hres, "-o", directory.path("b.glb")});
    REQUIRE(again.status == 0);
    CHECK(again.out_has("80 patches, exposure"));
    const bool same = directory.read("a.glb") == directory.read("b.glb"); // as text they are no use
    CHECK(same);

    const Json info = run_hemi({"info", directory.path("b.glb"), "--json"}).json();
    CHECK(info["patches"] == 160);
    REQUIRE(run_hemi({"bake", hres, "-o", directory.path("flat.glb"), "--flat", "--exposure", "2"}).status ==
            0);
    CHECK(directory.read("flat.glb").size() == directory.read("b.glb").size());
    const bool differs = directory.read("flat.glb") != directory.read("b.glb");
    CHECK(differs);

    CHECK(run_hemi({"bake", hres, "-o", directory.path("x.gltf")}).status == 2);
    const Outcome mapped =
        run_hemi({"bake", hres, "-o", directory.path("map.glb"), "--lightmap", "128", "--json"});
    INFO(mapped.err);
    CHECK(mapped.json()["lightmap"]["size"] == 128);
    CHECK(mapped.json()["lightmap"]["patch_size"] >= 1);
    CHECK(baked.json()["lightmap"].is_null());
    CHECK(run_hemi({"info", directory.path("map.glb")}).status == 0); // readers find the mesh in it
    CHECK(run_hemi({"bake", hres, "-o", directory.path("x.ply"), "--lightmap", "128"})
              .err_has("a .ply has no texture"));
    const Outcome little = run_hemi({"bake", hres, "-o", directory.path("x.glb"), "--lightmap", "16"});
    CHECK(little.status == 2);
    CHECK(little.err_has("are enough"));
    CHECK(run_hemi({"bake", hres, "-o", directory.path("x.glb"), "--lightmap", "128", "--flat"}).status == 2);
    CHECK(run_hemi({"bake", hres, "-o", directory.path("x.glb"), "--seed", "1"}).err_has("does not apply"));
    CHECK(run_hemi({"bake", directory.path("cube.hff"), "-o", directory.path("x.glb")}).status == 2);
}

TEST_CASE("Convert: to every format that can hold the content, told what it does not hold", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    const std::string hff = directory.path("cube.hff");
    REQUIRE(run_hemi(quick({"factors", scene, "-o", hff})).status == 0);
    for (const char* name :
         {"a.mtx", "a.csv", "a.npz", "a.npy", "a.h5", "a.txt", "a.vf", "a.dat", "a.bin", "a.idf"}) {
        const Outcome run = run_hemi({"convert", hff, directory.path(name)});
        INFO(name << ": " << run.err);
        CHECK(run.status == 0);
        CHECK(run.err_has(std::string(name) + ": "));
        CHECK(run.err_has("not in "));
        CHECK(directory.has(name));
    }
    CHECK(directory.read("a.idf").ends_with(";\n"));
    const Outcome factors = run_hemi(quick({"factors", scene, "-o", directory.path("b.idf")}));
    CHECK(factors.status == 0);
    const std::string a = directory.read("a.idf");
    const std::string b = directory.read("b.idf");
    CHECK(a.substr(a.find("Zone Name")) == b.substr(b.find("Zone Name")));
    REQUIRE(run_hemi({"convert", hff, directory.path("a.idf"), "--zone", "ZONE ONE"}).status == 0);
    CHECK(directory.read("a.idf").find("BySurfaceName,\n  ZONE ONE,  !- Zone Name\n") != std::string::npos);
    const Outcome misplaced = run_hemi({"convert", hff, directory.path("z.csv"), "--zone", "ZONE ONE"});
    CHECK(misplaced.status == 2);
    CHECK(misplaced.err_has("--zone is for EnergyPlus' .idf"));
    CHECK(run_hemi({"convert", hff, directory.path("a.idf"), "--zone", "a;b"}).err_has("zone \"a;b\""));
    const std::string npz = directory.path("a.npz");
    for (const char* name : {"b.mtx", "b.csv", "b.npy", "b.h5", "b.dat", "b.bin"}) {
        const Outcome run = run_hemi({"convert", npz, directory.path(name)});
        INFO(name << ": " << run.err);
        CHECK(run.status == 0);
    }
    const auto same = [&directory](const char* a_name, const char* b_name) { // as text they are no use
        return directory.read(a_name) == directory.read(b_name);
    };
    CHECK(same("a.bin", "b.bin"));
    CHECK(same("a.npy", "b.npy"));
    for (const char* name : {"a.txt", "a.vf", "a.dat", "a.bin"}) { // and back again
        const Outcome run = run_hemi({"convert", directory.path(name), directory.path("d.mtx")});
        INFO(name << ": " << run.err);
        CHECK(run.status == 0);
        CHECK(same("a.mtx", "d.mtx"));
        CHECK(run_hemi({"info", directory.path(name)}).out_has("24"));
    }
    const Outcome kept = run_hemi({"convert", directory.path("a.vf"), directory.path("d.txt")});
    CHECK(kept.status == 0);
    CHECK(kept.err_has("d.txt: emissivities"));
    CHECK(same("a.txt", "d.txt"));
    CHECK(run_hemi({"convert", directory.path("a.vf"), directory.path("d.h5")}).status == 0);
    CHECK(run_hemi({"convert", directory.path("a.vf"), directory.path("d.idf")})
              .err_has("hold areas and group names"));
    for (const char* name : {"c.hff", "c.txt", "c.vf", "c.idf"}) {
        const Outcome run = run_hemi({"convert", npz, directory.path(name)});
        INFO(name << ": " << run.err);
        CHECK(run.status == 2);
        CHECK(run.err_has("areas"));
        CHECK_FALSE(directory.has(name));
    }
    CHECK(run_hemi({"convert", hff, directory.path("x.xyz")}).err_has(".idf, .vtp"));
}

TEST_CASE("Bake: the scene that is read is not replaced", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(1));
    const std::string model = directory.path("a.glb");
    REQUIRE(run_hemi(quick({"bake", scene, "-o", model})).status == 0);
    const std::string before = directory.read("a.glb");
    const Outcome run = run_hemi(quick({"bake", model, "-o", directory.path(".") + "/a.glb"}));
    INFO(run.err);
    CHECK(run.status == 2);
    CHECK(run.err_has("a.glb: is what is read"));
    CHECK(directory.read("a.glb") == before);
}

TEST_CASE("Convert: a link to a pipe is written to", "[cli]") {
    const Directory directory;
    const std::string factors = directory.path("a.hff");
    REQUIRE(run_hemi(quick({"factors", directory.write("cube.json", cube(1)), "-o", factors})).status == 0);
    std::filesystem::create_symlink("/dev/stdout", directory.path("out.csv"));
    const auto piped = hemi::test::run_command({"sh", "-c", "\"$1\" convert \"$2\" \"$3\" | cat", "sh",
                                                HEMI_PROGRAM, factors, directory.path("out.csv")});
    INFO(piped.err);
    CHECK(piped.out.starts_with("i,j,F\n"));
    CHECK(piped.out == run_hemi({"convert", factors, "-"}).out);
}

TEST_CASE("EnergyPlus output: an open scene is told as such", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("open.json", open_cube(2, "open"));
    const Outcome run = run_hemi(quick({"factors", scene, "-o", directory.path("open.idf")}));
    INFO(run.err);
    CHECK(run.status == 0);
    CHECK(run.err_has("EnergyPlus takes a zone for closed"));
}

TEST_CASE("Bake: as PLY, which hemi reads", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", open_cube(4, "open"));
    const Outcome run = run_hemi(quick({"bake", scene, "-o", directory.path("a.ply")}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json info = run_hemi({"info", directory.path("a.ply"), "--json"}).json();
    CHECK(info["quadrilaterals"] == 80);
    CHECK(run_hemi({"bake", scene, "-o", directory.path("a.obj")}).err_has(".glb, .ply"));
}

TEST_CASE("Mesh scenes: several files are one scene, each a group", "[cli]") {
    const Directory directory;
    const std::string floor = directory.write(
        "floor.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
                     "endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\n"
                     "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n");
    directory.write("lid.mtl", "newmtl blue\nKd 0.2 0.3 0.7\n");
    const std::string lid =
        directory.write("lid.obj", "mtllib lid.mtl\nusemtl blue\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\ng "
                                   "top\nf 1 2 3 4\ng other\nv 5 5 5\nv 6 5 5\n"
                                   "v 6 6 5\nf 5 6 7\n");
    const Json json = run_hemi(quick({"factors", floor, lid, "--by-group", "--json", "--flip-group",
                                      "lid/top", "--preset", "default"}))
                          .json();
    CHECK(json["groups"] == Json({"floor", "lid/top", "lid/other"}));
    CHECK(json["factors"][1][0].get<double>() == Approx(0.199825).margin(1e-5));
    CHECK(run_hemi({"info", floor, lid, "--json"}).json()["channels"] == Json({"red", "green", "blue"}));

    const auto refused = [](const Words& words, int status, const std::string& message) {
        const Outcome run = run_hemi(words);
        INFO(run.err);
        CHECK(run.status == status);
        CHECK(run.err_has(message));
    };
    refused({"info", floor, floor}, 3, "another file is called floor");
    refused({"info", floor, directory.write("room.json", cube(1))}, 2, "a JSON scene is read alone");
    refused({"info", floor, directory.path("a.png")}, 2, "unexpected argument: " + directory.path("a.png"));
    refused({"info", floor, lid, "--flip-group", "top"}, 2, "lid/top");
}

TEST_CASE("Mesh scenes: Gmsh, PLY and STL are solved like any other, bad ones are exit status 3", "[cli]") {
    const Directory directory;
    const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    const std::string msh = directory.write(
        "box.msh", head +
                       "$PhysicalNames\n2\n2 1 \"low\"\n2 2 \"high\"\n$EndPhysicalNames\n$Nodes\n8\n"
                       "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n"
                       "$Elements\n2\n1 3 2 1 1 1 2 3 4\n2 3 2 2 2 8 7 6 5\n$EndElements\n");
    const Json json = run_hemi(quick({"factors", msh, "--by-group", "--json", "--preset", "default",
                                      "--patches-per-face", "16"}))
                          .json();
    CHECK(json["groups"] == Json({"low", "high"}));
    CHECK(json["factors"][0][1].get<double>() == Approx(0.199825).margin(1e-5));
    const auto refused = [&](const std::string& name, const std::string& text, const std::string& message) {
        const Outcome run = run_hemi({"info", directory.write(name, text)});
        INFO(run.err);
        CHECK(run.status == 3);
        CHECK(run.err_has(name + message));
    };
    refused("a.msh", "$MeshFormat\n3.0 0 8\n$EndMeshFormat\n", ":2: MSH version \"3.0\"");
    refused("a.ply", "ply\nformat binary 1.0\n", ":2: format \"binary\"");
    refused("a.stl", std::string(84, '\377'),
            ": cut short, or not STL: 84 bytes; its 4294967295 triangles need");
    const std::string outside =
        directory.write("s.json", R"({"hemi": 1, "surfaces": [{"mesh": "/etc/passwd.obj"}]})");
    const Outcome run = run_hemi({"info", outside});
    CHECK(run.status == 3);
    CHECK(run.err_has("s.json: surfaces[0].mesh: \"/etc/passwd.obj\"; must be in the scene's folder"));
    // A scene of the current folder, without a folder in its name.
    directory.write("typing.json", R"({"hemi": 1, "surfaces": [{"mesh": "none.obj"}]})");
    directory.write("above.json", R"({"hemi": 1, "surfaces": [{"mesh": "../none.obj"}]})");
    const auto info_here = [&directory](const std::string& name) {
        return hemi::test::run_command({"sh", "-c", "cd \"$1\" && exec \"$2\" info \"$3\"", "sh",
                                        directory.path(""), HEMI_PROGRAM, name})
            .err;
    };
    CHECK_THAT(info_here("typing.json"), Catch::Contains("none.obj: cannot be read: No such file"));
    CHECK_THAT(info_here("above.json"), Catch::Contains("must be in the scene's folder"));
    CHECK(run_hemi({"info", outside, "--allow-outside"})
              .err_has("/etc/passwd.obj: cannot be read: No such file"));
}
