#include "hemi/io/vtp_file.hpp"

#include "io_fixtures.hpp"
#include "support/places.hpp"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <limits>

namespace hemi::io_test {

namespace {

/// A square of 3 x 2 patches and a two-sided triangle of 4: 14 patches.
Scene mixed_scene() {
    Scene scene;
    scene.groups = {"floor & \"walls\" <é>", "sheet"};
    scene.materials = {{"grey", {0.5}, {0.0}}};
    scene.surfaces.resize(2);
    scene.surfaces[0].vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
    scene.surfaces[0].patches = Grid{3, 2};
    scene.surfaces[1].vertices = {Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(0, 1, 1.5), Vec3(0)};
    scene.surfaces[1].vertex_count = 3;
    scene.surfaces[1].group = 1;
    scene.surfaces[1].two_sided = true;
    scene.surfaces[1].patches = Grid{2, 2};
    return scene;
}

} // namespace

TEST_CASE("VTP: cells, their data and the names of groups are where the format has them", "[io]") {
    const Folder folder;
    const Scene scene = mixed_scene();
    const PatchMesh mesh(scene);
    REQUIRE(mesh.size() == 14);
    io::CellArray radiosity{"radiosity", {}, {"red", "green & <blue>"}};
    io::CellArray error{"row \"error\"", {}, {}};
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        radiosity.values.insert(radiosity.values.end(), {0.1 * i, 1e-300 * i});
        error.values.push_back(1.0 / (1.0 + i));
    }
    error.values[5] = std::numeric_limits<double>::quiet_NaN(); // null in the JSON
    io::write_vtp(folder / "a.vtp", mesh, std::vector{radiosity, error});

    std::vector<double> group(14, 0.0);
    std::fill(group.begin() + 6, group.end(), 1.0);
    nlohmann::json expected{{"groups", scene.groups}, {"arrays", nlohmann::json::object()}};
    for (const io::CellArray& array : {radiosity, error, io::CellArray{"group", group, {}}}) {
        expected["arrays"][array.name] = {{"components", array.components}, {"values", array.values}};
    }
    folder.write("expected.json", expected.dump());
    const std::string command = "/usr/bin/python3 '" + std::string(HEMI_TEST_DATA) + "/io/compare_vtp.py' '" +
                                (folder / "a.vtp").string() + "' '" + (folder / "expected.json").string() +
                                "'";
    REQUIRE(std::system(command.c_str()) == 0);
}

TEST_CASE("VTP: arrays that do not fit, and disks that are full, leave no file", "[io]") {
    const Folder folder;
    const PatchMesh mesh(mixed_scene());
    const auto write = [&](const io::CellArray& array) {
        io::write_vtp(folder / "a.vtp", mesh, std::vector{array});
    };
    require_parts(message_of<InvalidArgument>([&] {
                      write({"B", std::vector<double>(13, 0.0), {}});
                  }),
                  {"B: 13 values for 14 patches of 1 components"});
    require_parts(message_of<InvalidArgument>([&] {
                      write({"B", std::vector<double>(14, 0.0), {"r", "g"}});
                  }),
                  {"B: 14 values for 14 patches of 2 components"});
    std::vector<double> values(14, 0.0);
    values[3] = std::numeric_limits<double>::infinity();
    require_parts(message_of<InvalidArgument>([&] {
                      write({"B", values, {}});
                  }),
                  {"B: a value that is infinite"});
    REQUIRE_THROWS_AS(io::write_vtp("/dev/full", mesh, {}), IoError);
    REQUIRE(folder.files() == 0);
}

} // namespace hemi::io_test
