#include "cli/program.hpp"
#include "support/png.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <sstream>

using namespace hemi::cli_test;

namespace {

/// Solves cube(n) with a lamp of that exitance.
std::string solved(const Directory& directory, const std::string& name, int n, double exitance) {
    Json scene = cube(n);
    scene["materials"]["lamp"]["exitance"] = exitance;
    const std::string result = directory.path(name + ".hres");
    REQUIRE(run_hemi(quick({"solve", directory.write(name + ".json", scene), "--result", result})).status ==
            0);
    return result;
}

} // namespace

TEST_CASE("diff: twice the lamp is twice the light, by group, patch and in a picture", "[cli][gl]") {
    const Directory directory;
    const std::string one = solved(directory, "one", 3, 1.0);
    const std::string two = solved(directory, "two", 3, 2.0);
    const std::string picture = directory.path("d.png");
    const std::string csv = directory.path("d.csv");
    const Outcome run =
        run_hemi({"diff", one, two, "-o", picture, "--csv", csv, "--size", "240x200", "--device", "osmesa"});
    INFO(run.err);
    REQUIRE(run.status == 0);
    CHECK(run.out_has("54 patches, the same in both"));
    CHECK(run.out_has("+100"));
    const hemi::test::SrgbPicture drawn = hemi::test::read_png(picture);
    const std::size_t middle = (std::size_t{100} * 240 + 120) * 3; // brighter: red
    CHECK(drawn.pixels[middle] > drawn.pixels[middle + 2] + 20);

    std::istringstream lines(directory.read("d.csv"));
    std::string line;
    std::getline(lines, line);
    CHECK(line == "index,group,area,cx,cy,cz,nx,ny,nz,first,second,difference");
    std::getline(lines, line);
    std::vector<double> numbers;
    for (std::size_t at = line.find(',', 2) + 1; at != 0; at = line.find(',', at) + 1) {
        numbers.push_back(std::stod(line.substr(at)));
    }
    REQUIRE(numbers.size() == 10);
    CHECK(numbers[8] == Approx(2.0 * numbers[7]).epsilon(1e-5));
    CHECK(numbers[9] == Approx(numbers[7]).epsilon(1e-5));

    const Json json = run_hemi({"diff", one, two, "--json"}).json();
    CHECK(json["schema"] == "hemi/diff/1");
    CHECK(json["pairing"] == "same-patches");
    CHECK(json["groups"].size() == 6);
    for (std::size_t g = 0; g < 6; ++g) {
        CHECK(json["means"]["second"][g].get<double>() ==
              Approx(2.0 * json["means"]["first"][g].get<double>()).epsilon(1e-5));
        CHECK(json["rms"][g].get<double>() >= json["difference"][g].get<double>() * (1.0 - 1e-12));
    }
    CHECK(run_hemi({"diff", one, one, "--json"}).json()["all"]["rms"] == 0.0);
    const Json reflectance = run_hemi({"diff", one, two, "--show", "reflectance", "--json"}).json();
    CHECK(reflectance["quantity"] == "reflectance");
    CHECK(reflectance["all"]["largest"] == 0.0);
}

TEST_CASE("diff: other patches of the scene are paired by place, and wrong input is refused", "[cli]") {
    const Directory directory;
    const std::string coarse = solved(directory, "coarse", 2, 1.0);
    const std::string fine = solved(directory, "fine", 4, 1.0);
    const Outcome run = run_hemi({"diff", fine, coarse});
    CHECK(run.status == 0);
    CHECK(run.out_has("96 patches, not the same in both"));
    const Json json = run_hemi({"diff", fine, coarse, "--json"}).json();
    CHECK(json["pairing"] == "nearest");
    CHECK(json["off"] == 0);
    // Means of groups hardly depend on the patches, and the lamp's radiosity is its exitance.
    CHECK(std::abs(json["difference"][0].get<double>()) < 0.05 * json["means"]["first"][0].get<double>());
    CHECK(json["largest"][5] == 0.0);

    CHECK(run_hemi({"diff", fine}).status == 2);
    CHECK(run_hemi({"diff", fine, directory.path("fine.json")}).err_has(".hres"));
    CHECK(run_hemi({"diff", fine, directory.path("none.hres")}).status == 3);
    CHECK(run_hemi({"diff", fine, coarse, "--show", "radiocity"}).err_has("did you mean radiosity?"));
    CHECK(run_hemi({"diff", fine, coarse, "--show", "direct"}).err_has("the first solution"));
    CHECK(run_hemi({"diff", fine, coarse, "--range", "0,1"}).status == 2);
    CHECK(run_hemi({"diff", fine, coarse, "-o", fine}).status == 2);
    CHECK(run_hemi({"diff", fine, coarse, "--channel", "gray"}).err_has("did you mean \"grey\""));
}
