#include "hemi/pipeline/points.hpp"
#include "cli/cluster_settings.hpp"
#include "cli/commands.hpp"
#include "cli/factor_source.hpp"
#include "cli/heat_factors.hpp"
#include "cli/output_paths.hpp"
#include "cli/point_source.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/heat_report.hpp"
#include "cli/report/points_report.hpp"
#include "cli/report/seconds.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/display/value_map.hpp"
#include "hemi/io/image_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/io/vtp_file.hpp"
#include "hemi/pipeline/daylight.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/light_balance.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/scene/light_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace hemi::cli {

namespace {

/// What radiates, and what is known of it.
struct Lit {
    PatchMesh mesh;
    Enclosure enclosure = Enclosure::automatic;
    std::vector<std::string> channels;
    Radiation radiation;
    bool heat = false;
    ExitStatus status = ExitStatus::ok;
    std::vector<double> horizontal{}; ///< irradiance outside, channels, for daylight factors
    std::string unit = "W/m²";        ///< of irradiances
};

/// In as many channels as are lit.
void add_sun_and_sky(const Scene& scene, Lit& lit) {
    lit.radiation.sun = scene.sun;
    lit.radiation.sky = scene.sky;
    lit.radiation.up = scene.up;
    if (lit.radiation.sun) {
        lit.radiation.sun->irradiance.resize(lit.radiation.channels);
    }
    if (lit.radiation.sky) {
        lit.radiation.sky->horizontal.resize(lit.radiation.channels);
        lit.radiation.sky->ground.resize(lit.radiation.channels);
    }
    lit.unit = irradiance_unit(scene);
}

/// The points, once the faces are known.
struct Points {
    std::vector<Receiver> points;
    std::vector<PointGrid::Plane> planes; ///< of a grid
};

bool is_map(const PointsArguments& arguments) {
    return arguments.output && extension_of(*arguments.output) == ".png";
}

Outputs check_outputs(const PointsArguments& arguments) {
    if (arguments.points.has_value() == arguments.grid.has_value()) {
        throw InvalidArgument("points needs points: --points FILE.csv or --grid GROUP SPACING HEIGHT");
    }
    Outputs outputs;
    outputs.keep(arguments.scene.path);
    for (const auto& input : {arguments.points, arguments.heat.table}) {
        if (input) {
            outputs.keep(*input);
        }
    }
    if (arguments.factors) {
        if (extension_of(*arguments.factors) != ".hff") {
            throw InvalidArgument(
                fmt::format("--factors {}: the name must end in .hff", arguments.factors->string()));
        }
        check_factor_input(outputs, {arguments.factors, std::nullopt});
    }
    if (arguments.output) {
        outputs.add("-o", *arguments.output, {".csv", ".vtp", ".png"}, true);
    }
    if (is_map(arguments) && !arguments.grid) {
        throw InvalidArgument(
            fmt::format("-o {}: a map is that of a grid (--grid)", arguments.output->string()));
    }
    for (const auto& [option, given] :
         {std::pair{"--show", !arguments.show.empty()}, std::pair{"--range", arguments.range.has_value()},
          std::pair{"--no-legend", !arguments.legend}}) {
        if (given && !is_map(arguments)) {
            throw InvalidArgument(fmt::format("{} is for maps: -o FILE.png", option));
        }
    }
    const HeatOptions& heat = arguments.heat;
    if (arguments.daylight &&
        (arguments.posture || !heat.temperature.empty() || !heat.heat_flux.empty() || !heat.power.empty() ||
         heat.table || !heat.emissivity.empty() || heat.environment)) {
        throw InvalidArgument("--daylight is about the light of the sky alone, without temperatures");
    }
    outputs.refuse_with_json(arguments.common.json);
    return outputs;
}

/// Whether something is said of heat, on the command line or in the scene.
bool is_thermal(const PointsArguments& arguments) {
    const HeatOptions& heat = arguments.heat;
    if (!heat.temperature.empty() || !heat.heat_flux.empty() || !heat.power.empty() || heat.table) {
        return true;
    }
    bool thermal = false;
    bool photometric = false;
    if (extension_of(arguments.scene.path) == ".json") {
        io::SceneReaderOptions reader = arguments.scene.reader;
        reader.adiabatic = true;
        Diagnostics ignored; // the scene is read again
        const Scene scene = io::read_scene(arguments.scene.path, reader, ignored);
        thermal = scene.thermal && !scene.thermal->conditions.empty();
        photometric = scene.photometric;
    }
    if (arguments.scene.reader.unit && !thermal && !photometric) {
        throw InvalidArgument(
            fmt::format("--unit is for scenes with temperatures or in lumens; irradiances of "
                        "{} do not depend on it",
                        arguments.scene.path.string()));
    }
    if (!thermal && (!heat.emissivity.empty() || heat.environment)) {
        throw InvalidArgument(fmt::format("--emissivity and --environment-temperature are for scenes with "
                                          "temperatures; nothing is said of those of {}",
                                          arguments.scene.path.string()));
    }
    return thermal;
}

Points find_points(const PointsArguments& arguments, const PatchMesh& faces) {
    Points found;
    if (arguments.points) {
        found.points = read_points(*arguments.points);
    } else {
        PointGrid grid = points_of_grid(faces, *arguments.grid);
        found.points = std::move(grid.points);
        found.planes = std::move(grid.planes);
    }
    for (Receiver& point : found.points) {
        if (arguments.spheres) {
            point.normal.reset();
        }
    }
    const bool any_sphere = std::any_of(found.points.begin(), found.points.end(),
                                        [](const Receiver& point) { return !point.normal; });
    if (arguments.posture && !any_sphere) {
        throw InvalidArgument("--person needs points without normals; --spheres leaves those of a grid out");
    }
    return found;
}

Lit light_by_heat(const PointsArguments& arguments, LoadedScene& loaded, Observer& observer,
                  const Terminal& terminal, Seconds& seconds) {
    HeatProblem problem = heat_problem(loaded.scene, loaded.mesh, observer);
    const FormFactors factors =
        find_heat_rows(arguments.common, arguments.rows, {arguments.factors, std::nullopt}, loaded, observer,
                       terminal, seconds);
    report_buried(row_sums(factors.matrix), terminal);
    const Stopwatch watch;
    problem.direct = direct_heat(loaded.scene, loaded.mesh, factors.matrix, problem.bands);
    const HeatSolution solution = solve_heat(factors, problem, {}, observer);
    seconds["solve"] = watch.seconds();
    const EnclosureFinding enclosure = find_leaks(factors, arguments.rows.max_row_error);
    report_leaks(enclosure, factors.matrix, loaded.names(), &loaded.mesh, arguments.rows.max_row_error,
                 terminal);
    Lit lit{std::move(loaded.mesh),
            loaded.scene.enclosure,
            {},
            radiation_of(problem, solution),
            true,
            enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance};
    lit.channels = problem.bands > 1 ? loaded.scene.channels : std::vector<std::string>{"total"};
    add_sun_and_sky(loaded.scene, lit);
    return lit;
}

Lit light(const PointsArguments& arguments, LoadedScene& loaded, Observer& observer, const Terminal& terminal,
          Seconds& seconds) {
    const PatchValues values = patch_values(loaded.scene, loaded.mesh);
    const auto shines = [](double value) { return value > 0.0; };
    const bool dark = !loaded.scene.sun && !loaded.scene.sky &&
                      std::none_of(values.exitance.begin(), values.exitance.end(), shines) &&
                      std::none_of(values.environment.begin(), values.environment.end(), shines);
    Radiation radiation{values.channels, values.exitance, values.environment};
    ExitStatus status = ExitStatus::ok;
    if (dark) {
        terminal.detail("nothing radiates: no radiosity is computed");
    } else if (arguments.factors || !reflecting_patches(loaded.scene, loaded.mesh).empty()) {
        SolveArguments solve;
        solve.common = arguments.common;
        solve.rows = arguments.rows;
        solve.factors = arguments.factors;
        const Stopwatch rows_watch;
        FormFactors factors = find_rows(
            solve, loaded, arguments.factors ? all_patches(loaded.mesh.size()) : shining_patches(values),
            observer, terminal, nullptr);
        seconds["factors"] = rows_watch.seconds();
        const Stopwatch repair_watch;
        prepare_form_factors(factors, arguments.rows.factors.repair, observer);
        seconds["repair"] = repair_watch.seconds();
        report_buried(row_sums(factors.matrix), terminal);
        const Solution solution =
            solve_radiosity(loaded.scene, loaded.mesh, factors, arguments.solver, observer, false);
        seconds["solve"] = solution.seconds;
        radiation = radiation_of(loaded.mesh, values, solution);
        const EnclosureFinding enclosure = find_leaks(factors, arguments.rows.max_row_error);
        report_leaks(enclosure, factors.matrix, loaded.names(), &loaded.mesh, arguments.rows.max_row_error,
                     terminal);
        status = enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
    }
    Lit lit{std::move(loaded.mesh),
            loaded.scene.enclosure,
            loaded.scene.channels,
            std::move(radiation),
            false,
            status};
    add_sun_and_sky(loaded.scene, lit);
    if (arguments.daylight) {
        lit.horizontal = loaded.scene.sky->horizontal;
    }
    return lit;
}

/// Leaves the sky as the only light.
void leave_sky(const PointsArguments& arguments, Scene& scene) {
    const auto positive = [](double value) { return value > 0.0; };
    if (!scene.sky || !std::all_of(scene.sky->horizontal.begin(), scene.sky->horizontal.end(), positive)) {
        throw InputError(fmt::format("{}: --daylight needs a sky: \"environment\" with \"sky\" and a "
                                     "\"horizontal_illuminance\" or \"horizontal_irradiance\" above 0",
                                     arguments.scene.path.string()));
    }
    for (Material& material : scene.materials) {
        std::fill(material.exitance.begin(), material.exitance.end(), 0.0);
    }
    std::fill(scene.environment.begin(), scene.environment.end(), 0.0);
    scene.sun.reset();
}

/// @param find  gets the faces, before the work
Lit light_of_scene(const PointsArguments& given, Observer& observer, const Terminal& terminal,
                   Seconds& seconds, const std::function<void(const PatchMesh&)>& find) {
    const bool heat = !given.daylight && is_thermal(given);
    PointsArguments arguments = given;
    settle_clusters(arguments.common, arguments.rows,
                    heat ? std::nullopt : obstacle_of_solver(arguments.solver));
    if (arguments.posture && !heat) {
        throw InvalidArgument(
            fmt::format("--person needs temperatures, which neither {} nor --temperature has",
                        arguments.scene.path.string()));
    }
    SceneOptions options = arguments.scene;
    options.reader.adiabatic = heat;
    LoadedScene loaded = heat ? load_thermal_scene("points", options, {arguments.factors, std::nullopt},
                                                   arguments.heat, true, terminal)
                              : load_scene(options, terminal);
    if (!heat && arguments.factors) {
        adopt_mesh_of_rows(loaded, options, *arguments.factors);
    }
    if (arguments.daylight) {
        leave_sky(arguments, loaded.scene);
    }
    seconds["load"] = loaded.seconds;
    if (loaded.as_read && arguments.grid) {
        Scene faces = loaded.uncut();
        faces.surfaces = loaded.as_read->surfaces; // each with its own subdivision
        find(PatchMesh(faces));
    } else {
        find(loaded.mesh);
    }
    return heat ? light_by_heat(arguments, loaded, observer, terminal, seconds)
                : light(arguments, loaded, observer, terminal, seconds);
}

Lit light_of_result(const PointsArguments& arguments, Seconds& seconds,
                    const std::function<void(const PatchMesh&)>& find) {
    const std::filesystem::path& path = arguments.scene.path;
    if (extension_of(path) != ".hres") {
        throw InvalidArgument(fmt::format("{}: points needs a scene ({}) or a stored solution (.hres)",
                                          path.string(), io::scene_extensions()));
    }
    refuse_all_but(arguments.common,
                   std::vector<std::string>{"--points", "--grid", "--spheres", "--output", "--by-group",
                                            "--show", "--range", "--no-legend", "--preset", "--resolution",
                                            "--shadow-rays", "--seed", "--no-merge", "--device", "--jobs",
                                            "--person", "--facing", "--absorptance"},
                   path);
    const Stopwatch watch;
    const io::ResultFile result = io::read_hres(path);
    const bool heat = !result.solution.temperature.empty();
    if (arguments.posture && !heat) {
        throw InvalidArgument(fmt::format("--person needs temperatures, which {} does not have: `hemi heat "
                                          "SCENE --result FILE.hres` stores them",
                                          path.string()));
    }
    PatchMesh mesh(result.scene, result.subdivision);
    find(result.surfaces_as_read.empty() ? mesh : PatchMesh(result.scene_as_read()));
    Radiation radiation = heat ? radiation_of(result.scene, result.solution)
                               : radiation_of(mesh, patch_values(result.scene, mesh), result.solution);
    seconds["load"] = watch.seconds();
    Lit lit{std::move(mesh), result.scene.enclosure, result.scene.channels, std::move(radiation), heat,
            ExitStatus::ok};
    if (heat && lit.radiation.channels == 1) {
        lit.channels = {"total"};
    }
    add_sun_and_sky(result.scene, lit);
    return lit;
}

std::vector<io::CellArray> arrays_of(const PointColumns& columns) {
    std::vector<io::CellArray> arrays;
    for (std::size_t c = 0; c < columns.names.size(); ++c) {
        arrays.push_back({columns.names[c], columns.values[c], {}});
    }
    return arrays;
}

void write_vtp(const std::filesystem::path& path, const std::vector<Receiver>& points,
               const PointColumns& columns) {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;
    bool any = false;
    for (const Receiver& point : points) {
        positions.push_back(point.position);
        normals.push_back(point.normal.value_or(Vec3(0.0)));
        any = any || point.normal;
    }
    io::write_points_vtp(path, positions, any ? normals : std::vector<Vec3>(), arrays_of(columns));
}

std::size_t shown_column(const PointsArguments& arguments, const PointColumns& columns) {
    if (arguments.show.empty()) {
        return 0;
    }
    const auto found = std::find(columns.names.begin(), columns.names.end(), arguments.show);
    if (found == columns.names.end()) {
        throw InvalidArgument(fmt::format("--show {}: there is no such column{}", arguments.show,
                                          did_you_mean_or_list(arguments.show, columns.names)));
    }
    return static_cast<std::size_t>(found - columns.names.begin());
}

/// Of a column: that of irradiances, or by its name; shares have none.
std::string unit_of(const std::string& column, const std::string& irradiance) {
    return column.starts_with("irradiance") ? irradiance : unit_of_column(column);
}

/// Writes the map. @return report of it
Report write_map(const PointsArguments& arguments, const Points& points, const PointColumns& columns,
                 const std::string& unit) {
    const std::size_t column = shown_column(arguments, columns);
    const std::vector<double>& values = columns.values[column];
    std::array<double, 2> range{0.0, 1.0};
    if (arguments.range) {
        range = *arguments.range;
    } else {
        bool first = true;
        for (const double value : values) {
            if (std::isfinite(value)) {
                range = first ? std::array{value, value}
                              : std::array{std::min(range[0], value), std::max(range[1], value)};
                first = false;
            }
        }
        range[1] = range[0] < range[1] ? range[1] : range[0] + std::max(1e-6, 1e-6 * std::abs(range[0]));
    }
    std::vector<GridValues> grids;
    auto next = values.begin();
    for (const PointGrid::Plane& plane : points.planes) {
        const auto end = next + static_cast<std::ptrdiff_t>(plane.cell.size());
        grids.push_back({plane.columns, plane.rows, plane.cell, {next, end}});
        next = end;
    }
    const std::string& name = columns.names[column];
    const std::string unit_of_column = unit_of(name, unit);
    const ValueMap map = make_value_map(
        grids, range,
        arguments.legend ? std::optional(unit_of_column.empty() ? name : name + "  [" + unit_of_column + "]")
                         : std::nullopt);
    io::write_png(*arguments.output, map.width, map.height, map.rgb);
    Report report;
    report.add("map",
               fmt::format("{} from {} (dark) to {} (bright){}", name, number_text(range[0]),
                           number_text(range[1]), unit_of_column.empty() ? "" : ", " + unit_of_column),
               {{"map", {{"column", name}, {"range", range}, {"unit", unit_of_column}}}});
    return report;
}

/// Writes what is asked for. @return report of it
Report write(const PointsArguments& arguments, const Points& points, const PointColumns& columns,
             const std::string& unit) {
    if (!arguments.output) {
        return {};
    }
    if (is_map(arguments)) {
        return write_map(arguments, points, columns, unit);
    }
    if (extension_of(*arguments.output) == ".vtp") {
        write_vtp(*arguments.output, points.points, columns);
    } else {
        io::write_table(*arguments.output, point_table(points.points, columns));
    }
    return {};
}

void report_points_inside(const PointValues& values, const Terminal& terminal) {
    const auto inside = std::count_if(values.blocked.begin(), values.blocked.end(),
                                      [](double share) { return share > buried_above; });
    if (inside > 0) {
        terminal.warn(
            fmt::format("{} mostly backs of faces (\"blocked\"), such as points inside of bodies do",
                        plural(static_cast<std::size_t>(inside), "point sees", "points see")));
    }
}

std::string table_text(const io::TextTable& table) {
    Table text(table.columns, 0);
    for (const std::vector<std::string>& row : table.rows) {
        std::vector<std::string> cells;
        for (const std::string& cell : row) {
            cells.push_back(cell.empty() ? "-" : number_text(std::stod(cell)));
        }
        text.add(std::move(cells));
    }
    return text.text();
}

} // namespace

