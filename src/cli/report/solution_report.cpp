#include "cli/report/solution_report.hpp"

#include "cli/report/balance_report.hpp"
#include "cli/report/factor_report.hpp"
#include "cli/report/group_sizes.hpp"
#include "cli/report/scene_report.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/pipeline/group_light.hpp"
#include "hemi/pipeline/patch_size_error.hpp"
#include "hemi/scene/light_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace hemi::cli {

namespace {

/// Area mean per group and channel of a per-patch value.
std::vector<double> group_means(const LoadedScene& loaded, const std::vector<double>& areas,
                                const std::vector<double>& values, std::uint32_t channels) {
    std::vector<double> sums(areas.size() * channels, 0.0);
    for (std::uint32_t i = 0; i < loaded.mesh.size(); ++i) {
        for (std::uint32_t c = 0; c < channels; ++c) {
            sums[loaded.group_of[i] * channels + c] +=
                loaded.mesh.areas()[i] * values[std::size_t{i} * channels + c];
        }
    }
    for (std::size_t k = 0; k < sums.size(); ++k) {
        sums[k] /= areas[k / channels];
    }
    return sums;
}

/// Area mean per group of a share of rows; null for a group with rows that were not computed.
Json share_json(const LoadedScene& loaded, const std::vector<double>& areas, const FormFactorMatrix& factors,
                const std::vector<double>& shares) {
    std::vector<bool> known(areas.size(), true);
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        known[loaded.group_of[i]] = known[loaded.group_of[i]] && factors.known(i);
    }
    const std::vector<double> means = group_means(loaded, areas, shares, 1);
    Json json = Json::array();
    for (std::size_t g = 0; g < means.size(); ++g) {
        json.push_back(known[g] ? Json(means[g]) : Json());
    }
    return json;
}

/// @param steps  how many of what
Report solver_report(const Solution& solution, const std::string& steps) {
    Report report;
    report.add("solver",
               fmt::format("{}, {}, residual {:.3g}", to_word(solution.method), steps, solution.residual),
               {{"solver",
                 {{"name", to_word(solution.method)},
                  {"sweeps", solution.sweeps},
                  {"residual", solution.residual}}}});
    return report;
}

/// Null where it is not a number.
Json groups_json(const std::vector<double>& errors) {
    Json json = Json::array();
    for (const double error : errors) {
        json.push_back(std::isfinite(error) ? Json(error) : Json());
    }
    return json;
}

/// The group whose mean irradiance is off the most; as many as there are where none is known.
std::size_t worst_group(const std::vector<double>& errors) {
    std::size_t worst = errors.size();
    for (std::size_t g = 0; g < errors.size(); ++g) {
        if (std::isfinite(errors[g]) && (worst == errors.size() || errors[g] > errors[worst])) {
            worst = g;
        }
    }
    return worst;
}

/// Empty where none is known.
std::string groups_sentence(const std::vector<double>& errors, const std::vector<std::string>& names) {
    const std::size_t worst = worst_group(errors);
    return worst == errors.size() ? std::string()
                                  : fmt::format("mean irradiance of groups within {:.2g} % ({})",
                                                100.0 * errors[worst], names[worst]);
}

/// Whether patches were cut where it tells, as refinement does.
bool has_cut_patches(const PatchMesh& mesh) {
    const PatchCuts cuts = mesh.cuts();
    return std::any_of(cuts.parts.begin(), cuts.parts.end(),
                       [](const auto& parts) { return !parts.empty(); });
}

/// The error that was asked for; that of the vertices where it is not known.
double error_asked_for(const SolutionError& error, ErrorOf of) {
    if (of == ErrorOf::groups) {
        const std::size_t worst = worst_group(error.groups);
        return worst < error.groups.size() ? error.groups[worst] : error.vertices.rms;
    }
    return of == ErrorOf::field ? error.field.rms : error.vertices.rms;
}

