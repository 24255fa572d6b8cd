#include "cli/cluster_settings.hpp"
#include "cli/commands.hpp"
#include "cli/heat_factors.hpp"
#include "cli/output_paths.hpp"
#include "cli/picture_output.hpp"
#include "cli/report/balance_report.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/heat_report.hpp"
#include "cli/report/scene_report.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/black_body.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/io/table_file.hpp"
#include "hemi/io/vtp_file.hpp"
#include "hemi/pipeline/daylight.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace hemi::cli {

namespace {

/// Says of which file an error is.
template <class Work>
auto of_file(const std::filesystem::path& path, const Work& work) {
    const auto text = [&](const Error& error) { return fmt::format("{}: {}", path.string(), error.what()); };
    try {
        return work();
    } catch (const InputError& error) {
        throw InputError(text(error), error.settings());
    } catch (const NotConverged& error) {
        throw NotConverged(text(error), error.settings());
    }
}

io::TextTable read_series(const std::filesystem::path& path) {
    io::TextTable table = io::read_table(path);
    if (table.columns.size() < 2 || table.rows.empty()) {
        throw InputError(fmt::format("{}: {} of {}; a series has a column of times, then one for every group "
                                     "that changes, and a line for each time",
                                     path.string(), plural(table.rows.size(), "line", "lines"),
                                     plural(table.columns.size(), "column", "columns")));
    }
    return table;
}

/// The first column is that of the times.
void check_times(const std::filesystem::path& path, const io::TextTable& table, const Scene& scene) {
    const std::string& first = table.columns.front();
    if (std::find(scene.groups.begin(), scene.groups.end(), first) != scene.groups.end()) {
        throw InputError(fmt::format("{}: the first column is called {}, which is a group; a series begins "
                                     "with a column of times",
                                     path.string(), first));
    }
}

/// What the scene says nothing of has the temperatures of the first line.
void give_temperatures(Scene& scene, const std::filesystem::path& path, const io::TextTable& table) {
    for (std::size_t c = 1; c < table.columns.size(); ++c) {
        const auto found = std::find(scene.groups.begin(), scene.groups.end(), table.columns[c]);
        auto& environment = scene.thermal->environment_temperature;
        if (found == scene.groups.end()) {
            if (table.columns[c] == "environment" && !environment) {
                environment = parse_cell(path, table, 0, c, true);
            }
            continue;
        }
        const auto group = static_cast<std::uint32_t>(found - scene.groups.begin());
        const auto is_known = [group](const Surface& surface) {
            return surface.group == group && surface.heat != no_heat;
        };
        if (std::any_of(scene.surfaces.begin(), scene.surfaces.end(), is_known)) {
            continue;
        }
        const auto index = static_cast<std::uint32_t>(scene.thermal->conditions.size());
        scene.thermal->conditions.emplace_back().temperature = parse_cell(path, table, 0, c, true);
        for (Surface& surface : scene.surfaces) {
            surface.heat = surface.group == group ? index : surface.heat;
        }
    }
}

/// The table as a schedule, whose names and values can be used.
HeatSchedule schedule_of(const std::filesystem::path& path, const io::TextTable& table,
                         const LoadedScene& loaded, const HeatProblem& problem, Observer& observer) {
    HeatSchedule schedule;
    schedule.columns.assign(table.columns.begin() + 1, table.columns.end());
    schedule.places = table.lines;
    const auto check = [&](Observer& told) {
        return check_heat_schedule(loaded.mesh.groups(), loaded.group_of, problem, schedule, told);
    };
    const std::vector<HeatQuantity> quantities = of_file(path, [&] { return check(no_observer()); });
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        schedule.labels.push_back(table.rows[row][0]);
        for (std::size_t c = 1; c < table.columns.size(); ++c) {
            schedule.values.push_back(
                parse_cell(path, table, row, c, quantities[c - 1] == HeatQuantity::temperature));
        }
    }
    (void)check(observer);
    return schedule;
}

bool is_picture(const std::filesystem::path& path) {
    return extension_of(path) == ".png";
}

bool is_table(const std::filesystem::path& path) {
    return extension_of(path) == ".csv";
}

