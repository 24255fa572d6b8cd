#include "hemi/io/scene_reader.hpp"

#include "io_fixtures.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <limits>

namespace hemi::io_test {

namespace {

Scene read(const Folder& folder, const std::string& name, const std::string& text,
           Diagnostics* diagnostics = nullptr, const io::SceneReaderOptions& options = {}) {
    Diagnostics unused;
    return io::read_scene(folder.write(name, text), options, diagnostics != nullptr ? *diagnostics : unused);
}

template <class Number>
std::string bytes(Number number, std::endian order = std::endian::little) {
    std::string text(sizeof number, '\0');
    std::memcpy(text.data(), &number, sizeof number);
    return order == std::endian::native ? text : std::string(text.rbegin(), text.rend());
}

/// A square of two kinds of faces, a triangle above it and a pentagon, with more properties than are needed.
std::string mixed_ply(const std::string& format) {
    const bool text = format == "ascii";
    const std::endian order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
    std::string ply = "ply\nformat " + format +
                      " 1.0\ncomment made by hand\nelement vertex 6\nproperty double x\nproperty uchar red\n"
                      "property float y\nproperty list uchar short ring\nproperty int16 z\nelement face 3\n"
                      "property float quality\nproperty list ushort uint32 vertex_indices\n"
                      "property uint8 flags\nend_header\n";
    const double x[] = {0, 1, 1.1, 1, 0, 0.1};
    const float y[] = {0, 0, 0.5f, 1, 1, 0.5f};
    const short z[] = {2, 2, 2, 2, 2, 3};
    for (int k = 0; k < 6; ++k) {
        if (text) {
            ply += fmt::format("{} 255 {} 2 -7 8 {}\n", x[k], y[k], z[k]);
        } else {
            ply += bytes(x[k], order) + '\xff' + bytes(y[k], order) + '\2' + bytes<short>(-7, order) +
                   bytes<short>(8, order) + bytes(z[k], order);
        }
    }
    const std::vector<std::vector<std::uint32_t>> faces{{0, 1, 3, 4}, {0, 1, 5}, {0, 1, 2, 3, 4}};
    for (const auto& face : faces) {
        ply += text ? fmt::format("0.5 {}", face.size())
                    : bytes(0.5f, order) + bytes(static_cast<std::uint16_t>(face.size()), order);
        for (const std::uint32_t index : face) {
            ply += text ? fmt::format(" {}", index) : bytes(index, order);
        }
        ply += text ? " 3\n" : "\3";
    }
    return ply;
}

const std::string ascii_head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                               "property float z\nelement face 1\nproperty list uchar int vertex_index\n";
const std::string ascii_vertices = "end_header\n0 0 0\n1 0 0\n0 1 0\n";

std::string binary_head(const std::string& vertices, const std::string& faces) {
    return "ply\nformat binary_little_endian 1.0\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
           "\nproperty list char int vertex_index\nend_header\n";
}

std::string floats(const std::vector<float>& numbers) {
    std::string text;
    for (const float number : numbers) {
        text += bytes(number);
    }
    return text;
}

std::string facet(const std::string& normal = "0 0 1", const std::string& last = "0 1 0") {
    return "facet normal " + normal + "\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex " + last +
           "\n endloop\nendfacet\n";
}

std::string binary_stl(std::uint32_t claimed, const std::vector<std::vector<float>>& triangles,
                       const std::string& head = "") {
    std::string text = head + std::string(80 - head.size(), ' ') + bytes(claimed);
    for (const auto& triangle : triangles) {
        text += floats(triangle) + std::string(2, '\0');
    }
    return text;
}

const std::vector<float> upwards{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};

struct Bad {
    std::string text;
    std::vector<std::string> parts;
};

} // namespace

TEST_CASE("PLY reader: text and binary of both byte orders give the same faces, in the file's order",
          "[io]") {
    const Folder folder;
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        INFO(format);
        Diagnostics diagnostics;
        const Scene scene = read(folder, "a.ply", mixed_ply(format), &diagnostics);
        REQUIRE(scene.groups == std::vector<std::string>{"default"});
        REQUIRE(scene.materials == std::vector<Material>{{"default", {0.5}, {0.0}}});
        REQUIRE(scene.surfaces.size() == 4);
        REQUIRE(scene.surfaces[0].vertex_count == 4);
        REQUIRE(scene.surfaces[0].vertices[2] == Vec3(1, 1, 2));
        REQUIRE(scene.surfaces[1].vertex_count == 3);
        REQUIRE(scene.surfaces[1].vertices[2] == Vec3(0.1, 0.5, 3));
        REQUIRE(scene.surfaces[3].vertex_count == 3); // the rest of the pentagon
        REQUIRE(diagnostics.warnings().size() == 1);
        require_parts(diagnostics.warnings()[0], {"1 face of more than 4 vertices cut"});
    }
}

