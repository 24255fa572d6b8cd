#include "hemi/io/scene_reader.hpp"

#include "io/formats/base64.hpp"
#include "io_fixtures.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>

namespace hemi::io_test {

namespace {

using Json = nlohmann::json;

template <class T>
std::string bytes_of(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

/// Four corners of a unit square, 48 bytes, then six 16-bit indices.
const std::string square_bytes =
    bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 3});

Json square() {
    return Json::parse(R"({
        "asset": {"version": "2.0"},
        "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "floor", "mesh": 0}],
        "meshes": [{"name": "plate",
                    "primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "paint", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.75, 1]}}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
                      {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 6}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"byteLength": 60, "uri": "square.bin"}]})");
}

std::string word(std::uint32_t value) {
    return bytes_of<std::uint32_t>({value});
}

std::string glb(Json document, const std::string& binary) {
    document["buffers"][0].erase("uri");
    std::string json = document.dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto size = static_cast<std::uint32_t>(28 + json.size() + binary.size());
    return "glTF" + word(2) + word(size) + word(static_cast<std::uint32_t>(json.size())) + "JSON" + json +
           word(static_cast<std::uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
}

Scene read(const std::filesystem::path& path, Diagnostics* diagnostics = nullptr,
           const io::SceneReaderOptions& options = {}) {
    Diagnostics unused;
    return io::read_scene(path, options, diagnostics != nullptr ? *diagnostics : unused);
}

Scene read(const Folder& folder, const Json& document, Diagnostics* diagnostics = nullptr,
           const io::SceneReaderOptions& options = {}) {
    folder.write("square.bin", square_bytes);
    return read(folder.write("room.gltf", document.dump()), diagnostics, options);
}

void require_near(const Vec3& a, const Vec3& b) {
    INFO(a.x << " " << a.y << " " << a.z << " and " << b.x << " " << b.y << " " << b.z);
    REQUIRE(glm::length(a - b) < 1e-12);
}

bool has_warning(const Diagnostics& diagnostics, const std::string& part) {
    const auto& all = diagnostics.warnings();
    return std::any_of(all.begin(), all.end(),
                       [&](const std::string& text) { return text.find(part) != std::string::npos; });
}

} // namespace

TEST_CASE("Base64: text with and without padding, and what is none", "[io]") {
    REQUIRE(io::decode_base64("") == "");
    REQUIRE(io::decode_base64("Zg==") == "f");
    REQUIRE(io::decode_base64("Zm8=") == "fo");
    REQUIRE(io::decode_base64("Zm8") == "fo");
    REQUIRE(io::decode_base64("Zm9vYmFy") == "foobar");
    REQUIRE(io::decode_base64("+/+/") == "\xFB\xFF\xBF");
    for (const char* bad : {"Z", "Zm9vY", "Zm9 ", "Zm=v", "Zm9v====", "Z\xC3\xA4=="}) {
        INFO(bad);
        REQUIRE_FALSE(io::decode_base64(bad).has_value());
    }
}

TEST_CASE("glTF reader: triangles become surfaces in the group of their node", "[io]") {
    const Folder folder;
    const Scene scene = read(folder, square());
    REQUIRE(scene.name == "room");
    REQUIRE(scene.channels == std::vector<std::string>{"red", "green", "blue"});
    REQUIRE(scene.groups == std::vector<std::string>{"floor"});
    REQUIRE(scene.materials == std::vector<Material>{{"paint", {0.5, 0.25, 0.75}, {0, 0, 0}}});
    REQUIRE(scene.surfaces.size() == 2);
    REQUIRE(scene.surfaces[1].vertex_count == 3);
    REQUIRE(scene.surfaces[1].vertices[1] == Vec3(1, 1, 0));
    REQUIRE(scene.surfaces[1].vertices[2] == Vec3(0, 1, 0));
    REQUIRE_FALSE(scene.surfaces[0].two_sided);
    REQUIRE_FALSE(scene.camera.has_value());
    REQUIRE(scene.up == UpAxis::y);
}

