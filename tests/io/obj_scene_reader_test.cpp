#include "hemi/io/scene_reader.hpp"

#include "hemi/scene/patch_mesh.hpp"
#include "io_fixtures.hpp"

#include <fmt/format.h>

#include <clocale>
#include <cmath>
#include <locale>
#include <numeric>

namespace hemi::io_test {

namespace {

const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Scene read(const Folder& folder, const std::string& text, Diagnostics* diagnostics = nullptr,
           const io::SceneReaderOptions& options = {}) {
    Diagnostics unused;
    return io::read_scene(folder.write("room.obj", text), options,
                          diagnostics != nullptr ? *diagnostics : unused);
}

double area(const Scene& scene) {
    return std::accumulate(
        scene.surfaces.begin(), scene.surfaces.end(), 0.0,
        [](double sum, const Surface& s) { return sum + glm::length(area_vector(s.polygon())); });
}

class DecimalComma : public std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

} // namespace

TEST_CASE("OBJ reader: every face is a surface, in the file's order, in the group of the last o or g",
          "[io]") {
    const Folder folder;
    const Scene scene =
        read(folder,
             corners + "f 1 2 3\no box\nf 1 2 3 4\ng lid of box\nf 4 3 2 1\no box\nf -4 -3 -2\ng\nf 1 3 4\n");
    REQUIRE(scene.name == "room");
    REQUIRE(scene.groups == std::vector<std::string>{"default", "box", "lid of box"});
    REQUIRE(scene.surfaces.size() == 5);
    std::vector<std::uint32_t> groups;
    for (const Surface& surface : scene.surfaces) {
        groups.push_back(surface.group);
    }
    REQUIRE(groups == std::vector<std::uint32_t>{0, 1, 2, 1, 0});
    REQUIRE(scene.surfaces[0].vertex_count == 3);
    REQUIRE(scene.surfaces[1].vertex_count == 4);
    REQUIRE(scene.surfaces[2].vertices[0] == Vec3(0, 1, 0));
    REQUIRE(scene.surfaces[3].vertices[2] == Vec3(1, 1, 0));
    REQUIRE(scene.channels == std::vector<std::string>{"grey"});
    REQUIRE(scene.materials == std::vector<Material>{{"default", {0.5}, {0.0}}});
    REQUIRE(scene.environment == std::vector<double>{0.0});
}

TEST_CASE("OBJ reader: numbers are read to the last bit", "[io]") {
    const Folder folder;
    folder.write("m.mtl", "newmtl m\nKd 0.7 0.1 0.3\nKe 18.4 15.6 8.0\n");
    const Scene scene = read(folder, "mtllib m.mtl\nusemtl m\nv 0.1 0.7 -1.1e-3\nv +1 .3 1e2 1.0\nv "
                                     "0.123456789012345678 1 0 0.5 0.5 0.5\nf 1 2 3\n");
    REQUIRE(scene.surfaces[0].vertices[0] == Vec3(0.1, 0.7, -1.1e-3));
    REQUIRE(scene.surfaces[0].vertices[1] == Vec3(1, 0.3, 100));
    REQUIRE(scene.surfaces[0].vertices[2].x == 0.123456789012345678);
    REQUIRE(scene.materials == std::vector<Material>{{"m", {0.7, 0.1, 0.3}, {18.4, 15.6, 8.0}}});
    REQUIRE(scene.channels == std::vector<std::string>{"red", "green", "blue"});
}

TEST_CASE("OBJ reader: line ends, a missing last one, continued lines and a byte order mark do not matter",
          "[io]") {
    const Folder folder;
    const std::string text =
        corners + "vt 0 0\nvn 0 0 1\ns 1\n# comment\n\n  g  a \nf 1/1 2/1/1 3//1\nf 2 3 \\\n 4";
    const Scene plain = read(folder, text);
    REQUIRE(plain.surfaces.size() == 2);
    REQUIRE(plain.groups == std::vector<std::string>{"a"});
    for (const std::string end : {"\r\n", "\r"}) {
        std::string other = "\xEF\xBB\xBF";
        for (const char c : text) {
            other += c == '\n' ? end : std::string(1, c);
        }
        const Scene scene = read(folder, other);
        REQUIRE(scene.surfaces.size() == 2);
        REQUIRE(scene.groups == plain.groups);
        REQUIRE(scene.surfaces[1].vertices == plain.surfaces[1].vertices);
    }
    require_parts(
        message_of<ParseError>([&] { read(folder, "v 0 0 0\r\nv 1 0 0\r\n\r\nv 1 1 \\\r\n x\r\n"); }),
        {"room.obj:4: \"x\" in a vertex"});
    // A comment that ends with a folder's name has no second line.
    REQUIRE(read(folder, "# C:\\models\\\n" + text).surfaces.size() == 2);
    REQUIRE(read(folder, corners + "f 1 2 3\n\t# C:\\models\\\nf 2 3 4\n").surfaces.size() == 2);
}

TEST_CASE("OBJ reader: a decimal comma of the locale changes nothing", "[io]") {
    const Folder folder;
    const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
    const char* found = std::setlocale(LC_NUMERIC, "de_DE.UTF-8"); // as far as it is installed
    const Scene scene = read(folder, "v 0 0 0\nv 1.5 0 0\nv 0 1234.25 0\nf 1 2 3\n");
    if (found != nullptr) {
        std::setlocale(LC_NUMERIC, "C");
    }
    std::locale::global(before);
    REQUIRE(scene.surfaces[0].vertices[1].x == 1.5);
    REQUIRE(scene.surfaces[0].vertices[2].y == 1234.25);
}

TEST_CASE(
    "OBJ reader: planar convex faces of many vertices are cut, all of their area kept, with one warning",
    "[io]") {
    const Folder folder;
    for (const int n : {5, 6, 7, 64}) {
        std::string text;
        std::string face = "f";
        for (int k = 0; k < n; ++k) {
            const double angle = 2.0 * std::acos(-1.0) * k / n;
            text += fmt::format("v {} {} 2\n", std::cos(angle), std::sin(angle));
            face += fmt::format(" {}", k + 1);
        }
        Diagnostics diagnostics;
        const Scene scene = read(folder, text + face + "\n" + face + "\n", &diagnostics);
        REQUIRE(scene.surfaces.size() == 2 * static_cast<std::size_t>((n - 1) / 2));
        REQUIRE(area(scene) == Approx(n * std::sin(2.0 * std::acos(-1.0) / n)).epsilon(1e-5));
        for (const Surface& surface : scene.surfaces) {
            REQUIRE(area_vector(surface.polygon()).z > 0.0);
        }
        REQUIRE(diagnostics.warnings().size() == 1);
        require_parts(diagnostics.warnings()[0], {"2 faces of more than 4 vertices cut"});
    }
}

TEST_CASE("OBJ reader: vertices in a line with their neighbours and repeated ones do no harm", "[io]") {
    const Folder folder;
    const std::string text =
        "v 0 0 0\nv 0.5 0 0\nv 1 0 0\nv 1 0.5 0\nv 1 1 0\nv 0.5 1 0\nv 0 1 0\nv 0 0.5 0\n";
    REQUIRE(area(read(folder, text + "f 1 2 3 4 5 6 7 8\n")) == Approx(1.0));
    REQUIRE(area(read(folder, text + "f 8 1 2 3 4 5 6 7\n")) == Approx(1.0));
    const Scene repeated = read(folder, text + "f 1 3 3 5 1\n");
    REQUIRE(repeated.surfaces[0].vertex_count == 3);
}

TEST_CASE("OBJ reader: faces without area are left out with a warning, or refused by --strict", "[io]") {
    const Folder folder;
    const std::string text = corners + "f 1 2 3 4\nf 1 2 2\nf 1 2 1 2\nf 3 3 3\n";
    require_parts(message_of<ParseError>([&] { read(folder, text, nullptr, {.strict = true}); }),
                  {"room.obj:6: face: zero area"});
    Diagnostics diagnostics;
    REQUIRE(read(folder, text, &diagnostics).surfaces.size() == 1);
    REQUIRE(diagnostics.warnings().size() == 1);
    require_parts(diagnostics.warnings()[0], {"room.obj:6: 3 faces without area left out"});
}

TEST_CASE("OBJ reader: named groups become two-sided, unknown ones are refused", "[io]") {
    const Folder folder;
    const std::string text = corners + "g leaf\nf 1 2 3\ng wall\nf 1 2 3 4\n";
    const Scene scene = read(folder, text, nullptr, {.two_sided_groups = {"leaf"}});
    REQUIRE(scene.surfaces[0].two_sided);
    REQUIRE_FALSE(scene.surfaces[1].two_sided);
    const io::SceneReaderOptions wrong{.two_sided_groups = {"laef"}};
    require_parts(message_of<InvalidArgument>([&] { read(folder, text, nullptr, wrong); }),
                  {"room.obj: no group \"laef\" to make two-sided; did you mean \"leaf\"?"});
}

TEST_CASE("MTL: one value stands for three, blanks in names are kept, unused materials are not checked",
          "[io]") {
    const Folder folder;
    folder.write(
        "my materials.mtl",
        "# x\nnewmtl light blue \nKd 0.25 # grey\n\tKe 3\nillum 2\nmap_Kd a.png\nnewmtl mirror\nKd 1 1 1\n");
    Diagnostics diagnostics;
    const Scene scene =
        read(folder, "mtllib my materials.mtl\nusemtl light blue\n" + corners + "f 1 2 3\nusemtl mirror\n",
             &diagnostics);
    REQUIRE(scene.materials == std::vector<Material>{{"light blue", {0.25, 0.25, 0.25}, {3, 3, 3}}});
    REQUIRE(diagnostics.warnings().size() == 1);
    require_parts(diagnostics.warnings()[0], {"my materials.mtl:6: textures are not used"});
}

TEST_CASE("MTL: several files on one line are all read", "[io]") {
    const Folder folder;
    folder.write("a.mtl", "newmtl a\nKd 0.1\n");
    folder.write("b.mtl", "newmtl b\nKd 0.2\nnewmtl a\nKd 0.1\n");
    const Scene scene =
        read(folder, "mtllib a.mtl b.mtl\n" + corners + "usemtl b\nf 1 2 3\nf 1 2 3 4\nusemtl a\nf 1 2 3\n");
    REQUIRE(scene.materials.size() == 2);
    REQUIRE(scene.materials[0].name == "b");
    REQUIRE(scene.surfaces[2].material == 1);
}

TEST_CASE("MTL: a missing file gives a warning and the default material", "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    const Scene scene = read(folder, "mtllib no.mtl\nusemtl x\n" + corners + "f 1 2 3\n", &diagnostics);
    REQUIRE(scene.materials == std::vector<Material>{{"x", {0.5}, {0.0}}});
    REQUIRE(diagnostics.warnings().size() == 1);
    require_parts(diagnostics.warnings()[0], {"room.obj:1: there is no file", "no.mtl", "reflectance 0.5"});
    Diagnostics others;
    REQUIRE(read(folder, "usemtl x\n" + corners + "f 1 2 3\n", &others).materials[0].name == "x");
    require_parts(others.warnings().at(0), {"room.obj:1: usemtl without mtllib"});
}

TEST_CASE("OBJ reader: o, g and usemtl without a name go back to the default", "[io]") {
    const Folder folder;
    folder.write("m.mtl", "newmtl m\nKd 0.2\n");
    const Scene scene =
        read(folder, "mtllib m.mtl\n" + corners +
                         "g a\nusemtl m\nf 1 2 3\ng\nusemtl\nf 1 2 3\no b\nf 1 2 3\no \nf 1 2 3\n");
    REQUIRE(scene.groups == std::vector<std::string>{"a", "default", "b"});
    REQUIRE(scene.surfaces[3].group == 1);
    REQUIRE(scene.materials.size() == 2);
    REQUIRE(scene.materials[1] == Material{"default", {0.5, 0.5, 0.5}, {0, 0, 0}});
    REQUIRE(scene.surfaces[1].material == 1);
}

TEST_CASE("OBJ reader: other keywords are left out with one warning for each", "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    read(folder, corners + "l 1 2\nl 2 3\ncurv 1\nf 1 2 3\np 1\n", &diagnostics);
    REQUIRE(diagnostics.warnings().size() == 3);
    require_parts(diagnostics.warnings()[0], {"room.obj:5: \"l\" lines are left out"});
}

TEST_CASE("OBJ reader: names that are not UTF-8 become it and stay different", "[io]") {
    const Folder folder;
    const Scene scene = read(folder, corners + "g caf\xE9\nf 1 2 3\ng caf\xE8\nf 1 2 3\ng café\nf 1 2 3\n");
    REQUIRE(scene.groups == std::vector<std::string>{"café", "cafè"});
    REQUIRE(scene.surfaces[2].group == 0);
}

TEST_CASE("OBJ reader: a library by a name that no file can have is one that is not there", "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    const Scene scene = read(
        folder, "mtllib " + std::string(300, 'a') + "\nusemtl x\n" + corners + "f 1 2 3\n", &diagnostics);
    CHECK(scene.surfaces.size() == 1);
    REQUIRE(diagnostics.warnings().size() == 1);
    require_parts(diagnostics.warnings()[0], {"room.obj:1: there is no file"});
}