TEST_CASE("PLY reader: line ends of CR LF, blank lines and elements of other kinds do not matter", "[io]") {
    const Folder folder;
    std::string text;
    for (const char c : ascii_head + "element edge 1\nproperty int vertex1\nelement nothing 0\n" +
                            ascii_vertices + "\n3 0 1 2\n0\n") {
        text += c == '\n' ? "\r\n" : std::string(1, c);
    }
    Diagnostics diagnostics;
    REQUIRE(read(folder, "a.ply", text, &diagnostics).surfaces.size() == 1);
    REQUIRE(diagnostics.warnings().size() == 1);
    require_parts(diagnostics.warnings()[0], {"a.ply: the 1 element \"edge\" is not used"});
    std::string binary = binary_head("3", "1");
    binary.replace(binary.find("ply\n"), 4, "ply\r\n");
    binary.replace(binary.find("end_header\n"), 11, "end_header\r\n");
    binary += floats({0, 0, 0, 1, 0, 0, 0, 1, 0}) + '\3' + bytes(0) + bytes(1) + bytes(2);
    REQUIRE(read(folder, "a.ply", binary).surfaces.size() == 1);
}

TEST_CASE("PLY reader: faces without area are left out, named by line or by number", "[io]") {
    const Folder folder;
    const std::string text = ascii_head + ascii_vertices + "3 0 1 2\n";
    std::string two = text + "3 0 1 1\n";
    two.replace(two.find("face 1"), 6, "face 2");
    const io::SceneReaderOptions strict{.strict = true};
    require_parts(message_of<ParseError>([&] { read(folder, "a.ply", two, nullptr, strict); }),
                  {"a.ply:14: face: zero area"});
    Diagnostics diagnostics;
    REQUIRE(read(folder, "a.ply", two, &diagnostics).surfaces.size() == 1);
    require_parts(diagnostics.warnings().at(0), {"a.ply:14: 1 face without area left out"});
    const std::string binary = binary_head("3", "2") + floats({0, 0, 0, 1, 0, 0, 0, 1, 0}) + '\3' + bytes(0) +
                               bytes(1) + bytes(2) + '\3' + bytes(0) + bytes(1) + bytes(1);
    require_parts(message_of<InputError>([&] { read(folder, "a.ply", binary, nullptr, strict); }),
                  {"a.ply: face 1: zero area"});
    REQUIRE(read(folder, "a.ply", binary, &diagnostics).surfaces.size() == 1);
    require_parts(diagnostics.warnings().at(1),
                  {"a.ply: 1 face without area left out, the first one is face 1"});
}

