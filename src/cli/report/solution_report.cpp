#include "cli/report/solution_report.hpp"

#include "cli/report/factor_report.hpp"
#include "hemi/engine/engine.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hemi::cli {

namespace {

std::vector<double> group_areas(const LoadedScene& loaded) {
    std::vector<double> areas(loaded.mesh.groups().size(), 0.0);
    for (std::uint32_t i = 0; i < loaded.mesh.size(); ++i) {
        areas[loaded.group_of[i]] += loaded.mesh.areas()[i];
    }
    return areas;
}

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

} // namespace

std::string solution_summary(const Solution& solution) {
    const bool gradients = solution.method == SolverMethod::conjugate_gradient;
    return summary_line("dominance", fmt::format("{:.6g} (largest reflectance x row sum; converges below 1)",
                                                 solution.dominance)) +
           summary_line("solver", fmt::format("{}, {}, residual {:.3g}", to_word(solution.method),
                                              gradients ? plural(solution.sweeps, "iteration", "iterations")
                                                        : plural(solution.sweeps, "sweep", "sweeps"),
                                              solution.residual)) +
           summary_line("", solution.reason) + chosen_summary(solution.chosen_for) +
           error_summary(solution.factor_error, solution.error);
}

Json solution_json(const LoadedScene& loaded, const FormFactors& factors, const RowSums& sums,
                   const Solution& solution, const Seconds& seconds) {
    const std::uint32_t channels = solution.channels;
    const std::vector<double> areas = group_areas(loaded);
    const RepairReport& repair = *factors.repair;
    return {{"schema", "hemi/solve/1"},
            {"renderer", solution.renderer},
            {"patches", loaded.mesh.size()},
            {"channels", loaded.scene.channels},
            {"groups", loaded.mesh.groups()},
            {"areas", areas},
            {"radiosity", rows_json(group_means(loaded, areas, solution.radiosity, channels), channels)},
            {"exitance", rows_json(group_means(loaded, areas, solution.exitance, channels), channels)},
            {"environment", share_json(loaded, areas, factors.matrix, solution.environment_share)},
            {"blocked", share_json(loaded, areas, factors.matrix, solution.back_face_share)},
            {"solver",
             {{"name", to_word(solution.method)},
              {"sweeps", solution.sweeps},
              {"residual", solution.residual},
              {"why", solution.reason}}},
            {"row_sum", row_sum_json(sums)},
            {"reciprocity",
             factors.matrix.all_known() ? reciprocity_json(repair.reciprocity_after) : Json(nullptr)},
            {"repair", repair_json(repair, seconds.json()["repair"])},
            {"chosen_for", solution.chosen_for.empty() ? Json(nullptr) : Json(solution.chosen_for)},
            {"error_estimate", error_json(solution.factor_error, solution.error)},
            {"seconds", seconds.json()}};
}

void report_savings(const LoadedScene& loaded, const FormFactors& factors, const Solution& solution,
                    bool merge_lattices, const Terminal& terminal) {
    if (!terminal.verbose()) {
        return;
    }
    if (!factors.work.from_file) {
        terminal.detail(fmt::format("rows computed: {} of {} (patches that reflect nothing need none)",
                                    count_text(factors.work.rows), count_text(loaded.mesh.size())));
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
