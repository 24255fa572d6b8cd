#include "hemi/display/picture_cut.hpp"

#include "display/display_fixtures.hpp"
#include "display/picture_renderer.hpp"
#include "display/visible_point.hpp"
#include "gl/context.hpp"
#include "hemi/core/error.hpp"
#include "hemi/display/picture.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

using namespace hemi;
using hemi::test::SceneBuilder;

namespace {

/// Looks straight down; the square from (-1, -1) to (1, 1) in the plane z = 0 fills the picture, +y up.
Camera from_above() {
    return {{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(0.25) * 180.0 / std::numbers::pi};
}

PictureSettings plain() {
    PictureSettings settings;
    settings.width = 40;
    settings.height = 40;
    settings.tone_mapping = ToneMapping::linear;
    return settings;
}

/// A table, group 1, of radiosity 1 over the right half of a floor, group 0, of radiosity 0.25.
PatchMesh floor_and_table() {
    SceneBuilder builder;
    builder.floor("floor", -1.0, -1.0, 1.0, 1.0);
    builder.add("table", {{0, -1, 0.5}, {1, -1, 0.5}, {1, 1, 0.5}, {0, 1, 0.5}});
    return builder.mesh();
}

PictureMesh drawn_mesh() {
    return make_picture_mesh(floor_and_table(), 1, std::vector<double>{0.25, 1.0}, {}, {0, 0, 0});
}

double linear(const Picture& picture, std::uint32_t x, std::uint32_t y) {
    return static_cast<double>(picture.linear[(std::size_t{y} * picture.width + x) * 3]);
}

int shown(const Picture& picture, std::uint32_t x, std::uint32_t y) {
    return picture.srgb[(std::size_t{y} * picture.width + x) * 3];
}

constexpr int nothing = 44; // 0.025 of the display's white

} // namespace

TEST_CASE("Clip planes: what is written is what is shown, and is read back bit for bit", "[display]") {
    CHECK(parse_clip_plane("x<1.5") == ClipPlane{{1, 0, 0}, 1.5});
    CHECK(parse_clip_plane("z>-2") == ClipPlane{{0, 0, -1}, 2.0});
    CHECK(parse_clip_plane("0,3,4<10") == ClipPlane{{0, 0.6, 0.8}, 2.0});
    CHECK(PictureCut{{}, parse_clip_plane("x<1.5")}.keeps({1.4, 9, 9}));
    CHECK_FALSE(PictureCut{{}, parse_clip_plane("x<1.5")}.keeps({1.6, 9, 9}));
    CHECK_FALSE(PictureCut{{}, parse_clip_plane("x>1.5")}.keeps({1.4, 9, 9}));
    for (const ClipPlane& plane :
         {ClipPlane{{1, 0, 0}, 1.0 / 3.0}, ClipPlane{{0, -1, 0}, 0.1}, ClipPlane{{0, 0, -1}, 0.0},
          ClipPlane{glm::normalize(Vec3(0.3, -0.4, 0.7)), -2.0 / 7.0}}) {
        CHECK(parse_clip_plane(clip_plane_text(plane)) == plane);
    }
    CHECK(clip_plane_text({{0, 0, -1}, 0.0}) == "z>0");
    for (const std::string text : {"", "x", "x<", "w<1", "x<1 ", "x<nan", "1,2<3", "0,0,0<1", "1,2,3,4<5",
                                   "x<<1", "1,2,<3", "x=1", "1e999,0,0<1"}) {
        INFO(text);
        CHECK_THROWS_AS(parse_clip_plane(text), InvalidArgument);
    }
}

TEST_CASE("Picture: a plane cuts what is drawn and what is picked", "[display][gl]") {
    const auto context = gl::make_context("osmesa");
    PictureRenderer renderer;
    renderer.upload(drawn_mesh());
    PictureSettings settings = plain();
    CHECK(linear(renderer.picture(from_above(), settings), 30, 20) == Approx(1.0));
    settings.cut.clip = parse_clip_plane("z<0.25");
    const Picture low = renderer.picture(from_above(), settings);
    CHECK(linear(low, 30, 20) == Approx(0.25));
    CHECK(renderer.item(from_above(), settings, 30, 20) == 0U);
    settings.cut.clip = parse_clip_plane("y>0");
    const Picture half = renderer.picture(from_above(), settings);
    CHECK(linear(half, 10, 10) == Approx(0.25)); // +y is up
    CHECK(shown(half, 10, 30) == nothing);
    CHECK_FALSE(renderer.item(from_above(), settings, 10, 30));
    CHECK(renderer.item(from_above(), settings, 10, 10) == 0U);
    settings.cut.clip.reset();
    CHECK(linear(renderer.picture(from_above(), settings), 10, 30) == Approx(0.25)); // nothing is left behind
}

TEST_CASE("Picture: groups are hidden, or looked through, and then are not picked", "[display][gl]") {
    const auto context = gl::make_context("osmesa");
    PictureRenderer renderer;
    renderer.upload(drawn_mesh());
    PictureSettings settings = plain();
    settings.cut.groups = {Visibility::shown, Visibility::hidden};
    CHECK(linear(renderer.picture(from_above(), settings), 30, 20) == Approx(0.25));
    CHECK(renderer.item(from_above(), settings, 30, 20) == 0U);
    settings.cut.groups = {Visibility::hidden, Visibility::shown};
    const Picture table = renderer.picture(from_above(), settings);
    CHECK(linear(table, 30, 20) == Approx(1.0));
    CHECK(shown(table, 10, 20) == nothing);
    settings.cut.groups = {Visibility::shown, Visibility::outlines};
    const Picture outlines = renderer.picture(from_above(), settings);
    CHECK(linear(outlines, 30, 20) == Approx(0.25)); // through the middle of the table
    CHECK(renderer.item(from_above(), settings, 30, 20) == 0U);
    const Picture bare = [&] {
        PictureSettings hidden = settings;
        hidden.cut.groups[1] = Visibility::hidden;
        return renderer.picture(from_above(), hidden);
    }();
    CHECK(outlines.srgb != bare.srgb); // its left edge is drawn
    CHECK(shown(outlines, 20, 10) > shown(bare, 20, 10) + 10);
    settings.cut.groups.clear();
    CHECK(linear(renderer.picture(from_above(), settings), 30, 20) == Approx(1.0));

    PictureMesh nameless = drawn_mesh();
    nameless.groups.clear();
    renderer.upload(nameless);
    CHECK_NOTHROW(renderer.picture(from_above(), settings));
    settings.cut.groups = {Visibility::hidden};
    CHECK_THROWS_AS(renderer.picture(from_above(), settings), InvalidArgument);
}

TEST_CASE("visible_point: what is cut or hidden is looked through", "[display]") {
    const PatchMesh mesh = floor_and_table();
    const Vec3 eye{0.5, 0.2, 4.0};
    const Vec3 down{0, 0, -1};
    CHECK(visible_point(mesh, eye, down)->surface == 1);
    CHECK(visible_point(mesh, eye, down, false, {{Visibility::shown, Visibility::outlines}, {}})->surface ==
          0);
    CHECK(visible_point(mesh, eye, down, false, {{}, parse_clip_plane("z<0.25")})->surface == 0);
    CHECK_FALSE(visible_point(mesh, eye, down, false, {{}, parse_clip_plane("x<0")}));
}
