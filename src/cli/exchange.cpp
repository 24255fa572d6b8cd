#include "cli/cluster_settings.hpp"
#include "cli/commands.hpp"
#include "cli/heat_factors.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/balance_report.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/heat_report.hpp"
#include "cli/report/scene_report.hpp"
#include "cli/terminal_observer.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/exchange_file.hpp"
#include "hemi/io/table_file.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

namespace hemi::cli {

namespace {

Outputs check_outputs(const ExchangeArguments& arguments) {
    Outputs outputs;
    outputs.keep(arguments.scene.path);
    check_factor_input(outputs, arguments.input);
    if (arguments.heat.table) {
        outputs.keep(*arguments.heat.table);
    }
    if (arguments.output) {
        outputs.add("-o", *arguments.output, {".csv", ".npz", ".txt"}, true);
    }
    outputs.refuse_with_json(arguments.common.json);
    return outputs;
}

/// Every pair of groups, and every group with the environment.
/// @param all  those too that exchange nothing
io::TextTable exchange_table(const std::vector<std::string>& names, const HeatExchange& exchange, bool all) {
    const std::size_t groups = names.size();
    io::TextTable table;
    table.columns = {"from", "to", "gebhart", "script_f", "conductance"};
    const auto number = [](double value) { return fmt::format("{}", value); };
    for (std::size_t g = 0; g < groups; ++g) {
        const bool emits = exchange.emissivity[g] > 0.0;
        for (std::size_t h = 0; h < groups; ++h) {
            const std::size_t at = g * groups + h;
            if (!all && exchange.conductance[at] == 0.0) {
                continue;
            }
            table.rows.push_back({names[g], names[h], emits ? number(exchange.gebhart[at]) : "",
                                  number(exchange.script_f[at]), number(exchange.conductance[at])});
        }
        const double environment = exchange.environment[g];
        if (!all && environment == 0.0) {
            continue;
        }
        table.rows.push_back({names[g], "(environment)",
                              emits ? number(environment / exchange.emissivity[g]) : "", number(environment),
                              number(environment * exchange.areas[g])});
    }
    return table;
}

void write_exchange(const std::filesystem::path& path, const FormFactors& factors,
                    const HeatExchange& exchange, bool cut) {
    const io::ExchangeTables tables{factors.groups,       factors.enclosure,   exchange.areas,
                                    exchange.emissivity,  exchange.gebhart,    exchange.script_f,
                                    exchange.conductance, exchange.environment};
    const std::string extension = extension_of(path);
    if (extension == ".npz") {
        io::write_exchange_npz(path, tables);
    } else if (extension == ".txt") {
        io::write_exchange_view3d(path, tables);
    } else {
        io::write_table(path, exchange_table(factors.groups, exchange, !cut));
    }
}

void warn_of_isolated(const std::vector<std::string>& names, const ExchangeCutoff& cutoff,
                      const Terminal& terminal) {
    std::vector<std::string> isolated;
    for (const std::uint32_t g : cutoff.isolated) {
        isolated.push_back(names[g]);
    }
    if (!isolated.empty()) {
        terminal.warn(fmt::format("--min {}: nothing is left between {} and the rest; a smaller one keeps it",
                                  cutoff.min, fmt::join(isolated, ", ")));
    }
}

} // namespace

ExitStatus run(const ExchangeArguments& arguments, const Terminal& terminal) {
    const Outputs outputs = check_outputs(arguments);
    RowOptions rows = arguments.rows;
    settle_clusters(arguments.common, rows);
    Seconds seconds({"load", "factors", "estimate", "repair", "solve"});
    const LoadedScene loaded =
        load_thermal_scene("exchange", arguments.scene, arguments.input, arguments.heat, false, terminal);
    seconds["load"] = loaded.seconds;
    TerminalObserver observer(terminal);
    const HeatProblem problem = heat_problem(loaded.scene, loaded.mesh, observer, false);
    if (!arguments.input.factors) {
        rows.factors.estimate_error = false; // only a file would show it
    }
    const FormFactors factors =
        find_heat_rows(arguments.common, rows, arguments.input, loaded, observer, terminal, seconds);
    const double max_row_error = arguments.rows.max_row_error;
    const RowSums sums = row_sums(factors.matrix);
    const EnclosureFinding enclosure = find_leaks(factors, max_row_error);
    report_buried(sums, terminal);
    const Stopwatch watch;
    HeatExchange exchange = heat_exchange(factors, problem, {}, observer);
    std::optional<ExchangeCutoff> cutoff;
    if (arguments.min) {
        cutoff = drop_small_conductances(exchange, *arguments.min);
        warn_of_isolated(factors.groups, *cutoff, terminal);
    }
    seconds["solve"] = watch.seconds();
    if (arguments.output) {
        write_exchange(*arguments.output, factors, exchange, cutoff.has_value());
    }
    Report report = scene_size_report(loaded);
    report.add(rows_report(factors, sums, enclosure));
    report.add(repair_report(factors, seconds["repair"]));
    report.add(asymmetry_report(factors, exchange.asymmetry));
    report.add(cutoff_report(cutoff));
    report.add(seconds.report());
    const Report tables = exchange_report(factors.groups, exchange);
    report.json.update(tables.json);
    report.select("hemi/exchange/1", {"renderer", "patches", "parts", "groups", "areas", "emissivity",
                                      "gebhart", "script_f", "conductance", "environment", "cutoff",
                                      "clusters", "asymmetry", "row_sum", "repair", "seconds"});
    show_with_tables(outputs, std::move(report), tables, arguments.common.json, terminal);
    report_leaks(enclosure, factors.matrix, loaded.names(), &loaded.mesh, max_row_error, terminal);
    return enclosure.leaks.empty() ? ExitStatus::ok : ExitStatus::out_of_tolerance;
}

} // namespace hemi::cli