ExitStatus run(const PointsArguments& arguments, const Terminal& terminal) {
    const Outputs outputs = check_outputs(arguments);
    Seconds seconds({"load", "factors", "estimate", "repair", "solve", "points"});
    TerminalObserver observer(terminal);
    Points points;
    const auto find = [&](const PatchMesh& faces) { points = find_points(arguments, faces); };
    const Lit lit = io::is_scene_file(arguments.scene.path)
                        ? light_of_scene(arguments, observer, terminal, seconds, find)
                        : light_of_result(arguments, seconds, find);
    const Stopwatch watch;
    const PointValues values = compute_point_values(
        lit.mesh, points.points, lit.radiation, lit.enclosure, arguments.rows.factors,
        arguments.posture ? std::optional(arguments.facing.value_or(0.0)) : std::nullopt, observer);
    seconds["points"] = watch.seconds();
    const PointsAsked asked{lit.channels,
                            arguments.by_group ? lit.mesh.groups() : std::vector<std::string>(),
                            lit.heat,
                            arguments.posture,
                            arguments.facing.has_value(),
                            arguments.body,
                            lit.horizontal};
    const PointColumns columns = point_columns(points.points, values, asked);
    Report report;
    report.add("points", count_text(points.points.size()));
    report.add("irradiance", "in " + lit.unit, {{"unit", lit.unit}});
    report.add(write(arguments, points, columns, lit.unit));
    report.add(seconds.report());
    Json json{{"schema", "hemi/points/1"}};
    json.update(points_json(points.points, values, asked));
    json.update(report.json);
    report.json = std::move(json);
    Report table;
    if (!arguments.output) {
        table.text = table_text(point_table(points.points, columns));
    }
    show_with_tables(outputs, std::move(report), table, arguments.common.json, terminal);
    report_points_inside(values, terminal);
    return lit.status;
}

} // namespace hemi::cli