TEST_CASE("glTF reader: .glb, a file beside it and a data URI say the same", "[io]") {
    const Folder folder;
    Json document = square();
    const Scene beside = read(folder, document);
    const Scene binary = read(folder.write("room.glb", glb(document, square_bytes)));
    document["buffers"][0]["uri"] =
        "data:application/"
        "octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAA"
        "AAABAAIAAAACAAMA";
    const Scene inside = read(folder, document);
    document["buffers"][0]["uri"] = "sub%20folder/%73quare.bin";
    std::filesystem::create_directory(folder / "sub folder");
    folder.write("sub folder/square.bin", square_bytes);
    const Scene below = read(folder, document);
    for (const Scene& other : {binary, inside, below}) {
        REQUIRE(other.surfaces.size() == 2);
        for (std::size_t s = 0; s < 2; ++s) {
            REQUIRE(other.surfaces[s].vertices == beside.surfaces[s].vertices);
        }
        REQUIRE(other.materials == beside.materials);
    }
}

TEST_CASE("glTF reader: every width of index, none, and interleaved positions are read alike", "[io]") {
    const Folder folder;
    const Scene expected = read(folder, square());
    const auto require_same = [&](Json document, const std::string& bytes) {
        document["buffers"][0]["byteLength"] = bytes.size();
        const Scene scene = read(folder.write("other.glb", glb(document, bytes)));
        REQUIRE(scene.surfaces.size() == 2);
        for (std::size_t s = 0; s < 2; ++s) {
            REQUIRE(scene.surfaces[s].vertices == expected.surfaces[s].vertices);
        }
    };
    Json document = square();
    document["accessors"][1]["componentType"] = 5121;
    document["bufferViews"][1]["byteLength"] = 6;
    require_same(document, square_bytes.substr(0, 48) + std::string("\0\1\2\0\2\3", 6));
    document["accessors"][1]["componentType"] = 5125;
    document["bufferViews"][1]["byteLength"] = 24;
    require_same(document, square_bytes.substr(0, 48) + bytes_of<std::uint32_t>({0, 1, 2, 0, 2, 3}));

    document = square();
    document["meshes"][0]["primitives"][0].erase("indices");
    document["accessors"][0]["count"] = 6;
    document["bufferViews"][0]["byteLength"] = 72;
    require_same(document, bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0}));

    document = square();
    document["bufferViews"][0] = {{"buffer", 0}, {"byteOffset", 12}, {"byteLength", 76}, {"byteStride", 20}};
    document["accessors"][0]["byteOffset"] = 4;
    std::string bytes = square_bytes.substr(48);
    for (std::size_t k = 0; k < 4; ++k) {
        bytes += "abcd" + square_bytes.substr(12 * k, 12) + (k < 3 ? "efgh" : "");
    }
    document["bufferViews"][1]["byteOffset"] = 0;
    require_same(document, bytes);
}

TEST_CASE("glTF reader: sparse accessors change some elements, of a buffer or of zeros", "[io]") {
    const Folder folder;
    const Scene expected = read(folder, square());
    const auto require_same = [&](Json document, const std::string& bytes) {
        document["buffers"][0]["byteLength"] = bytes.size();
        const Scene scene = read(folder.write("sparse.glb", glb(document, bytes)));
        REQUIRE(scene.surfaces.size() == 2);
        for (std::size_t s = 0; s < 2; ++s) {
            REQUIRE(scene.surfaces[s].vertices == expected.surfaces[s].vertices);
        }
    };
    // Corners 1 to 3 are put in: the first one is 0 by itself.
    Json document = square();
    document["accessors"][0].erase("bufferView");
    document["accessors"][0]["sparse"] = Json::parse(
        R"({"count": 3, "indices": {"bufferView": 1, "byteOffset": 2, "componentType": 5121},
            "values": {"bufferView": 0, "byteOffset": 12}})");
    document["bufferViews"][1]["byteLength"] = 17;
    document["accessors"][1]["byteOffset"] = 5;
    const std::string indices = square_bytes.substr(48);
    require_same(document, square_bytes.substr(0, 48) + std::string("\7\7\1\2\3", 5) + indices);

    // Wrong corners are put right, and wrong indices.
    document = square();
    document["accessors"][0]["sparse"] = Json::parse(
        R"({"count": 2, "indices": {"bufferView": 2, "componentType": 5123},
            "values": {"bufferView": 2, "byteOffset": 4}})");
    document["accessors"][1]["sparse"] = Json::parse(
        R"({"count": 1, "indices": {"bufferView": 3, "componentType": 5125},
            "values": {"bufferView": 3, "byteOffset": 4}})");
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 60}, {"byteLength", 28}});
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 88}, {"byteLength", 6}});
    std::string wrong = square_bytes;
    wrong.replace(12, 12, bytes_of<float>({9, 9, 9}));
    wrong.replace(36, 12, bytes_of<float>({8, 8, 8}));
    wrong.replace(58, 2, bytes_of<std::uint16_t>({77}));
    require_same(document, wrong + bytes_of<std::uint16_t>({1, 3}) + bytes_of<float>({1, 0, 0, 0, 1, 0}) +
                               word(5) + bytes_of<std::uint16_t>({3}));
}

