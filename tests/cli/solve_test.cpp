#include "cli/program.hpp"
#include "support/png.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <sys/stat.h>
#include <thread>

using namespace hemi::cli_test;

namespace {

const std::string png_signature = "\x89PNG\r\n\x1a\n";

/// A closed cube in which radiosity is E / (1 - rho) everywhere, in three equal channels.
Json furnace(int n) {
    Json scene = cube(n);
    scene["channels"] = {"a", "b", "c"};
    for (Json& material : scene["materials"]) {
        material = {{"reflectance", 0.5}, {"exitance", 1}};
    }
    return scene;
}

} // namespace

TEST_CASE("solve: the JSON has all that is promised, in the right sizes", "[cli]") {
    const Directory directory;
    const Outcome run = run_hemi(
        quick({"solve", directory.write("cube.json", coloured(3)), "--json", "-o", directory.path("a.png")}));
    REQUIRE(run.status == 0);
    const Json solution = run.json();
    CHECK(solution["schema"] == "hemi/solve/1");
    CHECK(solution["renderer"].get<std::string>().size() > 3);
    CHECK(solution["patches"] == 54);
    CHECK(solution["channels"] == Json({"red", "green", "blue"}));
    CHECK(solution["groups"] == Json({"floor", "left", "right", "front", "back", "ceiling"}));
    REQUIRE(solution["areas"].size() == 6);
    for (const char* key : {"radiosity", "exitance"}) {
        REQUIRE(solution[key].size() == 6);
        CHECK(solution[key][0].size() == 3);
    }
    CHECK(solution["areas"][2].get<double>() == Approx(1.0));
    CHECK(solution["exitance"][5][1] == 1.0);
    CHECK(solution["exitance"][0][1] == 0.0);
    CHECK(solution["radiosity"][0][0] > solution["radiosity"][0][1]);
    CHECK(solution["solver"]["name"] == "gauss-seidel");
    CHECK(solution["solver"]["sweeps"] > 1);
    CHECK(solution["solver"]["residual"] <= 1e-6);
    for (const char* key : {"min", "max", "mean"}) {
        CHECK(solution["row_sum"][key].get<double>() == Approx(1.0).margin(1e-4));
    }
    for (const char* key : {"load", "factors", "repair", "solve", "render", "total"}) {
        CHECK(solution["seconds"][key] >= 0.0);
    }
    CHECK(solution["reciprocity"].is_object()); // the rows of all that reflects or shines
    CHECK(directory.read("a.png").substr(0, 8) == png_signature);
}

TEST_CASE("solve: a furnace is E / (1 - rho) everywhere, and grey scenes are solved once", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("furnace.json", furnace(3));
    const Outcome run = run_hemi(quick({"solve", scene, "--json", "-v"}));
    REQUIRE(run.status == 0);
    CHECK(run.err_has("channels solved: 1 of 3"));
    const Json solution = run.json();
    for (const Json& group : solution["radiosity"]) {
        for (const Json& value : group) {
            CHECK(value.get<double>() == Approx(2.0).epsilon(1e-3));
        }
    }
    REQUIRE(solution["reciprocity"].is_object());
    for (const char* key : {"rms", "max", "relative_rms", "worst", "pairs"}) {
        CHECK(solution["reciprocity"].contains(key));
    }
    const Json jacobi =
        run_hemi(quick({"solve", scene, "--json", "--solver", "jacobi", "--tolerance", "1e-9"})).json();
    CHECK(jacobi["solver"]["name"] == "jacobi");
    CHECK(jacobi["solver"]["residual"] <= 1e-9);
    CHECK(jacobi["radiosity"][3][2].get<double>() == Approx(2.0).epsilon(1e-3));
}

