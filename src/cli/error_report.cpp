#include "cli/error_report.hpp"

#include "hemi/engine/reference_rows.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hemi::cli {

namespace {

constexpr double reference_share = 0.08; // of the time that the rows took

} // namespace

void add_reference(Rows& rows, const LoadedScene& loaded, const RowOptions& options,
                   const Terminal& terminal) {
    std::vector<std::uint32_t> known;
    for (std::uint32_t i = 0; i < rows.file.factors.size(); ++i) {
        if (rows.file.factors.known(i)) {
            known.push_back(i);
        }
    }
    if (known.empty() || !options.estimate || rows.file.reference.entries() > 0) {
        return;
    }
    const Stopwatch watch;
    const HemicubeSettings settings = plan_rows(options, loaded.mesh.size()).hemicube;
    const auto patches = reference_patches(known, reference_count(settings, known.size(), reference_share));
    const auto engine = make_visibility(loaded.mesh, reference_settings(settings), options);
    rows.file.reference = compute_reference(*engine, loaded.mesh, patches);
    rows.reference_seconds = watch.seconds();
    terminal.detail(fmt::format("error estimate: {} compared with better ones in {}",
                                plural(patches.size(), "row", "rows"), seconds_text(rows.reference_seconds)));
}

void estimate_rows(io::FactorFile& file) {
    file.error.reset();
    if (file.reference.size() == file.factors.size() && file.reference.entries() > 0) {
        file.error = estimate_factor_error(file.factors, file.reference);
    }
}

std::optional<RadiosityErrorEstimate> estimate_solution(const LoadedScene& loaded, const io::FactorFile& file,
                                                        const Solution& solution) {
    if (!file.error) {
        return {};
    }
    return estimate_radiosity_error(file.factors, file.reference, loaded.mesh.areas(), solution.channels,
                                    patch_reflectance(loaded.scene, loaded.mesh), solution.exitance,
                                    solution.radiosity);
}

std::string chosen_summary(const std::string& chosen_for) {
    return chosen_for.empty() ? "" : summary_line("chosen", chosen_for);
}

std::string error_summary(const std::optional<FactorErrorEstimate>& factors,
                          const std::optional<RadiosityErrorEstimate>& radiosity) {
    if (!factors) {
        return "";
    }
    std::string text = summary_line(
        "error", fmt::format("estimated from {}: a factor is off by {:.2g} (rms), {:.2g} at most",
                             plural(factors->sampled, "row", "rows"), factors->rms, factors->max));
    std::string rows = fmt::format("a row by {:.2g} (root of its sum of squares; rms), {:.2g} at most",
                                   factors->row_rms, factors->row_max);
    text += summary_line("", rows);
    if (radiosity) {
        text += summary_line("", fmt::format("what is reflected by {:.2g} of itself (rms)", radiosity->rms));
    }
    return text;
}

Json error_json(const std::optional<FactorErrorEstimate>& factors,
                const std::optional<RadiosityErrorEstimate>& radiosity) {
    if (!factors) {
        return nullptr;
    }
    Json json{{"rows_compared", factors->sampled},
              {"factor", {{"rms", factors->rms}, {"max", factors->max}}},
              {"row", {{"rms", factors->row_rms}, {"max", factors->row_max}}}};
    if (radiosity) {
        json["radiosity"] = {{"rms", radiosity->rms}};
    }
    return json;
}

} // namespace hemi::cli