TEST_CASE("glTF reader: quantized positions, plain and as shares, signed and not", "[io]") {
    const Folder folder;
    const auto first_triangle = [&](std::uint32_t type, bool normalized, const std::string& positions) {
        Json document = square();
        document["extensionsRequired"] = {"KHR_mesh_quantization"};
        document["extensionsUsed"] = {"KHR_mesh_quantization"};
        document["accessors"][0]["componentType"] = type;
        document["accessors"][0]["count"] = 3;
        document["accessors"][0]["normalized"] = normalized;
        document["bufferViews"][0]["byteLength"] = positions.size();
        document["bufferViews"][0]["byteStride"] = positions.size() / 3;
        document["buffers"][0]["byteLength"] = positions.size();
        document["bufferViews"].erase(1);
        document["accessors"].erase(1);
        document["meshes"][0]["primitives"][0].erase("indices");
        Diagnostics diagnostics;
        const Scene scene = read(folder.write("quantized.glb", glb(document, positions)), &diagnostics);
        REQUIRE(diagnostics.warnings().empty());
        REQUIRE(scene.surfaces.size() == 1);
        return scene.surfaces[0].vertices;
    };
    const auto corners = [](const Vec3& a, const Vec3& b, const Vec3& c) {
        return std::array<Vec3, 4>{a, b, c, Vec3(0.0)};
    };
    // Elements of 3 bytes are padded to 4, those of 6 to 8.
    const auto i8 = bytes_of<std::int8_t>({-128, 0, 5, 0, 127, 0, 5, 0, 0, 127, -127, 0});
    CHECK(first_triangle(5120, false, i8) == corners({-128, 0, 5}, {127, 0, 5}, {0, 127, -127}));
    CHECK(first_triangle(5120, true, i8) == corners({-1, 0, 5 / 127.0}, {1, 0, 5 / 127.0}, {0, 1, -1}));
    const auto u8 = bytes_of<std::uint8_t>({0, 0, 51, 0, 255, 0, 51, 0, 0, 255, 51, 0});
    CHECK(first_triangle(5121, false, u8) == corners({0, 0, 51}, {255, 0, 51}, {0, 255, 51}));
    CHECK(first_triangle(5121, true, u8) == corners({0, 0, 0.2}, {1, 0, 0.2}, {0, 1, 0.2}));
    const auto i16 = bytes_of<std::int16_t>({-32768, 0, 0, 0, 32767, 0, 0, 0, 0, 300, 0, 0});
    CHECK(first_triangle(5122, false, i16) == corners({-32768, 0, 0}, {32767, 0, 0}, {0, 300, 0}));
    CHECK(first_triangle(5122, true, i16) == corners({-1, 0, 0}, {1, 0, 0}, {0, 300 / 32767.0, 0}));
    const auto u16 = bytes_of<std::uint16_t>({0, 0, 0, 0, 65535, 0, 0, 0, 0, 13107, 0, 0});
    CHECK(first_triangle(5123, false, u16) == corners({0, 0, 0}, {65535, 0, 0}, {0, 13107, 0}));
    CHECK(first_triangle(5123, true, u16) == corners({0, 0, 0}, {1, 0, 0}, {0, 0.2, 0}));
}

