#include "cli/heat_scenes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

using namespace hemi::cli_test;

TEST_CASE("hemi exchange: conductances are reciprocal and balance", "[cli][heat]") {
    const Directory directory;
    Json scene = box(1, 2, 3, 2);
    scene.erase("groups");
    scene["materials"]["top"] = {{"reflectance", 1}};
    const Outcome run = run_hemi(on_cpu({"exchange", directory.write("box.json", scene), "--json",
                                         "--emissivity", "left=0.05", "-o", directory.path("box.csv")}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json exchange = run.json();
    CHECK(exchange["schema"] == "hemi/exchange/1");
    CHECK(exchange["emissivity"][2].get<double>() == Approx(0.05));
    for (std::size_t g = 0; g < 6; ++g) {
        double sum = exchange["environment"][g].get<double>();
        for (std::size_t h = 0; h < 6; ++h) {
            sum += exchange["script_f"][g][h].get<double>();
            CHECK(exchange["conductance"][g][h] == exchange["conductance"][h][g]);
        }
        CHECK(sum == Approx(exchange["emissivity"][g].get<double>()).epsilon(1e-9).margin(1e-12));
    }
    CHECK(exchange["gebhart"][1][0].is_null()); // emits nothing
    CHECK(exchange["gebhart"][0][2].get<double>() > 0.0);
    const std::string table = directory.read("box.csv");
    CHECK(table.starts_with("from,to,gebhart,script_f,conductance\nbottom,bottom,"));
    CHECK(std::count(table.begin(), table.end(), '\n') == 1 + 6 * 7);
    CHECK(run_hemi({"exchange", directory.path("box.json"), "--temperature", "top=300"}).status == 2);
    CHECK(run_hemi({"exchange", directory.path("box.csv")}).err_has("exchange needs a scene"));
    const Outcome large = run_hemi(
        {"exchange", directory.write("large.json", box(100, 200, 600)), "--device", "cpu", "--json"});
    CHECK(large.err_has("no unit"));
    CHECK_FALSE(large.err_has("temperature"));
    CHECK(large.json()["seconds"]["estimate"] == 0.0);
}

TEST_CASE("hemi exchange: rooms that are apart exchange nothing at all", "[cli][heat]") {
    const Directory directory;
    Json scene = box(1, 2, 3, 2);
    const std::size_t faces = scene["surfaces"].size();
    for (std::size_t k = 0; k < faces; ++k) {
        Json face = scene["surfaces"][k];
        face["name"] = "other_" + face["name"].get<std::string>();
        for (Json& point : face["polygon"]) {
            point[0] = point[0].get<double>() + 5.0;
        }
        scene["surfaces"].push_back(face);
    }
    scene.erase("groups");
    const Json exchange =
        run_hemi(on_cpu({"exchange", directory.write("rooms.json", scene), "--json"})).json();
    for (std::size_t g = 0; g < faces; ++g) {
        for (std::size_t h = faces; h < 2 * faces; ++h) {
            REQUIRE(exchange["conductance"][g][h] == 0.0);
        }
        REQUIRE(exchange["conductance"][g][g] >= 0.0);
    }
}

TEST_CASE("hemi exchange --min: small conductances go to the others", "[cli][heat]") {
    const Directory directory;
    Json scene = box(1, 2, 3, 2);
    scene.erase("groups");
    const std::string file = directory.write("box.json", scene);
    const std::string table = directory.path("box.csv");
    const Json whole = run_hemi(on_cpu({"exchange", file, "--json"})).json();
    CHECK(whole["cutoff"].is_null());
    const Outcome run = run_hemi(on_cpu({"exchange", file, "--json", "--min", "0.2", "-o", table}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json cut = run.json();
    std::uint64_t dropped = 0;
    double change = 0.0;
    for (std::size_t g = 0; g < 6; ++g) {
        double sum = cut["environment"][g].get<double>();
        for (std::size_t h = 0; h < 6; ++h) {
            const double was = whole["conductance"][g][h].get<double>();
            const double is = cut["conductance"][g][h].get<double>();
            sum += cut["script_f"][g][h].get<double>();
            CHECK(is == cut["conductance"][h][g].get<double>());
            CHECK((g == h || is == 0.0 || is >= 0.2));
            dropped += g < h && is == 0.0 ? 1 : 0;
            change = g != h && is > 0.0 ? std::max(change, std::abs(is / was - 1.0)) : change;
        }
        CHECK(sum == Approx(cut["emissivity"][g].get<double>()).epsilon(1e-9));
    }
    CHECK(dropped > 0);
    CHECK(dropped < 15);
    CHECK(cut["cutoff"]["min"] == 0.2);
    CHECK(cut["cutoff"]["dropped"] == dropped);
    CHECK(cut["cutoff"]["kept"] == 15 - dropped);
    CHECK(cut["cutoff"]["largest_change"].get<double>() == Approx(change).epsilon(1e-9));
    const std::string lines =
        directory.read("box.csv"); // a line of names, groups with themselves, pairs both ways
    CHECK(std::count(lines.begin(), lines.end(), '\n') ==
          1 + 6 + 2 * (15 - static_cast<std::int64_t>(dropped)));
    const Outcome told = run_hemi(on_cpu({"exchange", file, "--min", "0.2"}));
    CHECK(told.out_has(std::to_string(dropped) + " of 15 conductances below 0.2 m²"));
    const Outcome apart = run_hemi(on_cpu({"exchange", file, "--min", "100"}));
    CHECK(apart.status == 0);
    CHECK(apart.err_has("nothing is left between bottom, top, left, right, front, back"));
    CHECK(run_hemi({"exchange", file, "--min", "0"}).status == 2);
    CHECK(run_hemi({"exchange", file, "--min", "small"}).status == 2);
}

TEST_CASE("hemi exchange -o: a NumPy archive, View3D's table with reflection", "[cli][heat]") {
    const Directory directory;
    // Infinite plates but for what leaves at the rim: 2000 wide and 1 apart.
    Json scene = {{"hemi", 1},
                  {"materials", {{"hot", {{"emissivity", 0.8}}}, {"cold", {{"emissivity", 0.3}}}}},
                  {"surfaces",
                   {face("oben ü", "hot", {{0, 0, 1}, {0, 2000, 1}, {2000, 2000, 1}, {2000, 0, 1}}, 1),
                    face("unten", "cold", {{0, 0, 0}, {2000, 0, 0}, {2000, 2000, 0}, {0, 2000, 0}}, 1)}},
                  {"unit", "m"}};
    const std::string file = directory.write("plates.json", scene);
    const std::string npz = directory.path("plates.npz");
    const Outcome run = run_hemi(on_cpu({"exchange", file, "--json", "--preset", "exact", "-o", npz}));
    INFO(run.err);
    REQUIRE(run.status == 0);
    const Json exchange = run.json();
    CHECK(exchange["script_f"][0][1].get<double>() ==
          Approx(1.0 / (1.0 / 0.8 + 1.0 / 0.3 - 1.0)).epsilon(2e-3));
    const std::string archive = directory.read("plates.npz");
    CHECK(archive.starts_with("PK"));
    for (const char* name : {"groups.npy", "areas.npy", "emissivity.npy", "gebhart.npy", "script_f.npy",
                             "conductance.npy", "environment.npy"}) {
        CHECK(archive.find(name) != std::string::npos);
    }
    CHECK(archive.find("'descr': '<U6', 'fortran_order': False, 'shape': (2,)") != std::string::npos);
    CHECK(archive.find("'descr': '<f8', 'fortran_order': False, 'shape': (2, 2)") != std::string::npos);
    const double area = exchange["areas"][0].get<double>();
    CHECK(archive.find(std::string(reinterpret_cast<const char*>(&area), sizeof(area))) != std::string::npos);
    // Program, version, text, open or closed, reflection, N; areas, script-F, emissivities.
    REQUIRE(run_hemi(on_cpu({"exchange", file, "--preset", "exact", "-o", directory.path("plates.txt")}))
                .status == 0);
    std::istringstream table(directory.read("plates.txt"));
    std::string program;
    std::string version;
    std::array<int, 4> head{};
    table >> program >> version >> head[0] >> head[1] >> head[2] >> head[3];
    CHECK(head == std::array<int, 4>{0, 0, 1, 2});
    std::vector<double> numbers;
    for (double number = 0.0; table >> number;) {
        numbers.push_back(number);
    }
    REQUIRE(numbers.size() == 8);
    CHECK(numbers[0] == area);
    for (std::size_t k = 0; k < 4; ++k) {
        CHECK(numbers[2 + k] == exchange["script_f"][k / 2][k % 2].get<double>());
    }
    CHECK(numbers[6] == Approx(0.8).epsilon(1e-12));
    CHECK(numbers[7] == Approx(0.3).epsilon(1e-12));
    CHECK(run_hemi({"factors", directory.path("plates.txt")}).status != 0);
    CHECK(run_hemi({"heat", file, "--factors", directory.path("plates.txt")}).err_has("include reflection"));
    CHECK(run_hemi({"exchange", file, "-o", directory.path("plates.mtx")}).status == 2);
}
