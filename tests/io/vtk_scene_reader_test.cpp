#include "hemi/io/scene_reader.hpp"

#include "io_fixtures.hpp"
#include "support/places.hpp"

namespace hemi::io_test {

namespace {

Scene read(const std::filesystem::path& path, Diagnostics* diagnostics = nullptr) {
    Diagnostics unused;
    return io::read_scene(path, {}, diagnostics != nullptr ? *diagnostics : unused);
}

std::string legacy(const std::string& rest) {
    return "# vtk DataFile Version 3.0\na sheet\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0 "
           "0 1 0\n" +
           rest;
}

const std::string vtu_head =
    "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece><Points><DataArray type=\"Float32\" "
    "format=\"ascii\">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points><Cells>";
const std::string vtu_end = "</Cells></Piece></UnstructuredGrid></VTKFile>";

std::string cells(const std::string& nodes, const std::string& ends, const std::string& types) {
    return vtu_head + "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">" + nodes +
           "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">" + ends +
           "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">" + types + "</DataArray>" +
           vtu_end;
}

} // namespace

TEST_CASE("VTK reader: files of VTK's own writers, of every encoding, say the same", "[io]") {
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(HEMI_TEST_DATA "/io/vtk")) {
        INFO(entry.path().string());
        ++files;
        Diagnostics diagnostics;
        const Scene scene = read(entry.path(), &diagnostics);
        REQUIRE(scene.surfaces.size() == 2);
        CHECK(scene.groups == std::vector<std::string>{"region_7", "region_9"});
        CHECK(scene.surfaces[0].vertices[2] == Vec3(1, 1, 0));
        CHECK(scene.surfaces[1].vertices[2] == Vec3(2, 1, 0));
        CHECK(scene.surfaces[1].vertex_count == 3);
        CHECK(scene.surfaces[1].group == 1);
        REQUIRE(diagnostics.warnings().size() == 1);
        require_parts(diagnostics.warnings()[0], {"1 cell that is no surface left out"});
    }
    CHECK(files == 10);
}

TEST_CASE("VTK reader: strips, pixels and cells of second order", "[io]") {
    const Folder folder;
    const Scene strip = read(folder.write(
        "a.vtk", legacy("TRIANGLE_STRIPS 1 5\n4 0 1 3 2\nPOINT_DATA 4\nSCALARS group int\nLOOKUP_TABLE "
                        "default\n1 2 3 4\nNORMALS n float\n0 0 1 0 0 1 0 0 1 0 0 1\n")));
    REQUIRE(strip.surfaces.size() == 2);
    CHECK(area_vector(strip.surfaces[0].polygon()).z == 0.5);
    CHECK(area_vector(strip.surfaces[1].polygon()).z == 0.5);
    CHECK(strip.groups == std::vector<std::string>{"default"});
    const Scene pixel = read(folder.write("a.vtu", cells("0 1 3 2", "4", "8")));
    CHECK(area_vector(pixel.surfaces[0].polygon()).z == 1.0);
    Diagnostics diagnostics;
    const Scene curved = read(folder.write("a.vtu", cells("0 1 2 3 3 3", "6", "22")), &diagnostics);
    CHECK(curved.surfaces[0].vertex_count == 3);
    require_parts(diagnostics.warnings().at(0), {"a.vtu: 1 cell of second order or more taken as plane"});
    struct Cell {
        std::string nodes;
        std::string count;
        std::string type;
        std::uint32_t corners;
    };
    for (const Cell& cell : {Cell{"0 1 2 3 3 3", "6", "30", 4}, Cell{"0 1 2 3 3 3 3 3", "8", "36", 4},
                             Cell{"0 1 2 3 3 3", "6", "61", 3}, Cell{"0 1 2 3 3", "5", "62", 4},
                             Cell{"0 1 2 3 3 3", "6", "76", 3}, Cell{"0 1 2 3 3", "5", "77", 4}}) {
        INFO(cell.type);
        Diagnostics told;
        const Scene scene = read(folder.write("a.vtu", cells(cell.nodes, cell.count, cell.type)), &told);
        CHECK(scene.surfaces.at(0).vertex_count == cell.corners);
        require_parts(told.warnings().at(0), {"1 cell of second order or more taken as plane"});
    }
}

TEST_CASE("VTK reader: values that are no numbers do not matter in arrays that are not used", "[io]") {
    const Folder folder;
    const Scene scene =
        read(folder.write("a.vtk", legacy("POLYGONS 1 5\n4 0 1 2 3\nCELL_DATA 1\nSCALARS temp float 1\n"
                                          "LOOKUP_TABLE default\nnan\nVECTORS flow double\n-inf 1 NaN\n")));
    CHECK(scene.surfaces.size() == 1);
}

