#include "cli/program.hpp"
#include "support/command.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

#include <fstream>

using namespace hemi::cli_test;
using hemi::test::run_command;

namespace {

const Words corpus{HEMI_SOURCE_DIR "/tools/corpus", "--hemi", HEMI_PROGRAM};

Words with(Words words) {
    words.insert(words.begin(), corpus.begin(), corpus.end());
    return words;
}

const std::string room = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                         "f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 3 7 8 4\nf 1 4 8 5\nf 2 6 7 3\n";

} // namespace

TEST_CASE("corpus: a table of what became of the scenes of a folder", "[cli]") {
    const Directory directory;
    (void)directory.write("a.OBJ", room);
    (void)directory.write("twice.obj", room + "f 1 2 3 4\n");
    (void)directory.write("bad.obj", "v 0 0 0\nf 1 2 3\n");
    (void)directory.write("leaks.vs3",
                          "C encl=1\nF 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\nV 5 0 0 1\n"
                          "V 6 1 0 1\nV 7 1 1 1\nV 8 0 1 1\nS 1 1 2 3 4 0 0 .5 low\n"
                          "S 2 8 7 6 5 0 0 .5 high\n");
    (void)directory.write("large.obj", room + room.substr(room.find('f')) + "f 1 2 3\n");
    (void)directory.write("notes.txt", "no scene");
    const std::string json = directory.path("rows.JS");
    const auto outcome = run_command(with({directory.path("."), "--json", json, "--most-patches", "12"}));
    INFO(outcome.out << outcome.err);
    CHECK(outcome.status == 0);
    CHECK(outcome.out.find("5 files: 1 leaks, 2 ok, 1 refused, 1 too large; ") != std::string::npos);
    const Json rows = Json::parse(std::ifstream(json));
    CHECK(rows["counts"]["ok"] == 2);
    REQUIRE(rows["files"].size() == 5);
    const auto row = [&](const std::string& name) {
        for (const Json& file : rows["files"]) {
            if (file["file"].get<std::string>().ends_with("/" + name)) {
                return file;
            }
        }
        return Json();
    };
    CHECK(row("a.OBJ")["patches"] == 6);
    CHECK(row("a.OBJ")["warnings"] == 0);
    CHECK(row("twice.obj")["warnings"] == 1);
    CHECK(row("twice.obj")["message"].get<std::string>().starts_with("1 face is left out"));
    CHECK(row("bad.obj")["verdict"] == "refused");
    CHECK(row("bad.obj")["message"].get<std::string>().starts_with("bad.obj:2: "));
    CHECK(row("leaks.vs3")["verdict"] == "leaks");
    CHECK(row("large.obj")["verdict"] == "too large");
}

TEST_CASE("corpus: a program that crashes or takes too long is exit status 1, wrong arguments are 2",
          "[cli]") {
    const Directory directory;
    (void)directory.write("a.obj", room);
    const auto with_program = [&](const std::string& commands) {
        const std::string program = directory.write(
            "hemi", "#!/bin/sh\n[ \"$2\" = --help ] && echo 'scene, one mesh or several (.obj)' && exit\n" +
                        commands);
        REQUIRE(run_command({"chmod", "+x", program}).status == 0);
        return run_command(
            {HEMI_SOURCE_DIR "/tools/corpus", "--hemi", program, "--timeout", "0.2", directory.path(".")});
    };
    const auto crashes = with_program("kill -SEGV $$\n");
    CHECK(crashes.status == 1);
    CHECK(crashes.out.find("1 files: 1 crashed") != std::string::npos);
    const auto hangs = with_program("exec sleep 5\n");
    CHECK(hangs.status == 1);
    CHECK(hangs.out.find("1 files: 1 too long") != std::string::npos);
    CHECK(run_command(with({directory.path("none")})).status == 2);
    const Directory empty;
    CHECK(run_command(with({empty.path(".")})).status == 2);
    CHECK(run_command({HEMI_SOURCE_DIR "/tools/corpus", "--help"}).status == 0);
}
