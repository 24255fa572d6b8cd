#include "cli/program.hpp"

#include <catch2/catch.hpp>

using namespace hemi::cli_test;

namespace {

Json bright_cube(int n, double reflectance) {
    Json scene = cube(n);
    scene["materials"]["white"]["reflectance"] = reflectance;
    scene["materials"]["lamp"]["reflectance"] = reflectance;
    return scene;
}

} // namespace

TEST_CASE("repair: plain rows are left alone unless it is asked for", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", bright_cube(4, 0.5));
    const Json plain = run_hemi(quick({"solve", scene, "--json"})).json();
    CHECK(plain["repair"]["name"] == "none");
    CHECK(plain["repair"]["before"] == plain["repair"]["after"]);
    CHECK(plain["repair"]["before"]["reciprocity"]["relative_rms"] > 1e-3);
    CHECK(plain["reciprocity"] == plain["repair"]["after"]["reciprocity"]);

    const Json closed = run_hemi(quick({"solve", scene, "--json", "--repair", "closure"})).json();
    CHECK(closed["repair"]["name"] == "closure");
    CHECK(closed["repair"]["before"] == plain["repair"]["before"]);
    CHECK(closed["repair"]["after"]["row_error"]["max"] < 1e-7);
    CHECK(closed["repair"]["after"]["reciprocity"]["relative_max"] < 1.3e-7);
    CHECK(closed["repair"]["iterations"] > 0);
    CHECK(closed["repair"]["seconds"] == closed["seconds"]["repair"]);
    CHECK(closed["seconds"]["repair"] > 0.0);
    CHECK(closed["reciprocity"]["relative_max"] < 1.3e-7);
    CHECK(closed["radiosity"][0][0].get<double>() ==
          Approx(plain["radiosity"][0][0].get<double>()).epsilon(0.02));

    const Outcome text = run_hemi(quick({"solve", scene, "--repair", "reciprocity", "-v"}));
    CHECK(text.out_has("repair        reciprocity"));
    CHECK(text.out_has("reciprocity error"));
}

TEST_CASE("repair: a .hff keeps the rows as computed, other files hold the repaired ones", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", bright_cube(3, 0.5));
    const auto path = [&](const char* name) { return directory.path(name); };
    REQUIRE(run_hemi(quick({"factors", scene, "-o", path("raw.hff")})).status == 0);
    const Outcome stored =
        run_hemi(quick({"factors", scene, "-o", path("closed.hff"), "--repair", "closure"}));
    CHECK(stored.out_has("closed.hff (rows before repair)"));
    CHECK(directory.read("raw.hff") == directory.read("closed.hff"));
    REQUIRE(run_hemi(quick({"solve", scene, "--factors", path("solve.hff"), "--repair", "closure"})).status ==
            0);
    CHECK(directory.read("raw.hff") == directory.read("solve.hff"));

    REQUIRE(run_hemi(quick({"factors", scene, "-o", path("raw.csv")})).status == 0);
    const Outcome exchanged =
        run_hemi(quick({"factors", scene, "-o", path("closed.csv"), "--repair", "closure"}));
    CHECK(exchanged.out_has("closed.csv (rows after repair)"));
    CHECK(directory.read("raw.csv") != directory.read("closed.csv"));
    const Outcome converted =
        run_hemi({"convert", path("raw.hff"), path("converted.csv"), "--repair", "closure"});
    CHECK(converted.err_has("after repair"));
    CHECK(directory.read("converted.csv") == directory.read("closed.csv"));
    REQUIRE(run_hemi({"convert", path("raw.hff"), path("again.csv")}).status == 0);
    CHECK(directory.read("again.csv") == directory.read("raw.csv"));

    const Json groups =
        run_hemi({"factors", path("raw.hff"), "--by-group", "--json", "--repair", "closure"}).json();
    CHECK(groups["repair"]["name"] == "closure");
    CHECK(groups["factors"][0][5].get<double>() ==
          Approx(groups["factors"][5][0].get<double>()).epsilon(1e-7));
    CHECK(groups["seconds"]["repair"] >= 0.0);
    const Json row =
        run_hemi({"factors", path("raw.hff"), "--row", "7", "--json", "--repair", "closure"}).json();
    CHECK(row["sum"].get<double>() == Approx(1.0).epsilon(1e-7));
    CHECK(run_hemi(quick({"factors", scene, "--row", "7", "--repair", "closure"})).status == 2);
}

