#include "hemi/core/nearest_word.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/scene/imprint.hpp"

#include "io_fixtures.hpp"

#include <nlohmann/json.hpp>

namespace hemi::io_test {

namespace {

using Json = nlohmann::json;

Json vertices(const std::vector<Vec3>& points) {
    Json list = Json::array();
    for (const Vec3& p : points) {
        list.push_back(
            {{"vertex_x_coordinate", p.x}, {"vertex_y_coordinate", p.y}, {"vertex_z_coordinate", p.z}});
    }
    return list;
}

/// Two zones side by side, 4 x 3 x 3 m, with a window in the south of the first; vertices counter-clockwise
/// from outside, as seen in each zone's own coordinates.
Json house() {
    Json document = Json::parse(R"({
        "Version": {"Version 1": {"version_identifier": "23.2"}},
        "Building": {"House": {"north_axis": 30}},
        "GlobalGeometryRules": {"Rules 1": {"starting_vertex_position": "UpperLeftCorner",
            "vertex_entry_direction": "Counterclockwise", "coordinate_system": "Relative"}},
        "Zone": {"Living": {}, "Bed Room": {"x_origin": 4, "z_origin": 1, "direction_of_relative_north": 90}},
        "FenestrationSurface:Detailed": {
            "Pane": {"building_surface_name": "LIVING south", "surface_type": "Window",
                "vertex_1_x_coordinate": 1, "vertex_1_y_coordinate": 0, "vertex_1_z_coordinate": 2,
                "vertex_2_x_coordinate": 1, "vertex_2_y_coordinate": 0, "vertex_2_z_coordinate": 1,
                "vertex_3_x_coordinate": 3, "vertex_3_y_coordinate": 0, "vertex_3_z_coordinate": 1,
                "vertex_4_x_coordinate": 3, "vertex_4_y_coordinate": 0, "vertex_4_z_coordinate": 2}}})");
    for (const std::string zone : {"Living", "Bed Room"}) {
        const auto add = [&](const char* kind, const std::string& name, const std::vector<Vec3>& polygon) {
            document[kind][zone + " " + name] = {{"zone_name", zone}, {"vertices", vertices(polygon)}};
        };
        add("BuildingSurface:Detailed", "South", {{0, 0, 3}, {0, 0, 0}, {4, 0, 0}, {4, 0, 3}});
        add("BuildingSurface:Detailed", "East", {{4, 0, 3}, {4, 0, 0}, {4, 3, 0}, {4, 3, 3}});
        add("Wall:Detailed", "North", {{4, 3, 3}, {4, 3, 0}, {0, 3, 0}, {0, 3, 3}});
        add("Wall:Detailed", "West", {{0, 3, 3}, {0, 3, 0}, {0, 0, 0}, {0, 0, 3}});
        add("Floor:Detailed", "Floor", {{0, 0, 0}, {0, 3, 0}, {4, 3, 0}, {4, 0, 0}});
        add("RoofCeiling:Detailed", "Ceiling", {{0, 0, 3}, {4, 0, 3}, {4, 3, 3}, {0, 3, 3}});
    }
    return document;
}

Scene read(const Folder& folder, const Json& document, const std::string& zone,
           Diagnostics* diagnostics = nullptr) {
    Diagnostics unused;
    io::SceneReaderOptions options;
    options.zone = zone;
    return io::read_scene(folder.write("house.epJSON", document.dump()), options,
                          diagnostics != nullptr ? *diagnostics : unused);
}

const Surface& surface_of(const Scene& scene, const std::string& group) {
    const auto found = std::find(scene.groups.begin(), scene.groups.end(), group);
    REQUIRE(found != scene.groups.end());
    for (const Surface& surface : scene.surfaces) {
        if (scene.groups[surface.group] == group) {
            return surface;
        }
    }
    throw std::runtime_error("a group without surfaces");
}

/// Six times the volume that the surfaces enclose, positive where they look outwards.
double six_volumes(const Scene& scene) {
    double sum = 0.0;
    for (const Surface& surface : scene.surfaces) {
        sum += 2.0 * glm::dot(surface.vertices[0], area_vector(surface.polygon()));
    }
    return sum;
}

} // namespace