TEST_CASE("solve: rows of patches from which no light comes are computed only where they are asked for",
          "[cli]") {
    const Directory directory;
    Json black = coloured(3);
    black["materials"]["black"] = {{"reflectance", 0}};
    black["surfaces"][1]["material"] = "black";
    const std::string scene = directory.write("cube.json", black);
    const Outcome picture_only = run_hemi(quick({"solve", scene, "-v"}));
    CHECK(picture_only.err_has("rows computed: 45 of 54"));
    CHECK(picture_only.err_has("channels solved: 3 of 3"));
    CHECK(picture_only.err_has("polygons drawn: "));
    const Outcome result = run_hemi(quick({"solve", scene, "-v", "--result", directory.path("a.hres")}));
    CHECK(result.err_has("rows computed: 54 of 54"));
    const Outcome four = run_hemi({"solve", scene, "-v", "--preset", "fast", "--eye-points", "4", "--device",
                                   "osmesa", "--no-estimate"});
    CHECK(four.err_has("rows computed: 45 of 54"));
    CHECK(four.out_has("; 180 in "));

    Json dark = coloured(3);
    dark["materials"]["white"]["reflectance"] = 0;
    const Outcome none = run_hemi(quick({"solve", directory.write("dark.json", dark), "--json"}));
    REQUIRE(none.status == 0);
    CHECK(none.json()["renderer"] == "none");
    CHECK(none.json()["row_sum"]["mean"].is_null());
    CHECK(none.json()["radiosity"][5][0] == 1.0);
}

TEST_CASE("solve: the balance tells where the light goes, and what is lost is warned of", "[cli]") {
    const Directory directory;
    Json room = cube(3);
    room["unit"] = "cm";
    const Outcome closed = run_hemi(quick({"solve", directory.write("room.json", room), "--json"}));
    REQUIRE(closed.status == 0);
    const Json balance = closed.json()["balance"];
    CHECK(balance["emitted"].get<double>() == Approx(1e-4)); // 1 W/m² of a square centimetre
    CHECK(balance["absorbed"].get<double>() == Approx(1e-4).epsilon(1e-3));
    CHECK(balance["environment"] == 0.0);
    CHECK(balance["lost"] == 0.0);
    CHECK_FALSE(closed.err_has("lost"));

    room["surfaces"].push_back(
        {{"name", "baffle"},
         {"material", "white"},
         {"polygon", Json::parse("[[0.2,0.2,0.5],[0.2,0.8,0.5],[0.8,0.8,0.5],[0.8,0.2,0.5]]")}});
    const Outcome baffled = run_hemi(quick({"solve", directory.write("baffle.json", room)}));
    CHECK(baffled.status == 0);
    CHECK(baffled.out_has("balance"));
    CHECK(baffled.err_has("% of the light is lost: it meets backs"));
    CHECK(baffled.err_has("most of what leaves ceiling"));
    // Rows that are reciprocal, as those of this preset, lose nothing on the way.
    const Json lost =
        run_hemi(quick({"solve", directory.path("baffle.json"), "--json", "--preset", "default"}))
            .json()["balance"];
    CHECK(lost["lost"].get<double>() > 1e-5);
    CHECK(lost["absorbed"].get<double>() + lost["lost"].get<double>() == Approx(1e-4).epsilon(1e-5));
}

TEST_CASE("solve: the summary has patches, renderer, row sums, sweeps, residual, seconds and the picture",
          "[cli]") {
    const Directory directory;
    const std::string picture = directory.path("a.png");
    const std::string scene = directory.write("cube.json", coloured(3));
    const Outcome run = run_hemi(quick({"solve", scene, "-o", picture, "-v"}));
    REQUIRE(run.status == 0);
    for (const char* text :
         {"54 patches", "6 surfaces", "6 groups", "renderer", "/s", "a row", "row sums", "dominance",
          "gauss-seidel", "sweeps", "residual", "load", "factors", "repair", "total"}) {
        INFO(text);
        CHECK(run.out_has(text));
    }
    CHECK(run.out_has(picture));
    const Outcome brief = run_hemi(quick({"solve", scene, "-o", picture}));
    for (const char* text : {"group", "irradiance W/m²", "(all)", "values are sums over ", "error ",
                             "balance ", "seconds ", "picture "}) {
        INFO(text);
        CHECK(brief.out_has(text));
    }
    for (const char* text : {"renderer", "row sums", "residual", "dominance"}) {
        INFO(text);
        CHECK_FALSE(brief.out_has(text));
    }
}

