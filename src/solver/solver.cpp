#include "hemi/solver/solver.hpp"

#include "hemi/core/error.hpp"
#include "hemi/matrix/balance.hpp"
#include "solver/radiosity_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace hemi {

namespace {

void check_sizes(const RadiosityProblem& problem) {
    if (problem.factors == nullptr || problem.channels == 0) {
        throw InvalidArgument("a radiosity problem needs form factors and at least one channel");
    }
    if (!problem.environment.empty() && problem.environment.size() != problem.channels) {
        throw InvalidArgument(fmt::format("{} values of the environment for {} channels",
                                          problem.environment.size(), problem.channels));
    }
    if (!problem.direct.empty() &&
        problem.direct.size() != std::size_t{problem.factors->size()} * problem.channels) {
        throw InvalidArgument(fmt::format("{} direct irradiances for {} patches of {} channels",
                                          problem.direct.size(), problem.factors->size(), problem.channels));
    }
    for (const double value : problem.environment) {
        if (!(value >= 0.0) || !std::isfinite(value)) {
            throw InvalidArgument(
                fmt::format("exitance {} of the environment; it must be finite and not negative", value));
        }
    }
}

void check_values(const RadiosityProblem& problem) {
    const std::uint32_t size = problem.factors->size();
    const std::size_t values = std::size_t{size} * problem.channels;
    if (problem.reflectance.size() != values || problem.exitance.size() != values) {
        throw InvalidArgument(fmt::format("{} reflectances and {} exitances for {} patches of {} channels",
                                          problem.reflectance.size(), problem.exitance.size(), size,
                                          problem.channels));
    }
    for (const double value : problem.direct) {
        if (!(value >= 0.0) || !std::isfinite(value)) {
            throw InvalidArgument(
                fmt::format("direct irradiance {}; it must be finite and not negative", value));
        }
    }
    for (std::size_t k = 0; k < values; ++k) {
        const double reflectance = problem.reflectance[k];
        if (!(reflectance >= 0.0 && reflectance < 1.0)) {
            throw InvalidArgument(fmt::format("patch {}, channel {}: reflectance {}; it must be in [0, 1)",
                                              k / problem.channels, k % problem.channels, reflectance));
        }
        if (!(problem.exitance[k] >= 0.0) || !std::isfinite(problem.exitance[k])) {
            throw InvalidArgument(
                fmt::format("patch {}, channel {}: exitance {}; it must be finite and not negative",
                            k / problem.channels, k % problem.channels, problem.exitance[k]));
        }
        if (reflectance > 0.0 && !problem.factors->known(static_cast<std::uint32_t>(k / problem.channels))) {
            throw InvalidArgument(fmt::format("patch {} reflects, but its row of form factors is unknown",
                                              k / problem.channels));
        }
    }
}

/// A method and a sentence on why it is the one.
struct Choice {
    SolverMethod method;
    std::string reason;
};

std::string pair_text(const Reciprocity& pairs) {
    return fmt::format("F of patches {} and {} differs by {:.3g} after weighting with their areas",
                       pairs.worst_i, pairs.worst_j, pairs.max);
}

/// @throws InvalidArgument if conjugate gradients are asked for and cannot be used
Choice choose(const RadiosityProblem& problem, const SolverSettings& settings, double dominance) {
    // Gauss-Seidel needs some 110 sweeps to 1e-10 there, and ten times as many for every nine that follows.
    constexpr double high_dominance = 0.9;
    const bool asked = settings.method == SolverMethod::conjugate_gradient;
    if (!asked && settings.method != SolverMethod::automatic) {
        return {settings.method, "as asked for"};
    }
    const auto sweeps = [](const std::string& reason) { return Choice{SolverMethod::gauss_seidel, reason}; };
    const std::string dominance_text =
        fmt::format("the largest reflectance times row sum is {:.6g}", dominance);
    if (!asked && dominance <= high_dominance) {
        return sweeps(dominance_text + ": sweeps converge quickly");
    }
    if (problem.areas.empty()) {
        if (asked) {
            throw InvalidArgument("conjugate gradients need the areas of the patches");
        }
        return sweeps(dominance_text + ", but conjugate gradients need areas, which are not known");
    }
    if (problem.factors->clusters() != nullptr) {
        if (asked) {
            throw InvalidArgument(
                "conjugate gradients need reciprocal rows, and those of clusters of sources "
                "are not; use Gauss-Seidel, which does not need them",
                {"clusters", "solver"});
        }
        return sweeps(dominance_text + ", but rows of clusters of sources are not reciprocal, as conjugate "
                                       "gradients need them");
    }
    const Reciprocity pairs = reciprocity(*problem.factors, problem.areas);
    if (is_reciprocal(pairs)) {
        return {SolverMethod::conjugate_gradient,
                asked ? "as asked for"
                      : dominance_text +
                            " and the rows are reciprocal: conjugate gradients converge as quickly as ever"};
    }
    if (asked) {
        throw InvalidArgument(fmt::format("conjugate gradients need reciprocal rows, and {}; repair the rows "
                                          "(closure or reciprocity), or use "
                                          "Gauss-Seidel, which does not need them",
                                          pair_text(pairs)),
                              {"repair", "solver"});
    }
    return sweeps(fmt::format("{}, but the rows are not reciprocal, as conjugate gradients need them ({})",
                              dominance_text, pair_text(pairs)));
}

} // namespace

