#include "hemi/scene/scene.hpp"

#include "hemi/core/error.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <limits>

using namespace hemi;
using namespace hemi::test;
using Catch::Matchers::Contains;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

using Polygon = std::vector<Vec3>;

Polygon times(Polygon polygon, double factor) {
    for (Vec3& point : polygon) {
        point *= factor;
    }
    return polygon;
}

Polygon plus(Polygon polygon, const Vec3& by) {
    for (Vec3& point : polygon) {
        point += by;
    }
    return polygon;
}

const Polygon square{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};

Scene one_square() {
    Scene scene = empty_scene();
    add_polygon(scene, "floor", square);
    return scene;
}

} // namespace

TEST_CASE("Scene: groups have one index a name in order of first appearance", "[scene]") {
    Scene scene;
    CHECK(scene.group_index("floor") == 0);
    CHECK(scene.group_index("wall") == 1);
    CHECK(scene.group_index("floor") == 0);
    CHECK(scene.group_index("") == 2);
    CHECK(scene.group_index("Floor") == 3);
    CHECK(scene.groups == std::vector<std::string>{"floor", "wall", "", "Floor"});
}

TEST_CASE("Scene: bounds ignore the unused fourth corner of a triangle", "[scene]") {
    Scene scene = empty_scene();
    CHECK(scene.bounds().empty());
    add_polygon(scene, "a", {Vec3(1, 1, 1), Vec3(2, 1, 1), Vec3(1, 3, 1)});
    scene.surfaces[0].vertices[3] = Vec3(100.0);
    CHECK(scene.bounds().lower == Vec3(1, 1, 1));
    CHECK(scene.bounds().upper == Vec3(2, 3, 1));
    add_polygon(scene, "b", {Vec3(-1, 0, 0), Vec3(0, 0, 0), Vec3(0, 0, 9), Vec3(-1, 0, 9)});
    CHECK(scene.bounds().lower == Vec3(-1, 0, 0));
    CHECK(scene.bounds().upper == Vec3(2, 3, 9));
}

TEST_CASE("polygon_defect: sound polygons have none", "[scene]") {
    const std::vector<Polygon> sound{
        square,
        {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)},
        {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1.5, 1, 0), Vec3(0.5, 1, 0)},
        {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(0, 1, 0)},    // a corner in the middle of an edge
        {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 9e-6), Vec3(0, 1, 0)}, // bent by less than 1e-5
        {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1e-6, 0), Vec3(0, 1e-6, 0)}, // long and thin
        {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(0, 1, 0)},
    };
    for (const Polygon& polygon : sound) {
        const double bent = polygon.size() == 4 ? polygon[2].z : 0.0;
        INFO("second corner " << polygon[1].x << " " << polygon[1].y << " bent " << bent);
        CHECK(polygon_defect(polygon) == std::nullopt);
        CHECK(polygon_defect(Polygon(polygon.rbegin(), polygon.rend())) == std::nullopt);
        for (const double factor : {1e-30, 1e-6, 1e6, 1e30}) {
            INFO("scaled by " << factor);
            CHECK(polygon_defect(times(polygon, factor)) == std::nullopt);
        }
        CHECK(polygon_defect(plus(polygon, Vec3(1e5, -1e5, 1e5))) == std::nullopt);
    }
}