TEST_CASE(
    "OBJ reader: lines may end in a carriage return alone, and faces name textures and normals as they like",
    "[io]") {
    const Folder folder;
    const Scene scene = read(folder, corners + "g a\rf 1 2 3\nf 1/ 2// 3/3/3\ng\nf 1/1 2/12/7 4\n");
    CHECK(scene.groups == std::vector<std::string>{"a", "default"});
    REQUIRE(scene.surfaces.size() == 3);
    CHECK(scene.surfaces[1].vertices[2] == Vec3(1, 1, 0));
    CHECK(scene.surfaces[2].vertices[2] == Vec3(0, 1, 0));
    CHECK_THROWS_AS(read(folder, corners + "g a\rf 7 8 9\n"), ParseError);
}

TEST_CASE("OBJ reader: a concave face is cut, and one whose edges cross is refused with its line", "[io]") {
    const Folder folder;
    const std::string arrow = "v 0 0 0\nv 2 0 0\nv 0.5 0.5 0\nv 0 2 0\n";
    Diagnostics diagnostics;
    const Scene cut_arrow = read(folder, arrow + "f 1 2 3 4\n", &diagnostics);
    CHECK(area(cut_arrow) == Approx(1.0));
    CHECK(cut_arrow.surfaces.size() == 2);
    require_parts(diagnostics.warnings().at(0), {"room.obj:5: 1 face that is not convex cut"});
    const std::string five = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 0.5 0\nv 0 2 0\n";
    CHECK(area(read(folder, five + "f 1 2 3 4 5\n")) == Approx(2.5));
    std::string star;
    for (int k = 0; k < 5; ++k) {
        const double angle = 4.0 * std::acos(-1.0) * k / 5;
        star += "v " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
    }
    require_parts(message_of<ParseError>([&] { read(folder, star + "f 1 2 3 4 5\n"); }),
                  {"room.obj:6: face: edges that cross each other"});
}

