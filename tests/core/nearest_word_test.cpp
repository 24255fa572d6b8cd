#include "hemi/core/nearest_word.hpp"

#include <catch2/catch.hpp>

namespace hemi {

TEST_CASE("nearest_word: finds what was meant by a slip, and nothing where nothing is close", "[core]") {
    const std::vector<std::string> known{"surfaces", "materials", "patch_size", "name", "egl", "a"};
    REQUIRE(nearest_word("surfases", known) == "surfaces");
    REQUIRE(nearest_word("sufraces", known) == "surfaces");
    REQUIRE(nearest_word("Materials", known) == "materials");
    REQUIRE(nearest_word("patchsize", known) == "patch_size");
    REQUIRE(nearest_word("nmae", known) == "name");
    REQUIRE(nearest_word("eg", known) == "egl");
    REQUIRE_FALSE(nearest_word("camera", known).has_value());
    REQUIRE_FALSE(nearest_word("b", known).has_value());
    REQUIRE_FALSE(nearest_word("", known).has_value());
    REQUIRE_FALSE(nearest_word(std::string(100'000, 'x'), known).has_value());
    REQUIRE_FALSE(nearest_word("x", {}).has_value());
}

TEST_CASE("did_you_mean: says the nearest word, or what there is", "[core]") {
    const std::vector<std::string> known{"closed", "open"};
    REQUIRE(did_you_mean("clsoed", known) == "; did you mean \"closed\"?");
    REQUIRE(did_you_mean("shut", known).empty());
    REQUIRE(did_you_mean_or_list("shut", known) == "; there is closed, open");
    REQUIRE(did_you_mean_or_list("shut", {}).empty());
    REQUIRE(did_you_mean_or_list("zzzz", std::vector<std::string>(20, "word")).ends_with("word, …"));
}

} // namespace hemi
