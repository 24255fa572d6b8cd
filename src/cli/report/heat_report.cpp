#include "cli/report/heat_report.hpp"

#include "hemi/core/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace hemi::cli {

namespace {

/// Of every group, without the last of `all`, which is their total.
Json column_json(const std::vector<GroupHeat>& all, double GroupHeat::*member) {
    Json json = Json::array();
    for (std::size_t g = 0; g + 1 < all.size(); ++g) {
        json.push_back(value_json(all[g].*member));
    }
    return json;
}

Json numbers_json(std::span<const double> values) {
    Json json = Json::array();
    for (const double value : values) {
        json.push_back(value_json(value));
    }
    return json;
}

Json slice_json(const std::vector<double>& values, std::size_t first, std::size_t count) {
    Json json = Json::array();
    for (std::size_t k = first; k < first + count; ++k) {
        json.push_back(value_json(values[k]));
    }
    return json;
}

/// Rows of a matrix, null in those of groups that emit nothing.
Json gebhart_json(const HeatExchange& exchange) {
    const std::size_t groups = exchange.areas.size();
    Json json = Json::array();
    for (std::size_t g = 0; g < groups; ++g) {
        Json row = Json::array();
        for (std::size_t h = 0; h < groups; ++h) {
            row.push_back(exchange.emissivity[g] > 0.0 ? Json(exchange.gebhart[g * groups + h]) : Json());
        }
        json.push_back(std::move(row));
    }
    return json;
}

} // namespace

Report heat_report(const FormFactors& factors, const HeatProblem& problem, const HeatSolution& solution,
                   std::span<const double> patch_size_errors) {
    const std::vector<GroupHeat> all = group_heat(factors, problem, solution);
    Json errors = Json::array();
    std::vector<double> combined;
    for (std::size_t g = 0; g < all.size(); ++g) {
        const bool estimated = g < patch_size_errors.size();
        combined.push_back(estimated ? std::hypot(all[g].flux_error, patch_size_errors[g])
                                     : std::numeric_limits<double>::quiet_NaN());
        if (g + 1 < all.size()) {
            errors.push_back(value_json(combined[g]));
        }
    }
    const bool lit = !problem.direct.empty();
    constexpr std::ptrdiff_t direct_column = 7;
    std::vector<std::string> columns{
        "group",         "area m²",          "emissivity",     "T K",           "emitted W/m²",
        "absorbed W/m²", "irradiation W/m²", "radiosity W/m²", "net flux W/m²", "+-",
        "net power W"};
    if (lit) {
        columns.insert(columns.begin() + direct_column, "sun and sky W/m²");
    }
    Table table(columns);
    for (std::size_t g = 0; g < all.size(); ++g) {
        const GroupHeat& heat = all[g];
        const bool total = g + 1 == all.size();
        std::vector<std::string> cells{total ? "(all surfaces)" : factors.groups[g],
                                       number_text(heat.area),
                                       value_text(heat.emissivity),
                                       value_text(heat.temperature),
                                       value_text(heat.emitted),
                                       value_text(heat.absorbed),
                                       value_text(heat.irradiation),
                                       value_text(heat.radiosity),
                                       number_text(heat.net_flux),
                                       std::isfinite(combined[g]) ? fmt::format("{:.2g}", combined[g]) : "-",
                                       number_text(heat.net_power)};
        if (lit) {
            cells.insert(cells.begin() + direct_column, value_text(heat.direct));
        }
        table.add(std::move(cells));
    }
    std::vector<std::string> environment(columns.size());
    environment.front() = "(environment)";
    environment[3] = problem.environment_temperature ? number_text(*problem.environment_temperature) : "";
    environment.back() = number_text(solution.environment_power);
    table.add(std::move(environment));
    Report report;
    Json names = Json::array();
    for (const std::string& name : factors.groups) {
        names.push_back(name);
    }
    report.json = {{"groups", std::move(names)},
                   {"areas", column_json(all, &GroupHeat::area)},
                   {"emissivity", column_json(all, &GroupHeat::emissivity)},
                   {"temperature", column_json(all, &GroupHeat::temperature)},
                   {"emitted", column_json(all, &GroupHeat::emitted)},
                   {"absorbed", column_json(all, &GroupHeat::absorbed)},
                   {"irradiation", column_json(all, &GroupHeat::irradiation)},
                   {"direct", column_json(all, &GroupHeat::direct)},
                   {"radiosity", column_json(all, &GroupHeat::radiosity)},
                   {"net_flux", column_json(all, &GroupHeat::net_flux)},
                   {"net_power", column_json(all, &GroupHeat::net_power)},
                   {"environment_power", solution.environment_power},
                   {"error",
                    {{"net_flux", std::move(errors)},
                     {"parts",
                      {{"factors", column_json(all, &GroupHeat::flux_error)},
                       {"patch_size", numbers_json(patch_size_errors)}}}}}};
    report.text = table.text();
    return report;
}

