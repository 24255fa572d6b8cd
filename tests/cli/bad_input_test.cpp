#include "cli/program.hpp"
#include "support/command.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

#include <cstring>

using namespace hemi::cli_test;
using hemi::test::run_command;

namespace {

struct BadFile {
    std::string name;
    std::string text;
    Words parts; ///< of the message
};

/// Every command that reads such a file ends with 3 and names file, place and value.
void refuses_all(const std::vector<BadFile>& table, const std::string& command = "info") {
    const Directory directory;
    directory.write("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    for (const BadFile& bad : table) {
        const Outcome run = run_hemi({command, directory.write(bad.name, bad.text)});
        INFO(command << " " << bad.name << ": " << bad.text.substr(0, 200) << "\nstderr: " << run.err);
        CHECK(run.status == 3);
        CHECK(run.out.empty());
        CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
        for (const std::string& part : bad.parts) {
            INFO("wanted: " << part);
            CHECK(run.err_has(part));
        }
    }
}

std::string scene_with(const std::string& polygon, const std::string& more = "") {
    return R"({"hemi": 1, "materials": {"w": {"reflectance": 0.5}}, "surfaces": [{"material": "w", "polygon": )" +
           polygon + "}]" + more + "}";
}

std::string raw(std::uint64_t value, int bytes) {
    return {reinterpret_cast<const char*>(&value), static_cast<std::size_t>(bytes)};
}

const std::string square = "[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]";
const std::string mtx = "%%MatrixMarket matrix coordinate real general\n";

} // namespace

TEST_CASE("Bad input: scenes as JSON end with 3, file, place, value and what would be right", "[cli]") {
    refuses_all({
        {"empty.json", "", {"empty.json:1:1"}},
        {"cut.json", scene_with(square).substr(0, 90), {"cut.json:1:91"}},
        {"nan.json", scene_with("[[0,0,0],[1,0,0],[1,NaN,0]]"), {"nan.json:1:"}},
        {"null.json",
         scene_with("[[0,0,0],[1,0,0],[1,null,0]]"),
         {"surfaces[0].polygon[2][1]: null", "number"}},
        {"huge.json",
         scene_with("[[0,0,0],[1e308,0,0],[1e308,1e308,0]]"),
         {"huge.json: surfaces[0].polygon"}},
        {"beyond.json", scene_with("[[0,0,0],[1e999,0,0],[1,1,0]]"), {"beyond.json:1:", "1e999"}},
        {"comma.json",
         scene_with("[[0,0,0],[1,5,0,0],[1,1,0]]"),
         {"polygon[1]: an array of 4", "three numbers"}},
        {"keys.json", R"({"hemi": 1, "hemi": 1})", {"keys.json:", "\"hemi\" is given twice"}},
        {"names.json",
         R"({"hemi": 1, "materials": {"w": {"reflectance": 0}, "w": {"reflectance": 0}}, "surfaces": []})",
         {"names.json:", "\"w\" is given twice"}},
        {"channels.json",
         scene_with(square, R"(, "channels": ["a", "a"])"),
         {"channels[1]: \"a\" is given twice"}},
        {"itself.json",
         R"({"hemi": 1, "surfaces": [{"mesh": "itself.json"}]})",
         {"surfaces[0].mesh: \"itself.json\"; must be the path of a mesh: .obj"}},
        {"nowhere.json",
         R"({"hemi": 1, "surfaces": [{"mesh": "no.obj"}]})",
         {"no.obj: cannot be read: No such"}},
        {"folder.json", R"({"hemi": 1, "surfaces": [{"mesh": "..obj"}]})", {"..obj"}},
        {"million.json", scene_with(square, R"(, "patch_size": 1e-300)"), {"million.json"}},
        {"patches.json",
         R"({"hemi": 1, "materials": {"w": {"reflectance": 0.5}}, "surfaces": [{"material": "w", "polygon": )" +
             square + R"(, "patches": [1000000, 1000000]}]})",
         {"patches.json: "}},
        {"nested.json", std::string(100'000, '['), {"nested deeper than 64"}},
        {"latin.json", scene_with(square, ", \"name\": \"Caf\xE9\""), {"latin.json:1:"}},
        {"binary.json", std::string("\0\1\2\3", 4), {"binary.json:1:"}},
    });
}

TEST_CASE("Bad input: meshes end with 3, file, line, value and what would be right", "[cli]") {
    refuses_all({
        {"empty.obj", "", {"empty.obj: no faces"}},
        {"cut.obj", "v 0 0 0\nv 1 0 0\nv 1 1", {"cut.obj:3: a vertex of 2 numbers"}},
        {"nan.obj", "v 0 0 nan\n", {"nan.obj:1: \"nan\" in a vertex; must be a finite number"}},
        {"huge.obj", "v 0 0 0\nv 1e308 0 0\nv 0 1e308 0\nf 1 2 3\n", {"huge.obj:4: face"}},
        {"comma.obj", "v 0,5 0 0\n", {"comma.obj:1: \"0,5\" in a vertex"}},
        {"crlf.obj", "v 0 0 0\r\nv 1 0 x\r\n", {"crlf.obj:2: \"x\" in a vertex"}},
        {"claim.glb",
         "glTF" + raw(2, 4) + raw(0xFFFFFFFF, 4) + std::string(20, ' '),
         {"claim.glb: cut short: 32 bytes; its header says 4294967295"}},
        {"cut.gltf", R"({"asset": {"version": )", {"cut.gltf:1:"}},
        {"buffer.gltf",
         R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 4294967296, "uri": "square.obj"}]})",
         {"buffer.gltf"}},
        {"cut.vs3", "F 3\nV 1 0 0\n", {"cut.vs3:2: vertex 1: z \"\"; must be a number"}},
        {"comma.vs3", "F 3\nV 1 0 0 0,5\n", {"comma.vs3:2: ", "0,5"}},
        {"nan.vs3", "F 3\nV 1 0 nan 0\n", {"nan.vs3:2: vertex 1: y \"nan\""}},
    });
}