TEST_CASE("glTF reader: a closed room that is double-sided has its inside alone, unless asked otherwise",
          "[io]") {
    const Folder folder;
    Json document = square();
    std::vector<float> points;
    for (int k = 0; k < 8; ++k) {
        for (const int axis : {1, 2, 4}) {
            points.push_back((k & axis) != 0 ? 1.0f : 0.0f);
        }
    }
    const std::vector<std::uint16_t> corners{0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                             2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    const std::string bytes = bytes_of<float>(points) + bytes_of<std::uint16_t>(corners);
    document["buffers"][0]["byteLength"] = bytes.size();
    document["bufferViews"] = Json::parse(
        R"([{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}])");
    document["accessors"][0]["count"] = 8;
    document["accessors"][1]["count"] = 36;
    document["materials"][0]["doubleSided"] = true;
    const auto path = folder.write("room.glb", glb(document, bytes));
    Diagnostics diagnostics;
    const Scene scene = read(path, &diagnostics);
    REQUIRE(scene.surfaces.size() == 12);
    for (const Surface& surface : scene.surfaces) {
        CHECK_FALSE(surface.two_sided);
        CHECK(glm::dot(area_vector(surface.polygon()), Vec3(0.5) - surface.vertices[0]) > 0.0);
    }
    REQUIRE(diagnostics.warnings().size() == 1);
    require_parts(diagnostics.warnings()[0],
                  {"12 double-sided faces taken as one-sided", "--two-sided GROUP"});
    CHECK(read(path, nullptr, {.two_sided_groups = {"*"}}).surfaces[0].two_sided);
    // Beside another file it is one of two bodies, and its outside may be meant.
    Diagnostics joined;
    folder.write("far.glb", glb(document, bytes));
    folder.write("plate.obj", "v 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\n");
    const std::vector<std::filesystem::path> both{folder / "far.glb", folder / "plate.obj"};
    CHECK(io::read_scenes(both, {}, joined).surfaces[0].two_sided);
}

TEST_CASE("glTF reader: nodes place, turn, scale and mirror what is below them", "[io]") {
    const Folder folder;
    Json document = square();
    const double half = std::sqrt(0.5);
    document["nodes"] = {{{"children", {1, 2}}, {"translation", {10, 0, 0}}},
                         {{"name", "turned"},
                          {"mesh", 0},
                          {"translation", {0, 5, 0}},
                          {"rotation", {0, 0, half, half}},
                          {"scale", {2, 3, 1}}},
                         {{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 7, 1}}}};
    const Scene scene = read(folder, document);
    REQUIRE(scene.groups == std::vector<std::string>{"turned", "plate"});
    REQUIRE(scene.surfaces.size() == 4);
    require_near(scene.surfaces[0].vertices[0], {10, 5, 0});
    require_near(scene.surfaces[0].vertices[1], {10, 7, 0});
    require_near(scene.surfaces[0].vertices[2], {7, 7, 0});
    // A mirrored plate still faces the way it did.
    require_near(scene.surfaces[2].vertices[0], {9, 1, 7});
    require_near(scene.surfaces[2].vertices[2], {10, 0, 7});
    for (const Surface& surface : scene.surfaces) {
        REQUIRE(area_vector(surface.polygon()).z > 0.0);
    }
    document.erase("scenes");
    document.erase("scene");
    REQUIRE(read(folder, document).surfaces.size() == 4);
}