TEST_CASE("VTK reader: what is wrong is named with its place, its value and what would be right", "[io]") {
    struct Bad {
        std::string name;
        std::string text;
        std::vector<std::string> parts;
    };
    const std::vector<Bad> table{
        {"a.vtk", "", {"a.vtk:1: no sound XML"}},
        {"a.vtk", "# vtk DataFile Version 3.0\nt\nascii\n", {"a.vtk:3: \"ascii\"; must be ASCII or BINARY"}},
        {"a.vtk",
         "# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\n",
         {":4: data set \"RECTILINEAR_GRID\"; must be POLYDATA or UNSTRUCTURED_GRID"}},
        {"a.vtk", legacy("POLYGONS 1 5\n4 0 1 2 x\n"), {":8: \"x\"; must be a number"}},
        {"a.vtk", legacy("POLYGONS 1 5\n4 0 1 2 nan\n"), {":8: nan; must be a whole number"}},
        {"a.vtk",
         legacy("POLYGONS 1 5\n4 0 1 2 3\nCELL_DATA 1\nSCALARS group float\nLOOKUP_TABLE default\ninf\n"),
         {"a.vtk: cell 0: \"group\" inf; must be a finite number"}},
        {"a.vtk",
         legacy("POLYGONS 1 5\n4 0 1 2 4\n"),
         {"a.vtk: cell 0: point 4; there are 4, counted from 0"}},
        {"a.vtk", legacy("POLYGONS 1 5\n6 0 1 2 4\n"), {"cell 0 of 6 points; 5 values are left"}},
        {"a.vtk", legacy("POLYGONS 1 99999\n"), {"99999 times 1 values; the file has"}},
        {"a.vtk", legacy("POLYGON 1 5\n"), {":7: \"POLYGON\"; must be a section of a VTK file"}},
        {"a.vtk", legacy(""), {"a.vtk: no faces"}},
        {"a.vtu", "<VTKFile", {"a.vtu:1: no sound XML"}},
        {"a.vtu", "<x/>", {"a.vtu: no element VTKFile"}},
        {"a.vtu",
         "<VTKFile type=\"ImageData\"/>",
         {"type \"ImageData\"; must be PolyData or UnstructuredGrid"}},
        {"a.vtu",
         "<VTKFile type=\"PolyData\" compressor=\"vtkLZ4DataCompressor\"/>",
         {"compressor \"vtkLZ4DataCompressor\""}},
        {"a.vtu", cells("0 1 2", "4", "5"), {"cell 0: its points end at 4; must be from 0 to 3"}},
        {"a.vtu", cells("0 1 2", "3", "5 5"), {"2 types of 1 cells"}},
        {"a.vtu", cells("0 1 2", "2", "5"), {"cell 0: 2 points; a cell of type 5 has at least 3"}},
        {"a.vtu", cells("0 1 -2", "3", "5"), {"cell 0: point -2"}},
        {"a.vtu", cells("0 1 2.5", "3", "5"), {"connectivity 2.5; must be a whole number"}},
        {"a.vtu", cells("0 1 two", "3", "5"), {"connectivity: \"two\"; must be a finite number"}},
        {"a.vtu", vtu_head + vtu_end, {"no DataArray of connectivity"}},
    };
    const Folder folder;
    for (const Bad& bad : table) {
        INFO(bad.text);
        require_parts(message_of<InputError>([&] { read(folder.write(bad.name, bad.text)); }), bad.parts);
    }
}

TEST_CASE("VTK reader: files cut anywhere, and with bytes changed, are read or refused by name", "[io]") {
    const Folder folder;
    for (const char* name :
         {"Binary110.vtu", "Appended111.vtp", "Appended101.vtu", "legacyu151.vtk", "legacyp142.vtk"}) {
        const std::string text = io::read_file(std::filesystem::path(HEMI_TEST_DATA "/io/vtk") / name);
        for (std::size_t at = 0; at < text.size(); at += 101) {
            for (const std::string& bad :
                 {text.substr(0, at), text.substr(0, at) + "\377" + text.substr(at + 1),
                  text.substr(0, at) + "9" + text.substr(at + 1)}) {
                try {
                    (void)read(folder.write(name, bad));
                } catch (const InputError& error) {
                    require_parts(error.what(), {name});
                }
            }
        }
    }
}

} // namespace hemi::io_test