TEST_CASE("PLY reader: what is wrong is named with its place, its value and what would be right", "[io]") {
    const std::string nan = bytes(std::numeric_limits<float>::quiet_NaN());
    const std::string three = floats({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::string end = "property float x\nproperty float y\nproperty float z\n";
    const std::vector<Bad> table{
        {"", {"a.ply:1: \"\"; a PLY file begins with ply"}},
        {"plyx\n", {"a.ply:1: \"plyx\"; a PLY file"}},
        {"ply\n", {":1: cut short: end_header is missing"}},
        {"ply\nend_header\n", {":2: no format line"}},
        {"ply\nformat text 1.0\n",
         {":2: format \"text\"; must be ascii, binary_little_endian or binary_big"}},
        {"ply\nformat ascii 2.0\n", {":2: version \"2.0\"; must be 1.0"}},
        {"ply\nformat ascii 1.0\nface 1\n", {":3: \"face\"; must be format, element, property, comment"}},
        {"ply\nformat ascii 1.0\nelement vertex\n", {":3: \"element vertex\"; must be element, its name"}},
        {"ply\nformat ascii 1.0\nelement vertex -1\n", {":3: \"element vertex -1\"; must be element"}},
        {"ply\nformat ascii 1.0\nelement v 1\nelement v 1\n", {":4: element \"v\" is there twice"}},
        {"ply\nformat ascii 1.0\nproperty float x\n", {":3: a property before the first element"}},
        {"ply\nformat ascii 1.0\nelement v 1\nproperty half x\n", {":4: type \"half\"; must be char"}},
        {"ply\nformat ascii 1.0\nelement v 1\nproperty float\n", {":4: a property without a name"}},
        {"ply\nformat ascii 1.0\nelement v 1\nproperty float x\nproperty int x\n",
         {":5: property \"x\" is there"}},
        {"ply\nformat ascii 1.0\nelement f 1\nproperty list float int x\n", {":4: a list's length must be"}},
        {"ply\nformat ascii 1.0\nelement f 99999999999\nend_header\n",
         {":4: element \"f\" has no properties"}},
        {"ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\nend_header\n",
         {"a.ply: element face before element vertex"}},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" + end + "end_header\n0 0 0\n",
         {"a.ply: no element face"}},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nelement face 0\n"
         "property list uchar int vertex_index\nend_header\n0\n",
         {"a.ply: element vertex has no property y"}},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" + end +
             "element face 1\nproperty int vertex_index\nend_header\n",
         {"a.ply: element face has no list of integers vertex_indices"}},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" + end +
             "element face 1\nproperty list uchar float vertex_index\nend_header\n",
         {"a.ply: element face has no list of integers"}},
        {"ply\rformat binary_little_endian 1.0\relement vertex 0\rend_header\r",
         {":4: line ends of CR alone"}},
        {ascii_head + "end_header\n0 0 0\n1 0 0\n", {":11: vertex: cut short: 2 of the 3 elements vertex"}},
        {ascii_head + "end_header\n0 0 0\n1 0\n", {":11: vertex: z \"\"; must be a finite number"}},
        {ascii_head + "end_header\n0 0 0\n1 inf 0\n", {":11: vertex: y \"inf\""}},
        {ascii_head + "end_header\n0 0 0\n1 0,5 0\n", {":11: vertex: y \"0,5\""}},
        {ascii_head + "end_header\n0 0 0 1\n", {":10: vertex: \"1\" after the properties"}},
        {ascii_head + ascii_vertices, {":12: face: cut short: 0 of the 1 elements face"}},
        {ascii_head + ascii_vertices + "2 0 1\n", {":13: face: 2 vertices; must have 3 or more"}},
        {ascii_head + ascii_vertices + "4 0 1 2\n", {":13: face: vertex_index \"\"; must be a whole number"}},
        {ascii_head + ascii_vertices + "3 0 1 2 0\n", {":13: face: \"0\" after the properties"}},
        {ascii_head + ascii_vertices + "3 0 1 3\n", {":13: face: vertex 3; there are 3, counted from 0"}},
        {ascii_head + ascii_vertices + "3 0 1 -1\n", {":13: face: vertex_index \"-1\""}},
        {ascii_head + ascii_vertices + "-3 0 1 2\n", {":13: face: vertex_index \"-3\""}},
        {ascii_head + ascii_vertices + "99999999999 0 1 2\n", {":13: face: vertex_index \"\""}},
        {binary_head("4000000000", "1") + three,
         {"a.ply: 4000000000 elements vertex in a file of", "cannot be"}},
        {binary_head("18446744073709551615", "1") + three, {"elements vertex in a file of", "cannot be"}},
        {binary_head("3", "99") + three + "\3", {"a.ply: 99 elements face in a file of"}},
        {binary_head("3", "1") + three + '\3' + bytes(0) + bytes(1), {"a.ply: face 0: cut short"}},
        {binary_head("3", "1") + three + '\3' + bytes(0) + bytes(1) + bytes(3),
         {"a.ply: face 0: vertex 3; there are 3, counted from 0"}},
        {binary_head("3", "1") + three + '\3' + bytes(0) + bytes(1) + bytes(-1),
         {"a.ply: face 0: vertex_index -1; must not be negative"}},
        {binary_head("3", "1") + three + '\xff' + bytes(0) + bytes(1) + bytes(2),
         {"a.ply: face 0: vertex_index -1; must not be negative"}},
        {binary_head("3", "1") + three + '\1' + bytes(0), {"a.ply: face 0: 1 vertices; must have 3 or more"}},
        {binary_head("3", "1") + floats({0, 0, 0, 1}) + nan + floats({0, 0, 1, 0}) + '\3',
         {"a.ply: vertex 1: y nan; must be a finite number"}},
        {binary_head("3", "1") + floats({0, 0, 0, 1, 0, 0, 3, 0, 0}) + '\3' + bytes(0) + bytes(1) + bytes(2),
         {"a.ply: no faces with an area"}},
    };
    const Folder folder;
    for (const Bad& bad : table) {
        INFO(bad.text);
        require_parts(message_of<InputError>([&] { read(folder, "a.ply", bad.text); }), bad.parts);
    }
    const std::string claim =
        "ply\nformat binary_big_endian 1.0\nelement blob 1\nproperty list uint double all\n"
        "element vertex 3\n" +
        end +
        "element face 1\nproperty list uchar int vertex_index\n"
        "end_header\n\377\377\377\377";
    require_parts(message_of<InputError>([&] { read(folder, "a.ply", claim + std::string(80, ' ')); }),
                  {"a.ply: blob 0: all: 4294967295 values; 80 bytes are left"});
}