/// What makes the error smaller, where the patches' size makes most of it; else empty.
/// @param of  which error
std::string advice(const Solution& solution, const SolutionError& error, const PatchMesh& mesh, ErrorOf of) {
    double patch_size = error.patch_size;
    double others = std::hypot(error.factors, error.solver);
    if (const std::size_t worst = worst_group(error.groups);
        of == ErrorOf::groups && worst < error.groups.size()) {
        patch_size = solution.patch_size_error->groups[worst].patch_size;
        others = solution.patch_size_error->groups[worst].factors;
    }
    if (patch_size < 2.0 * others) {
        return {};
    }
    std::string by = fmt::format("--error-target {:.2g}%", 50.0 * error_asked_for(error, of));
    if (!has_cut_patches(mesh)) {
        by = fmt::format("--patch-size {:.2g}, half of it, or {}", 0.5 * mean_patch_size(mesh), by);
    }
    return fmt::format("most of it from the patches' size: {} would halve it", by);
}

std::string percent_text(double share) {
    return fmt::format("{:.2g} %", 100.0 * share);
}

std::string error_sentence(const SolutionError& error) {
    return fmt::format("the reflected light is within {} (rms) of the exact one: patch size {}, form factors "
                       "{}, solver {}",
                       percent_text(error.vertices.rms), percent_text(error.patch_size),
                       percent_text(error.factors), percent_text(error.solver));
}

/// How far the solution is from the exact one; empty where that was not estimated.
Report solution_error_report(const Solution& solution, const PatchMesh& mesh, ErrorOf of) {
    Report report;
    report.json["error"] = nullptr;
    const auto error = solution_error(solution);
    if (!error) {
        return report;
    }
    const auto json = [](const FieldError& e) { return Json{{"rms", e.rms}, {"p95", e.percentile95}}; };
    report.add(
        "error", error_sentence(*error),
        {{"error",
          {{"vertices", json(error->vertices)},
           {"field", json(error->field)},
           {"groups", groups_json(error->groups)},
           {"parts",
            {{"patch_size", error->patch_size}, {"factors", error->factors}, {"solver", error->solver}}},
           {"patches_sampled", solution.patch_size_error->sampled}}}});
    report.add("",
               fmt::format("within {} on 95 % of the area; as one constant a patch {} and {}; from {}",
                           percent_text(error->vertices.percentile95), percent_text(error->field.rms),
                           percent_text(error->field.percentile95),
                           plural(solution.patch_size_error->sampled, "patch", "patches") + " cut in four"));
    if (const std::string worst = groups_sentence(error->groups, mesh.groups()); !worst.empty()) {
        report.add("", worst);
    }
    if (const std::string smaller = advice(solution, *error, mesh, of); !smaller.empty()) {
        report.add("", smaller);
    }
    return report;
}

/// The solver and how it went, settings that the program chose, estimated errors.
Report solution_report(const Solution& solution, const PatchMesh& mesh, ErrorOf of) {
    const bool gradients = solution.method == SolverMethod::conjugate_gradient;
    Report report;
    report.add("dominance",
               fmt::format("{:.6g} (largest reflectance x row sum; converges below 1)", solution.dominance));
    report.add(solver_report(solution, gradients ? plural(solution.sweeps, "iteration", "iterations")
                                                 : plural(solution.sweeps, "sweep", "sweeps")));
    report.add("", solution.reason);
    report.json["solver"]["why"] = solution.reason;
    report.add(chosen_report(solution.chosen_for));
    report.add(solution_error_report(solution, mesh, of));
    report.add(error_report(solution.factor_error, solution.error, !solution.patch_size_error));
    return report;
}

