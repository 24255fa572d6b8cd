#include "hemi/display/picture.hpp"

#include "display/display_fixtures.hpp"
#include "display/picture_renderer.hpp"
#include "gl/context.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

using namespace hemi;
using hemi::test::SceneBuilder;

namespace {

using Pixel = std::array<int, 3>;

const Pixel background{44, 44, 44}; // 0.025 of the display's white

Pixel pixel(const Picture& picture, std::uint32_t x, std::uint32_t y) {
    const std::size_t at = (std::size_t{y} * picture.width + x) * 3;
    return {picture.srgb[at], picture.srgb[at + 1], picture.srgb[at + 2]};
}

double linear(const Picture& picture, std::uint32_t x, std::uint32_t y) {
    return static_cast<double>(picture.linear[(std::size_t{y} * picture.width + x) * 3]);
}

/// sRGB's own curve, as an 8-bit value.
int encoded(double value) {
    const double curve = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
    return static_cast<int>(std::lround(255.0 * curve));
}

/// Looks straight down; the square from (-1, -1) to (1, 1) in the plane z = 0 fills the picture, +y up.
Camera from_above() {
    return {{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(0.25) * 180.0 / std::numbers::pi};
}

PictureSettings plain(std::uint32_t width, std::uint32_t height) {
    PictureSettings settings;
    settings.width = width;
    settings.height = height;
    settings.tone_mapping = ToneMapping::linear;
    return settings;
}

/// A square from (-0.5, -0.5) to (0.5, 0.5): the middle quarter of what from_above() sees.
PictureMesh square(double radiosity, Grid grid = {1, 1}) {
    SceneBuilder builder;
    builder.floor("square", -0.5, -0.5, 0.5, 0.5, grid);
    const PatchMesh mesh = builder.mesh();
    return make_picture_mesh(mesh, 1, std::vector<double>(mesh.size(), radiosity), {}, {0, 0, 0});
}

/// The whole view, radiosity 0 on its left and `right` on its right edge.
PictureMesh ramp(float right) {
    SceneBuilder builder;
    builder.floor("ramp", -1.0, -1.0, 1.0, 1.0);
    PictureMesh mesh = make_picture_mesh(builder.mesh(), 1, std::vector<double>{1.0}, {}, {0, 0, 0});
    for (std::size_t k = 0; k < 4; ++k) {
        std::fill_n(mesh.corners.begin() + static_cast<std::ptrdiff_t>(k * 3), 3,
                    mesh.positions[k * 3] > 0.0F ? right : 0.0F);
    }
    return mesh;
}

} // namespace

TEST_CASE("Picture: a surface has the colour of its radiosity, what is empty is dark grey", "[display][gl]") {
    for (const double value : {0.0, 0.001, 0.1, 0.5, 1.0, 3.0}) {
        const Picture picture = draw_picture(square(value), from_above(), plain(80, 80), "osmesa");
        REQUIRE(picture.srgb.size() == 80 * 80 * 3);
        REQUIRE(picture.linear.size() == 80 * 80 * 3);
        const int expected = encoded(std::min(value, 1.0));
        for (const auto& [x, y] : {std::pair{21, 21}, {40, 40}, {58, 58}, {58, 21}}) {
            const Pixel found = pixel(picture, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
            for (const int channel : found) {
                CHECK(std::abs(channel - expected) <= 1);
            }
            CHECK(linear(picture, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)) ==
                  Approx(value).epsilon(1e-6));
        }
        CHECK(pixel(picture, 5, 40) == background);
        CHECK(pixel(picture, 79, 79) == background);
        CHECK(linear(picture, 5, 40) == 0.0);
    }
}

TEST_CASE("Picture: an environment shows where no surface is", "[display][gl]") {
    PictureMesh mesh = square(0.5);
    mesh.environment = {2.0F, 0.0F, 0.25F};
    PictureSettings settings = plain(20, 20);
    settings.exposure = 0.25;
    const Picture picture = draw_picture(mesh, from_above(), settings, "osmesa");
    CHECK(std::abs(pixel(picture, 1, 1)[0] - encoded(0.5)) <= 1);
    CHECK(pixel(picture, 1, 1)[1] == 0);
    CHECK(linear(picture, 1, 1) == 2.0);
    CHECK(linear(picture, 10, 10) == Approx(0.5));
}

TEST_CASE("Picture: the first row is the upper one, the first column the left one", "[display][gl]") {
    SceneBuilder builder;
    builder.floor("upper left", -0.9, 0.1, -0.1, 0.9);
    const PatchMesh mesh = builder.mesh();
    const PictureMesh drawn = make_picture_mesh(mesh, 1, std::vector<double>{1.0}, {}, {0, 0, 0});
    const Picture picture = draw_picture(drawn, from_above(), plain(40, 40), "osmesa");
    CHECK(pixel(picture, 10, 10) == Pixel{255, 255, 255});
    CHECK(pixel(picture, 30, 10) == background);
    CHECK(pixel(picture, 10, 30) == background);
}

TEST_CASE("Picture: exposure multiplies what is shown and leaves the linear values alone", "[display][gl]") {
    PictureSettings settings = plain(16, 16);
    settings.exposure = 0.25;
    const Picture picture = draw_picture(square(2.0), from_above(), settings, "osmesa");
    CHECK(std::abs(pixel(picture, 8, 8)[0] - encoded(0.5)) <= 1);
    CHECK(linear(picture, 8, 8) == Approx(2.0));
}

TEST_CASE("Picture: tone mapping never turns brighter into darker", "[display][gl]") {
    for (const ToneMapping mapping : {ToneMapping::filmic, ToneMapping::linear}) {
        PictureSettings settings = plain(600, 1);
        settings.tone_mapping = mapping;
        Camera camera = from_above();
        camera.fov = 2.0 * std::atan(0.25 / 600.0) * 180.0 / std::numbers::pi; // the ramp is 600 pixels wide
        const Picture picture = draw_picture(ramp(20.0F), camera, settings, "osmesa");
        REQUIRE(linear(picture, 599, 0) > linear(picture, 0, 0));
        for (std::uint32_t x = 1; x < 600; ++x) {
            REQUIRE(pixel(picture, x, 0)[0] >= pixel(picture, x - 1, 0)[0]);
        }
        CHECK(pixel(picture, 599, 0)[0] == 255);
        CHECK(pixel(picture, 0, 0)[0] < 60);
    }
}

TEST_CASE("Picture: Gouraud shading runs straight from corner to corner", "[display][gl]") {
    const Picture picture = draw_picture(ramp(1.0F), from_above(), plain(64, 64), "osmesa");
    for (std::uint32_t x = 0; x < 64; ++x) {
        for (const std::uint32_t y : {0U, 31U, 63U}) {
            CHECK(linear(picture, x, y) == Approx((x + 0.5) / 64.0).margin(1e-4));
        }
    }
}

TEST_CASE("Picture: a quadrilateral's centre is the mean of its corners and shows no diagonal",
          "[display][gl]") {
    PictureMesh mesh = ramp(0.0F);
    std::fill_n(mesh.corners.begin(), 3, 1.0F); // one bright corner, lower left
    const Picture picture = draw_picture(mesh, from_above(), plain(65, 65), "osmesa");
    CHECK(linear(picture, 32, 32) == Approx(0.25).margin(0.01));
    // The same along both of the other corners' sides.
    for (std::uint32_t i = 0; i < 65; ++i) {
        CHECK(linear(picture, i, 64) == Approx(linear(picture, 0, 64 - i)).margin(1e-5));
    }
}

TEST_CASE("Picture: flat shading shows each patch in one colour", "[display][gl]") {
    SceneBuilder builder;
    builder.floor("two", -1.0, -1.0, 1.0, 1.0, {2, 1});
    const PatchMesh mesh = builder.mesh();
    const PictureMesh drawn = make_picture_mesh(mesh, 1, std::vector<double>{0.2, 0.6}, {}, {0, 0, 0});
    PictureSettings settings = plain(32, 32);
    settings.shading = Shading::flat;
    const Picture picture = draw_picture(drawn, from_above(), settings, "osmesa");
    for (std::uint32_t x = 0; x < 32; ++x) {
        CHECK(linear(picture, x, 7) == Approx(x < 16 ? 0.2 : 0.6).epsilon(1e-6));
    }
}

TEST_CASE("Picture: edges are smooth in as many steps as there are samples", "[display][gl]") {
    SceneBuilder builder;
    builder.floor("half a pixel", -1.0, -1.0, 0.125, 1.0); // ends in the middle of pixel 4 of 8
    const PatchMesh mesh = builder.mesh();
    const PictureMesh drawn = make_picture_mesh(mesh, 1, std::vector<double>{1.0}, {}, {0, 0, 0});
    PictureSettings settings = plain(8, 8);
    const Picture smooth = draw_picture(drawn, from_above(), settings, "osmesa");
    CHECK(linear(smooth, 3, 4) == 1.0);
    CHECK(linear(smooth, 4, 4) == Approx(0.5));
    CHECK(linear(smooth, 5, 4) == 0.0);
    CHECK(std::abs(pixel(smooth, 4, 4)[0] - encoded(0.5 * (1.0 + 0.025))) <= 1);
    settings.samples = 1;
    const Picture hard = draw_picture(drawn, from_above(), settings, "osmesa");
    for (std::uint32_t x = 0; x < 8; ++x) {
        const double value = linear(hard, x, 4);
        CHECK((value == 0.0 || value == 1.0));
    }
}

TEST_CASE("Picture: backs are not drawn, both sides of a two-sided sheet are", "[display][gl]") {
    SceneBuilder builder;
    builder.add("faces down", {{-1, -1, 0}, {-1, 1, 0}, {0, 1, 0}, {0, -1, 0}});
    builder.add("sheet", {{0, -1, 0}, {0, 1, 0}, {1, 1, 0}, {1, -1, 0}}).two_sided = true;
    const PatchMesh mesh = builder.mesh();
    const PictureMesh drawn = make_picture_mesh(mesh, 1, std::vector<double>{0.3, 0.5, 0.8}, {}, {0, 0, 0});
    const Picture above = draw_picture(drawn, from_above(), plain(16, 16), "osmesa");
    CHECK(pixel(above, 4, 8) == background);
    CHECK(linear(above, 12, 8) == Approx(0.8)); // the sheet's back looks up
    Camera camera = from_above();
    camera.eye.z = -4.0;
    const Picture below = draw_picture(drawn, camera, plain(16, 16), "osmesa"); // left and right swapped
    CHECK(linear(below, 12, 8) == Approx(0.3));
    CHECK(linear(below, 4, 8) == Approx(0.5));
}

TEST_CASE("Picture: backs that are shown are striped, and no light", "[display][gl]") {
    SceneBuilder builder;
    builder.add("faces down", {{-1, -1, 0}, {-1, 1, 0}, {0, 1, 0}, {0, -1, 0}});
    builder.add("sheet", {{0, -1, 0}, {0, 1, 0}, {1, 1, 0}, {1, -1, 0}}).two_sided = true;
    builder.floor("below", -1, -1, 1, 1);
    for (Vec3& vertex : builder.scene.surfaces[2].vertices) {
        vertex.z = -1.0;
    }
    const PatchMesh mesh = builder.mesh();
    const PictureMesh drawn =
        make_picture_mesh(mesh, 1, std::vector<double>{0.3, 0.5, 0.8, 0.9}, {}, {0, 0, 0});
    PictureSettings settings = plain(48, 48);
    CHECK(linear(draw_picture(drawn, from_above(), settings, "osmesa"), 12, 24) == Approx(0.9));
    settings.backs = true;
    const Picture above = draw_picture(drawn, from_above(), settings, "osmesa");
    std::vector<Pixel> stripes;
    for (std::uint32_t y = 4; y < 44; ++y) {
        for (std::uint32_t x = 2; x < 22; ++x) {
            stripes.push_back(pixel(above, x, y));
            CHECK(linear(above, x, y) == 0.0);
            CHECK(linear(above, x + 24, y) == Approx(0.8)); // both sides of the sheet are fronts
        }
    }
    CHECK(std::find(stripes.begin(), stripes.end(), Pixel{encoded(0.35), encoded(0.04), encoded(0.16)}) !=
          stripes.end());
    CHECK(std::find(stripes.begin(), stripes.end(), Pixel{encoded(0.12), encoded(0.02), encoded(0.06)}) !=
          stripes.end());
}

TEST_CASE("Picture: an orthographic camera shows everything at the scale of its target", "[display][gl]") {
    SceneBuilder builder;
    builder.floor("near", -0.5, -0.5, 0.5, 0.0);
    builder.floor("far", -0.5, 0.0, 0.5, 0.5);
    for (Vec3& vertex : builder.scene.surfaces[0].vertices) {
        vertex.z = 7.0; // behind the eye
    }
    const PatchMesh mesh = builder.mesh();
    const PictureMesh drawn = make_picture_mesh(mesh, 1, std::vector<double>{0.3, 0.6}, {}, {0, 0, 0});
    Camera camera = from_above();
    camera.orthographic = true;
    const Picture picture = draw_picture(drawn, camera, plain(32, 32), "osmesa");
    for (std::uint32_t y = 0; y < 32; ++y) {
        for (std::uint32_t x = 0; x < 32; ++x) {
            const bool inside = x >= 8 && x < 24 && y >= 8 && y < 24;
            CHECK(linear(picture, x, y) == Approx(inside ? (y < 16 ? 0.6 : 0.3) : 0.0));
        }
    }
    // Larger pictures are drawn in tiles.
    const Picture large = draw_picture(drawn, camera, plain(640, 640), "osmesa");
    CHECK(linear(large, 161, 400) == Approx(0.3));
    CHECK(linear(large, 158, 400) == 0.0);
    CHECK(linear(large, 478, 161) == Approx(0.6));
    CHECK(linear(large, 478, 158) == 0.0);
}

TEST_CASE("Picture: nearer surfaces hide farther ones, down to a millionth of the distance",
          "[display][gl]") {
    for (const double gap : {1.0, 1e-3, 1e-5}) {
        SceneBuilder builder;
        builder.floor("wall", -1.0, -1.0, 1.0, 1.0);
        builder.add("poster", {{-0.5, -0.5, gap}, {0.5, -0.5, gap}, {0.5, 0.5, gap}, {-0.5, 0.5, gap}});
        for (const bool poster_first : {false, true}) {
            if (poster_first) {
                std::swap(builder.scene.surfaces[0], builder.scene.surfaces[1]);
            }
            const PatchMesh mesh = builder.mesh();
            std::vector<double> values{0.2, 0.9};
            if (poster_first) {
                std::swap(values[0], values[1]);
            }
            const PictureMesh drawn = make_picture_mesh(mesh, 1, values, {}, {0, 0, 0});
            const Picture picture = draw_picture(drawn, from_above(), plain(20, 20), "osmesa");
            CHECK(linear(picture, 10, 10) == Approx(0.9));
            CHECK(linear(picture, 8, 12) == Approx(0.9));
            CHECK(linear(picture, 1, 1) == Approx(0.2));
        }
    }
}

TEST_CASE("Picture: no background shows between surfaces of a closed room", "[display][gl]") {
    SceneBuilder builder;
    builder.add("g", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {17, 23});
    builder.add("g", {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}, {29, 31});
    builder.add("g", {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}, {19, 13});
    builder.add("g", {{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}, {11, 7});
    builder.add("g", {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}, {37, 41});
    builder.add("g", {{1, 0, 0}, {1, 0, 1}, {1, 1, 1}, {1, 1, 0}}, {5, 3});
    const PatchMesh mesh = builder.mesh();
    const PictureMesh drawn =
        make_picture_mesh(mesh, 1, std::vector<double>(mesh.size(), 0.5), {}, {0, 0, 0});
    for (int view = 0; view < 4; ++view) {
        const double angle = 1.1 * view;
        const Camera camera{{0.3, 0.4, 0.6},
                            {0.5 + 0.4 * std::cos(angle), 0.5 + 0.4 * std::sin(angle), 0.45},
                            {0, 0, 1},
                            90.0};
        const Picture picture = draw_picture(drawn, camera, plain(400, 400), "osmesa");
        CHECK(*std::min_element(picture.linear.begin(), picture.linear.end()) > 0.49999F);
        CHECK(*std::max_element(picture.linear.begin(), picture.linear.end()) < 0.50001F);
    }
}

TEST_CASE("Picture: odd sizes work", "[display][gl]") {
    for (const auto& [width, height] : {std::pair{1U, 1U}, {333U, 77U}, {1U, 500U}, {1300U, 2U}}) {
        const Picture picture = draw_picture(square(0.5), from_above(), plain(width, height), "osmesa");
        CHECK(picture.width == width);
        CHECK(picture.height == height);
        REQUIRE(picture.srgb.size() == std::size_t{width} * height * 3);
        REQUIRE(picture.linear.size() == std::size_t{width} * height * 3);
        if (width == 333U) {
            CHECK(linear(picture, 166, 38) == Approx(0.5));
            CHECK(linear(picture, 166 - 18, 38) == Approx(0.5));
            CHECK(linear(picture, 166 - 21, 38) == 0.0);
        }
    }
}

TEST_CASE("Picture: tiles of a large picture fit together", "[display][gl]") {
    // 8 samples an edge: tiles of 128 pixels.
    PictureSettings settings = plain(1100, 600);
    settings.samples = 8;
    Camera camera = from_above();
    const Picture picture = draw_picture(ramp(1.0F), camera, settings, "osmesa");
    // The ramp spans 600 pixels in the middle and goes on evenly across the tiles; so do the rows.
    for (std::uint32_t x = 260; x < 840; ++x) {
        REQUIRE(linear(picture, x, 300) == Approx((x - 250 + 0.5) / 600.0).margin(1e-4));
        REQUIRE(linear(picture, x, 10) == Approx(linear(picture, x, 590)).margin(1e-5));
    }
}

TEST_CASE("Picture: two runs give equal pixels, and so do OSMesa and EGL in software", "[display][gl]") {
    SceneBuilder builder;
    builder.add("a", {{-0.7, -0.8, 0}, {0.8, -0.5, 0.1}, {0.6, 0.7, 0.3}}, {9, 9});
    builder.floor("b", -1.0, -1.0, 1.0, 1.0, {13, 7});
    const PatchMesh mesh = builder.mesh();
    std::vector<double> values;
    for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
        values.push_back(0.1 + 0.05 * (patch % 17));
    }
    const PictureMesh drawn = make_picture_mesh(mesh, 1, values, {}, {0, 0, 0});
    const PictureSettings settings = plain(123, 99);
    const Picture first = draw_picture(drawn, from_above(), settings, "osmesa");
    const Picture second = draw_picture(drawn, from_above(), settings, "osmesa");
    CHECK(first.srgb == second.srgb);
    CHECK(first.linear == second.linear);
    if (gl::make_context("egl")->software()) {
        const Picture egl = draw_picture(drawn, from_above(), settings, "egl");
        CHECK(first.srgb == egl.srgb);
        CHECK(first.linear == egl.linear);
    }
}

TEST_CASE("Picture: scale and place of the scene do not matter", "[display][gl]") {
    const auto at = [](double scale, const Vec3& shift) {
        SceneBuilder builder;
        builder.add("g", {shift + scale * Vec3(-0.5, -0.5, 0), shift + scale * Vec3(0.5, -0.5, 0),
                          shift + scale * Vec3(0.5, 0.5, 0), shift + scale * Vec3(-0.5, 0.5, 0)});
        const PatchMesh mesh = builder.mesh();
        Camera camera = from_above();
        camera.eye = shift + scale * camera.eye;
        camera.target = shift;
        return draw_picture(make_picture_mesh(mesh, 1, std::vector<double>{0.5}, {}, {0, 0, 0}), camera,
                            plain(33, 33), "osmesa")
            .srgb;
    };
    const auto reference = at(1.0, Vec3(0.0));
    CHECK(at(1e-6, Vec3(0.0)) == reference);
    CHECK(at(1e6, Vec3(0.0)) == reference);
    CHECK(at(1.0, Vec3(1e5, -1e5, 1e5)) == reference);
}

TEST_CASE("Picture: outlines darken the edges of patches only", "[display][gl]") {
    PictureSettings settings = plain(100, 100);
    settings.outlines = true;
    const Picture picture = draw_picture(square(0.5, {2, 1}), from_above(), settings, "osmesa");
    CHECK(linear(picture, 50, 60) < 0.4);          // between the two patches
    CHECK(linear(picture, 37, 50) == Approx(0.5)); // a patch's centre, where its triangles meet
    CHECK(linear(picture, 31, 31) == Approx(0.5)); // on a diagonal
}

TEST_CASE("Picture: settings that make no sense are refused", "[display][gl]") {
    const PictureMesh mesh = square(0.5);
    const Camera camera = from_above();
    CHECK_THROWS_AS(draw_picture(mesh, camera, plain(0, 10), "osmesa"), InvalidArgument);
    CHECK_THROWS_AS(draw_picture(mesh, camera, plain(10, 16385), "osmesa"), InvalidArgument);
    CHECK_THROWS_AS(draw_picture(mesh, camera, plain(10, 10), "no such device"), InvalidArgument);
    PictureSettings settings = plain(10, 10);
    settings.samples = 9;
    CHECK_THROWS_AS(draw_picture(mesh, camera, settings, "osmesa"), InvalidArgument);
    settings = plain(10, 10);
    settings.exposure = -1.0;
    CHECK_THROWS_AS(draw_picture(mesh, camera, settings, "osmesa"), InvalidArgument);
    Camera blind = camera;
    blind.target = blind.eye;
    CHECK_THROWS_AS(draw_picture(mesh, blind, plain(10, 10), "osmesa"), InvalidArgument);
    Camera wide = camera;
    wide.fov = 180.0;
    CHECK_THROWS_AS(draw_picture(mesh, wide, plain(10, 10), "osmesa"), InvalidArgument);
}

TEST_CASE("Picture: a camera that looks along its up direction still shows something", "[display][gl]") {
    Camera camera = from_above();
    camera.up = {0, 0, 1};
    const Picture picture = draw_picture(square(0.5), camera, plain(10, 10), "osmesa");
    CHECK(linear(picture, 5, 5) == Approx(0.5));
}

TEST_CASE("PictureRenderer: an item is what the item buffer holds there", "[display][gl]") {
    SceneBuilder builder;
    builder.floor("below", -1.0, -1.0, 1.0, 0.5, {3, 2});
    builder.add("above", {{-0.5, -0.5, 0.5}, {0.7, -0.4, 0.5}, {0.1, 0.6, 0.5}}, {2, 2});
    const PatchMesh mesh = builder.mesh();
    const auto context = gl::make_context("osmesa");
    PictureRenderer renderer;
    renderer.upload(make_picture_mesh(mesh, 1, std::vector<double>(mesh.size(), 1.0), {}, {0, 0, 0}));
    const PictureSettings settings = plain(60, 40);
    const std::vector<std::uint32_t> items = renderer.items(from_above(), settings);
    REQUIRE(items.size() == 60 * 40);
    std::size_t wrong = 0;
    std::size_t seen = 0;
    for (std::uint32_t y = 0; y < 40; ++y) {
        for (std::uint32_t x = 0; x < 60; ++x) {
            const std::uint32_t item = items[std::size_t{y} * 60 + x];
            const auto found = renderer.item(from_above(), settings, x, y);
            wrong += found.value_or(PictureRenderer::no_item) == item ? 0 : 1;
            seen += item == PictureRenderer::no_item ? 0 : 1;
        }
    }
    CHECK(wrong == 0);
    CHECK(seen > 40 * 30); // a square of 40 pixels less its upper quarter, and a tip of the triangle
    CHECK(seen < 40 * 30 + 20);
    CHECK(renderer.item(from_above(), settings, 30, 38).value() == 1); // middle of the lower row
    CHECK(renderer.item(from_above(), settings, 30, 20).value() >= 6); // the triangle hides the square
    CHECK_THROWS_AS(renderer.item(from_above(), settings, 60, 0), InvalidArgument);
}
