#include "hemi/io/baked_mesh_file.hpp"

#include "hemi/io/scene_reader.hpp"
#include "io_fixtures.hpp"

#include <cmath>
#include <cstring>
#include <limits>

namespace hemi::io_test {

namespace {

Scene baked_scene() {
    Scene scene;
    scene.groups = {"wall", "sheet"};
    scene.materials = {{"grey", {0.5}, {0.0}}};
    Surface wall;
    wall.vertices = {Vec3(1e6, 0, 0), Vec3(1e6 + 1, 0, 0), Vec3(1e6 + 1, 1, 0), Vec3(1e6, 1.0 / 3.0, 0)};
    wall.patches = Grid{2, 3};
    Surface sheet;
    sheet.vertices = {Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(0, 1, 1.5), Vec3(0)};
    sheet.vertex_count = 3;
    sheet.group = 1;
    sheet.two_sided = true;
    scene.surfaces = {wall, sheet};
    return scene;
}

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
    Number number;
    REQUIRE(at + sizeof number <= bytes.size());
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
}

} // namespace

TEST_CASE("Baked PLY: hemi's own reader finds every patch again, bit for bit and in order", "[io]") {
    const Folder folder;
    const PatchMesh mesh(baked_scene());
    REQUIRE(mesh.size() == 8);
    io::write_baked_ply(folder / "a.ply", mesh, std::vector<float>(8 * 12, 0.5f), 1.0);
    Diagnostics diagnostics;
    const Scene scene = io::read_scene(folder / "a.ply", {}, diagnostics);
    REQUIRE(diagnostics.warnings().empty());
    REQUIRE(scene.surfaces.size() == 8);
    for (std::uint32_t i = 0; i < 8; ++i) {
        const PatchCorners corners = mesh.corners(i);
        REQUIRE(scene.surfaces[i].vertex_count == corners.count);
        for (std::size_t c = 0; c < corners.count; ++c) {
            REQUIRE(scene.surfaces[i].vertices[c] == corners.points[c]);
        }
    }
}

TEST_CASE("Baked PLY: colours are sRGB of exposure times radiosity, beside the radiosity itself", "[io]") {
    const Folder folder;
    const PatchMesh mesh(baked_scene());
    std::vector<float> radiosity(std::size_t{8} * 12, 0.0f);
    radiosity[0] = 0.214041f; // of the first corner
    radiosity[1] = 0.001f;
    radiosity[2] = 7.5f;
    radiosity[6 * 12 + 2 * 3 + 1] = 0.25f; // green of the triangle's third corner
    io::write_baked_ply(folder / "a.ply", mesh, radiosity, 2.0);
    const std::string bytes = io::read_file(folder / "a.ply");
    const std::size_t data = bytes.find("end_header\n") + 11;
    constexpr std::size_t vertex = 3 * 8 + 3 + 3 * 4;
    REQUIRE(bytes.size() == data + (6 * 4 + 2 * 3) * vertex + 6 * 17 + 2 * 13);
    const auto colour = [&](std::size_t index, std::size_t channel) {
        return static_cast<int>(number_at<std::uint8_t>(bytes, data + index * vertex + 24 + channel));
    };
    REQUIRE(colour(0, 0) == 175); // 255 (1.055 · 0.428082^(1/2.4) - 0.055) = 174.9
    REQUIRE(colour(0, 1) == 7);   // 255 · 12.92 · 0.002 = 6.6
    REQUIRE(colour(0, 2) == 255);
    REQUIRE(colour(26, 1) == 188); // 255 (1.055 · 0.5^(1/2.4) - 0.055) = 187.5
    REQUIRE(number_at<float>(bytes, data + 27) == 0.214041f);
    REQUIRE(number_at<float>(bytes, data + 35) == 7.5f);
    REQUIRE(number_at<float>(bytes, data + 26 * vertex + 31) == 0.25f);
}

TEST_CASE("Baked PLY: radiosities that do not fit or are not finite leave no file", "[io]") {
    const Folder folder;
    const PatchMesh mesh(baked_scene());
    std::vector<float> radiosity(std::size_t{8} * 12, 0.0f);
    REQUIRE_THROWS_AS(io::write_baked_ply(folder / "a.ply", mesh, radiosity, -1.0), InvalidArgument);
    REQUIRE_THROWS_AS(io::write_baked_ply("/dev/full", mesh, radiosity, 1.0), IoError);
    radiosity[5] = std::numeric_limits<float>::infinity();
    REQUIRE_THROWS_AS(io::write_baked_ply(folder / "a.ply", mesh, radiosity, 1.0), InvalidArgument);
    radiosity.pop_back();
    REQUIRE_THROWS_AS(io::write_baked_ply(folder / "a.ply", mesh, radiosity, 1.0), InvalidArgument);
    REQUIRE(folder.files() == 0);
}

} // namespace hemi::io_test