/// What came of the lines of a series: a time, then a column for every group.
void write_series(const std::filesystem::path& path, const HeatSchedule& schedule,
                  const std::vector<std::string>& groups, const HeatSeries& series) {
    io::TextTable table;
    table.columns = {"time"};
    const std::array quantities{std::pair("temperature", &series.temperature),
                                std::pair("net_flux", &series.net_flux),
                                std::pair("net_power", &series.net_power)};
    for (const auto& [quantity, values] : quantities) {
        for (const std::string& group : groups) {
            table.columns.push_back(fmt::format("{}_{}", quantity, group));
        }
    }
    table.columns.emplace_back("environment_power");
    for (std::size_t l = 0; l < schedule.labels.size(); ++l) {
        std::vector<std::string>& row = table.rows.emplace_back(1, schedule.labels[l]);
        for (const auto& [quantity, values] : quantities) {
            for (std::size_t g = 0; g < groups.size(); ++g) {
                const double value = (*values)[l * groups.size() + g];
                row.push_back(std::isnan(value) ? std::string() : fmt::format("{}", value));
            }
        }
        row.push_back(fmt::format("{}", series.environment_power[l]));
    }
    io::write_table(path, table);
}

/// What files beside a series hold: not its lines.
void tell_of_own_state(const HeatArguments& arguments, const Terminal& terminal) {
    std::vector<std::string> options;
    if (arguments.output && !is_table(*arguments.output)) {
        options.emplace_back("-o");
    }
    if (arguments.fluxes) {
        options.emplace_back("--fluxes");
    }
    if (arguments.result) {
        options.emplace_back("--result");
    }
    if (!options.empty()) {
        terminal.warn(fmt::format("{}: what the scene itself says, not a line of the series; -o FILE.csv has "
                                  "its lines",
                                  fmt::join(options, ", ")));
    }
}

Outputs check_outputs(const HeatArguments& arguments) {
    Outputs outputs;
    outputs.keep(arguments.scene.path);
    check_factor_input(outputs, arguments.input);
    if (arguments.heat.table) {
        outputs.keep(*arguments.heat.table);
    }
    if (arguments.series) {
        outputs.keep(*arguments.series);
    }
    if (arguments.output) {
        if (is_table(*arguments.output) && !arguments.series) {
            throw InvalidArgument(fmt::format("-o {}: a .csv is for the lines of a --series; --fluxes writes "
                                              "one of the patches",
                                              arguments.output->string()));
        }
        outputs.add("-o", *arguments.output, {".vtp", ".png", ".csv"});
        if (!is_picture(*arguments.output)) {
            for (const std::string& option : arguments.picture.options) {
                const auto& given = arguments.common.given;
                if (std::find(given.begin(), given.end(), option) != given.end()) {
                    throw InvalidArgument(fmt::format("{} is for a picture, and -o is {}; a .png is one",
                                                      option, arguments.output->string()));
                }
            }
        } else if (arguments.picture.picture.celsius &&
                   arguments.picture.picture.quantity != Quantity::temperature) {
            throw InvalidArgument(fmt::format("--celsius is for temperatures, and --show is {}",
                                              to_word(*arguments.picture.picture.quantity)));
        }
    }
    if (arguments.result) {
        outputs.add("--result", *arguments.result, {".hres"});
    }
    if (arguments.fluxes) {
        outputs.add("--fluxes", *arguments.fluxes, {".csv"}, true);
    }
    outputs.refuse_with_json(arguments.common.json);
    return outputs;
}

/// What is known of the mesh's patches, for those that results are about.
std::vector<io::CellArray> of_patches(std::vector<io::CellArray> arrays, const LoadedScene& loaded) {
    return loaded.as_read ? io::means_of_cells(std::move(arrays), loaded.as_read->parts, loaded.mesh.areas())
                          : arrays;
}

/// Net fluxes times areas, W: areas are in square units of the scene, whatever these are.
std::vector<io::CellArray> with_powers(std::vector<io::CellArray> arrays, std::span<const double> areas,
                                       double unit) {
    const auto flux = std::find_if(arrays.begin(), arrays.end(),
                                   [](const io::CellArray& array) { return array.name == "net_flux"; });
    io::CellArray power{"net_power", {}, {}};
    for (std::size_t i = 0; i < areas.size(); ++i) {
        power.values.push_back(flux->values[i] * areas[i] * unit * unit);
    }
    arrays.insert(flux + 1, std::move(power));
    return arrays;
}