TEST_CASE("EnergyPlus reader: a zone's surfaces look inwards, a group each, its windows over their walls",
          "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    Json document = house();
    const Scene scene = read(folder, document, "LIVING", &diagnostics);
    CHECK(diagnostics.warnings().empty());
    CHECK(scene.name == "Living");
    CHECK(scene.groups.size() == 7);
    REQUIRE(scene.surfaces.size() == 7);
    CHECK(area_vector(surface_of(scene, "Living South").polygon()) == Vec3(0, 9 + 3, 0));
    CHECK(area_vector(surface_of(scene, "Pane").polygon()) == Vec3(0, 2, 0));
    CHECK(area_vector(surface_of(scene, "Living Floor").polygon()) == Vec3(0, 0, 12));
    const auto cut = imprint(scene);
    REQUIRE(cut);
    CHECK(cut->covered == Approx(2.0)); // the window is no part of the wall any more

    Scene walls = scene;
    std::erase_if(walls.surfaces, [&](const Surface& s) { return scene.groups[s.group] == "Pane"; });
    CHECK(six_volumes(walls) == Approx(-6.0 * 36.0));
    document["GlobalGeometryRules"]["Rules 1"]["vertex_entry_direction"] = "Clockwise";
    const Scene turned = read(folder, document, "Living");
    CHECK(area_vector(surface_of(turned, "Living Floor").polygon()) == Vec3(0, 0, -12));
    CHECK(area_vector(surface_of(turned, "Pane").polygon()) == Vec3(0, -2, 0)); // as its wall
}

TEST_CASE("EnergyPlus reader: relative coordinates are placed by the zone's origin and north", "[io]") {
    const Folder folder;
    Json document = house();
    const Scene scene = read(folder, document, "bed room");
    // A zone turned by 90 degrees, clockwise from above: what was its north is the east.
    const Bounds bounds = scene.bounds();
    CHECK(glm::distance(bounds.lower, Vec3(4, -4, 1)) < 1e-12);
    CHECK(glm::distance(bounds.upper, Vec3(7, 0, 4)) < 1e-12);
    const Vec3 north = area_vector(surface_of(scene, "Bed Room North").polygon());
    CHECK(glm::distance(north, Vec3(-12, 0, 0)) < 1e-12);
    document["GlobalGeometryRules"]["Rules 1"]["coordinate_system"] = "World";
    CHECK(read(folder, document, "Bed Room").bounds().lower == Vec3(0, 0, 0));
}

TEST_CASE("EnergyPlus reader: a window a little off its wall is moved into it, what is left out is told",
          "[io]") {
    const Folder folder;
    Json document = house();
    Json& window = document["FenestrationSurface:Detailed"]["Pane"];
    window["vertex_2_y_coordinate"] = 0.004;
    window["multiplier"] = 2;
    document["InternalMass"]["Table"] = {{"zone_or_zonelist_name", "living"}};
    Diagnostics diagnostics;
    const Scene scene = read(folder, document, "Living", &diagnostics);
    CHECK(area_vector(surface_of(scene, "Pane").polygon()) == Vec3(0, 2, 0));
    REQUIRE(diagnostics.warnings().size() == 2);
    require_parts(diagnostics.warnings()[0],
                  {"FenestrationSurface:Detailed.Pane: the multiplier is not used"});
    require_parts(diagnostics.warnings()[1], {"1 InternalMass left out"});
}