TEST_CASE("solve: what has no effect, and faces that are too large to show light, are warned of", "[cli]") {
    const Directory directory;
    Json room = cube(2);
    const std::string scene = directory.write("room.json", room);
    const Outcome closed = run_hemi(quick({"solve", scene, "--environment", "3"}));
    CHECK(closed.status == 0);
    CHECK(closed.err_has("--environment has no effect: the scene is closed"));
    CHECK_FALSE(run_hemi(quick({"solve", scene})).err_has("has no effect"));
    room["patch_size"] = 0.1;
    const Outcome size = run_hemi(quick({"solve", directory.write("size.json", room)}));
    CHECK(size.err_has("size.json: \"patch_size\" has no effect: every surface has \"patches\""));

    for (Json& surface : room["surfaces"]) {
        surface.erase("patches");
    }
    CHECK_FALSE(
        run_hemi(quick({"solve", directory.write("cut.json", room)})).err_has("every face is one patch"));
    room.erase("patch_size");
    const std::string faces = directory.write("faces.json", room);
    const char* const advice = "every face is one patch, on which the light is one value: --patch-size 0.08 "
                               "makes about 1,000 of them";
    CHECK(run_hemi(quick({"solve", faces})).err_has(advice));
    CHECK(run_hemi(quick({"bake", faces, "-o", directory.path("a.ply")})).err_has(advice));
    room["materials"]["lamp"]["exitance"] = 0;
    CHECK_FALSE(
        run_hemi(quick({"solve", directory.write("dark.json", room)})).err_has("every face is one patch"));
}

TEST_CASE("solve: the table of groups has the light of each, as the JSON has", "[cli]") {
    const Directory directory;
    Json room = cube(2); // 1 W/m² of one wall of a cube
    room["unit"] = "cm";
    const std::string scene = directory.write("room.json", room);
    const Json found = run_hemi(quick({"solve", scene, "--json", "--preset", "default", "--result",
                                       directory.path("a.hres")}))
                           .json();
    REQUIRE(found["light"].size() == 6);
    CHECK(found["weights"] == Json({1.0}));
    double in = 0.0;
    double out = 0.0;
    double absorbed = 0.0;
    for (std::size_t g = 0; g < 6; ++g) {
        const Json& light = found["light"][g];
        CHECK(light["group"] == found["groups"][g]);
        CHECK(light["area"].get<double>() == Approx(1e-4));
        CHECK(light["radiosity"].get<double>() == Approx(found["radiosity"][g][0].get<double>()));
        CHECK(light["min"].get<double>() <= light["radiosity"].get<double>());
        CHECK(light["max"].get<double>() >= light["radiosity"].get<double>());
        CHECK(light["in"].get<double>() == Approx(1e-4 * light["irradiance"].get<double>()));
        in += light["in"].get<double>();
        out += light["out"].get<double>();
        absorbed +=
            light["in"].get<double>() + 1e-4 * light["exitance"].get<double>() - light["out"].get<double>();
    }
    CHECK(in == Approx(out).epsilon(1e-6)); // it is closed
    CHECK(absorbed == Approx(found["balance"]["absorbed"].get<double>()).epsilon(1e-6));
    const Outcome table = run_hemi(quick({"solve", scene, "--preset", "default"}));
    CHECK(table.out_has("in W"));
    CHECK_FALSE(table.out_has("sums over")); // one channel

    room["materials"]["lamp"] = {{"reflectance", 0.5}};
    room["groups"] = {{"ceiling", {{"luminous_flux", 3000}}}};
    const Outcome lit = run_hemi(quick({"solve", directory.write("lit.json", room)}));
    CHECK(lit.out_has("irradiance lx"));
    CHECK(lit.out_has("in lm"));

    Json many = cube(1);
    for (int k = 0; k < 50; ++k) {
        Json post = many["surfaces"][0];
        post["name"] = fmt::format("post {}", k);
        const double at = 0.01 * (k + 1);
        post["polygon"] = {
            {at, 0.5, 0.5}, {at + 0.005, 0.5, 0.5}, {at + 0.005, 0.505, 0.5}, {at, 0.505, 0.5}};
        many["surfaces"].push_back(post);
    }
    const Outcome listed = run_hemi(quick({"solve", directory.write("many.json", many), "--no-estimate"}));
    CHECK(listed.out_has("16 groups with less light are not listed; --json has all"));
}