Report heat_balance_report(const FormFactors& factors, const HeatProblem& problem,
                           const HeatSolution& solution) {
    Report report;
    double emitted = 0.0;
    double absorbed = 0.0;
    for (std::size_t i = 0; i < solution.buried.size(); ++i) {
        const double area = solution.buried[i] != 0 ? 0.0 : factors.areas[i] * problem.unit * problem.unit;
        emitted += area > 0.0 ? area * solution.emitted[i] : 0.0;
        absorbed += area > 0.0 ? area * solution.absorbed[i] : 0.0;
    }
    const std::vector<double> backs = power_to_backs(factors, solution);
    const double met = std::accumulate(backs.begin(), backs.end(), 0.0);
    report.add(
        "balance",
        fmt::format("emitted {} W, absorbed {} W, from the environment {} W; {:.3g} W left over, {:.2g} "
                    "of all net powers{}",
                    number_text(emitted), number_text(absorbed), number_text(solution.environment_power),
                    solution.balance, solution.relative_balance,
                    met > 0.0
                        ? fmt::format("; {:.2g} % of what leaves meets backs and comes back", 100.0 * met)
                        : std::string()),
        {{"balance",
          {{"residual", solution.balance},
           {"relative", solution.relative_balance},
           {"emitted", emitted},
           {"absorbed", absorbed},
           {"environment", solution.environment_power},
           {"backs", met}}}});
    report.add("solver",
               fmt::format("conjugate gradients, {}, residual {:.3g}",
                           plural(solution.iterations, "iteration", "iterations"), solution.residual),
               {{"solver",
                 {{"iterations", solution.iterations},
                  {"residual", solution.residual},
                  {"outer_iterations", solution.outer},
                  {"outer_change", solution.outer_change}}}});
    if (solution.outer > 0) {
        report.add("", fmt::format("{} for temperatures; sigma T⁴ changed by {:.2g} in the last",
                                   plural(solution.outer, "outer iteration", "outer iterations"),
                                   solution.outer_change));
    }
    report.add(asymmetry_report(factors, solution.asymmetry));
    const auto buried = std::count(solution.buried.begin(), solution.buried.end(), std::uint8_t{1});
    if (buried > 0) {
        report.add("buried",
                   fmt::format("{} no flux and are left out of means",
                               plural(static_cast<std::uint64_t>(buried), "patch has", "patches have")));
    }
    report.json["buried"] = buried;
    return report;
}

Report asymmetry_report(const FormFactors& factors, double asymmetry) {
    Report report;
    const bool clusters = factors.matrix.clusters() != nullptr;
    if (clusters) {
        report.add("clusters",
                   fmt::format("exchange made symmetric and scaled: what a patch exchanges was {:.2g} % "
                               "off its row (rms by area)",
                               100.0 * asymmetry));
    }
    report.json["clusters"] = clusters;
    report.json["asymmetry"] = clusters ? Json(asymmetry) : Json();
    return report;
}

std::vector<double> power_to_backs(const FormFactors& factors, const HeatSolution& solution) {
    std::vector<double> shares(factors.groups.size(), 0.0);
    double all = 0.0;
    for (std::uint32_t i = 0; i < factors.matrix.size(); ++i) {
        if (solution.buried[i] != 0) {
            continue;
        }
        double leaving = 0.0;
        for (std::size_t k = 0; k < solution.bands; ++k) {
            leaving += factors.areas[i] * solution.radiosity[std::size_t{i} * solution.bands + k];
        }
        all += leaving;
        shares[factors.group_of[i]] += leaving * factors.matrix.blocked(i);
    }
    for (double& share : shares) {
        share = all > 0.0 ? share / all : 0.0;
    }
    return shares;
}