/// How far the solution is from the exact one, and what would make it better.
/// @param of  which error counts, besides that of the vertices
std::string brief_error(const Solution& solution, const PatchMesh& mesh, ErrorOf of) {
    const auto error = solution_error(solution);
    if (!error) {
        return error_report(solution.factor_error, solution.error, true).text;
    }
    std::string text = summary_line("error", error_sentence(*error));
    if (of == ErrorOf::field) {
        text += summary_line("", fmt::format("as one constant a patch {}", percent_text(error->field.rms)));
    } else if (const std::string worst = groups_sentence(error->groups, mesh.groups());
               of == ErrorOf::groups && !worst.empty()) {
        text += summary_line("", worst);
    }
    if (const std::string smaller = advice(solution, *error, mesh, of); !smaller.empty()) {
        text += summary_line("", smaller);
    }
    return text;
}

/// Which groups are listed: all, or of very many those that send out most.
/// @param all  groups, and last their total
std::vector<bool> groups_to_show(const std::vector<GroupLight>& all) {
    constexpr std::size_t most_listed = 40;
    const std::size_t count = all.size() - 1;
    std::vector<bool> shown(count, count <= most_listed);
    if (count > most_listed) {
        std::vector<std::size_t> order(count);
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return all[a].leaving > all[b].leaving; });
        for (std::size_t k = 0; k < most_listed; ++k) {
            shown[order[k]] = true;
        }
    }
    return shown;
}

/// Means over the groups.
Json group_means_json(const LoadedScene& loaded, const FormFactorMatrix& factors, const Solution& solution) {
    const std::uint32_t channels = solution.channels;
    std::vector<double> areas;
    for (const GroupSize& group : group_sizes(loaded.mesh, loaded.mesh.areas())) {
        areas.push_back(group.area);
    }
    return {{"channels", loaded.scene.channels},
            {"areas", areas},
            {"radiosity", rows_json(group_means(loaded, areas, solution.radiosity, channels), channels)},
            {"exitance", rows_json(group_means(loaded, areas, solution.exitance, channels), channels)},
            {"environment", share_json(loaded, areas, factors, solution.environment_share)},
            {"blocked", share_json(loaded, areas, factors, solution.back_face_share)}};
}

/// The least and the largest of the values that are known.
Report range_report(const char* name, std::span<const double> values, const char* unit, const char* key) {
    double least = std::numeric_limits<double>::infinity();
    double largest = -least;
    for (const double value : values) {
        least = std::isnan(value) ? least : std::min(least, value);
        largest = std::isnan(value) ? largest : std::max(largest, value);
    }
    Report report;
    if (least <= largest) {
        report.add(name, fmt::format("{} to {}{}", number_text(least), number_text(largest), unit),
                   {{key, {{"min", least}, {"max", largest}}}});
    } else {
        report.add(name, "not known", {{key, nullptr}});
    }
    return report;
}

} // namespace

Report refinement_report(const std::vector<Refinement::Step>& steps, const std::string& stopped) {
    Json json = Json::array();
    std::vector<std::string> sizes;
    std::uint64_t rows = 0;
    for (const Refinement::Step& step : steps) {
        sizes.push_back(count_text(step.patches));
        rows += step.rows;
        json.push_back({{"patches", step.patches},
                        {"rows", step.rows},
                        {"error", std::isfinite(step.error) ? Json(step.error) : Json()}});
    }
    Report report;
    report.add("refinement",
               fmt::format("{} of {} patches; {} computed in all", plural(steps.size(), "mesh", "meshes"),
                           fmt::join(sizes, ", "), plural(rows, "row", "rows")),
               {{"refinement", {{"steps", std::move(json)}, {"rows", rows}, {"stopped", stopped}}}});
    if (!stopped.empty()) {
        report.add("", "stopped: " + stopped);
    }
    return report;
}

Report stored_solution_report(const Solution& solution, const PatchMesh& mesh) {
    Report report;
    report.add("renderer", solution.renderer, {{"renderer", solution.renderer}});
    report.add(solver_report(solution, plural(solution.sweeps, "sweep", "sweeps")));
    report.add(chosen_report(solution.chosen_for));
    report.json["chosen_for"] = solution.chosen_for; // "" rather than null, as the file has it
    report.add(solution_error_report(solution, mesh, ErrorOf::vertices));
    report.add(error_report(solution.factor_error, solution.error, !solution.patch_size_error));
    report.json["temperature"] = report.json["net_flux"] = nullptr;
    if (!solution.temperature.empty()) {
        report.add(range_report("temperature", solution.temperature, " K", "temperature"));
        report.add(range_report("net flux", solution.net_flux, " W/m²", "net_flux"));
    }
    return report;
}

