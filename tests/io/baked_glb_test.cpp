#include "hemi/io/baked_mesh_file.hpp"

#include "hemi/core/error.hpp"
#include "hemi/display/lightmap.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "io/scenes/gltf_file.hpp"
#include "io_fixtures.hpp"
#include "support/png.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace hemi::io_test {

namespace {

/// Two groups, the surfaces of one before and after the other's, far from the origin.
Scene far_scene() {
    Scene scene;
    scene.groups = {"walls", "unused", "sheet"};
    scene.materials = {{"grey", {0.5}, {0.0}}};
    const Vec3 far(1e6, 0, 0);
    Surface wall;
    wall.vertices = {far, far + Vec3(1, 0, 0), far + Vec3(1, 1, 0), far + Vec3(0, 1, 0)};
    wall.patches = Grid{2, 1};
    Surface sheet;
    sheet.vertices = {far + Vec3(0, 0, 1), far + Vec3(1, 0, 1), far + Vec3(0, 1, 1.5), Vec3(0)};
    sheet.vertex_count = 3;
    sheet.group = 2;
    sheet.two_sided = true;
    scene.surfaces = {wall, sheet, wall};
    return scene;
}

/// 0, 0.01, 0.02 ...
std::vector<float> ramp(const PatchMesh& mesh) {
    std::vector<float> values(std::size_t{mesh.size()} * 12);
    for (std::size_t k = 0; k < values.size(); ++k) {
        values[k] = 0.01f * static_cast<float>(k);
    }
    return values;
}

} // namespace

TEST_CASE("Baked glTF: hemi's own reader finds every patch again, in the group it was in", "[io]") {
    const Folder folder;
    const PatchMesh mesh(far_scene());
    REQUIRE(mesh.size() == 6);
    io::write_baked_glb(folder / "a.glb", mesh, ramp(mesh), 2.0);
    Diagnostics diagnostics;
    const Scene scene = io::read_scene(folder / "a.glb", {}, diagnostics);
    REQUIRE(scene.groups == std::vector<std::string>{"walls", "sheet"});
    REQUIRE(scene.surfaces.size() == 10);
    const PatchMesh back(scene);
    for (const std::uint32_t group : {0u, 2u}) {
        double expected = 0.0;
        double found = 0.0;
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            expected += mesh.group(i) == group ? mesh.areas()[i] : 0.0;
        }
        for (std::uint32_t i = 0; i < back.size(); ++i) {
            found += back.group(i) == (group == 0 ? 0u : 1u) ? back.areas()[i] : 0.0;
        }
        REQUIRE(found == Approx(expected).epsilon(1e-6));
    }
    REQUIRE(scene.surfaces[0].vertices[0].x == Approx(1e6).epsilon(1e-12));
    REQUIRE(area_vector(scene.surfaces[0].polygon()).z > 0.0);
    // Front and back of the sheet.
    REQUIRE(area_vector(scene.surfaces[8].polygon()).z > 0.0);
    REQUIRE(area_vector(scene.surfaces[9].polygon()).z < 0.0);
}

TEST_CASE("Baked glTF: colours are linear and end at 1, radiosities are as they were", "[io]") {
    const Folder folder;
    const PatchMesh mesh(far_scene());
    const std::vector<float> values = ramp(mesh);
    io::write_baked_glb(folder / "a.glb", mesh, values, 2.0);
    const io::GltfFile file(folder / "a.glb", false);
    const io::JsonNode meshes = file.root().member("meshes");
    REQUIRE(meshes.size() == 2);
    const std::vector<std::vector<std::uint32_t>> patches{{0, 1, 4, 5}, {2, 3}};
    for (std::size_t m = 0; m < 2; ++m) {
        const io::JsonNode baked = meshes.element(m);
        const io::JsonNode primitives = baked.member("primitives");
        const io::JsonNode primitive = primitives.element(0);
        const io::JsonNode attributes = primitive.member("attributes");
        const io::GltfAccessor colours = file.accessor(attributes.member("COLOR_0"));
        const io::GltfAccessor radiosity = file.accessor(attributes.member("_RADIOSITY"));
        const std::uint32_t corners = m == 0 ? 4 : 3;
        REQUIRE(colours.count() == patches[m].size() * corners);
        REQUIRE(radiosity.count() == colours.count());
        for (std::size_t v = 0; v < colours.count(); ++v) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                const float expected = values[(patches[m][v / corners] * 4 + v % corners) * 3 + c];
                REQUIRE(radiosity.number(v, c) == expected);
                REQUIRE(colours.number(v, c) == std::min(1.0f, 2.0f * expected));
            }
        }
    }
    REQUIRE(file.root().value().at("materials")[0].at("extensions").contains("KHR_materials_unlit"));
    // Bounds are those of the positions as they are stored, which validators check.
    const auto& position = file.root().value().at("accessors")[0];
    REQUIRE(position.at("min") == nlohmann::ordered_json::array({-0.5, -0.5, -0.75}));
    REQUIRE(position.at("max") == nlohmann::ordered_json::array({0.5, 0.5, -0.75}));
}