TEST_CASE("solve: factors are stored once and used again with other materials", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(3));
    const std::string file = directory.path("a.hff");
    const Json first = run_hemi(quick({"solve", scene, "--factors", file, "--json"})).json();
    const std::string bytes = directory.read("a.hff");
    REQUIRE_FALSE(bytes.empty());

    const Outcome again = run_hemi({"solve", scene, "--factors", file, "--json", "-v"});
    REQUIRE(again.status == 0);
    CHECK(again.err_has("no rows to compute"));
    CHECK(again.json()["radiosity"] == first["radiosity"]);
    CHECK(again.json()["renderer"] == first["renderer"]);

    Json relit = coloured(3);
    relit["materials"]["lamp"]["exitance"] = 2;
    const Json brighter =
        run_hemi({"solve", directory.write("relit.json", relit), "--factors", file, "--json"}).json();
    CHECK(brighter["radiosity"][0][0].get<double>() == Approx(2.0 * first["radiosity"][0][0].get<double>()));
    CHECK(directory.read("a.hff") == bytes);
}

TEST_CASE("solve: factors of another geometry and conflicting settings are refused", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(3));
    const std::string file = directory.path("a.hff");
    REQUIRE(run_hemi(quick({"solve", scene, "--factors", file})).status == 0);

    const Outcome other = run_hemi({"solve", directory.write("other.json", coloured(2)), "--factors", file});
    CHECK(other.status == 3);
    CHECK(other.err_has("another geometry"));
    CHECK(other.err_has(file));

    const Outcome finer = run_hemi({"solve", scene, "--factors", file, "--resolution", "128"});
    CHECK(finer.status == 2);
    CHECK(finer.err_has("--resolution 128"));
    CHECK(finer.err_has("--resolution 64"));
    CHECK(run_hemi({"solve", scene, "--factors", file, "--seed", "7"}).status == 2);
    CHECK(run_hemi({"solve", scene, "--factors", file, "--seed", "0", "--resolution", "64"}).status == 0);
}

TEST_CASE("solve: a closed scene that leaks is exit 5, after its outputs are written", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("open.json", open_cube(3, "closed"));
    const Outcome run = run_hemi(quick({"solve", scene, "-o", directory.path("a.png"), "--json"}));
    CHECK(run.status == 5);
    CHECK(run.err_has("45 patches lose"));
    CHECK(run.err_has("Worst: patch "));
    CHECK(run.err_has(", at "));
    CHECK(run.err_has(", towards "));
    CHECK(run.json()["schema"] == "hemi/solve/1");
    CHECK(directory.has("a.png"));
    CHECK(run_hemi(quick({"solve", scene, "--enclosure", "open"})).status == 0);
    CHECK(run_hemi(quick({"solve", scene, "--enclosure", "auto"})).status == 0);
    CHECK(run_hemi(quick({"solve", scene, "--max-row-error", "1"})).status == 0);
}

TEST_CASE("solve: a dash writes to stdout and the summary goes to stderr", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(3));
    const Outcome picture = run_hemi(quick({"solve", scene, "-o", "-", "--size", "40x30"}));
    CHECK(picture.status == 0);
    CHECK(picture.out.substr(0, 8) == png_signature);
    CHECK(picture.err_has("balance"));

    const Outcome table = run_hemi(quick({"solve", scene, "--radiosity", "-", "-q"}));
    CHECK(table.out.rfind("index,group,area,cx,cy,cz,nx,ny,nz,exitance_red", 0) == 0);
    CHECK(table.out_has("radiosity_blue,error_red,error_green,error_blue,reflectance_red,"));
    CHECK(std::count(table.out.begin(), table.out.end(), '\n') == 55);
}

TEST_CASE("solve: a named pipe gets its table once", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(3));
    const std::string pipe = directory.path("table.csv");
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    std::string table;
    std::thread reader([&] {
        std::ifstream stream(pipe);
        table.assign(std::istreambuf_iterator<char>(stream), {});
    });
    const Outcome solved = run_hemi(quick({"solve", scene, "--radiosity", pipe, "-q"}));
    reader.join();
    CHECK(solved.status == 0);
    CHECK(std::count(table.begin(), table.end(), '\n') == 55);
    CHECK(table.find("error_blue,") != std::string::npos);
}

