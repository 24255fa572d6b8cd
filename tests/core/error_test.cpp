#include "hemi/core/diagnostics.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

#include <string>

using namespace hemi;

TEST_CASE("ParseError: begins with file and line and column as far as they are known", "[core]") {
    const ParseError full("room.json", 12, 5, "unknown key");
    CHECK(std::string(full.what()) == "room.json:12:5: unknown key");
    CHECK(full.file() == "room.json");
    CHECK(full.line() == 12);
    CHECK(full.column() == 5);
    CHECK(std::string(ParseError("room.obj", 12, 0, "bad index").what()) == "room.obj:12: bad index");
    CHECK(std::string(ParseError("room.obj", 0, 0, "is empty").what()) == "room.obj: is empty");
    CHECK(std::string(ParseError("room.obj", 0, 7, "is empty").what()) == "room.obj: is empty");
}

TEST_CASE("ParseError: takes braces and percent signs as they are", "[core]") {
    CHECK(std::string(ParseError("{}%s", 1, 2, "{0} %d").what()) == "{}%s:1:2: {0} %d");
}

TEST_CASE("errors: all are hemi errors and the finer kinds are of the coarser ones", "[core]") {
    CHECK_THROWS_AS(throw ParseError("a", 1, 1, "b"), InputError);
    CHECK_THROWS_AS(throw InputError("a"), Error);
    CHECK_THROWS_AS(throw InvalidArgument("a"), Error);
    CHECK_THROWS_AS(throw NoDevice("a"), GlError);
    CHECK_THROWS_AS(throw GlError("a"), Error);
    CHECK_THROWS_AS(throw IoError("a"), Error);
    CHECK_THROWS_AS(throw OutOfMemory("a"), Error);
    CHECK_THROWS_AS(throw NotConverged("a"), Error);
    CHECK_THROWS_WITH(throw Cancelled(), "interrupted");
    CHECK_THROWS_AS(throw Error("a"), std::runtime_error);
}

TEST_CASE("Diagnostics: keeps warnings in the order they came", "[core]") {
    Diagnostics diagnostics;
    CHECK(diagnostics.warnings().empty());
    diagnostics.warn("first");
    diagnostics.warn("second");
    CHECK(diagnostics.warnings() == std::vector<std::string>{"first", "second"});
}
