#include "cli/program.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

using namespace hemi::cli_test;

namespace {

Words on_cpu(Words words) {
    words.insert(words.end(), {"--device", "cpu", "--jobs", "1"});
    return words;
}

/// A room with an L-shaped floor and ceiling, seen from inside: vertices 1 to 6 below, 7 to 12 above.
const char* const ell_corners = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
                                "v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\nv 1 0 0\nv 0 1 0\n";
const char* const ell_walls = "g ceiling\nf 12 11 10 9 8 7\ng walls\nf 2 1 7 8\nf 3 2 8 9\nf 4 3 9 10\n"
                              "f 5 4 10 11\nf 6 5 11 12\nf 1 6 12 7\n";

/// A cube seen from inside, with one corner of its floor 0.3 lower: the floor is out of plane.
const char* const warped =
    "mtllib m.mtl\nusemtl white\nv 0 0 0\nv 1 0 0\nv 1 1 -0.3\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "g floor\nf 1 2 3 4\ng ceiling\nusemtl lamp\nf 8 7 6 5\ng walls\n"
    "usemtl white\nf 2 1 5 6\nf 3 2 6 7\nf 4 3 7 8\nf 1 4 8 5\n";

/// Rows of F from a `.csv` of triples.
std::map<std::array<int, 2>, double> triples(const std::string& text) {
    std::map<std::array<int, 2>, double> factors;
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
        std::istringstream fields(line);
        std::array<int, 2> at{};
        double value = 0.0;
        char comma = 0;
        fields >> at[0] >> comma >> at[1] >> comma >> value;
        factors[at] = value;
    }
    return factors;
}

/// Fields of a line of a table.
std::vector<std::string> fields_of(const std::string& text, std::size_t wanted) {
    std::istringstream lines(text);
    std::string line;
    for (std::size_t k = 0; k <= wanted; ++k) {
        std::getline(lines, line);
    }
    std::vector<std::string> fields;
    std::istringstream parts(line);
    for (std::string field; std::getline(parts, field, ',');) {
        fields.push_back(field);
    }
    return fields;
}

std::size_t lines_of(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

} // namespace

TEST_CASE("pieces: a face that is not convex is one patch, with its area, centre, row and column", "[cli]") {
    const Directory directory;
    const std::string scene =
        directory.write("ell.obj", std::string(ell_corners) + "g floor\nf 1 2 3 4 5 6\n" + ell_walls);
    const std::string hff = directory.path("f.hff");
    const Outcome run = run_hemi(
        on_cpu({"factors", scene, "-o", hff, "--patches", directory.path("p.csv"), "--by-group", "--json"}));
    REQUIRE(run.status == 0);
    const std::vector<std::string> floor = fields_of(directory.read("p.csv"), 1);
    CHECK(std::stod(floor[2]) == Approx(3.0));
    CHECK(std::stod(floor[3]) == Approx(5.0 / 6.0));
    CHECK(std::stod(floor[4]) == Approx(5.0 / 6.0));
    CHECK(std::stod(floor[8]) == Approx(1.0));
    CHECK(lines_of(directory.read("p.csv")) == 9);

    // Rows of eight faces that sum to one and are reciprocal, by the areas of the table.
    REQUIRE(run_hemi({"convert", hff, directory.path("f.csv")}).status == 0);
    const auto factors = triples(directory.read("f.csv"));
    std::array<double, 8> sums{};
    double imbalance = 0.0;
    for (const auto& [at, value] : factors) {
        REQUIRE(at[0] < 8);
        REQUIRE(at[1] < 8);
        sums[static_cast<std::size_t>(at[0])] += value;
        const auto area = [&](int patch) {
            return std::stod(fields_of(directory.read("p.csv"), static_cast<std::size_t>(patch) + 1)[2]);
        };
        imbalance =
            std::max(imbalance, std::abs(area(at[0]) * value - area(at[1]) * factors.at({at[1], at[0]})));
    }
    for (const double sum : sums) {
        CHECK(sum == Approx(1.0).margin(1e-6));
    }
    CHECK(imbalance < 1e-6);
    CHECK(factors.at({0, 1}) > 0.3);
    CHECK_FALSE(factors.contains({0, 0})); // its pieces are in one plane

    // The same floor as three squares that are three faces of one group.
    const std::string squares =
        directory.write("squares.obj", std::string(ell_corners) +
                                           "g floor\nf 1 13 4 14\nf 13 2 3 4\nf 14 4 5 6\n" + ell_walls);
    const Json by_squares = run_hemi(on_cpu({"factors", squares, "--by-group", "--json"})).json();
    CHECK(by_squares["areas"] == run.json()["areas"]);
    for (std::size_t g = 0; g < 3; ++g) {
        CHECK(run.json()["factors"][0][g].get<double>() ==
              Approx(by_squares["factors"][0][g].get<double>()).margin(2e-5));
    }

    const Json info = run_hemi(on_cpu({"info", scene, "--json"})).json();
    CHECK(info["patches"] == 8);
    CHECK(info["surfaces"] == 8);
    CHECK(info["polygons"] == 2);
    CHECK(info["imprint"]["faces"].empty());
    CHECK(info["groups"][0]["surfaces"] == 1);
    CHECK(run_hemi(on_cpu({"info", scene, "--no-imprint", "--json"})).json()["patches"] == 8);
}

