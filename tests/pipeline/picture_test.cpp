#include "hemi/pipeline/picture.hpp"

#include "support/scenes.hpp"

#include <catch2/catch.hpp>

#include <vector>

using namespace hemi;
using namespace hemi::test;

TEST_CASE("picture: light that shows little of a scene is told in words", "[pipeline]") {
    Scene scene = empty_scene();
    scene.channels = {"a", "b"};
    Solution solution;
    solution.channels = 2;
    solution.radiosity.assign(6, 0.0);
    solution.back_face_share.assign(3, 0.0);
    CHECK(is_dark(solution.radiosity, scene.environment));
    CHECK(light_note(scene, solution).find("evenly lit") != std::string::npos);
    // The environment is seen behind black surfaces.
    CHECK_FALSE(is_dark(solution.radiosity, std::vector<double>{0.0, 1.0}));

    solution.radiosity = {2.0, 5.0, 2.0001, 5.0, 2.0, 5.0002};
    CHECK(is_uniform(solution));
    CHECK_FALSE(is_dark(solution.radiosity, scene.environment));
    CHECK(light_note(scene, solution) == "the radiosity is the same everywhere: 2.0001, 5.0002 W/m²");
    solution.radiosity[5] = 5.001;
    CHECK_FALSE(is_uniform(solution));
    CHECK(light_note(scene, solution).empty());
    solution.back_face_share[2] = 1.0; // buried: its light is of no interest
    CHECK(is_uniform(solution));
    solution.back_face_share[1] = 1.0; // one patch says nothing of others
    CHECK_FALSE(is_uniform(solution));
}