TEST_CASE("polygon_defect: says what is wrong with a polygon", "[scene]") {
    struct Case {
        const char* what;
        Polygon polygon;
        const char* message;
    };
    const std::vector<Case> cases{
        {"no vertices", {}, "0 vertices; a patch needs 3 or 4"},
        {"one vertex", {Vec3(0.0)}, "1 vertices; a patch needs 3 or 4"},
        {"two vertices", {Vec3(0.0), Vec3(1.0)}, "2 vertices; a patch needs 3 or 4"},
        {"five vertices",
         {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 1, 0), Vec3(1, 2, 0), Vec3(0, 1, 0)},
         "5 vertices; a patch needs 3 or 4"},
        {"not a number", {Vec3(0, 0, 0), Vec3(1, not_a_number, 0), Vec3(0, 1, 0)}, "vertex 1 is not finite"},
        {"infinite",
         {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, -infinity)},
         "vertex 3 is not finite"},
        {"huge", times(square, 1e308), "coordinate of magnitude 1e+308; must be below 1e70"},
        {"huge both ways",
         {Vec3(-1e308, 0, 0), Vec3(1e308, 0, 0), Vec3(0, 1e308, 0)},
         "coordinate of magnitude 1e+308; must be below 1e70"},
        {"too large for its area", times(square, 1e90), "coordinate of magnitude 1e+90; must be below 1e70"},
        {"tiny", times(square, 1e-75), "longest edge 1e-75; must be above 1e-70"},
        {"one point", Polygon(4, Vec3(1.0)), "zero area"},
        {"collinear", {Vec3(0, 0, 0), Vec3(1, 1, 1), Vec3(2, 2, 2)}, "zero area"},
        {"there and back", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(1, 0, 0)}, "zero area"},
        {"a sliver", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 1e-10, 0)}, "zero area"},
        {"a bow tie", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0)}, "zero area"},
        {"an uneven bow tie",
         {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0)},
         "not convex at vertex"},
        {"lost in rounding", plus(square, Vec3(1e16, 0, 0)), "zero area"},
        {"bent", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0.1), Vec3(0, 1, 0)}, "not planar: vertex"},
        {"bent a little", {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 1e-4), Vec3(0, 1, 0)}, "not planar"},
        {"an arrow",
         {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0, 2, 0)},
         "not convex at vertex 2"},
        {"an arrow begun at its notch",
         {Vec3(0.5, 0.5, 0), Vec3(0, 2, 0), Vec3(0, 0, 0), Vec3(2, 0, 0)},
         "not convex at vertex 0"},
        {"hardly concave",
         {Vec3(0, 0, 0), Vec3(1, 1e-6, 0), Vec3(2, 0, 0), Vec3(1, 1, 0)},
         "not convex at vertex 1"},
        {"coinciding vertices",
         {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)},
         "vertices 1 and 2 coincide"},
        {"last on first",
         {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 0)},
         "vertices 3 and 0 coincide"},
    };
    for (const Case& wrong : cases) {
        INFO(wrong.what);
        const auto defect = polygon_defect(wrong.polygon);
        REQUIRE(defect.has_value());
        CHECK_THAT(*defect, Contains(wrong.message));
    }
}

TEST_CASE("polygon_defect: judges the same at every scale and far from the origin", "[scene]") {
    const Polygon bent{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 1e-3), Vec3(0, 1, 0)};
    const Polygon arrow{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0, 2, 0)};
    const Polygon line{Vec3(0, 0, 0), Vec3(1, 1, 1), Vec3(2, 2, 2)};
    for (const double factor : {1e-30, 1e-6, 1.0, 1e6, 1e30}) {
        INFO("scaled by " << factor);
        CHECK_THAT(polygon_defect(times(bent, factor)).value_or(""), Contains("not planar"));
        CHECK_THAT(polygon_defect(times(arrow, factor)).value_or(""), Contains("not convex"));
        CHECK_THAT(polygon_defect(times(line, factor)).value_or(""), Contains("zero area"));
    }
    const Vec3 far(1e5, 1e5, -1e5);
    CHECK_THAT(polygon_defect(plus(bent, far)).value_or(""), Contains("not planar"));
    CHECK_THAT(polygon_defect(plus(arrow, far)).value_or(""), Contains("not convex"));
    CHECK_THAT(polygon_defect(plus(line, far)).value_or(""), Contains("zero area"));
}

TEST_CASE("validate: a sound scene passes", "[scene]") {
    CHECK_NOTHROW(validate(one_square()));
    CHECK_NOTHROW(validate(room_with_blocks(4)));
    Scene edge = one_square();
    edge.materials[0] = {"grey", {0.0}, {0.0}};
    edge.materials.push_back({"bright", {std::nextafter(1.0, 0.0)}, {1e30}});
    edge.environment = {0.0};
    CHECK_NOTHROW(validate(edge));
}

