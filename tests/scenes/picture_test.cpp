#include "cli/program.hpp"
#include "support/picture_difference.hpp"
#include "support/places.hpp"
#include "support/png.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>

// The reference is made by `tools/figures --renew picture`, by the preset exact. Make it anew only when the
// picture is meant to change, and look at it.
//
// By the preset default the picture differs from it by a mean of 0.03, 0.20 at 99 % and 0.23 in the worst
// cell. The limits are 5 and more times as much; each fault further down exceeds at least one of them.

using namespace hemi::cli_test;
using namespace hemi::test;

namespace {

constexpr double mean_limit = 0.4;
constexpr double percentile_limit = 1.5;
constexpr double cell_limit = 1.5;

bool looks_like(const PictureDifference& difference) {
    return difference.mean < mean_limit && difference.percentile_99 < percentile_limit &&
           difference.worst_cell < cell_limit;
}

SrgbPicture reference() {
    return read_png(HEMI_TEST_DATA "/pictures/cornell-box.png");
}

std::string scene_path() {
    return HEMI_SOURCE_DIR "/scenes/cornell-box.json";
}

SrgbPicture drawn(const std::string& scene, const Words& options = {}) {
    const Directory directory;
    Words words{"solve", scene,      "-o",    directory.path("a.png"), "--size", "200x200", "--jobs",
                "2",     "--device", "osmesa"};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome run = run_hemi(words);
    INFO(run.err);
    REQUIRE(run.status == 0);
    return read_png(directory.path("a.png"));
}

/// Radiosity of a pixel times `factor`, as nearly as the tone curve is a square root.
std::uint8_t dimmed(std::uint8_t value, double factor) {
    return static_cast<std::uint8_t>(std::min(255.0, value * std::sqrt(factor)));
}

void dim(SrgbPicture& picture, std::size_t x, std::size_t y, std::size_t width, std::size_t height,
         double factor) {
    for (std::size_t v = y; v < y + height; ++v) {
        for (std::size_t u = x; u < x + width; ++u) {
            for (std::size_t c = 0; c < 3; ++c) {
                std::uint8_t& value = picture.pixels[(v * picture.width + u) * 3 + c];
                value = dimmed(value, factor);
            }
        }
    }
}

} // namespace

TEST_CASE("picture: the Cornell box looks like the stored picture", "[scenes][gl][slow]") {
    const SrgbPicture expected = reference();
    const SrgbPicture found = drawn(scene_path());
    REQUIRE(expected.width == 200);
    REQUIRE(found.width == expected.width);
    REQUIRE(found.height == expected.height);
    const PictureDifference difference = picture_difference(found, expected);
    CHECK(difference.mean < mean_limit);
    CHECK(difference.percentile_99 < percentile_limit);
    CHECK(difference.worst_cell < cell_limit);
}

TEST_CASE("picture: hemicubes that are turned otherwise do not show", "[scenes][gl][slow]") {
    CHECK(looks_like(picture_difference(drawn(scene_path(), {"--seed", "1"}), reference())));
}

TEST_CASE("picture: light under a block that hangs above the floor shows", "[scenes][gl][slow]") {
    Json scene = Json::parse(std::ifstream(scene_path()));
    for (Json& surface : scene["surfaces"]) {
        if (surface["name"] == "tall_block") {
            for (Json& corner : surface["polygon"]) {
                corner[1] = corner[1] == 0 ? Json(12) : corner[1];
            }
        }
    }
    const Directory directory;
    const PictureDifference difference =
        picture_difference(drawn(directory.write("hanging.json", scene)), reference());
    CHECK(difference.worst_cell > 1.5 * cell_limit);
}

TEST_CASE("picture: the comparison finds what is wrong with a disturbed picture", "[scenes]") {
    const SrgbPicture original = reference();
    REQUIRE(looks_like(picture_difference(original, original)));
    struct Fault {
        const char* what;
        std::function<void(SrgbPicture&)> disturb;
    };
    const std::vector<Fault> faults{
        {"shifted by 6 pixels",
         [](SrgbPicture& p) { std::rotate(p.pixels.begin(), p.pixels.begin() + 6 * 3, p.pixels.end()); }},
        {"shifted by 2 pixels",
         [](SrgbPicture& p) { std::rotate(p.pixels.begin(), p.pixels.begin() + 2 * 3, p.pixels.end()); }},
        {"upside down", [](SrgbPicture& p) { std::reverse(p.pixels.begin(), p.pixels.end()); }},
        {"red and green swapped",
         [](SrgbPicture& p) {
             for (std::size_t i = 0; i < p.pixels.size(); i += 3) {
                 std::swap(p.pixels[i], p.pixels[i + 1]);
             }
         }},
        {"red and blue swapped",
         [](SrgbPicture& p) {
             for (std::size_t i = 0; i < p.pixels.size(); i += 3) {
                 std::swap(p.pixels[i], p.pixels[i + 2]);
             }
         }},
        {"red wall darkened by 20 %", [](SrgbPicture& p) { dim(p, 6, 10, 30, 180, 0.8); }},
        {"green wall darkened by 20 %", [](SrgbPicture& p) { dim(p, 165, 10, 30, 180, 0.8); }},
        {"all brighter by 5 %", [](SrgbPicture& p) { dim(p, 0, 0, 200, 200, 1.05); }},
        {"a bright patch in the shadow", [](SrgbPicture& p) { dim(p, 66, 172, 20, 12, 1.5); }},
        {"a bright seam along an edge of the ceiling", [](SrgbPicture& p) { dim(p, 45, 40, 110, 1, 2.0); }},
        {"no colour bleeding on the floor", [](SrgbPicture& p) {
             for (std::size_t i = (170 * p.width + 30) * 3; i < (170 * p.width + 60) * 3; i += 3) {
                 for (std::size_t row = 0; row < 15; ++row) {
                     std::uint8_t* pixel = p.pixels.data() + i + row * p.width * 3;
                     pixel[0] = pixel[2] = pixel[1];
                 }
             }
         }}};
    for (const Fault& fault : faults) {
        SrgbPicture disturbed = original;
        fault.disturb(disturbed);
        const PictureDifference difference = picture_difference(disturbed, original);
        INFO(fault.what << ": mean " << difference.mean << " 99 % " << difference.percentile_99 << " cell "
                        << difference.worst_cell);
        CHECK_FALSE(looks_like(difference));
    }
}