TEST_CASE("glTF reader: emission, sidedness and the lack of a material", "[io]") {
    const Folder folder;
    Json document = square();
    document["materials"][0] = {
        {"emissiveFactor", {1, 0.5, 0}},
        {"doubleSided", true},
        {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}}}}};
    Diagnostics diagnostics;
    Scene scene = read(folder, document, &diagnostics);
    REQUIRE(scene.materials == std::vector<Material>{{"material_0", {0.99, 0.99, 0.99}, {20, 10, 0}}});
    REQUIRE(scene.surfaces[0].two_sided);
    REQUIRE(has_warning(diagnostics, "reflectance 0.99 instead of the base colour's 1 in material_0"));

    document["meshes"][0]["primitives"][0].erase("material");
    REQUIRE(read(folder, document).materials ==
            std::vector<Material>{{"default", {0.5, 0.5, 0.5}, {0, 0, 0}}});
    document.erase("materials");
    scene = read(folder, document, nullptr, {.two_sided_groups = {"floor"}});
    REQUIRE(scene.materials == std::vector<Material>{{"default", {0.5}, {0.0}}});
    REQUIRE(scene.surfaces[0].two_sided);
}

TEST_CASE("glTF reader: the first perspective camera is the scene's", "[io]") {
    const Folder folder;
    Json document = square();
    document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    document["nodes"].push_back({{"camera", 0}, {"translation", {1, 2, 3}}});
    document["scenes"][0]["nodes"] = {0, 1};
    const Scene scene = read(folder, document);
    REQUIRE(scene.camera.has_value());
    require_near(scene.camera->eye, {1, 2, 3});
    require_near(scene.camera->target, {1, 2, 2});
    require_near(scene.camera->up, {0, 1, 0});
    REQUIRE(scene.camera->fov == Approx(28.6478897));
}

