#include "cli/arguments/arguments.hpp"

#include "cli/arguments/completion.hpp"
#include "cli/arguments/options.hpp"
#include "cli/arguments/picture_arguments.hpp"
#include "cli/arguments/points_arguments.hpp"
#include "cli/arguments/row_arguments.hpp"
#include "cli/arguments/scene_arguments.hpp"
#include "cli/arguments/usage_errors.hpp"
#include "cli/arguments/version.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/scene_reader.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <type_traits>

namespace hemi::cli {

namespace {

using Words = std::vector<std::string>;

constexpr const char* help_help = "print this help";
constexpr const char* version_help = "print version, revision, compiler and OpenGL";
void add_positional(CLI::App& app, const std::string& name, std::filesystem::path& target,
                    const std::string& help) {
    app.add_option_function<std::string>(
           name, [&target](const std::string& text) { target = text; }, help)
        ->required()
        ->option_text(" ")
        ->type_name(file_type);
}

void add_common(CLI::App& app, CommonOptions& common, bool json = true) {
    app.set_version_flag("--version", version_text(), version_help)->group("General");
    Options options(app, "General");
    if (json) {
        options.flag("--json", common.json, "one JSON object on stdout instead of text");
    }
    options.flag("-q,--quiet", common.quiet, "errors only: no progress, warnings or summary");
    options.flag("-v,--verbose", common.verbose, "say more");
    options.choice<ColourChoice>("--color", "WHEN", "auto, always or never (NO_COLOR is honoured)",
                                 common.colour);
}

/// @param stored  extensions of stored files that do as well
void add_scene(CLI::App& app, SceneOptions& scene, const std::string& name = "SCENE",
               const std::string& stored = "") {
    app.add_option_function<std::vector<std::string>>(
           name,
           [&scene](const std::vector<std::string>& paths) {
               scene.path = paths.front();
               scene.also.assign(paths.begin() + 1, paths.end());
           },
           stored.empty() ? fmt::format("scene, one mesh or several: {}", io::scene_extensions())
                          : fmt::format("scene, one mesh or several ({}), or stored file ({})",
                                        io::scene_extensions(), stored))
        ->required()
        ->option_text(" ")
        ->type_name(file_type);
    add_scene_options(app, scene);
}

void add_max_row_error(Options& options, RowOptions& rows) {
    options.value(
        "--max-row-error", "T", "largest share of a row that may leak or meet back faces (1e-4)",
        [&rows](const std::string& text) { rows.max_row_error = parse_positive("--max-row-error", text); });
}

void add_enclosure(CLI::App& app, SceneOptions& scene, RowOptions& rows, bool checks = true) {
    Options options(app, "Scene");
    options.choice<Enclosure>("--enclosure", "KIND", "auto, closed or open; overrides the scene",
                              scene.enclosure);
    if (!checks) {
        return;
    }
    add_max_row_error(options, rows);
}

void add_repair(CLI::App& app, std::optional<Repair>& repair) {
    Options(app, "Form factors")
        .choice<Repair>(
            "--repair", "KIND",
            "constraints enforced on F: none, reciprocity, or closure (reciprocity and row sums; the "
            "default unless rows are plain)",
            repair);
}

/// Estimates of errors, and settings chosen by them. After add_rows.
void add_estimate(CLI::App& app, RowOptions& rows) {
    Options options(app, "Form factors");
    options.flag("--no-estimate", rows.factors.estimate_error,
                 "skip the error estimates, which take a tenth of the time of new form factors", false);
    const bool settings = rows.error_of == ErrorOf::factors;
    auto* target = options.value(
        "--error-target", "T",
        fmt::format("{} the estimated error is at most T, such as 1%",
                    settings ? "choose the cheapest settings by which" : "cut patches until"),
        [&rows](const std::string& text) { rows.error_target = parse_share("--error-target", text); });
    for (const char* name : {"--method", "--rays", "--no-estimate"}) {
        target->excludes(app.get_option(name));
    }
}

/// Patches that are cut until the solution is good enough. After add_estimate.
/// @param of_factors  whether the target may be for form factors, too
void add_refinement(CLI::App& app, RowOptions& rows, RefinementOptions& a, bool of_factors) {
    Options options(app, "Refinement");
    options
        .choice<ErrorOf>(
            "--error-target-of", "ERROR",
            fmt::format("error of vertices (in pictures; the default), of the field (one value a "
                        "patch){}",
                        of_factors ? ", of groups' means; or of factors: patches stay, settings "
                                     "are chosen"
                                   : " or of groups' means"),
            rows.error_of)
        ->needs(app.get_option("--error-target"));
    auto* refine =
        options.value("--refine", "N", "cut patches where it tells, until there are N",
                      [&a](const std::string& text) { a.patches = parse_index("--refine", text, 1); });
    options.value("--budget", "TIME", "cut no more patches after this time, such as 30s or 5m",
                  [&a](const std::string& text) { a.budget = parse_duration("--budget", text); });
    refine->excludes(app.get_option("--method"))->excludes(app.get_option("--no-estimate"));
}

/// @param output  the file of form factors beside which rows are kept
void add_resume(CLI::App& app, RowOptions& rows, CLI::Option* output) {
    Options(app, "Output")
        .flag("--resume", rows.resume,
              fmt::format("with {}: resume from the rows that an interrupted run left in FILE.rows",
                          output->get_name()));
    auto* resume = app.get_option("--resume")->needs(output);
    if (auto* target = app.get_option_no_throw("--error-target");
        target != nullptr && rows.error_of == ErrorOf::factors) {
        resume->excludes(target);
    }
}

void add_max_memory(CLI::App& app, RowOptions& rows) {
    Options options(app, "Computing");
    options.value(
        "--max-memory", "SIZE", "refuse to need more than that, such as 512M or 2G (80 % of what is free)",
        [&rows](const std::string& text) { rows.factors.max_memory = parse_memory("--max-memory", text); });
    options.path("--scratch", "DIR", rows.scratch,
                 "keep the rows of form factors in a file in this folder, not in memory");
}

/// Far sources taken together. After add_rows and add_estimate.
void add_clusters(CLI::App& app, RowOptions& rows) {
    rows.factors.clusters = Clusters::automatic;
    Options options(app, "Form factors");
    options
        .choice<Clusters>("--clusters", "WHEN",
                          "far patches are seen in clusters, which takes less memory: auto (where the pairs "
                          "of all patches do not fit), on or off",
                          rows.factors.clusters)
        ->excludes(app.get_option("--method"));
    options.value("--cluster-error", "T",
                  "about what clusters may change the gathered light by, relative (0.1%)",
                  [&rows](const std::string& text) {
                      rows.factors.cluster_error = parse_share("--cluster-error", text);
                  });
}

void add_environment(CLI::App& app, SceneOptions& scene) {
    Options options(app, "Scene");
    options.value("--environment", "E[,E...]",
                  "exitance of the environment, one for all channels or one for each; overrides the scene",
                  [&scene](const std::string& text) {
                      scene.environment.clear();
                      for (const std::string& value : parse_list(text)) {
                          scene.environment.push_back(parse_number("--environment", value));
                      }
                  });
    options.path(
        "--exitance-from", "FILE.csv", scene.exitance_from,
        "exitance of single faces: columns index (of a face, from 0) and exitance, or exitance_CHANNEL; "
        "overrides the scene");
}

void add_solver(CLI::App& app, SolverSettings& solver) {
    Options options(app, "Solver");
    options.choice<SolverMethod>("--solver", "NAME",
                                 "auto, gauss-seidel, jacobi or cg (auto: cg for high reflectance and "
                                 "reciprocal rows)",
                                 solver.method);
    options.value("--tolerance", "T", "relative residual to reach (1e-6)",
                  [&solver](const std::string& text) {
                      solver.tolerance = parse_positive("--tolerance", text);
                      if (solver.tolerance >= 1.0) {
                          throw InvalidArgument(fmt::format("--tolerance {}: must be below 1", text));
                      }
                  });
}

void add_solve(CLI::App& app, SolveArguments& a) {
    a.rows.error_of = ErrorOf::vertices;
    add_scene(app, a.scene);
    add_unit(app, a.scene);
    add_enclosure(app, a.scene, a.rows);
    add_rows(app, a.rows);
    add_repair(app, a.rows.factors.repair);
    add_estimate(app, a.rows);
    add_clusters(app, a.rows);
    add_refinement(app, a.rows, a.refinement, true);
    Options(app, "Refinement")
        .flag("--parts", a.parts,
              "tables, .hres and .csv of cut patches, also where the scene's own patches are whole faces");
    add_max_memory(app, a.rows);
    add_environment(app, a.scene);
    add_solver(app, a.solver);
    Options output(app, "Output");
    auto* picture = output.path("-o,--output", "PICTURE", a.picture.output,
                                "picture: .png or .hdr; - for .png on stdout");
    auto* factors = output.path("--factors", "FILE.hff", a.factors,
                                "use these form factors if the file exists, else write them there; patches "
                                "that are cut go on from it, and it gets their rows");
    add_resume(app, a.rows, factors);
    output.path("--result", "FILE.hres", a.result, "the whole solution, for `hemi render` and `hemi view`");
    output.path("--radiosity", "FILE.csv", a.radiosity,
                "exitance, irradiance, radiosity and its error of every patch");
    output.path("--patches", "FILE.csv", a.patches, "area, centre, normal, environment share of every patch");
    add_picture(app, a.picture, picture, true, &a.scene);
    add_gather(app, a.gather);
    add_common(app, a.common);
    app.footer("Examples:\n"
               "  hemi solve scenes/cornell-box.json -o cornell-box.png\n"
               "  hemi solve room.obj --patch-size 0.1 --factors room.hff --result room.hres");
}

void add_factors(CLI::App& app, FactorsArguments& a) {
    a.scene.reader.adiabatic = true;
    add_scene(app, a.scene, "SCENE|FILE", ".hff");
    add_enclosure(app, a.scene, a.rows);
    add_rows(app, a.rows);
    add_repair(app, a.rows.factors.repair);
    add_estimate(app, a.rows);
    add_clusters(app, a.rows);
    add_max_memory(app, a.rows);
    Options output(app, "Output");
    auto* file = output.path(
        "-o,--output", "FILE", a.output,
        "form factors: .hff .mtx .csv .npz .npy .h5, View3D's .txt .vf, Elmer's .dat .bin, EnergyPlus' .idf, "
        "ParaView's .vtp; - for .csv on stdout");
    add_resume(app, a.rows, file);
    output.path("--patches", "FILE.csv", a.patches, "area, centre, normal, environment share of every patch");
    auto* row = output.value("--row", "I", "print one row, largest first, with names",
                             [&a](const std::string& text) { a.row = parse_index("--row", text, 0); });
    output.flag("--by-group", a.by_group, "sum over named groups: a table, or with -o FILE.csv the file");
    row->excludes(file);
    row->excludes(app.get_option("--by-group"));
    row->excludes(app.get_option("--error-target"));
    auto* rows =
        output.value("--rows", "A:B|K/N",
                     "rows A to B - 1 (from 0), or the K-th of N shares, into a part for `hemi merge`",
                     [&a](const std::string& text) { a.selection = parse_rows(text); });
    rows->needs(file);
    for (const char* const other : {"--row", "--by-group", "--error-target", "--repair", "--max-row-error"}) {
        rows->excludes(app.get_option(other));
    }
    auto* point = output.value(
        "--from-point", "X,Y,Z,NX,NY,NZ",
        "another name of `hemi points` for one point with a normal, by patch: factors from a surface element "
        "there to every patch, analytic, largest first",
        [&a](const std::string& text) {
            const std::vector<std::string> numbers = parse_list(text);
            if (numbers.size() != 6) {
                throw InvalidArgument(fmt::format("--from-point {}: {} numbers; it must be 6, such as "
                                                  "0,0,0,0,0,1",
                                                  text, numbers.size()));
            }
            std::array<double, 6>& at = a.from_point.emplace();
            for (std::size_t k = 0; k < 6; ++k) {
                at[k] = parse_number("--from-point", numbers[k]);
            }
        });
    point->excludes(file);
    point->excludes(row);
    point->excludes(app.get_option("--by-group"));
    add_common(app, a.common);
    app.footer("Examples:\n"
               "  hemi factors scenes/cube.json --by-group\n"
               "  hemi factors room.obj -o room.npz --patches room.csv");
}

void add_check(CLI::App& app, CheckArguments& a) {
    a.scene.reader.adiabatic = true;
    add_scene(app, a.scene, "SCENE|FILE", ".hff");
    add_enclosure(app, a.scene, a.rows);
    add_rows(app, a.rows);
    add_repair(app, a.rows.factors.repair);
    add_max_memory(app, a.rows);
    add_common(app, a.common);
    app.footer(
        "Checks row balance, bounds, reciprocity, leaks, buried and never visible patches, reversed "
        "normals.\n"
        "Exit 5 if, beyond --max-row-error, a row of a closed scene leaks, a patch that is not buried meets\n"
        "back faces, or a row does not balance. With `auto`, a scene in which fewer than 5 % of the patches\n"
        "leak, or which loses less than 0.1 % in all, counts as nearly closed: that is a warning;\n"
        "--enclosure closed makes it an error. Buried and never-visible patches are reported but are not\n"
        "errors.\n\n"
        "Examples:\n"
        "  hemi check scenes/l-room.json --enclosure closed\n"
        "  hemi check room.hff --max-row-error 1e-3 --json");
}

void add_trade(CLI::App& app, TradeArguments& a) {
    add_scene(app, a.scene);
    add_enclosure(app, a.scene, a.rows, false);
    add_drawing(app, a.rows);
    add_max_memory(app, a.rows);
    add_environment(app, a.scene);
    add_up(app, a.scene, "axis that points upwards in the sky (z, or what the scene says)");
    Options(app, "Output")
        .path("-o,--output", "PLOT.svg", a.output, "errors against seconds as a drawing; - for stdout");
    Options(app, "Computing")
        .value("--budget", "TIME", "about how long it may take in all, such as 30s or 5m (60s)",
               [&a](const std::string& text) { a.budget = parse_duration("--budget", text); });
    add_common(app, a.common);
    app.footer(
        "Solves the scene on patches of several sizes, uniform and refined, and compares the light with "
        "that\n"
        "of a finer mesh; compares form factors by methods, presets, sample points and resolutions with the\n"
        "best rows that the budget affords. The last measurement may exceed the budget.\n\n"
        "Examples:\n"
        "  hemi trade scenes/cube.json -o cube.svg\n"
        "  hemi trade room.obj --patch-size 0.1 --budget 5m --json");
}

/// What `heat` and `exchange` have in common.
void add_rows_of_heat(CLI::App& app, SceneOptions& scene, RowOptions& rows, FactorInput& input) {
    scene.reader.adiabatic = true;
    add_scene(app, scene);
    add_enclosure(app, scene, rows);
    add_rows(app, rows);
    add_repair(app, rows.factors.repair);
    Options(app, "Form factors")
        .flag("--no-estimate", rows.factors.estimate_error,
              "skip the error estimates, which take a tenth of the time of new form factors", false);
    add_clusters(app, rows);
    auto* factors = add_factor_input(app, input);
    add_resume(app, rows, factors);
    add_max_memory(app, rows);
}

void add_heat(CLI::App& app, HeatArguments& a) {
    add_rows_of_heat(app, a.scene, a.rows, a.input);
    add_heat_options(app, a.heat, true);
    add_unit(app, a.scene);
    add_heat_output(app, a);
    add_common(app, a.common);
    app.footer("Examples:\n"
               "  hemi heat scenes/furnace-hot.json\n"
               "  hemi heat room.obj --temperature walls=20C --temperature floor=26C --emissivity walls=0.9");
}

void add_exchange(CLI::App& app, ExchangeArguments& a) {
    add_rows_of_heat(app, a.scene, a.rows, a.input);
    add_heat_options(app, a.heat, false);
    add_unit(app, a.scene);
    add_exchange_output(app, a);
    add_common(app, a.common);
    app.footer("Examples:\n"
               "  hemi exchange scenes/furnace.json\n"
               "  hemi exchange scenes/furnace-hot.json --emissivity load=0.7\n"
               "  hemi exchange room.obj --emissivity walls=0.9 --min 1e-3 -o room.csv");
}

/// A scene that is solved on the way, or its stored solution.
template <class A>
void add_solved_scene(CLI::App& app, A& a) {
    add_scene(app, a.scene, "SCENE|RESULT", ".hres");
    add_enclosure(app, a.scene, a.rows);
    add_rows(app, a.rows);
    add_repair(app, a.rows.factors.repair);
    add_clusters(app, a.rows);
    add_max_memory(app, a.rows);
    add_environment(app, a.scene);
    add_up(app, a.scene, "axis that points upwards in the sky (z, or what the scene says)");
    add_solver(app, a.solver);
}

void add_points(CLI::App& app, PointsArguments& a) {
    add_solved_scene(app, a);
    add_heat_options(app, a.heat, true);
    add_unit(app, a.scene);
    add_point_options(app, a);
    add_common(app, a.common);
}

void add_render(CLI::App& app, RenderArguments& a) {
    add_positional(app, "RESULT", a.input, "stored solution: .hres");
    Options output(app, "Output");
    output.path("-o,--output", "PICTURE", a.picture.output,
                "picture: .png or .hdr (RESULT's name with .png, here); - for .png on stdout");
    add_picture(app, a.picture, nullptr, true, nullptr);
    add_dots(app, a.dots);
    add_device(app, a.device, false);
    add_common(app, a.common);
    app.footer("Examples:\n"
               "  hemi render room.hres -o room.png --size 1600x900 --exposure 0.8\n"
               "  hemi render room.hres -o flat.png --flat --camera 0,-3,1:0,0,1\n"
               "  hemi render room.hres -o light.png --show irradiance --range 0,500\n"
               "  hemi render room.hres -o desks.png --points desks.csv --column irradiance");
}

void add_diff(CLI::App& app, DiffArguments& a) {
    add_positional(app, "FIRST", a.first, "stored solution: .hres");
    add_positional(app, "SECOND", a.second, "another: differences are SECOND less FIRST");
    Options output(app, "Output");
    auto* picture = output.path("-o,--output", "PICTURE", a.picture.output,
                                "differences in false colours, zero in the middle: .png; - on stdout");
    output.path("--csv", "FILE.csv", a.csv, "both values and the difference of every patch; - for stdout");
    add_difference_picture(app, a.picture, picture);
    add_device(app, a.device, false);
    add_common(app, a.common);
    app.footer("Examples:\n"
               "  hemi diff day.hres evening.hres\n"
               "  hemi diff coarse.hres fine.hres --show irradiance -o difference.png --range=-50,50");
}

#ifdef HEMI_WITH_VIEWER
void add_view(CLI::App& app, ViewArguments& a) {
    add_scene(app, a.scene, "SCENE|RESULT", "one .hres, or two to compare");
    add_unit(app, a.scene);
    a.rows.error_of = ErrorOf::vertices;
    add_rows(app, a.rows);
    add_repair(app, a.rows.factors.repair);
    add_estimate(app, a.rows);
    add_clusters(app, a.rows);
    add_refinement(app, a.rows, a.refinement, false);
    add_max_memory(app, a.rows);
    add_environment(app, a.scene);
    add_solver(app, a.solver);
    a.picture.size = {1280, 720};
    add_picture(app, a.picture, nullptr, false, &a.scene);
    add_dots(app, a.dots);
    add_gather(app, a.gather);
    auto* factors = Options(app, "Form factors")
                        .path("--factors", "FILE.hff", a.factors, "use these form factors, with no new row");
    for (const char* name : {"--error-target", "--refine"}) {
        factors->excludes(app.get_option(name));
    }
    Options window(app, "Window");
    window.choice<viewer::Controls>("--controls", "NAME",
                                    "standard (the default) or blender: what the mouse does", a.controls);
    window
        .value("--script", "FILE",
               "drags, keys, screenshots and more from a file, for demonstrations and tests",
               [&a](const std::string& text) { a.script = text; })
        ->type_name(file_type);
    add_common(app, a.common, false);
    app.footer("Examples:\n"
               "  hemi view scenes/cornell-box.json\n"
               "  hemi view scenes/l-room.json --error-target 1%\n"
               "  hemi view room.hres --flat\n"
               "  hemi view day.hres evening.hres");
}

#endif

void add_bake(CLI::App& app, BakeArguments& a) {
    add_solved_scene(app, a);
    Options(app, "Output")
        .path("-o,--output", "OUT", a.picture.output,
              "mesh with vertex colours: .glb or .ply; - for .glb on stdout")
        ->required();
    (void)add_shown(app, a.picture);
    Options(app, "Output")
        .value("--lightmap", "SIZE",
               "of a .glb: the light as a texture of SIZE x SIZE texels instead of vertex colours",
               [&a](const std::string& text) {
                   const std::uint32_t size = parse_index("--lightmap", text, 16, 16384);
                   a.picture.size = {size, size};
               })
        ->excludes(app.get_option("--flat"));
    add_gather(app, a.gather);
    add_common(app, a.common);
    app.footer(
        "Colours are exposure times radiosity, at most 1: linear in a .glb (COLOR_0), sRGB in a .ply. The\n"
        "radiosity itself is _RADIOSITY, or radiosity_red and so on. Axes are those of the scene.\n\n"
        "Examples:\n"
        "  hemi bake scenes/cornell-box.json -o cornell-box.glb\n"
        "  hemi bake room.hres -o room.glb --exposure 0.5 --flat\n"
        "  hemi bake room.hres -o room.glb --lightmap 1024");
}

void add_merge(CLI::App& app, MergeArguments& a) {
    app.add_option_function<Words>(
           "PART", [&a](const Words& parts) { a.parts.assign(parts.begin(), parts.end()); },
           "all parts of a scene, by `hemi factors --rows`, in any order")
        ->required()
        ->option_text(" ")
        ->type_name(file_type);
    Options factors(app, "Form factors");
    add_max_row_error(factors, a.rows);
    add_repair(app, a.rows.factors.repair);
    add_max_memory(app, a.rows);
    Options(app, "Output")
        .path("-o,--output", "FILE.hff", a.output, "form factors, as one run would have written them")
        ->required();
    add_common(app, a.common);
    app.footer("Examples:\n"
               "  hemi factors room.obj --rows 1/2 -o part1.hff\n"
               "  hemi factors room.obj --rows 2/2 -o part2.hff\n"
               "  hemi merge part1.hff part2.hff -o room.hff");
}

void add_convert(CLI::App& app, ConvertArguments& a) {
    add_positional(
        app, "IN", a.input,
        "form factors: .hff .mtx .csv .npz, View3D's .txt .vf, Elmer's .dat .bin; a solution: .hres");
    add_positional(
        app, "OUT", a.output,
        "form factors: .mtx .csv .npz .npy .h5 .dat .bin; from .hff also .hff .txt .vf and EnergyPlus' "
        ".idf; - for .csv on stdout; of a solution: .vtp, or .csv with the radiosity of every patch");
    add_repair(app, a.repair);
    Options(app, "EnergyPlus")
        .value("--zone", "NAME", "for .idf: the zone that the surfaces close in; default: the name of OUT",
               [&a](const std::string& text) { a.zone = text; });
    Options paraview(app, "ParaView");
    auto* factors =
        paraview.path("--factors", "FILE.hff", a.factors, "for .vtp: form factors with the rows of --row");
    auto* row = app.add_option_function<Words>(
                       "--row",
                       [&a](const Words& all) {
                           for (const std::string& text : all) {
                               a.rows.push_back(parse_index("--row", text, 0));
                               if (std::count(a.rows.begin(), a.rows.end(), a.rows.back()) > 1) {
                                   throw InvalidArgument(fmt::format("--row {}: is given twice", text));
                               }
                           }
                       },
                       "for .vtp: show F(I, j) at every patch j; repeatable")
                    ->allow_extra_args(false)
                    ->option_text("I")
                    ->group("ParaView");
    row->needs(factors);
    factors->needs(row);
    add_common(app, a.common);
    app.footer("Examples:\n"
               "  hemi convert room.hff room.npz\n"
               "  hemi convert room.hres room.vtp --factors room.hff --row 12 --row 40");
}

void add_info(CLI::App& app, InfoArguments& a) {
    a.scene.reader.adiabatic = true;
    add_scene(app, a.scene, "SCENE|FILE", ".hff, .hres, .mtx, .csv, .npz, .txt, .vf, .dat, .bin");
    add_rows(app, a.rows);
    add_clusters(app, a.rows);
    add_max_memory(app, a.rows);
    add_common(app, a.common);
    app.footer("Examples:\n"
               "  hemi info scenes/office.json --preset exact\n"
               "  hemi info room.hff --json");
}

void add_devices(CLI::App& app, DevicesArguments& a) {
    add_common(app, a.common);
    app.footer("Examples:\n"
               "  hemi devices\n"
               "  hemi devices --json");
}

/// Help without the double blank lines between groups, and with a blank between names of an option.
std::string help_text(const CLI::App& app, const std::string& previous = "") {
    std::string text = app.help(previous);
    for (std::size_t gap = text.find("\n\n\n"); gap != std::string::npos; gap = text.find("\n\n\n")) {
        text.erase(gap, 1);
    }
    for (std::size_t comma = text.find(",--"); comma != std::string::npos; comma = text.find(",--")) {
        text.insert(comma + 1, " ");
        if (const std::size_t gap = text.find("  ", comma + 2); gap < text.find('\n', comma)) {
            text.erase(gap, 1);
        }
    }
    return text;
}

/// The command that was named, with what it was given.
template <class A>
void add_command(CLI::App& app, const std::string& name, const std::string& help, void (*add)(CLI::App&, A&),
                 std::optional<Arguments>& chosen) {
    CLI::App* command = app.add_subcommand(name, help)->group("Commands");
    command->set_help_flag("-h,--help", help_help)->group("General");
    const auto values = std::make_shared<A>();
    add(*command, *values);
    command->final_callback([command, values, &chosen] {
        for (const CLI::Option* option : command->get_options()) {
            if (option->count() > 0 && !option->get_lnames().empty()) {
                const std::string& spelling =
                    values->common.given.emplace_back("--" + option->get_lnames().front());
                const bool flag = option->get_expected_max() == 0;
                values->common.words.emplace_back(spelling,
                                                  flag ? std::vector<std::string>() : option->results());
            }
        }
        if constexpr (requires { values->scene.also; }) {
            check_files(values->scene, std::is_same_v<A, ViewArguments>);
        }
        if constexpr (requires { values->rows.factors.method; }) {
            check_method(values->rows, values->common.given);
        }
        chosen = *values;
    });
}

} // namespace

std::variant<Arguments, Answer> parse_arguments(int argc, const char* const* argv) {
    CLI::App app("hemi: form factors by OpenGL hemicubes, radiosity, pictures", "hemi");
    app.set_help_flag("-h,--help", help_help);
    app.set_version_flag("--version", version_text(), version_help);
    app.get_formatter()->label("SUBCOMMAND", "COMMAND");
    app.get_formatter()->label("Positionals", "Arguments");
    app.footer("Every command has its own --help. Exit status: 0 ok, 1 failure, 2 usage, 3 bad input,\n"
               "4 no usable OpenGL device, 5 a check is out of tolerance, 130 interrupted.\n\n"
               "Examples:\n"
               "  hemi solve scenes/cornell-box.json -o cornell-box.png\n"
               "  hemi factors scenes/cube.json --by-group");
    app.require_subcommand(1);
    std::optional<Arguments> chosen;
    add_command(app, "solve", "Form factors, radiosity and a picture of a scene", add_solve, chosen);
    add_command(app, "factors", "Form factors only", add_factors, chosen);
    add_command(app, "check", "Which rows are wrong, and why", add_check, chosen);
    add_command(app, "trade", "Speed against accuracy, measured on a scene", add_trade, chosen);
    add_command(app, "heat", "Net heat fluxes and temperatures", add_heat, chosen);
    add_command(app, "exchange", "Grey exchange between groups: Gebhart factors, script-F, conductances",
                add_exchange, chosen);
    add_command(app, "points", "Irradiance, view of the sky and radiant temperature at points", add_points,
                chosen);
    add_command(app, "render", "Picture of a stored solution", add_render, chosen);
    add_command(app, "diff", "Two stored solutions compared, by group and as a picture", add_diff, chosen);
#ifdef HEMI_WITH_VIEWER
    add_command(app, "view", "Window with an orbiting camera", add_view, chosen);
#endif
    add_command(app, "bake", "Mesh with the solution as vertex colours", add_bake, chosen);
    add_command(app, "merge", "Form factors from parts that were computed separately", add_merge, chosen);
    add_command(app, "convert", "Form factors from one file format to another", add_convert, chosen);
    add_command(app, "info", "What a file holds and what it would cost", add_info, chosen);
    add_command(app, "devices", "OpenGL devices that can be used", add_devices, chosen);

    if (argc > 1 && std::string_view(argv[1]) == "help") {
        const std::vector<const char*> asked = argc > 2 ? std::vector<const char*>{argv[0], argv[2], "--help"}
                                                        : std::vector<const char*>{argv[0], "--help"};
        return parse_arguments(static_cast<int>(asked.size()), asked.data());
    }
    if (argc > 1 && std::string_view(argv[1]) == "completion") {
        if (argc != 3 || std::string_view(argv[2]) != "bash") {
            throw InvalidArgument("`hemi completion bash` prints a script for bash; no other shell has one");
        }
        return Answer{bash_completion(app)};
    }
    if (argc > 1 && argv[1][0] != '-') {
        const auto named =
            app.get_subcommands([&](const CLI::App* command) { return command->get_name() == argv[1]; });
        if (named.empty()) {
            refuse_command(app, argv[1]);
        }
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        const auto commands = app.get_subcommands();
        return Answer{commands.empty() ? help_text(app) : help_text(*commands.front(), "hemi")};
    } catch (const CLI::CallForVersion& version) {
        return Answer{version.what()};
    } catch (const CLI::ParseError& error) {
        const auto commands = app.get_subcommands();
        if (commands.empty()) {
            const Words rest = app.remaining();
            if (rest.empty()) {
                refuse_no_command(app);
            }
            throw InvalidArgument(
                fmt::format("unexpected '{}' before the command (see `hemi --help`)", rest.front()));
        }
        const Words rest = app.remaining(true);
        if (!rest.empty()) {
            const auto option = std::find_if(rest.begin(), rest.end(),
                                             [](const std::string& w) { return w.starts_with("-"); });
            refuse_word(app, *commands.front(), option != rest.end() ? *option : rest.front());
        }
        throw InvalidArgument(
            fmt::format("{} (see `hemi {} --help`)", error.what(), commands.front()->get_name()));
    }
    return *chosen;
}

} // namespace hemi::cli