void write_patches(const HeatArguments& arguments, const LoadedScene& loaded, const HeatProblem& problem,
                   const HeatSolution& solution) {
    std::vector<std::string> bands;
    if (problem.bands > 1) {
        bands = loaded.scene.channels;
    }
    std::vector<io::CellArray> arrays{{"temperature", solution.temperature, {}},
                                      {"net_flux", solution.net_flux, {}},
                                      {"emitted", solution.emitted, {}},
                                      {"absorbed", solution.absorbed, {}},
                                      {"irradiation", solution.irradiation, bands},
                                      {"radiosity", solution.radiosity, bands}};
    if (!problem.direct.empty()) {
        arrays.push_back({"direct", problem.direct, bands});
    }
    if (arguments.fluxes) {
        const io::PatchPlaces left = loaded.as_read ? loaded.as_read->left : io::PatchPlaces();
        const std::span<const double> areas = left.areas.empty() ? loaded.patches().areas() : left.areas;
        io::write_patch_table(*arguments.fluxes, loaded.patches(),
                              with_powers(of_patches(arrays, loaded), areas, problem.unit), left);
    }
    if (arguments.output && extension_of(*arguments.output) == ".vtp") {
        io::write_vtp(*arguments.output, loaded.mesh,
                      with_powers(std::move(arrays), loaded.mesh.areas(), problem.unit));
    }
}

void write_result(const std::filesystem::path& path, const LoadedScene& loaded, const FormFactors& factors,
                  const HeatProblem& problem, const HeatSolution& solution) {
    const auto channels = static_cast<std::uint32_t>(loaded.scene.channels.size());
    Solution stored = heat_as_solution(factors, problem, solution, channels);
    stored.method = SolverMethod::conjugate_gradient;
    stored.sweeps = solution.iterations;
    stored.residual = solution.residual;
    stored.renderer = factors.provenance.renderer;
    io::ResultFile file = loaded.result(std::move(stored));
    file.scene = scene_of_heat(std::move(file.scene), problem);
    for (Surface& surface : file.surfaces_as_read) {
        surface.heat = no_heat;
    }
    io::write_hres(path, file);
}

/// In false colours. @return what `heat` reports of it
Report draw_heat(const HeatArguments& arguments, const LoadedScene& loaded, const FormFactors& factors,
                 const HeatProblem& problem, const HeatSolution& solution) {
    const auto channels = static_cast<std::uint32_t>(loaded.scene.channels.size());
    PictureOptions options = arguments.picture.picture;
    options.output = arguments.output;
    const std::vector<std::string>& given = arguments.common.given;
    if (problem.bands == channels && std::find(given.begin(), given.end(), "--channel") == given.end()) {
        options.channel = "sum"; // bands are parts of one radiation
    }
    return write_picture(loaded.scene, loaded.mesh, heat_as_solution(factors, problem, solution, channels),
                         options, arguments.rows.factors.engine.device);
}

} // namespace