TEST_CASE("EnergyPlus reader: what is wrong is named with its place, its value and what would be right",
          "[io]") {
    struct Bad {
        const char* patch; ///< JSON Patch (RFC 6902) of the house
        std::vector<std::string> parts;
    };
    const std::vector<Bad> table{
        {R"({"op": "remove", "path": "/Zone"})", {"house.epJSON: no Zone"}},
        {R"({"op": "remove", "path": "/GlobalGeometryRules"})", {"no GlobalGeometryRules"}},
        {R"({"op": "replace", "path": "/GlobalGeometryRules/Rules 1/coordinate_system", "value": "x"})",
         {"GlobalGeometryRules.Rules 1.coordinate_system: \"x\"; must be Relative or World"}},
        {R"({"op": "replace", "path": "/GlobalGeometryRules/Rules 1/vertex_entry_direction", "value": "x"})",
         {"vertex_entry_direction: \"x\"; must be Counterclockwise or Clockwise"}},
        {R"({"op": "remove", "path": "/Wall:Detailed/Living North/vertices"})",
         {"Wall:Detailed.Living North: \"vertices\" is missing"}},
        {R"({"op": "remove", "path": "/Wall:Detailed/Living North/vertices/3/vertex_x_coordinate"})",
         {"Wall:Detailed.Living North.vertices[3]: \"vertex_x_coordinate\" is missing"}},
        {R"({"op": "replace", "path": "/Wall:Detailed/Living North/vertices", "value": []})",
         {"Wall:Detailed.Living North.vertices: 0 vertices; must be from 3 to"}},
        {R"({"op": "add", "path": "/Wall:Detailed/LIVING SOUTH", "value":
             {"zone_name": "Living", "vertices": [
             {"vertex_x_coordinate": 0, "vertex_y_coordinate": 0, "vertex_z_coordinate": 0},
             {"vertex_x_coordinate": 1, "vertex_y_coordinate": 0, "vertex_z_coordinate": 0},
             {"vertex_x_coordinate": 0, "vertex_y_coordinate": 0, "vertex_z_coordinate": 1}]}})",
         {"Wall:Detailed.LIVING SOUTH: another surface has this name, too"}},
        {R"({"op": "add", "path": "/Roof", "value": {"Top": {"zone_name": "LIVING"}}})",
         {"Roof.Top: Roof is not supported; write it as BuildingSurface:Detailed"}},
        {R"({"op": "add", "path": "/Window", "value": {"W": {"building_surface_name": "living SOUTH"}}})",
         {"Window.W: Window is not supported; write it as FenestrationSurface:Detailed"}},
        {R"({"op": "replace", "path": "/FenestrationSurface:Detailed/Pane/vertex_3_y_coordinate",
             "value": 0.5})",
         {"FenestrationSurface:Detailed.Pane: vertex 3 is 0.5 off the plane of \"LIVING south\""}},
        {R"({"op": "remove", "path": "/FenestrationSurface:Detailed/Pane/vertex_2_z_coordinate"})",
         {"FenestrationSurface:Detailed.Pane: \"vertex_2_z_coordinate\" is missing"}},
        {R"({"op": "replace", "path": "/Zone/Living", "value": 7})", {"Zone.Living: 7; must be an object"}},
    };
    const Folder folder;
    for (const Bad& bad : table) {
        INFO(bad.patch);
        const Json document = house().patch(Json::array({Json::parse(bad.patch)}));
        require_parts(message_of<InputError>([&] { (void)read(folder, document, "Living"); }), bad.parts);
    }
    const auto refusal = [&](const Json& document, const std::string& zone) {
        return message_of<InvalidArgument>([&] { (void)read(folder, document, zone); });
    };
    require_parts(refusal(house(), ""),
                  {"house.epJSON: 2 zones; one must be chosen (--zone NAME)", "Bed Room, Living"});
    require_parts(refusal(house(), "Livin"), {"no zone \"Livin\"; did you mean \"Living\"?"});
    Json one = house();
    one["Zone"].erase("Bed Room");
    CHECK(read(folder, one, "").name == "Living");
    Json empty = house();
    empty["Zone"]["Attic"] = Json::object();
    require_parts(message_of<InputError>([&] { (void)read(folder, empty, "Attic"); }),
                  {"zone \"Attic\" has no surfaces; they are read from BuildingSurface:Detailed"});
    io::SceneReaderOptions options;
    options.zone = "Living";
    Diagnostics unused;
    const auto other = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    require_parts(message_of<InvalidArgument>([&] { (void)io::read_scene(other, options, unused); }),
                  {"a.obj: no zone \"Living\"; only .epJSON files have zones"});
}

} // namespace hemi::io_test