TEST_CASE("Bad input: stored files end with 3, file, place and what would be right", "[cli]") {
    refuses_all({
        {"empty.hff", "", {"empty.hff: 0 bytes; too short"}},
        {"text.hff", "i,j,F\n0,1,0.5 and more\n", {"text.hff: does not hold form factors"}},
        {"claim.hff",
         "HEMIFF\r\n" + raw(4, 4) + raw(0, 4) + "HEAD" + raw(0, 4) + raw(0xFFFFFFFF, 8),
         {"claim.hff: cut short: chunk HEAD at byte 16 says it has 4294967295 bytes, the file has 0 more"}},
        {"old.hff", "HEMIFF\r\n" + raw(1, 4) + raw(0, 4), {"old.hff: version 1", "reads version"}},
        {"empty.hres", "", {"empty.hres: 0 bytes; too short"}},
        {"claim.mtx", mtx + "4294967295 4294967295 0\n", {"claim.mtx:2: 4294967295 rows"}},
        {"many.mtx", mtx + "2 2 4294967296\n", {"many.mtx:2: 2 rows and 4294967296 entries in a file of"}},
        {"nan.mtx", mtx + "2 2 1\n1 2 nan\n", {"nan.mtx:3: value \"nan\"; a form factor must be finite"}},
        {"huge.mtx", mtx + "2 2 1\n1 2 1e308\n", {"huge.mtx:3: value \"1e308\""}},
        {"comma.csv", "i;j;F\n0;1;0,5\n", {"comma.csv:1: \"i;j;F\"; must be the header"}},
        {"twice.csv", "i,j,F\n0,1,1\n0,1,1\n", {"twice.csv:3: the entry of line 2 again"}},
        {"cut.npz", "PK\3\4", {"cut.npz: cannot be read as a ZIP archive"}},
    });
}