TEST_CASE("convert: a csv keeps the number of patches", "[cli]") {
    const Directory directory; // the third square sees nothing and is seen by nothing
    const std::string scene = directory.write(
        "iso.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 0 1 1\nv 1 1 1\nv 1 0 1\nv 0 0 9\nv 1 0 9\n"
        "v 1 1 9\nv 0 1 9\nf 1 2 3 4\nf 5 6 7 8\nf 9 10 11 12\n");
    REQUIRE(run_hemi(quick({"factors", scene, "-o", directory.path("iso.csv")})).status == 0);
    REQUIRE(run_hemi({"convert", directory.path("iso.csv"), directory.path("iso.npz")}).status == 0);
    CHECK(run_hemi({"info", directory.path("iso.npz"), "--json"}).json()["patches"] == 3);
}

TEST_CASE("render: draws a stored solution as solve drew it", "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(3));
    const std::string result = directory.path("a.hres");
    const Words size{"--size", "48x32", "--camera", "0.5,0.1,0.5:0.5,1,0.5:70"};
    const auto with = [&size](Words words) {
        words.insert(words.end(), size.begin(), size.end());
        return words;
    };
    REQUIRE(
        run_hemi(quick(with({"solve", scene, "--result", result, "-o", directory.path("a.png")}))).status ==
        0);
    const Outcome run =
        run_hemi(with({"render", result, "-o", directory.path("b.png"), "--device", "osmesa"}));
    CHECK(run.status == 0);
    CHECK(run.out_has("48 x 32"));
    CHECK(directory.read("a.png") == directory.read("b.png"));

    const Json shown = run_hemi(with({"render", result, "-o", directory.path("c.hdr"), "--device", "osmesa",
                                      "--show", "green", "--flat", "--json"}))
                           .json();
    CHECK(run_hemi({"render", result, "-o", directory.path("d.hdr"), "--exposure", "2"}).status == 2);
    CHECK(shown["schema"] == "hemi/render/1");
    CHECK(directory.read("c.hdr").rfind("#?RADIANCE", 0) == 0);
    CHECK(run_hemi({"render", result, "-o", "-", "--show", "green,blue"}).status == 2);
    // Quantities look the same whether the solution was stored before or not.
    REQUIRE(run_hemi(quick(with({"solve", scene, "-o", directory.path("e.png"), "--show", "irradiance",
                                 "--channel", "red", "--map", "inferno"})))
                .status == 0);
    const Json quantity =
        run_hemi(with({"render", result, "-o", directory.path("f.png"), "--device", "osmesa", "--show",
                       "irradiance", "--channel", "red", "--map", "inferno", "--json"}))
            .json();
    CHECK(quantity["quantity"] == "irradiance");
    CHECK(directory.read("e.png") == directory.read("f.png"));
    CHECK(directory.read("e.png") != directory.read("a.png"));
    for (const Words& wrong :
         {Words{"--range", "0,1"}, Words{"--show", "area", "--exposure", "2"}, Words{"--log"},
          Words{"--show", "area", "--range", "2,1"}, Words{"--show", "radiosity", "--channel", "violet"}}) {
        Words words{"render", result, "--device", "osmesa", "-o", directory.path("g.png")};
        words.insert(words.end(), wrong.begin(), wrong.end());
        CHECK(run_hemi(words).status == 2);
    }
    CHECK_FALSE(directory.has("g.png"));
    CHECK(run_hemi({"render", result, "-o", "-", "--show", "gren"}).err_has("did you mean \"green\""));
    for (const Words& more : {Words{}, Words{"--range", "0,1"}}) {
        Words words{"render", result, "-o", "-", "--show", "irradience"};
        words.insert(words.end(), more.begin(), more.end());
        CHECK(run_hemi(words).err_has("did you mean \"irradiance\""));
    }
    CHECK_FALSE(run_hemi({"bake", result, "-o", "-", "--show", "irradience"}).err_has("did you mean"));
    CHECK(run_hemi({"render", result, "-o", "-", "--show", "irradiance", "--channel", "luminence"})
              .err_has("did you mean \"luminance\""));
    CHECK(run_hemi({"render", scene, "-o", "-"}).status == 2);

    const Json info = run_hemi({"info", result, "--json"}).json();
    CHECK(info["kind"] == "result");
    CHECK(info["patches"] == 54);
    CHECK(info["solver"]["name"] == "gauss-seidel");
    CHECK(run_hemi({"info", result}).out_has("gauss-seidel"));
}