TEST_CASE("OBJ reader: what is wrong is named with its line, its value and what would be right", "[io]") {
    struct Bad {
        std::string text;
        std::vector<std::string> parts;
    };
    const std::string use = "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const std::vector<Bad> table{
        {"", {"room.obj: no faces"}},
        {corners, {"room.obj: no faces"}},
        {"v 1 2\n", {":1: a vertex of 2 numbers; must have 3"}},
        {"v\n", {":1: a vertex of 0 numbers"}},
        {"v 1 2 abc\n", {":1: \"abc\" in a vertex; must be a finite number"}},
        {"v 1 2 3x\n", {":1: \"3x\" in a vertex"}},
        {"v 1 2 nan\n", {":1: \"nan\" in a vertex"}},
        {"v 1 2 inf\n", {":1: \"inf\" in a vertex"}},
        {"v 1 2 1e999\n", {":1: \"1e999\" in a vertex"}},
        {"v 1 2 1,5\n", {":1: \"1,5\" in a vertex"}},
        {"v 0 0 +-1\n", {":1: \"+-1\" in a vertex"}},
        {corners + "f 1 2\n", {":5: a face of 2 vertices; must have 3 or more"}},
        {corners + "f\n", {":5: a face of 0 vertices"}},
        {corners + "f 1 2 5\n", {":5: a face with vertex 5; there are 4 vertices so far"}},
        {corners + "f 1 2 -5\n", {":5: a face with vertex -5"}},
        {corners + "f 0 1 2\n", {":5: \"0\" in a face"}},
        {corners + "f 1 2 x\n", {":5: \"x\" in a face"}},
        {corners + "f 1 2 3.5\n", {":5: \"3.5\" in a face"}},
        {corners + "f 1 2 99999999999999999999\n", {":5: \"99999999999999999999\" in a face"}},
        {corners + "f 1/a 2/b 3/c\n", {":5: \"1/a\" in a face; must be like"}},
        {corners + "f 1// 2//3/ 3\n", {":5: \"2//3/\" in a face; must be like"}},
        {"f 1 2 3\n" + corners, {":1: a face with vertex 1; there are 0"}},
        {corners + std::string("f 1 2 3\0x\n", 10), {":5: a zero byte"}},
        {corners + "f 1 2 4 3\n", {":5: face: zero area, since its edges cross each other"}},
        {corners + "f 1 2 2\n", {"room.obj: no faces with an area"}},
        {"v 0 0 0\nv 1e200 0 0\nv 0 1e200 0\nf 1 2 3\n", {":4: face: "}},
        {"mtllib one.mtl\nusemtl one\n" + corners + "f 1 2 3\n",
         {"one.mtl:1: material \"one\": Kd 1.5; a reflectance must be at least 0 and below 1"}},
        {"mtllib dark.mtl\nusemtl dark\n" + corners + "f 1 2 3\n", {"dark.mtl:1: material \"dark\": Ke -2"}},
        {"mtllib word.mtl\nusemtl w\n" + corners + "f 1 2 3\n",
         {"word.mtl:2: \"red\" after Kd; must be one or three numbers"}},
        {"mtllib two.mtl\nusemtl t\n" + corners + "f 1 2 3\n", {"two.mtl:2: Kd with 2 numbers"}},
        {"mtllib four.mtl\nusemtl t\n" + corners + "f 1 2 3\n", {"four.mtl:2: \"0.4\" after Kd"}},
        {"mtllib early.mtl\nusemtl t\n" + corners + "f 1 2 3\n", {"early.mtl:1: Ke before the first newmtl"}},
        {"mtllib nameless.mtl\nusemtl t\n" + corners + "f 1 2 3\n",
         {"nameless.mtl:1: newmtl without a name"}},
        {"mtllib twice.mtl\nusemtl t\n" + corners + "f 1 2 3\n",
         {"twice.mtl:3: material \"t\" has other values than at"}},
    };
    const Folder folder;
    folder.write("m.mtl", "newmtl m\nKd 0.5\n");
    folder.write("long.mtl", "newmtl whitewash\n");
    folder.write("one.mtl", "newmtl one\nKd 1.5 1 1\n");
    folder.write("dark.mtl", "newmtl dark\nKe 0 -2 0\n");
    folder.write("word.mtl", "newmtl w\nKd red\n");
    folder.write("two.mtl", "newmtl t\nKd 0.1 0.2\n");
    folder.write("four.mtl", "newmtl t\nKd 0.1 0.2 0.3 0.4\n");
    folder.write("early.mtl", "Ke 1\n");
    folder.write("nameless.mtl", "newmtl \n");
    folder.write("twice.mtl", "newmtl t\nKd 0.1\nnewmtl t\nKd 0.2\n");
    REQUIRE_NOTHROW(read(folder, use));
    for (const Bad& bad : table) {
        INFO(bad.text);
        require_parts(message_of<InputError>([&] { read(folder, bad.text); }), bad.parts);
    }
}