TEST_CASE("Bad input: names in files do not command the terminal", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write(
        "a.obj", "mtllib \x1b]0;x\x07.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\ng \x1b[31mred\nusemtl a\nf 1 2 3\n");
    const Outcome run = run_hemi({"info", scene});
    INFO(run.err);
    CHECK(run.status == 0);
    CHECK(run.out_has("?[31mred"));
    CHECK(run.err_has("?]0;x?.mtl"));
    CHECK((run.out + run.err).find('\x1b') == std::string::npos);
}

TEST_CASE("Bad input: files that are missing, directories, unreadable or endless links end with 3", "[cli]") {
    const Directory directory;
    for (const std::string extension :
         {"json", "obj", "gltf", "glb", "vs3", "hff", "hres", "mtx", "csv", "npz"}) {
        const auto refuses = [&](const std::string& name, const std::string& why) {
            const Outcome run = run_hemi({"info", directory.path(name)});
            INFO(name << ": " << run.err);
            CHECK(run.status == 3);
            CHECK(run.err_has(name));
            CHECK(run.err_has(why));
        };
        refuses("none." + extension, "No such file");
        std::filesystem::create_directory(directory.path("folder." + extension));
        refuses("folder." + extension, "directory");
        std::filesystem::create_symlink("loop." + extension, directory.path("loop." + extension));
        refuses("loop." + extension, "symbolic links");
        // Unreadable even for root: nothing is mapped at address 0.
        std::filesystem::create_symlink("/proc/self/mem", directory.path("mem." + extension));
        refuses("mem." + extension, "mem." + extension);
    }
}

TEST_CASE("Bad output: full disks and places that cannot be written end with 1 and leave nothing", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(8));
    const std::string factors = directory.path("cube.hff");
    REQUIRE(run_hemi(quick({"factors", scene, "-o", factors})).status == 0);
    for (const std::string name :
         {"a.hff", "a.mtx", "a.csv", "a.npz", "a.npy", "a.h5", "a.txt", "a.vf", "a.dat", "a.bin"}) {
        const std::string line = "trap '' XFSZ; ulimit -f 16; exec '" HEMI_PROGRAM "' convert '" + factors +
                                 "' '" + directory.path(name) + "'";
        const auto full = run_command({"bash", "-c", line});
        INFO(name << ": " << full.err);
        CHECK(full.status == 1);
        CHECK(full.err.find(name + ": cannot be written: File too large") != std::string::npos);
        CHECK(directory.names() == Words{"cube.hff", "cube.json"});

        // Not even root makes files there.
        const Outcome read_only = run_hemi({"convert", factors, "/proc/" + name});
        INFO(read_only.err);
        CHECK(read_only.status == 1);
        CHECK(read_only.err_has("/proc/" + name));
    }
}

TEST_CASE("Good input: UTF-8 names, CR LF and the locale of the system change nothing", "[cli]") {
    const Directory directory;
    const std::string text =
        "o Decke \xC3\xA4\xE2\x88\x9E\nv 0 0 0\nv 1.5 0 0\nv 1.5 1 0\nv 0 1 0\nf 1 2 3 4\n";
    std::string crlf;
    for (const char c : text) {
        crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
    }
    directory.write("r\xC3\xA4um.obj", text);
    directory.write("crlf.obj", crlf);
    const Outcome plain =
        run_hemi(quick({"factors", directory.path("r\xC3\xA4um.obj"), "--by-group", "--json"}));
    INFO(plain.err);
    REQUIRE(plain.status == 0);
    CHECK(plain.json()["groups"][0] == "Decke \xC3\xA4\xE2\x88\x9E");
    CHECK(plain.json()["areas"][0] == 1.5);
    // The program never leaves the C locale, whether or not the system has another.
    const Outcome german = run_hemi(quick({"factors", directory.path("crlf.obj"), "--by-group", "--json"}),
                                    {"LC_ALL=de_DE.UTF-8", "LANG=de_DE.UTF-8"});
    REQUIRE(german.status == 0);
    for (const char* key : {"groups", "areas", "factors", "environment"}) {
        CHECK(german.json()[key] == plain.json()[key]);
    }
}