TEST_CASE("solve, render: --up says which axis is upwards in the picture, else the file or its shape does",
          "[cli]") {
    const Directory directory;
    // A room of 3 x 4 x 2 with a lamp in its ceiling, as it is and with its y axis upwards.
    const auto room = [](bool y_up) {
        std::string text;
        for (int k = 0; k < 8; ++k) {
            const int y = k / 2 % 2 * 4;
            const int z = k / 4 * 2;
            text += fmt::format("v {} {} {}\n", k % 2 * 3, y_up ? z : y, y_up ? -y : z);
        }
        return text + "mtllib a.mtl\nusemtl white\nf 1 2 4 3\nf 1 3 7 5\nf 2 6 8 4\nf 1 5 6 2\nf 3 4 8 7\n"
                      "usemtl lamp\nf 5 7 8 6\n";
    };
    (void)directory.write("a.mtl", "newmtl white\nKd 0.5 0.6 0.7\nnewmtl lamp\nKd 0 0 0\nKe 3 3 3\n");
    const std::string upright = directory.write("upright.obj", room(false));
    const std::string turned = directory.write("turned.obj", room(true));
    const auto draws = [&](const std::string& scene, const char* name, const Words& options) {
        Words words = quick({"solve", scene, "-o", directory.path(name), "--size", "32x32", "--flat"});
        words.insert(words.end(), options.begin(), options.end());
        const Outcome run = run_hemi(words);
        INFO(run.err);
        REQUIRE(run.status == 0);
        return hemi::test::read_png(directory.path(name));
    };
    const auto difference = [](const auto& a, const auto& b) {
        double sum = 0.0;
        REQUIRE(a.pixels.size() == b.pixels.size());
        for (std::size_t k = 0; k < a.pixels.size(); ++k) {
            sum += std::abs(static_cast<double>(a.pixels[k]) - static_cast<double>(b.pixels[k]));
        }
        return sum / static_cast<double>(a.pixels.size());
    };
    const auto expected = draws(upright, "a.png", {});
    CHECK(difference(draws(turned, "b.png", {"--result", directory.path("b.hres")}), expected) < 1.0);
    CHECK(difference(draws(turned, "c.png", {"--up", "z"}), expected) > 5.0);
    const auto renders = [&](const Words& options) {
        Words words{"render", directory.path("b.hres"),
                    "-o",     directory.path("d.png"),
                    "--size", "32x32",
                    "--flat", "--device",
                    "osmesa"};
        words.insert(words.end(), options.begin(), options.end());
        return run_hemi(words);
    };
    REQUIRE(renders({}).status == 0);
    CHECK(difference(hemi::test::read_png(directory.path("d.png")), expected) < 1.0);
    REQUIRE(renders({"--up", "z"}).status == 0);
    CHECK(difference(hemi::test::read_png(directory.path("d.png")), expected) > 5.0);
    const Outcome both = renders({"--up", "z", "--camera", "1,1,1:1,2,1:0,1,1"});
    CHECK(both.status == 2);
    CHECK(both.err_has("--camera names an up direction, too"));
    const Outcome along = renders({"--up", "y", "--camera", "1,1,-1:1,0.5,-1"});
    CHECK(along.status == 2);
    CHECK(along.err_has("looks along its up direction"));
}

TEST_CASE("solve: pictures of two channels ask which to show, before the work", "[cli]") {
    const Directory directory;
    Json scene = cube(2);
    scene["channels"] = {"visible", "infrared"};
    const std::string path = directory.write("two.json", scene);
    const Outcome refused = run_hemi(quick({"solve", path, "-o", directory.path("a.png")}));
    CHECK(refused.status == 2);
    CHECK(refused.err_has("visible, infrared"));
    CHECK(run_hemi(quick({"solve", path, "-o", directory.path("a.png"), "--show", "infrared"})).status == 0);
    CHECK(
        run_hemi(quick({"solve", path, "-o", directory.path("a.png"), "--show", "infrared,visible,visible"}))
            .status == 0);
}