TEST_CASE("OBJ reader: a mesh of many faces is read in linear time", "[io]") {
    const Folder folder;
    std::string text;
    constexpr int n = 250;
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
            text += "v " + std::to_string(i) + " " + std::to_string(j) + " 0\n";
        }
    }
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const int a = i * (n + 1) + j + 1;
            const auto group = "g cell" + std::to_string(a) + "\nf ";
            text += group + std::to_string(a) + " " + std::to_string(a + n + 1) + " " +
                    std::to_string(a + n + 2) + " " + std::to_string(a + 1) + "\n";
        }
    }
    const Scene scene = read(folder, text);
    REQUIRE(scene.surfaces.size() == n * n);
    REQUIRE(scene.groups.size() == n * n);
    REQUIRE(scene.surfaces.back().group == n * n - 1);
}

TEST_CASE("OBJ reader: the upward axis is that of the floors, where there are more of them than walls across",
          "[io]") {
    const Folder folder;
    // A block x by y by z, without its side towards -y, or -z.
    const auto block = [](double x, double y, double z, const std::string& faces) {
        std::string text;
        for (int k = 0; k < 8; ++k) {
            text += fmt::format("v {} {} {}\n", k % 2 * x, k / 2 % 2 * y, k / 4 * z);
        }
        return text + faces;
    };
    const std::string sides = "f 1 5 7 3\nf 2 4 8 6\n";
    const std::string across_z = "f 1 3 4 2\nf 5 6 8 7\n";
    const std::string across_y = "f 1 2 6 5\nf 3 7 8 4\n";
    CHECK(read(folder, block(1, 1, 1, sides + across_z + "f 3 7 8 4\n")).up == UpAxis::z);
    CHECK(read(folder, block(1, 1, 1, sides + across_y + "f 5 6 8 7\n")).up == UpAxis::y);
    CHECK(read(folder, block(9, 7, 3, sides + across_y + across_z)).up == UpAxis::z);
    CHECK(read(folder, block(9, 3, 7, sides + across_y + across_z)).up == UpAxis::y);
    CHECK(read(folder, block(1, 1, 1, sides + across_y + across_z)).up == UpAxis::z);
    // Slopes alone: the flat side.
    CHECK(read(folder, "v 0 0 0\nv 9 1 0\nv 9 2 9\nf 1 2 3\n").up == UpAxis::y);
    CHECK(read(folder, "v 0 0 0\nv 9 0 1\nv 9 9 2\nf 1 2 3\n").up == UpAxis::z);
    folder.write("tall.obj", block(9, 3, 7, sides + across_y + across_z));
    folder.write("wide.obj", block(9, 7, 3, sides + across_y + across_z));
    Diagnostics unused;
    const std::vector<std::filesystem::path> mixed{folder / "tall.obj", folder / "wide.obj"};
    CHECK(io::read_scenes(mixed, {}, unused).up == UpAxis::z);
    folder.write("other.obj", block(8, 2, 6, sides + across_y + across_z));
    const std::vector<std::filesystem::path> alike{folder / "tall.obj", folder / "other.obj"};
    CHECK(io::read_scenes(alike, {}, unused).up == UpAxis::y);
}

TEST_CASE("read_scene: goes by the extension, whatever its case, and lists what can be read", "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    folder.write("A.OBJ", corners + "f 1 2 3\n");
    REQUIRE(io::read_scene(folder / "A.OBJ", {}, diagnostics).surfaces.size() == 1);
    REQUIRE(io::is_scene_file("x.Json"));
    REQUIRE_FALSE(io::is_scene_file("x.hff"));
    const auto refusal = [&](const char* name) {
        return message_of<InputError>([&] { (void)io::read_scene(folder / name, {}, diagnostics); });
    };
    require_parts(refusal("a.3ds"), {"a.3ds: unknown extension \".3ds\"; scenes are read from .json, .obj, "
                                     ".gltf, .glb, .vs3, .msh, .ply, "
                                     ".stl, .inp, .vtk, .vtp, .vtu, .bdf, .nas, .epjson files"});
    require_parts(refusal("a"), {"a: no extension; scenes are read from"});
    require_parts(refusal("no.obj"), {"no.obj: cannot be read: No such file"});
    require_parts(refusal("no.json"), {"no.json: cannot be read: No such file"});
}

} // namespace hemi::io_test