TEST_CASE("STL reader: triangles stay in the file's order, in the group of their solid", "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    const Scene scene =
        read(folder, "a.stl",
             "\nsolid lower part \n" + facet() + facet("0 0 0", "0 2 0") + "endsolid lower part\n" +
                 "SOLID\nFACET NORMAL nan nan nan OUTER LOOP VERTEX 0 0 0\tVERTEX 1 0 0 VERTEX 0 "
                 "3.25e0 0 ENDLOOP ENDFACET\r\nENDSOLID",
             &diagnostics);
    REQUIRE(scene.groups == std::vector<std::string>{"lower part", "default"});
    REQUIRE(scene.surfaces.size() == 3);
    REQUIRE(scene.surfaces[1].vertices[2] == Vec3(0, 2, 0));
    REQUIRE(scene.surfaces[2].vertices[2] == Vec3(0, 3.25, 0));
    REQUIRE(scene.surfaces[2].group == 1);
    REQUIRE(scene.materials == std::vector<Material>{{"default", {0.5}, {0.0}}});
    REQUIRE(diagnostics.warnings().empty());
}

TEST_CASE("STL reader: a binary file that begins with the word solid is read as what it is", "[io]") {
    const Folder folder;
    const std::vector<float> other{0, 0, -1, 0, 0, 0.1f, 1, 0, 0.1f, 0, 1, 0.1f};
    Diagnostics diagnostics;
    const Scene scene =
        read(folder, "a.stl", binary_stl(2, {upwards, other}, "solid but binary"), &diagnostics);
    REQUIRE(scene.surfaces.size() == 2);
    REQUIRE(scene.groups == std::vector<std::string>{"default"});
    REQUIRE(scene.surfaces[1].vertices[0] == Vec3(0, 0, static_cast<double>(0.1f)));
    REQUIRE(area_vector(scene.surfaces[1].polygon()).z > 0.0);
    REQUIRE(diagnostics.warnings().size() == 1);
    require_parts(diagnostics.warnings()[0], {"a.stl: 1 normals point to the back; the front is where the"});
    REQUIRE(read(folder, "a.stl", binary_stl(1, {upwards, other}), &diagnostics).surfaces.size() == 1);
    require_parts(diagnostics.warnings().at(1), {"a.stl: 50 bytes after the last triangle are not used"});
}