ExitStatus run(const HeatArguments& given, const Terminal& terminal) {
    HeatArguments arguments = given;
    settle_clusters(arguments.common, arguments.rows);
    const Outputs outputs = check_outputs(arguments);
    std::optional<io::TextTable> lines;
    if (arguments.series) {
        lines = read_series(*arguments.series);
    }
    Seconds seconds({"load", "factors", "estimate", "repair", "solve", "series"});
    LoadedScene loaded =
        load_thermal_scene("heat", arguments.scene, arguments.input, arguments.heat, true, terminal);
    seconds["load"] = loaded.seconds;
    if (lines) {
        check_times(*arguments.series, *lines, loaded.scene);
        give_temperatures(loaded.scene, *arguments.series, *lines);
    }
    if (arguments.output && is_picture(*arguments.output)) { // tested before the work
        check_channel(loaded.scene.channels, arguments.picture.picture.channel);
        (void)picture_cut(arguments.picture.picture, loaded.mesh.groups());
    }
    TerminalObserver observer(terminal);
    HeatProblem problem = heat_problem(loaded.scene, loaded.mesh, observer);
    HeatSchedule schedule;
    if (lines) {
        schedule = schedule_of(*arguments.series, *lines, loaded, problem, observer);
    }
    const FormFactors factors = find_heat_rows(arguments.common, arguments.rows, arguments.input, loaded,
                                               observer, terminal, seconds);
    const double max_row_error = arguments.rows.max_row_error;
    const RowSums sums = row_sums(factors.matrix);
    const EnclosureFinding enclosure = find_leaks(factors, max_row_error);
    report_buried(sums, terminal);
    const Stopwatch watch;
    problem.direct = direct_heat(loaded.scene, loaded.mesh, factors.matrix, problem.bands);
    const HeatSolution solution = solve_heat(factors, problem, {}, observer);
    seconds["solve"] = watch.seconds();
    HeatSeries series;
    if (lines) {
        const Stopwatch series_watch;
        series = of_file(*arguments.series,
                         [&] { return solve_heat_series(factors, problem, schedule, {}, observer); });
        seconds["series"] = series_watch.seconds();
        terminal.detail(fmt::format("{} {}", plural(lines->rows.size(), "line", "lines"),
                                    series.superposed ? "by superposition of one solve a column"
                                                      : "solved one by one: the problem is not linear"));
    }
    write_patches(arguments, loaded, problem, solution);
    if (arguments.result) {
        write_result(*arguments.result, loaded, factors, problem, solution);
    }
    Report picture;
    if (arguments.output && is_picture(*arguments.output)) {
        picture = draw_heat(arguments, loaded, factors, problem, solution);
    }
    std::vector<double> errors(factors.groups.size(), std::numeric_limits<double>::quiet_NaN());
    // With clusters errors of groups are not to be had.
    if (arguments.rows.factors.estimate_error && factors.error && factors.matrix.clusters() == nullptr) {
        const Stopwatch estimate_watch;
        errors = patch_size_flux_errors(loaded.scene, loaded.mesh, loaded.subdivision, factors, problem,
                                        solution, arguments.rows.factors, observer);
        seconds["estimate"] += estimate_watch.seconds();
    }
    Report tables = heat_report(factors, problem, solution, errors);
    tables.json["series"] = nullptr;
    if (lines) {
        Report of_lines = series_report(factors.groups, schedule.labels, series);
        if (arguments.output && is_table(*arguments.output)) {
            write_series(*arguments.output, schedule, factors.groups, series);
            of_lines.text = fmt::format("{} in {}\n", plural(schedule.labels.size(), "line", "lines"),
                                        arguments.output->string());
        }
        tables.text += "\n";
        tables.add(of_lines);
        tell_of_own_state(arguments, terminal);
    }
    Report report = scene_size_report(loaded);
    report.add(rows_report(factors, sums, enclosure));
    report.add(repair_report(factors, seconds["repair"]));
    report.add(seconds.report());
    report.add(heat_balance_report(factors, problem, solution));
    report.add(picture);
    report.json.update(tables.json);
    report.json["bands"] = problem.bands;
    report.json["unit"] = problem.unit;
    report.select("hemi/heat/1", {"renderer",
                                  "patches",
                                  "parts",
                                  "bands",
                                  "unit",
                                  "groups",
                                  "areas",
                                  "emissivity",
                                  "temperature",
                                  "emitted",
                                  "absorbed",
                                  "irradiation",
                                  "direct",
                                  "radiosity",
                                  "net_flux",
                                  "net_power",
                                  "environment_power",
                                  "balance",
                                  "error",
                                  "clusters",
                                  "asymmetry",
                                  "buried",
                                  "solver",
                                  "row_sum",
                                  "repair",
                                  "series",
                                  "seconds"});
    if (!lines) {
        report.json.erase("series");
    }
    show_with_tables(outputs, std::move(report), tables, arguments.common.json, terminal);
    report_no_fronts(sums, factors.matrix, terminal);
    report_met_backs(power_to_backs(factors, solution), factors.groups, terminal);
    report_leaks(enclosure, factors.matrix, loaded.names(), &loaded.mesh, max_row_error, terminal);
    return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

} // namespace hemi::cli
