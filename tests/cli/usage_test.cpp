#include "cli/program.hpp"
#include "support/command.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

using namespace hemi::cli_test;

namespace {

const Words commands{"solve", "factors", "check", "render", "view", "bake", "convert", "info", "devices"};

/// Runs with the arguments and expects a usage error that says `text`.
void refuses(const Words& arguments, const std::string& text) {
    const Outcome run = run_hemi(arguments);
    INFO("stderr: " << run.err << " expected: " << text);
    CHECK(run.status == 2);
    CHECK(run.out.empty());
    CHECK(run.err_has(text));
}

} // namespace

TEST_CASE("Command line: help and version answer on stdout at every level", "[cli]") {
    const Outcome version = run_hemi({"--version"});
    CHECK(version.status == 0);
    CHECK(version.out.rfind("hemi ", 0) == 0);
    for (const char* name : {"\nrevision  ", "\ncompiler  ", "\nOpenGL    4.5 core, loader glad 2."}) {
        CHECK(version.out_has(name));
    }
    CHECK(version.out.ends_with("\n"));
    CHECK_FALSE(version.out.ends_with("\n\n"));
    CHECK(run_hemi({"solve", "--version"}).out == version.out);

    const Outcome help = run_hemi({"--help"});
    CHECK(help.status == 0);
    for (const std::string& command : commands) {
        CHECK(help.out_has("  " + command));
        const Outcome own = run_hemi({command, "--help"});
        INFO(command);
        CHECK(own.status == 0);
        CHECK(own.err.empty());
        CHECK(own.out_has("Usage: hemi " + command));
        // The last thing is two examples.
        const std::size_t examples = own.out.rfind("Examples:\n  hemi " + command);
        REQUIRE(examples != std::string::npos);
        const std::string rest = own.out.substr(examples);
        CHECK(rest.find("\n  hemi " + command, rest.find("hemi") + 1) != std::string::npos);
    }
    CHECK(run_hemi({"help"}).out == help.out);
    CHECK(run_hemi({"help", "solve"}).out == run_hemi({"solve", "--help"}).out);
}

TEST_CASE("Command line: a mistyped word gets the nearest right one", "[cli]") {
    refuses({"slove", "x.json"}, "did you mean solve?");
    refuses({"factros"}, "did you mean factors?");
    refuses({"solve", "x.json", "--resoluton", "64"}, "did you mean --resolution?");
    refuses({"solve", "--resoluton=64", "x.json"}, "did you mean --resolution?");
    refuses({"solve", "x.json", "--solver", "jakobi"}, "did you mean jacobi?");
    refuses({"solve", "x.json", "--device", "osmessa"}, "did you mean osmesa?");
    refuses({"check", "x.json", "--enclosure", "close"}, "did you mean closed?");
    refuses({"solve", "x.json", "--repair", "closur"}, "did you mean closure?");
}

TEST_CASE("Command line: options that do not apply are refused", "[cli]") {
    refuses({"factors", "x.json", "--solver", "jacobi"},
            "--solver does not apply to `hemi factors`; it belongs to solve");
    refuses({"solve", "x.json", "--row", "1"}, "it belongs to factors");
    refuses({"devices", "--resolution", "64"}, "does not apply to `hemi devices`");
    refuses({"convert", "x.mtx", "x.csv", "--repair", "closure"}, "only a .hff has");
    refuses({"convert", "x.hff", "y.hff", "--repair", "closure"}, "redone when it is read");
    refuses({"info", "x.json", "--repair", "closure"}, "--repair does not apply to `hemi info`");
    refuses({"solve", "x.json", "--size", "80x60"}, "--size"); // no picture to be of that size
    refuses({"solve", "x.json", "--flat"}, "--flat");
    refuses({"solve", "x.json", "--patch-size", "1", "--patches-per-face", "4"}, "--patch");
    refuses({"factors", "x.json", "--row", "1", "--by-group"}, "--by-group");
    refuses({"view", "x.json", "--json"}, "--json");
    refuses({"solve", "x.json", "--preset", "plain", "--shadow-rays", "4"}, "--preset plain");
    refuses({"factors", "x.json", "--method", "direct", "--shadow-rays", "4"}, "--method direct");
    refuses({"devices", "more"}, "unexpected argument 'more'");
}

