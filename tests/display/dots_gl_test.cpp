#include "hemi/display/dots.hpp"

#include "display/colour_scale.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace hemi {

namespace {

/// How bright the middle of a picture of one dot is, display linear, of three channels.
std::array<double, 3> middle_of(double value, const PictureSettings& settings) {
    const PointTable table{{Vec3(0.0), Vec3(50.0, 0.0, 0.0), Vec3(0.0, 0.0, 50.0)},
                           {{"irradiance", "W/m²", {value, 0.0, 100.0}}}};
    Dots dots = make_dots(table, 0, {Vec3(-1.0), Vec3(1.0)});
    dots.radius = 1.0;
    const Picture picture =
        draw_picture(with_dots(PictureMesh{}, dots, settings),
                     {{0.0, -10.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 20.0}, settings, "osmesa");
    std::array<double, 3> result{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double srgb =
            picture.srgb[(std::size_t{picture.height} / 2 * picture.width + picture.width / 2) * 3 + c];
        const double share = srgb / 255.0;
        result[c] = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
    }
    return result;
}

} // namespace

TEST_CASE("dots: colours are those of the scale, whatever the exposure and the tone mapping",
          "[display][gl]") {
    PictureSettings settings;
    settings.width = settings.height = 64;
    settings.samples = 1;
    for (const ToneMapping tone_mapping : {ToneMapping::filmic, ToneMapping::linear}) {
        for (const double exposure : {1e-3, 1.0, 1e3}) {
            settings.tone_mapping = tone_mapping;
            settings.exposure = exposure;
            const std::array<double, 3> is = middle_of(30.0, settings);
            const std::array<float, 3> should = scale_colour(0.3);
            for (std::size_t c = 0; c < 3; ++c) {
                CHECK(is[c] == Approx(static_cast<double>(should[c])).margin(0.006));
            }
        }
    }
    const std::array<double, 3> none = middle_of(std::numeric_limits<double>::quiet_NaN(), settings);
    CHECK(none[0] == Approx(0.16).margin(0.006)); // grey
    CHECK(none[0] == none[2]);
}

TEST_CASE("dots: they have no outlines, and a rim but where backs are shown or dots are many", "[display]") {
    PointTable table;
    table.positions.assign(500, Vec3(0.0));
    for (std::size_t k = 0; k < table.positions.size(); ++k) {
        table.positions[k].x = static_cast<double>(k);
    }
    const Bounds scene{Vec3(0.0), Vec3(1.0)};
    const Dots few = make_dots(table, std::nullopt, scene);
    CHECK(few.shown.values.empty());
    CHECK(few.radius <= 0.01 * scene.diagonal());
    PictureSettings settings;
    const PictureMesh round = with_dots(PictureMesh{}, few, settings);
    CHECK(round.without_outline == 500 * 2 * 128); // with rims
    CHECK(round.patches.size() == std::size_t{3} * round.without_outline);
    settings.backs = true; // which a rim would be
    CHECK(with_dots(PictureMesh{}, few, settings).without_outline == 500 * 128);
    table.positions.emplace_back(-1.0);
    CHECK(with_dots(PictureMesh{}, make_dots(table, std::nullopt, scene), settings).without_outline ==
          501 * 8);
    CHECK_THROWS_AS(make_dots(table, 0, scene), InvalidArgument);
    Picture picture;
    picture.width = picture.height = 400;
    picture.srgb.assign(std::size_t{3} * 400 * 400, 0);
    CHECK_FALSE(draw_dots_legend(picture, few));
}

} // namespace hemi