Report light_balance_report(const std::optional<LightBalance>& balance, double metres, const char* unit) {
    Report report;
    report.json["balance"] = nullptr;
    if (!balance) {
        return report;
    }
    const auto watts = [&](double power) { return power * metres * metres; };
    const auto part = [&](double power) {
        return fmt::format("{}{} ({:.3g} %)", number_text(watts(power)), unit,
                           balance->incoming > 0.0 ? 100.0 * power / balance->incoming : 0.0);
    };
    report.add("balance",
               fmt::format("emitted {}{}; absorbed {}, to the environment {}, lost on backs {}",
                           number_text(watts(balance->emitted)), unit, part(balance->absorbed),
                           part(balance->environment), part(balance->lost)),
               {{"balance",
                 {{"emitted", watts(balance->emitted)},
                  {"absorbed", watts(balance->absorbed)},
                  {"environment", watts(balance->environment)},
                  {"lost", watts(balance->lost)}}}});
    return report;
}

Report light_report(const LoadedScene& loaded, const Solution& solution) {
    const Scene& scene = loaded.scene;
    const std::vector<double> weights = flux_weights(scene);
    const std::vector<GroupLight> all =
        group_light(loaded.mesh, patch_values(scene, loaded.mesh), solution, weights);
    const double square_metres = std::pow(scene.unit.value_or(1.0), 2.0);
    const std::string power = scene.photometric ? " lm" : " W";
    const std::string flux = " " + flux_density_unit(scene);
    Table table({"group", "area m²", "exitance" + flux, "irradiance " + irradiance_unit(scene),
                 "radiosity" + flux, "min", "max", "in" + power, "out" + power});
    Json json = Json::array();
    const auto add = [&](const std::string& name, const GroupLight& light) {
        table.add({name, number_text(square_metres * light.area), value_text(light.exitance),
                   value_text(light.irradiance), value_text(light.radiosity), value_text(light.least),
                   value_text(light.most), value_text(square_metres * light.received),
                   number_text(square_metres * light.leaving)});
    };
    const auto& names = loaded.mesh.groups();
    const std::vector<bool> shown = groups_to_show(all);
    for (std::size_t g = 0; g < names.size(); ++g) {
        const GroupLight& light = all[g];
        json.push_back({{"group", names[g]},
                        {"area", square_metres * light.area},
                        {"exitance", value_json(light.exitance)},
                        {"irradiance", value_json(light.irradiance)},
                        {"radiosity", value_json(light.radiosity)},
                        {"min", value_json(light.least)},
                        {"max", value_json(light.most)},
                        {"in", value_json(square_metres * light.received)},
                        {"out", square_metres * light.leaving}});
        if (shown[g]) {
            add(names[g], light);
        }
    }
    add("(all)", all.back());
    Report report;
    report.text = table.text();
    if (const auto left = std::count(shown.begin(), shown.end(), false); left > 0) {
        report.text +=
            fmt::format("{} with less light {} not listed; --json has all\n",
                        plural(static_cast<std::size_t>(left), "group", "groups"), left == 1 ? "is" : "are");
    }
    if (scene.channels.size() > 1) {
        const bool luminance =
            std::any_of(weights.begin(), weights.end(), [](double weight) { return weight != 1.0; });
        report.text += fmt::format("values are sums over {}{}\n", fmt::join(scene.channels, ", "),
                                   luminance ? ", by their shares of luminance" : "");
    }
    report.text += "\n";
    report.json = {{"light", std::move(json)}, {"weights", weights}};
    return report;
}