TEST_CASE("Baked glTF: values that do not fit, and disks that are full, leave no file", "[io]") {
    const Folder folder;
    const PatchMesh mesh(far_scene());
    std::vector<float> values = ramp(mesh);
    const auto write = [&](double exposure) {
        io::write_baked_glb(folder / "a.glb", mesh, values, exposure);
    };
    REQUIRE_THROWS_AS(write(-1.0), InvalidArgument);
    REQUIRE_THROWS_AS(write(std::nan("")), InvalidArgument);
    values[5] = std::numeric_limits<float>::infinity();
    REQUIRE_THROWS_AS(write(1.0), InvalidArgument);
    values.pop_back();
    require_parts(message_of<InvalidArgument>([&] { write(1.0); }), {"71 radiosities for 6 patches"});
    REQUIRE_THROWS_AS(io::write_baked_glb("/dev/full", mesh, ramp(mesh), 1.0), IoError);
    Scene far = far_scene();
    for (Surface& surface : far.surfaces) {
        for (Vec3& vertex : surface.vertices) {
            vertex *= 1e40;
        }
    }
    const PatchMesh huge(far);
    require_parts(
        message_of<InvalidArgument>([&] { io::write_baked_glb(folder / "a.glb", huge, ramp(huge), 1.0); }),
        {"too large for the 32-bit numbers"});
    REQUIRE(folder.files() == 0);
}

TEST_CASE("Baked glTF: a lightmap holds the radiosity of every vertex where that is in it", "[io]") {
    const Folder folder;
    const PatchMesh mesh(far_scene());
    const std::vector<float> values = ramp(mesh);
    const Lightmap map = make_lightmap(mesh, values, 64);
    io::write_lightmapped_glb(folder / "a.glb", mesh, values, 1.25, {map.size, map.texels, map.coordinates});
    const io::GltfFile file(folder / "a.glb", false);
    const std::string bytes = io::read_file(folder / "a.glb");
    std::uint32_t json_bytes = 0;
    std::memcpy(&json_bytes, bytes.data() + 12, sizeof json_bytes);
    const auto json = nlohmann::json::parse(bytes.substr(20, json_bytes));
    const auto texture = json["materials"][0]["emissiveTexture"];
    CHECK(texture["texCoord"] == 1);
    const auto image =
        json["images"][json["textures"][texture["index"].get<std::size_t>()]["source"].get<std::size_t>()];
    CHECK(image["mimeType"] == "image/png");
    const auto view = json["bufferViews"][image["bufferView"].get<std::size_t>()];
    const auto offset = view["byteOffset"].get<std::size_t>();
    CHECK(offset + view["byteLength"].get<std::size_t>() <=
          json["buffers"][0]["byteLength"].get<std::size_t>());
    const test::DeepPicture picture =
        test::read_png_16(bytes.substr(20 + json_bytes + 8 + offset, view["byteLength"].get<std::size_t>()));
    REQUIRE(picture.width == 64);
    REQUIRE(picture.height == 64);
    std::size_t compared = 0;
    for (std::size_t m = 0; m < 2; ++m) {
        const io::JsonNode meshes = file.root().member("meshes");
        const io::JsonNode baked = meshes.element(m);
        const io::JsonNode primitives = baked.member("primitives");
        const io::JsonNode primitive = primitives.element(0);
        const io::JsonNode attributes = primitive.member("attributes");
        CHECK_FALSE(attributes.has("COLOR_0"));
        const io::GltfAccessor places = file.accessor(attributes.member("TEXCOORD_1"));
        const io::GltfAccessor first_places = file.accessor(attributes.member("TEXCOORD_0"));
        const io::GltfAccessor radiosity = file.accessor(attributes.member("_RADIOSITY"));
        REQUIRE(places.count() == radiosity.count());
        for (std::size_t v = 0; v < places.count(); ++v) {
            CHECK(places.number(v, 0) == first_places.number(v, 0));
            const auto x = static_cast<std::size_t>(places.number(v, 0) * 64.0);
            const auto y = static_cast<std::size_t>(places.number(v, 1) * 64.0);
            for (std::uint32_t c = 0; c < 3; ++c) {
                const double coded = picture.pixels[(y * 64 + x) * 3 + c] / 65535.0;
                const double linear =
                    coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
                CHECK(linear == Approx(std::min(1.0, 1.25 * radiosity.number(v, c))).margin(5e-5));
                ++compared;
            }
        }
    }
    CHECK(compared == 3 * (4 * 4 + 2 * 3));
    CHECK_THROWS_AS(
        io::write_lightmapped_glb(folder / "b.glb", mesh, values, 1.0, {32, map.texels, map.coordinates}),
        InvalidArgument);
}

} // namespace hemi::io_test
