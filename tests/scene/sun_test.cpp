#include "hemi/scene/sun.hpp"

#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

using namespace hemi;
using Catch::Contains;

TEST_CASE("the sun is where published positions have it", "[scene][sun]") {
    // I. Reda, A. Andreas, "Solar position algorithm for solar radiation applications", NREL/TP-560-34302,
    // 2008, appendix A.5: azimuth 194.34024, elevation 90 - 50.11162 with the refraction of a mountain's thin
    // air.
    const SunPosition golden = sun_position(39.742476, -105.1786, "2003-10-17T12:30:30-07:00");
    CHECK(golden.azimuth == Approx(194.34024).margin(0.01));
    CHECK(golden.elevation == Approx(39.88838).margin(0.01));

    // J. Meeus, "Astronomical Algorithms", examples 25.a and 28.b, 1992-10-13 0h: declination -7.78507
    // degrees; equation of time 13 min 42.6 s, so that the sun is in the south where local mean time is noon
    // less that.
    const SunPosition pole = sun_position(-90.0, 0.0, "1992-10-13T00:00:00Z");
    CHECK(pole.elevation == Approx(7.78507 + 0.1109).margin(0.003)); // lifted by the air
    const SunPosition noon = sun_position(50.0, (720.0 - 13.7101) / 4.0, "1992-10-13T00:00Z");
    CHECK(noon.azimuth == Approx(180.0).margin(0.02));
    CHECK(noon.elevation == Approx(90.0 - 50.0 - 7.78507 + 0.0255).margin(0.003));

    // The same moment in other words, and the sun at night.
    const SunPosition again = sun_position(39.742476, -105.1786, "2003-10-17T19:30:30.0Z");
    CHECK(again.azimuth == Approx(golden.azimuth).margin(1e-9));
    CHECK(sun_position(39.742476, -105.1786, "2003-10-17T00:30:30-07:00").elevation < -40.0);
    CHECK(sun_position(0.0, 0.0, "2026-03-20T12:07:00+00:00").elevation > 89.5); // equinox: overhead
}

TEST_CASE("times and places that are none are refused", "[scene][sun]") {
    for (const char* const time :
         {"2026-06-21", "2026-06-21T12:00", "2026-13-01T12:00Z", "2026-02-30T12:00Z", "2026-06-21T24:00Z",
          "2026-06-21T12:61Z", "2026-06-21T12:00+2", "2026-06-21T12:00Z+", "noon"}) {
        INFO(time);
        CHECK_THROWS_WITH(sun_position(48.0, 11.0, time), Contains(time) && Contains("offset"));
    }
    CHECK_THROWS_WITH(sun_position(91.0, 11.0, "2026-06-21T12:00Z"), Contains("latitude 91"));
    CHECK_THROWS_WITH(sun_position(48.0, 181.0, "2026-06-21T12:00Z"), Contains("longitude 181"));
}

TEST_CASE("azimuths count clockwise from north, which is +y turned clockwise", "[scene][sun]") {
    const auto near = [](const Vec3& a, const Vec3& b) { return glm::length(a - b) < 1e-12; };
    CHECK(near(sky_direction(0.0, 0.0), {0.0, 1.0, 0.0}));
    CHECK(near(sky_direction(90.0, 0.0), {1.0, 0.0, 0.0}));
    CHECK(near(sky_direction(180.0, 90.0), {0.0, 0.0, 1.0}));
    CHECK(near(sky_direction(0.0, 0.0, 90.0), {1.0, 0.0, 0.0}));
    CHECK(near(sky_direction(180.0, 30.0), {0.0, -std::sqrt(0.75), 0.5}));
}