Report solve_report(const LoadedScene& loaded, const FormFactors& factors, const Report& rows,
                    const Solution& solution, const std::optional<LightBalance>& balance,
                    const Seconds& seconds, ErrorOf error_of, bool in_full) {
    Report report = scene_size_report(loaded);
    report.add(rows);
    report.add(repair_report(factors, seconds["repair"]));
    report.add(solution_report(solution, loaded.mesh, error_of));
    report.add(light_balance_report(balance, loaded.scene.unit.value_or(1.0),
                                    loaded.scene.photometric ? " lm" : ""));
    report.json["photometric"] = loaded.scene.photometric;
    report.add(seconds.report());
    const Report light = light_report(loaded, solution);
    if (!in_full) {
        report.text = chosen_report(solution.chosen_for).text + brief_error(solution, loaded.mesh, error_of) +
                      light_balance_report(balance, loaded.scene.unit.value_or(1.0),
                                           loaded.scene.photometric ? " lm" : "")
                          .text +
                      seconds.report().text;
    }
    report.text = light.text + report.text;
    report.json.update(light.json);
    report.json.update(group_means_json(loaded, factors.matrix, solution));
    report.json["reciprocity"] =
        factors.matrix.all_known() && factors.matrix.clusters() == nullptr
            ? reciprocity_json(factors.repair->reciprocity_after, factors.parts.patch_of)
            : Json(nullptr);
    report.select("hemi/solve/1",
                  {"renderer",       "patches",  "parts",       "channels", "groups",     "areas",
                   "radiosity",      "exitance", "environment", "blocked",  "light",      "weights",
                   "solver",         "row_sum",  "reciprocity", "repair",   "chosen_for", "error",
                   "error_estimate", "balance",  "photometric", "seconds",  "clusters"});
    return report;
}

void report_lost_light(const std::optional<LightBalance>& balance, const std::vector<std::string>& groups,
                       const Terminal& terminal) {
    constexpr double worth_a_warning = 1e-3;
    if (!balance || balance->lost_share() <= worth_a_warning) {
        return;
    }
    std::vector<std::size_t> order(groups.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const std::vector<double>& lost = balance->lost_of_group;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return lost[a] > lost[b]; });
    std::string worst;
    for (std::size_t k = 0; k < std::min<std::size_t>(3, order.size()) && lost[order[k]] > 0.0; ++k) {
        worst += fmt::format("{}{} ({:.2g} %)", k == 0 ? "" : ", ", groups[order[k]],
                             100.0 * lost[order[k]] / balance->incoming);
    }
    terminal.warn(
        fmt::format("{:.2g} % of the light is lost: it meets backs of one-sided surfaces, or leaves what is "
                    "buried; most of what leaves {}. `hemi check` says where; \"two_sided\", or "
                    "--two-sided GROUP, makes backs reflect",
                    100.0 * balance->lost_share(), worst));
}

void report_savings(const LoadedScene& loaded, const FormFactors& factors, const Solution& solution,
                    bool merge_lattices, const Terminal& terminal) {
    if (!terminal.verbose()) {
        return;
    }
    if (!factors.work.from_file) {
        const bool more = has_cut_patches(loaded.mesh); // or fewer
        terminal.detail(fmt::format("rows computed: {}{}", count_text(factors.work.rows),
                                    more ? std::string()
                                         : fmt::format(" of {} (patches from which no light comes need none)",
                                                       count_text(loaded.mesh.size()))));
    }
    terminal.detail(fmt::format("channels solved: {} of {}{}", solution.channels_solved, solution.channels,
                                solution.channels_solved < solution.channels ? " (all are equal)" : ""));
    if (factors.work.hemicubes > 0) {
        terminal.detail(fmt::format("polygons drawn: {} for {}",
                                    count_text(count_draw_polygons(loaded.mesh, merge_lattices)),
                                    plural(loaded.mesh.surfaces().size(), "surface", "surfaces")));
    }
}

} // namespace hemi::cli