void report_met_backs(const std::vector<double>& shares, const std::vector<std::string>& groups,
                      const Terminal& terminal) {
    constexpr double worth_telling = 1e-3;
    const double met = std::accumulate(shares.begin(), shares.end(), 0.0);
    if (met <= worth_telling) {
        return;
    }
    const auto worst =
        static_cast<std::size_t>(std::max_element(shares.begin(), shares.end()) - shares.begin());
    terminal.warn(
        fmt::format("{:.2g} % of the radiation meets backs of one-sided surfaces, most of it from {}, "
                    "and counts as coming back; \"two_sided\", or --two-sided GROUP, gives them a "
                    "radiation of their own",
                    100.0 * met, groups[worst]));
}

Report series_report(std::span<const std::string> names, std::span<const std::string> labels,
                     const HeatSeries& series) {
    Report report;
    Json json = Json::array();
    std::vector<std::string> header{"time"};
    for (const std::string& name : names) {
        header.push_back(name + " K");
        header.push_back(name + " W/m²");
    }
    header.emplace_back("environment W");
    Table table(std::move(header));
    const std::size_t groups = series.groups;
    for (std::size_t l = 0; l < labels.size(); ++l) {
        std::vector<std::string> row{labels[l]};
        for (std::size_t g = 0; g < groups; ++g) {
            row.push_back(value_text(series.temperature[l * groups + g]));
            row.push_back(number_text(series.net_flux[l * groups + g]));
        }
        row.push_back(number_text(series.environment_power[l]));
        table.add(std::move(row));
        json.push_back({{"time", labels[l]},
                        {"temperature", slice_json(series.temperature, l * groups, groups)},
                        {"net_flux", slice_json(series.net_flux, l * groups, groups)},
                        {"net_power", slice_json(series.net_power, l * groups, groups)},
                        {"environment_power", series.environment_power[l]}});
    }
    report.text = table.text();
    report.json["series"] = std::move(json);
    return report;
}

Report exchange_report(std::span<const std::string> names, const HeatExchange& exchange) {
    const std::size_t groups = names.size();
    std::vector<std::string> header{"conductance m²"};
    header.insert(header.end(), names.begin(), names.end());
    header.insert(header.end(), {"(environment)", "emissivity", "area m²"});
    Table table(std::move(header));
    for (std::size_t g = 0; g < groups; ++g) {
        std::vector<std::string> row{names[g]};
        for (std::size_t h = 0; h < groups; ++h) {
            row.push_back(number_text(exchange.conductance[g * groups + h]));
        }
        row.push_back(number_text(exchange.environment[g] * exchange.areas[g]));
        row.push_back(number_text(exchange.emissivity[g]));
        row.push_back(number_text(exchange.areas[g]));
        table.add(std::move(row));
    }
    Report report;
    report.text = table.text();
    report.json = {{"groups", std::vector<std::string>(names.begin(), names.end())},
                   {"areas", exchange.areas},
                   {"emissivity", exchange.emissivity},
                   {"gebhart", gebhart_json(exchange)},
                   {"script_f", rows_json(exchange.script_f, groups)},
                   {"conductance", rows_json(exchange.conductance, groups)},
                   {"environment", exchange.environment}};
    return report;
}

Report cutoff_report(const std::optional<ExchangeCutoff>& cutoff) {
    Report report;
    report.json["cutoff"] = nullptr;
    if (cutoff) {
        report.add("cutoff",
                   fmt::format(
                       "{} of {} below {} m²; they carried up to {:.2g} % of a group's; of those kept "
                       "none changed by more than {:.2g} %",
                       cutoff->dropped, plural(cutoff->dropped + cutoff->kept, "conductance", "conductances"),
                       cutoff->min, 100.0 * cutoff->largest_share, 100.0 * cutoff->largest_change),
                   {{"cutoff",
                     {{"min", cutoff->min},
                      {"dropped", cutoff->dropped},
                      {"kept", cutoff->kept},
                      {"largest_share", cutoff->largest_share},
                      {"largest_change", cutoff->largest_change},
                      {"isolated", cutoff->isolated}}}});
    }
    return report;
}

void show_with_tables(const Outputs& outputs, Report summary, const Report& tables, bool json,
                      const Terminal& terminal) {
    if (!json && terminal.quiet() && !outputs.uses_standard_output()) {
        print(tables.text);
        return;
    }
    summary.text += fmt::format("\n{}", tables.text);
    outputs.show(summary, json, terminal);
}

} // namespace hemi::cli