TEST_CASE("STL reader: what is wrong is named with its place, its value and what would be right", "[io]") {
    std::vector<float> far = upwards;
    far[4] = std::numeric_limits<float>::infinity();
    std::vector<float> flat = upwards;
    flat[10] = 0.0f;
    const std::vector<Bad> table{
        {"", {"a.stl: 0 bytes; an STL file begins with \"solid\", or, binary, has at least 84 bytes"}},
        {"facet\n", {"a.stl: 6 bytes; an STL file begins"}},
        {binary_stl(2, {upwards}), {"a.stl: cut short, or not STL: 134 bytes; its 2 triangles need 184"}},
        {binary_stl(2, {upwards}, "solid but binary"), {"a.stl: cut short, or not STL: 134 bytes"}},
        {binary_stl(4294967295u, {upwards}), {"its 4294967295 triangles need 214748364834"}},
        {binary_stl(0, {}), {"a.stl: no faces; a scene needs at least one (triangles)"}},
        {binary_stl(2, {upwards, far}), {"a.stl: face 1: coordinate inf; must be finite"}},
        {binary_stl(1, {flat}), {"a.stl: no faces with an area; a scene needs at least one (triangles)"}},
        {"solid a", {":1: cut short: endsolid is missing"}},
        {"solid a\nendsolid\n", {"a.stl: no faces"}},
        {"solid a\nfacett\n", {":2: \"facett\"; must be facet or endsolid"}},
        {"solid a\nendsolid a\nfacet\n", {":3: \"facet\"; must be solid"}},
        {"solid a\nfacet normal 0 0\n", {":2: cut short: the normal is missing"}},
        {"solid a\n" + facet("0 0 1 0"), {":2: \"0\"; must be outer"}},
        {"solid a\n" + facet("0 0 1", "0 1 x"), {":6: \"x\" in a vertex; must be a finite number"}},
        {"solid a\n" + facet("0 0 1", "0 1 inf"), {":6: \"inf\" in a vertex"}},
        {"solid a\n" + facet("0 0 1", "0 1\n"), {":8: \"endloop\" in a vertex"}},
        {"solid a\n" + facet("0 0 1", "0 1 0\nvertex 0 0 0"), {":7: a fourth vertex; a facet has 3"}},
        {"solid a\n" + facet("0 0 1", "0 1 0 0"), {":6: \"0\"; must be endloop"}},
        {"solid a\n" + facet("0 0 1", "0 1e80 0"),
         {":2: face: coordinate 1e+80; must be finite and below 1e+70"}},
        {"solid a\n" + facet() + facet(), {":15: cut short: endsolid is missing"}},
    };
    const Folder folder;
    REQUIRE_NOTHROW(read(folder, "a.stl", "solid a\n" + facet() + "endsolid a\n"));
    for (const Bad& bad : table) {
        INFO(bad.text);
        require_parts(message_of<InputError>([&] { read(folder, "a.stl", bad.text); }), bad.parts);
    }
}

TEST_CASE("PLY and STL readers: files cut anywhere, and with any byte changed, are read or refused by name",
          "[io]") {
    const Folder folder;
    const std::vector<std::pair<std::string, std::string>> files{
        {"a.ply", mixed_ply("ascii")},
        {"b.ply", mixed_ply("binary_little_endian")},
        {"c.ply", mixed_ply("binary_big_endian")},
        {"a.stl", "solid a\n" + facet() + facet() + "endsolid a\n"},
        {"b.stl", binary_stl(2, {upwards, upwards})},
    };
    for (const auto& [name, text] : files) {
        for (std::size_t at = 0; at < text.size(); ++at) {
            std::string flipped = text;
            flipped[at] = static_cast<char>(flipped[at] ^ (1 << at % 8));
            std::string high = text;
            high[at] = '\377';
            for (const std::string& bad : {text.substr(0, at), flipped, high}) {
                try {
                    (void)read(folder, name, bad);
                } catch (const InputError& error) {
                    require_parts(error.what(), {name});
                }
            }
        }
    }
}

} // namespace hemi::io_test