TEST_CASE("glTF reader: what is not used is told", "[io]") {
    const Folder folder;
    Json document = square();
    document["skins"] = Json::array();
    document["animations"] = Json::array();
    document["extensionsUsed"] = {"KHR_materials_transmission", "KHR_materials_unlit"};
    document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
    document["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = 0.9;
    document["materials"][0]["alphaMode"] = "BLEND";
    document["meshes"][0]["primitives"][0]["targets"] = Json::array();
    document["meshes"][0]["primitives"].push_back({{"mode", 1}, {"attributes", {{"POSITION", 0}}}});
    Diagnostics diagnostics;
    REQUIRE(read(folder, document, &diagnostics).surfaces.size() == 2);
    for (const char* part : {"room.gltf: not used: KHR_materials_transmission, skins, animations",
                             "1 primitive of points or lines left out", "morph targets are not used",
                             "textures are not used; baseColorFactor", "transparency is not used",
                             "metals mirror light, and are taken as diffuse"}) {
        INFO(part);
        REQUIRE(has_warning(diagnostics, part));
    }
    REQUIRE(diagnostics.warnings().size() == 6);
}

TEST_CASE("glTF reader: what is wrong is named with its place, its value and what would be right", "[io]") {
    struct Bad {
        const char* patch; ///< JSON Patch (RFC 6902) of the square
        std::vector<std::string> parts;
    };
    const std::vector<Bad> table{
        {R"({"op": "remove", "path": "/asset"})", {"room.gltf: \"asset\" is missing"}},
        {R"({"op": "replace", "path": "/asset/version", "value": "1.0"})",
         {"asset.version: \"1.0\"; must be"}},
        {R"({"op": "add", "path": "/extensionsRequired", "value": ["KHR_draco_mesh_compression"]})",
         {"extensionsRequired[0]: KHR_draco_mesh_compression is not supported"}},
        {R"({"op": "replace", "path": "/scene", "value": 1})", {"scene: 1; there are 1 scenes"}},
        {R"({"op": "replace", "path": "/scenes/0/nodes/0", "value": 4000000000})",
         {"scenes[0].nodes[0]: 4000000000; there are 1 nodes"}},
        {R"({"op": "replace", "path": "/scenes/0/nodes", "value": []})", {"no triangles; a scene needs"}},
        {R"({"op": "replace", "path": "/scenes/0/nodes", "value": [0, 0]})", {"nodes[0]: is reached twice"}},
        {R"({"op": "add", "path": "/nodes/0/children", "value": [0]})", {"nodes[0]: is reached twice"}},
        {R"({"op": "replace", "path": "/nodes/0/mesh", "value": 1})",
         {"nodes[0].mesh: 1; there are 1 meshes"}},
        {R"({"op": "replace", "path": "/nodes/0/mesh", "value": -1})",
         {"nodes[0].mesh: -1; must be a whole"}},
        {R"({"op": "replace", "path": "/nodes/0", "value": 7})", {"nodes[0]: 7; must be an object"}},
        {R"({"op": "add", "path": "/nodes/0/matrix", "value": [1, 2]})", {"nodes[0].matrix:", "16 numbers"}},
        {R"({"op": "add", "path": "/nodes/0/matrix", "value": [1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]})",
         {"nodes[0].matrix: the last row must be 0, 0, 0, 1"}},
        {R"({"op": "add", "path": "/nodes/0/rotation", "value": [0,0,0,0]})", {"nodes[0].rotation: not a"}},
        {R"({"op": "add", "path": "/nodes/0/scale", "value": [0,1,1]})",
         {"no triangles; a scene needs at least one"}},
        {R"({"op": "add", "path": "/nodes/0/translation", "value": [1e200,0,0]})", {"triangle 0", "1e+70"}},
        {R"({"op": "add", "path": "/meshes/0/primitives/0/mode", "value": 7})",
         {"meshes[0].primitives[0].mode: 7; must be a whole number"}},
        {R"({"op": "remove", "path": "/meshes/0/primitives/0/attributes/POSITION"})",
         {"meshes[0].primitives[0].attributes: \"POSITION\" is missing"}},
        {R"({"op": "replace", "path": "/meshes/0/primitives/0/attributes/POSITION", "value": 9})",
         {"attributes.POSITION: 9; there are 2 accessors"}},
        {R"({"op": "replace", "path": "/meshes/0/primitives/0/attributes/POSITION", "value": 1})",
         {"attributes.POSITION: must be an accessor of VEC3"}},
        {R"({"op": "replace", "path": "/meshes/0/primitives/0/indices", "value": 0})",
         {"primitives[0].indices: must be an accessor of SCALAR"}},
        {R"({"op": "replace", "path": "/meshes/0/primitives/0/material", "value": 1})",
         {"primitives[0].material: 1; there are 1 materials"}},
        {R"({"op": "add", "path": "/accessors/0/sparse", "value": {}})",
         {"accessors[0].sparse: \"count\" is missing"}},
        {R"({"op": "add", "path": "/accessors/0/sparse", "value": {"count": 5}})",
         {"accessors[0].sparse.count: 5; must be a whole number"}},
        {R"({"op": "add", "path": "/accessors/0/sparse", "value": {"count": 0}})",
         {"accessors[0].sparse.count: 0; must be at least 1"}},
        {R"({"op": "add", "path": "/accessors/0/sparse", "value":
             {"count": 2, "indices": {"bufferView": 1, "componentType": 5126}}})",
         {"accessors[0].sparse.indices.componentType: must be unsigned"}},
        {R"({"op": "add", "path": "/accessors/0/sparse", "value":
             {"count": 4, "indices": {"bufferView": 1, "byteOffset": 2, "componentType": 5125}}})",
         {"accessors[0].sparse.indices: 4 elements of 4 bytes from byte 2 on"}},
        {R"({"op": "add", "path": "/accessors/0/sparse", "value":
             {"count": 4, "indices": {"bufferView": 1, "componentType": 5123},
              "values": {"bufferView": 0, "byteOffset": 4}}})",
         {"accessors[0].sparse.values: 4 elements of 12 bytes from byte 4 on"}},
        {R"({"op": "add", "path": "/accessors/0/sparse", "value":
             {"count": 4, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}})",
         {"accessors[0].sparse.indices: index 3 is 0; must ascend, and be below 4"}},
        {R"({"op": "replace", "path": "/accessors/0/componentType", "value": 5124})",
         {"accessors[0].componentType: 5124; must be 5120 to 5123"}},
        {R"({"op": "replace", "path": "/accessors/0/componentType", "value": 5122})",
         {"attributes.POSITION: must be an accessor of VEC3 of floats (5126); of 8 or 16 bits with"}},
        {R"({"op": "replace", "path": "/accessors/0/type", "value": "MAT4"})",
         {"accessors[0].type: \"MAT4\""}},
        {R"({"op": "replace", "path": "/accessors/0/count", "value": 5})",
         {"accessors[0]: 5 elements of 12 bytes from byte 0 on, every 12 bytes; its bufferView has 48 "
          "bytes"}},
        {R"({"op": "replace", "path": "/accessors/0/count", "value": 1000000000000})",
         {"accessors[0]: 1000000000000 elements"}},
        {R"({"op": "replace", "path": "/accessors/0/count", "value": 18446744073709551615})",
         {"accessors[0].count: 18446744073709551615; must be a whole number from 0"}},
        {R"({"op": "replace", "path": "/accessors/0/count", "value": 0})", {"accessors[0]: count 0"}},
        {R"({"op": "replace", "path": "/accessors/0/count", "value": 3})",
         {"primitives[0].indices: index 5 is 3; there are 3 positions"}},
        {R"({"op": "replace", "path": "/accessors/1/count", "value": 5})",
         {"primitives[0]: 5 indices; triangles need a multiple of 3"}},
        {R"({"op": "add", "path": "/accessors/0/byteOffset", "value": 1})", {"accessors[0]: 4 elements"}},
        {R"({"op": "remove", "path": "/accessors/0/bufferView"})",
         {"accessors[0]: \"bufferView\" is missing"}},
        {R"({"op": "replace", "path": "/bufferViews/0/byteLength", "value": 61})",
         {"bufferViews[0]: bytes 0 to 61; its buffer has 60"}},
        {R"({"op": "replace", "path": "/bufferViews/1/byteOffset", "value": 1099511627776})",
         {"bufferViews[1]: bytes 1099511627776 to"}},
        {R"({"op": "replace", "path": "/bufferViews/0/buffer", "value": 1})",
         {"buffer: 1; there are 1 buffers"}},
        {R"({"op": "add", "path": "/bufferViews/0/byteStride", "value": 4})",
         {"bufferViews[0]: byteStride 4; must be at least 12"}},
        {R"({"op": "replace", "path": "/buffers/0/byteLength", "value": 4294967296})",
         {"buffers[0]: cut short: 60 bytes; byteLength says 4294967296"}},
        {R"({"op": "remove", "path": "/buffers/0/uri"})", {"buffers[0]: no \"uri\""}},
        {R"({"op": "replace", "path": "/buffers/0/uri", "value": "no.bin"})", {"buffers[0].uri: ", "no.bin"}},
        {R"({"op": "replace", "path": "/buffers/0/uri", "value": "/etc/hostname"})",
         {"buffers[0].uri: \"/etc/hostname\"; must be in the scene's folder or below it"}},
        {R"({"op": "replace", "path": "/buffers/0/uri", "value": "%2e%2e/x.bin"})",
         {"in the scene's folder"}},
        {R"({"op": "replace", "path": "/buffers/0/uri", "value": "link/passwd"})", {"in the scene's folder"}},
        {R"({"op": "replace", "path": "/buffers/0/uri", "value": "http://x/y.bin"})",
         {"in the scene's folder"}},
        {R"({"op": "replace", "path": "/buffers/0/uri", "value": "a%2"})", {"% must be followed by two"}},
        {R"({"op": "replace", "path": "/buffers/0/uri", "value": "data:,abc"})", {"without \";base64,\""}},
        {R"({"op": "replace", "path": "/buffers/0/uri", "value": "data:;base64,ab!"})",
         {"is no base64 text"}},
        {R"({"op": "replace", "path": "/materials/0/pbrMetallicRoughness/baseColorFactor/1", "value": 1.5})",
         {"baseColorFactor[1]: 1.5; must be a number from 0 to 1"}},
        {R"({"op": "replace", "path": "/materials/0/pbrMetallicRoughness/baseColorFactor", "value": [1]})",
         {"baseColorFactor: an array of 1; must be 4 numbers"}},
        {R"({"op": "add", "path": "/materials/0/emissiveFactor", "value": [0, -1, 0]})",
         {"materials[0].emissiveFactor[1]: -1"}},
        {R"({"op": "add", "path": "/materials/0/extensions",
             "value": {"KHR_materials_emissive_strength": {"emissiveStrength": -2}}})",
         {"emissiveStrength: -2; must be a number that is not negative"}},
    };
    const Folder folder;
    std::filesystem::create_directory_symlink("/etc", folder / "link");
    for (const Bad& bad : table) {
        INFO(bad.patch);
        const Json document = square().patch(Json::array({Json::parse(bad.patch)}));
        require_parts(message_of<InputError>([&] { (void)read(folder, document); }), bad.parts);
    }
}