TEST_CASE("validate: messages name the material or surface and the value and what would be right",
          "[scene]") {
    struct Case {
        const char* what;
        std::function<void(Scene&)> spoil;
        std::vector<const char*> message;
    };
    const std::vector<Case> cases{
        {"no surfaces", [](Scene& s) { s.surfaces.clear(); }, {"no surfaces", "at least one"}},
        {"no channels", [](Scene& s) { s.channels.clear(); }, {"no channels", "at least one"}},
        {"too few values",
         [](Scene& s) {
             s.channels = {"red", "green"};
         },
         {"\"grey\"", "1 reflectances", "2 channels"}},
        {"too many exitances",
         [](Scene& s) {
             s.materials[0].exitance = {1, 2, 3};
         },
         {"\"grey\"", "3 exitances", "1 channels"}},
        {"reflectance of one",
         [](Scene& s) { s.materials[0].reflectance = {1.0}; },
         {"\"grey\"", "reflectance 1", "below 1"}},
        {"negative reflectance",
         [](Scene& s) { s.materials[0].reflectance = {-0.25}; },
         {"\"grey\"", "reflectance -0.25", "at least 0"}},
        {"reflectance that is no number",
         [](Scene& s) { s.materials[0].reflectance = {not_a_number}; },
         {"\"grey\"", "reflectance nan"}},
        {"negative exitance",
         [](Scene& s) { s.materials[0].exitance = {-3.5}; },
         {"\"grey\"", "exitance -3.5", "not negative"}},
        {"infinite exitance",
         [](Scene& s) { s.materials[0].exitance = {infinity}; },
         {"\"grey\"", "exitance inf", "finite"}},
        {"an unused material",
         [](Scene& s) {
             s.materials.push_back({"unused", {7.0}, {0.0}});
         },
         {"\"unused\"", "reflectance 7"}},
        {"environment of another size",
         [](Scene& s) {
             s.environment = {1, 2};
         },
         {"environment", "2 exitances", "1 channels"}},
        {"negative environment",
         [](Scene& s) { s.environment = {-1}; },
         {"environment", "-1", "not negative"}},
        {"environment that is no number",
         [](Scene& s) { s.environment = {not_a_number}; },
         {"environment", "nan"}},
        {"patch size of zero", [](Scene& s) { s.patch_size = 0.0; }, {"patch_size 0", "positive"}},
        {"patch size that is no number", [](Scene& s) { s.patch_size = not_a_number; }, {"patch_size nan"}},
        {"infinite patch size", [](Scene& s) { s.patch_size = infinity; }, {"patch_size inf"}},
        {"a material that is not there",
         [](Scene& s) { s.surfaces[0].material = 1; },
         {"surface 0", "material 1 of 1"}},
        {"a group that is not there",
         [](Scene& s) { s.surfaces[0].group = 9; },
         {"surface 0", "group 9 of 1"}},
        {"a bad polygon",
         [](Scene& s) {
             add_polygon(s, "lid", square);
             s.surfaces[1].vertices[2].z = 0.5;
         },
         {"surface 1", "\"lid\"", "not planar"}},
        {"a scene lost in the rounding of its coordinates",
         [](Scene& s) { s = moved(scaled(s, 1e-3), Vec3(1e10, 0, 0)); },
         {"the scene is 0.00141 across at coordinates of up to 1e+10", "towards the origin"}},
        {"five vertices",
         [](Scene& s) { s.surfaces[0].vertex_count = 5; },
         {"surface 0", "\"floor\"", "5 vertices"}},
        {"no vertices", [](Scene& s) { s.surfaces[0].vertex_count = 0; }, {"surface 0", "0 vertices"}},
        {"no patches",
         [](Scene& s) {
             s.surfaces[0].patches = Grid{0, 3};
         },
         {"surface 0", "\"floor\"", "[0, 3]", "at least 1"}},
        {"no patches the other way",
         [](Scene& s) {
             s.surfaces[0].patches = Grid{3, 0};
         },
         {"[3, 0]"}},
        {"an uneven triangle",
         [](Scene& s) {
             s.surfaces[0].vertex_count = 3;
             s.surfaces[0].patches = Grid{2, 3};
         },
         {"surface 0", "[2, 3]", "equal for a triangle"}},
    };
    for (const Case& wrong : cases) {
        INFO(wrong.what);
        Scene scene = one_square();
        wrong.spoil(scene);
        std::string message;
        try {
            validate(scene);
        } catch (const InputError& error) {
            message = error.what();
        }
        REQUIRE_FALSE(message.empty());
        for (const char* part : wrong.message) {
            CHECK_THAT(message, Contains(part));
        }
    }
}