TEST_CASE("solve: the environment of the command line lights an OBJ, and darkness is told", "[cli]") {
    const Directory directory;
    const std::string plate = directory.write("plate.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    const Outcome dark = run_hemi(quick({"solve", plate, "--json"}));
    REQUIRE(dark.status == 0);
    CHECK(dark.json()["radiosity"][0][0] == 0.0);
    CHECK_THAT(dark.err, Catch::Contains("nothing radiates"));
    const Outcome lit = run_hemi(quick({"solve", plate, "--json", "--environment", "3"}));
    REQUIRE(lit.status == 0);
    CHECK(lit.json()["radiosity"][0][0].get<double>() == Approx(1.5)); // reflectance 0.5, nothing in the way
    CHECK_THAT(lit.err, !Catch::Contains("nothing radiates"));
    CHECK(run_hemi(quick({"solve", plate, "--environment", "1,2"})).status == 2);
    CHECK(run_hemi(quick({"solve", plate, "--environment", "-1"})).status == 2);
}

TEST_CASE("solve --gather: vertices have light of their own, in pictures, stored solutions and meshes",
          "[cli]") {
    const Directory directory;
    const std::string scene = directory.write("cube.json", coloured(4));
    const auto solve = [&](const std::string& gather, const std::string& name) {
        const Outcome run = run_hemi({"solve", scene, "--device", "osmesa", "--jobs", "1", "--gather", gather,
                                      "--result", directory.path(name + ".hres"), "-o",
                                      directory.path(name + ".hdr"), "--size", "64x64", "--json"});
        REQUIRE(run.status == 0);
        return run.json();
    };
    const Json on = solve("on", "on");
    CHECK(on["seconds"]["gather"] > 0.0);
    CHECK(solve("off", "off")["seconds"]["gather"].get<double>() < 0.01);
    (void)solve("auto", "auto"); // corners differ: as on
    const auto same = [&directory](const std::string& a, const std::string& b) {
        return directory.read(a) == directory.read(b);
    };
    CHECK_FALSE(same("on.hdr", "off.hdr"));
    CHECK(same("on.hdr", "auto.hdr"));
    for (const std::string name : {"on", "off"}) {
        REQUIRE(run_hemi({"render", directory.path(name + ".hres"), "--device", "osmesa", "-o",
                          directory.path("again.hdr"), "--size", "64x64", "-q"})
                    .status == 0);
        CHECK(same("again.hdr", name + ".hdr"));
        REQUIRE(run_hemi({"bake", directory.path(name + ".hres"), "-o", directory.path(name + ".ply"), "-q"})
                    .status == 0);
        REQUIRE(run_hemi({"bake", scene, "--device", "osmesa", "--gather", name, "-o",
                          directory.path("scene-" + name + ".ply"), "-q"})
                    .status == 0);
    }
    for (const std::string from : {"", "scene-"}) {
        CHECK_FALSE(same(from + "on.ply", from + "off.ply"));
    }
    const Outcome wrong = run_hemi({"solve", scene, "--gather", "always", "-o", directory.path("x.png")});
    CHECK(wrong.status == 2);
    CHECK(wrong.err.find("auto, on or off") != std::string::npos);
}

TEST_CASE("solve: a scene that nothing lights is drawn evenly lit, and its numbers stay zero", "[cli][gl]") {
    const Directory directory;
    Json dark = cube(3, "open");
    dark["materials"]["lamp"]["exitance"] = 0;
    const std::string scene = directory.write("dark.json", dark);
    const std::string result = directory.path("dark.hres");
    const Words look{"--size", "64x48", "--camera", "0.5,0.1,0.5:0.5,1,0.5:70"};
    const auto with = [&look](Words words) {
        words.insert(words.end(), look.begin(), look.end());
        return words;
    };
    const Outcome solved = run_hemi(quick(with({"solve", scene, "--result", result, "--radiosity",
                                                directory.path("a.csv"), "-o", directory.path("a.png")})));
    REQUIRE(solved.status == 0);
    CHECK(solved.out_has("evenly lit"));
    const Outcome drawn =
        run_hemi(with({"render", result, "-o", directory.path("b.png"), "--device", "osmesa"}));
    CHECK(drawn.out_has("evenly lit"));
    CHECK(directory.read("a.png") == directory.read("b.png"));
    const hemi::test::SrgbPicture picture = hemi::test::read_png(directory.path("a.png"));
    const auto [low, high] = std::minmax_element(picture.pixels.begin(), picture.pixels.end());
    CHECK(*low + 40 < *high);

    const Outcome raw =
        run_hemi(with({"render", result, "-o", directory.path("a.hdr"), "--device", "osmesa"}));
    CHECK_FALSE(raw.out_has("evenly lit"));
    const std::string hdr = directory.read("a.hdr");
    std::string black;
    for (int row = 0; row < 48; ++row) {
        black += std::string("\x02\x02\x00\x40", 4); // a line of 64 pixels, each of four bytes a run of zeros
        for (int byte = 0; byte < 4; ++byte) {
            black += std::string("\xC0\x00", 2);
        }
    }
    CHECK(hdr.ends_with("+X 64\n" + black));
    REQUIRE(run_hemi({"convert", result, directory.path("b.csv")}).status == 0);
    CHECK(directory.read("a.csv") == directory.read("b.csv"));
    CHECK(directory.read("a.csv").find(",radiosity_grey,error_grey,reflectance_grey,emissivity_grey,"
                                       "environment,blocked,row_sum") != std::string::npos);
    CHECK(directory.read("a.csv").find(",0,0,0,0,0.5,0.5,") != std::string::npos); // no light

    Json furnace = cube(3);
    furnace["materials"]["white"]["exitance"] = 1;
    furnace["materials"]["lamp"] = furnace["materials"]["white"];
    const std::string glow = directory.write("glow.json", furnace);
    const Outcome uniform =
        run_hemi(quick(with({"solve", glow, "-o", directory.path("c.png"), "--repair", "closure"})));
    CHECK(uniform.out_has("the radiosity is the same everywhere: 2 W/m²"));
}

TEST_CASE("render: the background is what is asked for, in light and in false colours", "[cli][gl]") {
    const Directory directory;
    const std::string scene = directory.write("open.json", open_cube(2, "open"));
    const std::string result = directory.path("a.hres");
    REQUIRE(run_hemi(quick({"solve", scene, "--result", result, "--environment", "1"})).status == 0);
    const auto corner = [&](const Words& more) {
        Words words{"render",   result,   "-o",       directory.path("a.png"),  "--size", "64x48",
                    "--device", "osmesa", "--camera", "0.5,-5,0.5:0.5,0,0.5:60"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome run = run_hemi(words);
        INFO(run.err);
        REQUIRE(run.status == 0);
        const hemi::test::SrgbPicture picture = hemi::test::read_png(directory.path("a.png"));
        return std::vector<int>(picture.pixels.begin(), picture.pixels.begin() + 3);
    };
    CHECK(corner({"--background", "#10a0ff"}) == std::vector<int>{0x10, 0xa0, 0xff});
    CHECK(corner({"--background", "white", "--exposure", "0.01"}) == std::vector<int>{255, 255, 255});
    CHECK(corner({"--background", "#10a0ff", "--show", "environment"}) == std::vector<int>{0x10, 0xa0, 0xff});
    CHECK(corner({"--background", "environment"}) == corner({}));
    CHECK(corner({})[0] > 100); // as bright as the environment
    for (const char* wrong : {"#10a0f", "#10a0fg", "10a0ff", "blue", "#10a0ff0", "# 0a0ff"}) {
        CHECK(run_hemi({"render", result, "-o", "-", "--background", wrong}).err_has("#RRGGBB"));
    }
    CHECK(run_hemi({"render", result, "-o", directory.path("a.hdr"), "--background", "white"}).status == 2);
    CHECK(run_hemi({"render", result, "-o", directory.path("b.png"), "--size", "4K", "--samples", "1",
                    "--device", "osmesa"})
              .out_has("3840 x 2160"));
}