TEST_CASE("glTF reader: positions that are no numbers", "[io]") {
    const Folder folder;
    std::string bytes = square_bytes;
    bytes.replace(0, 4, bytes_of<float>({std::numeric_limits<float>::quiet_NaN()}));
    require_parts(message_of<InputError>([&] { (void)read(folder.write("nan.glb", glb(square(), bytes))); }),
                  {"nan.glb: meshes[0].primitives[0]: triangle 0 (placed by nodes[0]): coordinate nan; must "
                   "be finite"});
}

TEST_CASE("glTF reader: a mesh placed too often", "[io][slow]") {
    const Folder folder;
    Json document = square();
    const std::size_t indices = 600'000;
    document["accessors"][1]["count"] = indices;
    document["accessors"][1]["componentType"] = 5121;
    document["bufferViews"][1]["byteLength"] = indices;
    document["buffers"][0]["byteLength"] = 48 + indices;
    document["nodes"] = Json::array();
    for (int k = 0; k < 60; ++k) {
        document["nodes"].push_back({{"mesh", 0}});
    }
    document.erase("scenes");
    document.erase("scene");
    const auto path =
        folder.write("often.glb", glb(document, square_bytes.substr(0, 48) + std::string(indices, '\0')));
    require_parts(message_of<InputError>([&] { (void)read(path); }),
                  {"often.glb: meshes[0].primitives[0]: more than 10000000 triangles and primitives in all"});
}