Solution solve_radiosity(const RadiosityProblem& problem, const SolverSettings& settings) {
    check_sizes(problem);
    check_values(problem);
    if (!(settings.tolerance > 0.0) || !std::isfinite(settings.tolerance)) {
        throw InvalidArgument(fmt::format("tolerance {}; it must be finite and above 0", settings.tolerance));
    }
    if (!settings.start.empty() && settings.start.size() != problem.exitance.size()) {
        throw InvalidArgument(fmt::format("{} radiosities to begin with for {} patches of {} channels",
                                          settings.start.size(), problem.factors->size(), problem.channels));
    }
    for (const double value : settings.start) {
        if (!(value >= 0.0) || !std::isfinite(value)) {
            throw InvalidArgument(
                fmt::format("radiosity {} to begin with; it must be finite and not negative", value));
        }
    }
    const RadiositySystem system(problem);
    Solution solution;
    solution.channels = problem.channels;
    solution.channels_solved = problem.channels;
    solution.dominance = system.dominance();
    Choice choice = choose(problem, settings, solution.dominance);
    solution.method = choice.method;
    solution.reason = std::move(choice.reason);
    const SolverRun run{settings, solution};
    solution.radiosity = system.unscaled(solution.method == SolverMethod::conjugate_gradient
                                             ? solve_by_conjugate_gradients(system, problem.areas, run)
                                             : solve_by_sweeps(system, run));
    return solution;
}

std::vector<double> irradiance(const RadiosityProblem& problem, std::span<const double> radiosity) {
    check_sizes(problem);
    const FormFactorMatrix& factors = *problem.factors;
    const std::uint32_t channels = problem.channels;
    if (radiosity.size() != std::size_t{factors.size()} * channels) {
        throw InvalidArgument(fmt::format("{} radiosities for {} patches of {} channels", radiosity.size(),
                                          factors.size(), channels));
    }
    ChannelField field(factors.size(), channels);
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        std::copy_n(radiosity.data() + std::size_t{i} * channels, channels, field.patch(i));
    }
    field = with_clusters(std::move(field), factors);
    std::vector<double> sums(field.stride());
    std::vector<double> result;
    result.reserve(radiosity.size());
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        row_product(row, field, sums.data());
        const double defect =
            factors.known(i) ? balance_row(row.sum(), row.environment, row.blocked).defect : 0.0;
        for (std::uint32_t c = 0; c < channels; ++c) {
            const double bright = problem.environment.empty() ? 0.0 : problem.environment[c];
            const double direct =
                problem.direct.empty() ? 0.0 : problem.direct[std::size_t{i} * channels + c];
            result.push_back(sums[c] + defect * field.patch(i)[c] + row.environment * bright + direct);
        }
    }
    return result;
}

} // namespace hemi
