#include "viewer/workplace.hpp"

#include "support/places.hpp"

#include <utility>

using namespace hemi;
using namespace hemi::viewer_test;

TEST_CASE("Viewer: points are dots with the values of a column, told under the cursor", "[viewer][gl]") {
    const Workplace place;
    // The first one is in the middle of the picture, before a wall; the last one is behind it.
    place.write("points.csv",
                "x,y,z,nx,ny,nz,irradiance,mean_radiant_temperature\n0.5,0.5,0.5,0,0,1,100,300\n"
                "0.8,0.5,0.5,0,0,1,200,\n0.2,0.5,0.5,0,0,1,,310\n0.2,1.5,0.2,0,0,1,150,290\n");
    const std::string options = small + " --points points.csv";
    REQUIRE(place.view("live\ncommand draw.txt\n", options) == 2);
    CHECK(place.read("errors.txt").find("points are drawn by `hemi render`") != std::string::npos);
    REQUIRE(place.view("move 150 100\nreport dot.json\nscreenshot dots.png\n"
                       "dots mean_radiant_temperature\nreport other.json\nclick 150 100\nreport picked.json\n"
                       "move 121 129\nreport behind.json\nshow radiosity\nscreenshot both.png\n"
                       "dots none\nclick 150 100\nreport none.json\nsave-result a.hres\n",
                       options) == 0);
    const auto dot = place.json("dot.json")["dots"];
    CHECK(dot["column"] == "irradiance");
    CHECK(dot["under_cursor"] == 0);
    CHECK(dot["value"] == 100.0);
    const auto other = place.json("other.json")["dots"];
    CHECK(other["column"] == "mean_radiant_temperature");
    CHECK(other["value"] == 300.0);
    CHECK(place.json("picked.json")["picked"].is_null()); // a dot is no patch
    CHECK(place.json("behind.json")["dots"]["under_cursor"].is_null());
    CHECK(place.json("none.json")["dots"].is_null());
    CHECK(place.json("none.json")["picked"].is_number());

    // `hemi render` draws the same.
    REQUIRE(place.run(fmt::format("'{}' render a.hres --device osmesa --size 300x200 --points points.csv "
                                  "-o render.png",
                                  HEMI_PROGRAM)) == 0);
    CHECK(place.read("render.png") == place.read("dots.png"));
    REQUIRE(place.run(fmt::format("'{}' render a.hres --device osmesa --size 300x200 --points points.csv "
                                  "--column mean_radiant_temperature --show radiosity -o render.png",
                                  HEMI_PROGRAM)) == 0);
    CHECK(place.read("render.png") == place.read("both.png"));
    const auto refused = [&](const std::string& words) {
        const int status = place.run(fmt::format("'{}' render a.hres {}", HEMI_PROGRAM, words));
        return std::pair(status, place.read("errors.txt"));
    };
    const auto [unknown, message] = refused("--points points.csv --column iradiance");
    CHECK(unknown == 2);
    CHECK(message.find("did you mean \"irradiance\"?") != std::string::npos);
    CHECK(refused("--column irradiance").first == 2);
    CHECK(refused("--points points.csv -o a.hdr").first == 2);
    place.write("points.csv", "x,y,z,irradiance\n0,0,0,bright\n");
    const auto [unsound, place_of_it] = refused("--points points.csv --column irradiance");
    CHECK(unsound == 3);
    CHECK(place_of_it.find("points.csv:2") != std::string::npos);
    place.write("points.csv", "x,y,z,room,irradiance\n0.5,0.5,0.5,hall,7\n"); // words are no values
    CHECK(refused("--points points.csv --device osmesa --size 30x20 -o words.png").first == 0);
}