TEST_CASE("glTF reader: a .glb cut anywhere is refused, and claims of its header are not believed", "[io]") {
    const Folder folder;
    const std::string whole = glb(square(), square_bytes);
    for (std::size_t length = 0; length < whole.size(); length += length < 40 ? 1 : 13) {
        INFO(length);
        require_parts(
            message_of<InputError>([&] { (void)read(folder.write("cut.glb", whole.substr(0, length))); }),
            {"cut.glb"});
    }
    const auto changed = [&](std::size_t at, const std::string& bytes) {
        std::string other = whole;
        other.replace(at, bytes.size(), bytes);
        return message_of<InputError>([&] { (void)read(folder.write("a.glb", other)); });
    };
    require_parts(changed(4, word(1)), {"a.glb: glTF version 1; must be 2"});
    require_parts(changed(8, word(0xFFFFFFFF)), {"a.glb: cut short:", "its header says 4294967295"});
    require_parts(changed(12, word(0xFFFFFFF0)), {"a.glb: byte 12: a chunk of 4294967280 bytes"});
    require_parts(changed(16, "BINX"), {"a.glb: byte 12: the first chunk must be JSON"});
    require_parts(changed(8, word(12)), {"a.glb: no JSON chunk"});
}

TEST_CASE("glTF reader: no flipped bit of a .glb does harm", "[io]") {
    const Folder folder;
    const std::string whole = glb(square(), square_bytes);
    for (std::size_t position = 0; position < whole.size(); ++position) {
        INFO("byte " << position);
        std::string flipped = whole;
        flipped[position] = static_cast<char>(flipped[position] ^ (1 << position % 8));
        try {
            const Scene scene = read(folder.write("flipped.glb", flipped));
            REQUIRE(scene.surfaces.size() <= 2);
        } catch (const InputError& error) {
            require_parts(error.what(), {"flipped.glb"});
        }
    }
}

} // namespace hemi::io_test