TEST_CASE("Command line: bad values are named with what would be right", "[cli]") {
    refuses({}, "a command is missing");
    refuses({}, "\n  diff      Two stored solutions compared");
    refuses({"solve"}, "SCENE");
    refuses({"solve", "x.json", "--resolution", "127"}, "must be even");
    refuses({"solve", "x.json", "--eye-points", "5"}, "1, 4, 9, 16");
    refuses({"solve", "x.json", "--preset", "exat"}, "did you mean exact?");
    refuses({"solve", "x.json", "--resolution", "5000"}, "2 to 4096");
    refuses({"solve", "x.json", "--resolution", "-4"}, "--resolution -4");
    refuses({"solve", "x.json", "--patch-size", "0"}, "a number above 0");
    refuses({"solve", "x.json", "--patch-size", "nan"}, "--patch-size nan");
    refuses({"solve", "x.json", "--tolerance", "2"}, "must be below 1");
    refuses({"solve", "x.json", "--max-memory", "2Q"}, "an amount of memory such as");
    refuses({"solve", "x.json", "-o", "a.png", "--size", "80"}, "WIDTHxHEIGHT");
    refuses({"solve", "x.json", "-o", "a.png", "--exposure", "-1"}, "--exposure -1");
    refuses({"solve", "x.json", "-o", "a.png", "--camera", "1,2:3,4,5"}, "EYE:TARGET");
    refuses({"solve", "x.json", "-o", "a.png", "--camera", "1,2,3:1,2,3"}, "differ");
    refuses({"solve", "x.json", "-o", "a.png", "--up", "x"}, "--up x");
    refuses({"solve", "x.json", "--device", "egl:x"}, "a whole number");
    refuses({"solve", "x.json", "--seed", "1.5"}, "--seed 1.5");
    refuses({"solve", "x.json", "--resolution"}, "--resolution");
}

TEST_CASE("Command line: output names are looked at before the work", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    refuses({"solve", scene, "-o", directory.path("a.jpg")}, "must end in .png, .hdr");
    refuses({"solve", scene, "--result", directory.path("a.bin")}, "must end in .hres");
    refuses({"factors", scene, "-o", directory.path("a.doc")},
            "must end in .hff, .mtx, .csv, .npz, .npy, .h5, .txt, .vf, .dat, .bin, .idf, .vtp");
    refuses({"solve", scene, "--patches", directory.path("a.csv"), "--radiosity", directory.path("a.csv")},
            "the same file");
    for (const std::string& spelling :
         {std::string("./a.csv"), directory.path("a.csv")}) { // nothing is there yet
        const auto twice = hemi::test::run_command(
            {"sh", "-c", "cd \"$1\" && exec \"$2\" factors cube.json -o a.csv --patches \"$3\"", "sh",
             directory.path(""), HEMI_PROGRAM, spelling});
        INFO(spelling << ": " << twice.err);
        CHECK(twice.status == 2);
        CHECK(twice.err.find("the same file") != std::string::npos);
    }
    refuses({"solve", scene, "-o", "-", "--json"}, "standard output");
    refuses({"solve", scene, "-o", "-", "--radiosity", "-"}, "standard output");
    refuses({"solve", scene, "--factors", "-"}, "standard output");

    const Outcome nowhere = run_hemi({"solve", scene, "-o", directory.path("none/a.png")});
    CHECK(nowhere.status == 1);
    CHECK(nowhere.err_has("there is no directory"));
    CHECK(directory.names() == Words{"cube.json"});
}