TEST_CASE("pieces: light on a face out of plane is the mean over it, as stored and as refined", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("warped.obj", warped);
    directory.write("m.mtl", "newmtl white\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n");
    const std::string result = directory.path("a.hres");
    const Outcome run = run_hemi(
        on_cpu({"solve", scene, "--result", result, "--radiosity", directory.path("a.csv"), "--json"}));
    REQUIRE(run.status == 0);
    CHECK(run.json()["patches"] == 6);
    CHECK(run.json()["parts"] == 7);
    CHECK(lines_of(directory.read("a.csv")) == 7);
    REQUIRE(run_hemi({"convert", result, directory.path("b.csv")}).status == 0);
    CHECK(directory.read("a.csv") == directory.read("b.csv"));
    const Json info = run_hemi({"info", result, "--json"}).json();
    CHECK(info["patches"] == 6);
    CHECK(info["parts"] == 7);
    CHECK(info["surfaces"] == 6);
    const Json refined = run_hemi(on_cpu({"solve", scene, "--refine", "80", "--json"})).json();
    CHECK(refined["patches"] == 6);
    CHECK(refined["parts"] >= 80);

    // Points lie over all of the floor, whatever pieces it has.
    REQUIRE(
        run_hemi(on_cpu({"points", scene, "--grid", "walls", "0.5", "0.1", "-o", directory.path("p.csv")}))
            .status == 0);
    // Subdivided, its pieces are surfaces of their own.
    const Json finer = run_hemi(on_cpu({"info", scene, "--patches-per-face", "4", "--json"})).json();
    CHECK(finer["patches"] == 28);
    CHECK(finer["surfaces"] == 6);
}

TEST_CASE("pieces: two triangles of a quadrilateral are subdivided as it, faces are the file's", "[cli]") {
    const Directory directory;
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    const std::vector<std::array<int, 4>> quads{{1, 2, 3, 4}, {8, 7, 6, 5}, {2, 1, 5, 6},
                                                {3, 2, 6, 7}, {4, 3, 7, 8}, {1, 4, 8, 5}};
    std::string whole = corners;
    std::string halves = corners;
    for (const auto& [p, q, r, s] : quads) {
        whole += fmt::format("f {} {} {} {}\n", p, q, r, s);
        halves += fmt::format("f {} {} {}\nf {} {} {}\n", p, q, r, p, r, s);
    }
    const auto info = [](const std::string& scene) {
        return run_hemi({"info", scene, "--patch-size", "0.4", "--json"}).json();
    };
    const Json of_quads = info(directory.write("quads.obj", whole));
    const Json of_triangles = info(directory.write("triangles.obj", halves));
    CHECK(of_quads["patches"] == 54);
    CHECK(of_triangles["patches"] == 54);
    CHECK(of_triangles["surfaces"] == 12);
    CHECK(of_triangles["triangles"] == 12);
    CHECK(of_triangles["groups"][0]["surfaces"] == 12);
}