TEST_CASE("repair: check tells the errors before and after", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", bright_cube(3, 0.5));
    const Json report = run_hemi(quick({"check", scene, "--json", "--repair", "closure"})).json();
    CHECK(report["ok"] == true);
    CHECK(report["repair"]["before"]["reciprocity"]["max"] > 1e-4);
    CHECK(report["repair"]["after"]["reciprocity"]["max"] < 1e-7);
    CHECK(report["reciprocity"]["max"] < 1e-7);
    CHECK(run_hemi(quick({"check", scene, "--repair", "closure"})).out_has("before"));
    // Reciprocal, but no longer in balance.
    CHECK(run_hemi(quick({"check", scene, "--repair", "reciprocity"})).status == 5);

    REQUIRE(run_hemi(quick({"factors", scene, "-o", directory.path("a.hff")})).status == 0);
    CHECK(run_hemi({"check", directory.path("a.hff"), "--repair", "closure", "--json"})
              .json()["repair"]["after"] == report["repair"]["after"]);
}

TEST_CASE("solve: chooses the solver, says why, and is right in a furnace of reflectance 1 - 1e-6", "[cli]") {
    const Directory directory;
    Json scene = bright_cube(4, 0.999999);
    scene["materials"]["white"]["exitance"] = 1;
    const std::string path = directory.write("furnace.json", scene);
    const Words closed{"solve", path, "--json", "--repair", "closure", "--tolerance", "1e-8"};
    const Json solution = run_hemi(quick(closed)).json();
    CHECK(solution["solver"]["name"] == "cg");
    CHECK(solution["solver"]["why"].get<std::string>().find("reciprocal") != std::string::npos);
    CHECK(solution["solver"]["residual"] <= 1e-8);
    for (const Json& group : solution["radiosity"]) {
        CHECK(group[0].get<double>() == Approx(1e6).epsilon(1e-6));
    }

    const std::string bright = directory.write("bright.json", bright_cube(3, 0.95));
    CHECK(run_hemi(quick({"solve", bright, "--json"})).json()["solver"]["name"] == "gauss-seidel");
    CHECK(run_hemi(quick({"solve", bright, "-v"})).out_has("not reciprocal"));
    const Outcome refused = run_hemi(quick({"solve", bright, "--solver", "cg"}));
    CHECK(refused.status == 2);
    CHECK(refused.err_has("--repair"));
    const Json cg =
        run_hemi(quick({"solve", bright, "--json", "--solver", "cg", "--repair", "closure"})).json();
    const Json sweeps =
        run_hemi(quick({"solve", bright, "--json", "--solver", "gauss-seidel", "--repair", "closure"}))
            .json();
    CHECK(cg["solver"]["name"] == "cg");
    CHECK(sweeps["solver"]["name"] == "gauss-seidel");
    CHECK(cg["radiosity"][0][0].get<double>() ==
          Approx(sweeps["radiosity"][0][0].get<double>()).epsilon(1e-4));
}

TEST_CASE("repair: rows that were not needed stay out of it", "[cli]") {
    const Directory directory;
    Json scene = cube(3); // nothing leaves the black floor: its rows are not computed
    scene["materials"]["black"] = {{"reflectance", 0.0}};
    scene["surfaces"][0]["material"] = "black";
    const Json solution = run_hemi(quick({"solve", directory.write("cube.json", scene), "--json", "--repair",
                                          "closure", "--solver", "cg"}))
                              .json();
    CHECK(solution["reciprocity"].is_null());
    CHECK(solution["repair"]["after"]["row_error"]["max"] < 1e-7);
    CHECK(solution["solver"]["name"] == "cg");
    const Json plain = run_hemi(quick({"solve", directory.path("cube.json"), "--json"})).json();
    CHECK(solution["radiosity"][1][0].get<double>() ==
          Approx(plain["radiosity"][1][0].get<double>()).epsilon(0.02));
}