TEST_CASE("Command line: a scene that cannot be used is exit 3", "[cli]") {
    const Directory directory;
    CHECK(run_hemi({"info", directory.path("missing.json")}).status == 3);
    CHECK(run_hemi({"solve", directory.write("broken.json", "{\"hemi\": 1,")}).status == 3);
    Json scene = cube(2);
    scene["materials"]["white"]["reflectance"] = 1.5;
    const Outcome bright = run_hemi({"solve", directory.write("bright.json", scene)});
    CHECK(bright.status == 3);
    CHECK(bright.err_has("white"));
    const Outcome broken = run_hemi({"check", directory.write("broken.hff", "HFF?")});
    CHECK(broken.status == 3);
    CHECK(broken.err_has("broken.hff"));
}

TEST_CASE("Command line: a device that is not there is exit 4, and no other is taken", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    const Outcome run = run_hemi({"factors", scene, "--device", "egl:99"});
    CHECK(run.status == 4);
    CHECK(run.err_has("egl:99"));
    const Outcome window = run_hemi({"view", scene}, {"DISPLAY", "WAYLAND_DISPLAY"});
    CHECK(window.status == 4);
    CHECK(window.err_has("display"));
}

TEST_CASE("Command line: too little memory is exit 1 with figures and advice", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(7));
    const Outcome run =
        run_hemi(quick({"factors", scene, "--max-memory", "64K", "-o", directory.path("a.hff")}));
    CHECK(run.status == 1);
    CHECK(run.err_has("the limit is 64.0 KiB"));
    CHECK(run.err_has("--max-memory"));
    CHECK(run.err_has("--patch-size"));
    CHECK_FALSE(directory.has("a.hff"));
    CHECK(run_hemi(quick({"factors", scene, "--max-memory", "1.5GiB"})).status == 0);
}

TEST_CASE("Command line: colour and quiet are honoured", "[cli]") {
    const Words bad{"info", "missing.json"};
    const auto with = [&bad](Words more) {
        more.insert(more.begin(), bad.begin(), bad.end());
        return more;
    };
    CHECK_FALSE(run_hemi(bad).err_has("\x1b["));
    CHECK(run_hemi(with({"--color", "always"})).err_has("\x1b["));
    CHECK_FALSE(run_hemi(with({"--color", "never"}), {"CLICOLOR_FORCE=1"}).err_has("\x1b["));
    CHECK(run_hemi(bad, {"CLICOLOR_FORCE=1", "NO_COLOR", "TERM=xterm"}).err_has("\x1b["));
    CHECK_FALSE(run_hemi(bad, {"CLICOLOR_FORCE=1", "NO_COLOR=1"}).err_has("\x1b["));
    CHECK(run_hemi(with({"-q"})).err_has("missing.json")); // errors stay

    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    const Outcome quiet = run_hemi(quick({"solve", scene, "-q"}));
    CHECK(quiet.status == 0);
    CHECK(quiet.out.empty());
    CHECK(quiet.err.empty());
    const Outcome plain = run_hemi(quick({"solve", scene}));
    CHECK(plain.err.empty()); // no progress off a terminal
    CHECK_FALSE(plain.out.empty());
    CHECK(run_hemi(quick({"solve", directory.write("more.json", cube(7)), "-v"})).err_has(" %"));
}

TEST_CASE("Command line: a full disk behind stdout is exit 1", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", cube(2));
    const Outcome info = Run({"info", scene}, {}, "/dev/full").wait();
    CHECK(info.status == 1);
    CHECK(info.err_has("standard output"));
    CHECK(Run(quick({"factors", scene, "-o", "-"}), {}, "/dev/full").wait().status == 1);
}

TEST_CASE("Devices: a table and the same as JSON", "[cli]") {
    const Outcome table = run_hemi({"devices"});
    CHECK(table.status == 0);
    CHECK(table.out_has("osmesa"));
    const Json devices = run_hemi({"devices", "--json"}).json();
    CHECK(devices["schema"] == "hemi/devices/1");
    int chosen = 0;
    for (const Json& device : devices["devices"]) {
        for (const char* key : {"name", "renderer", "version", "usable", "problem", "software", "auto"}) {
            CHECK(device.contains(key));
        }
        chosen += device["auto"].get<bool>() ? 1 : 0;
    }
    CHECK(chosen == 1);
}
