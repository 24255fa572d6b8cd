#include "solver/radiosity_system.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hemi {

RadiositySystem::RadiositySystem(const RadiosityProblem& problem)
    : factors_(*problem.factors), channels_(problem.channels),
      reflectance_(factors_.size(), problem.channels), source_(factors_.size(), problem.channels),
      self_(factors_.size(), 0.0), defect_(factors_.size(), 0.0), exponent_(problem.channels, 0),
      source_norm_(problem.channels, 0.0) {
    for (std::uint32_t i = 0; i < factors_.size(); ++i) {
        add_row(problem, i);
    }
    for (std::uint32_t c = 0; c < channels_; ++c) {
        scale_channel(c);
    }
}

void RadiositySystem::add_row(const RadiosityProblem& problem, std::uint32_t i) {
    const RowView row = factors_.row(i);
    RowBalance balance{.lost = 1.0};
    if (factors_.known(i)) {
        balance = balance_row(row.sum(), row.environment, row.blocked);
    }
    defect_[i] = balance.defect;
    self_[i] = diagonal_of(row, i) + balance.defect;
    for (std::uint32_t c = 0; c < channels_; ++c) {
        const std::size_t k = std::size_t{i} * channels_ + c;
        const double rho = problem.reflectance[k];
        if (rho * self_[i] >= 1.0) {
            throw InvalidArgument(fmt::format("patch {}, channel {}: reflectance {} times F({}, {}) = {} "
                                              "must be below 1",
                                              i, c, rho, i, i, self_[i]));
        }
        const double bright = problem.environment.empty() ? 0.0 : problem.environment[c];
        reflectance_.patch(i)[c] = rho;
        const double direct = problem.direct.empty() ? 0.0 : problem.direct[k];
        source_.patch(i)[c] = problem.exitance[k] + rho * (row.environment * bright + direct);
        dominance_ = std::max(dominance_, rho * (1.0 - balance.lost));
    }
}

void RadiositySystem::scale_channel(std::uint32_t c) {
    double largest = 0.0;
    for (std::uint32_t i = 0; i < size(); ++i) {
        largest = std::max(largest, source_.patch(i)[c]);
    }
    if (largest == 0.0) {
        return;
    }
    exponent_[c] = std::ilogb(largest);
    double squares = 0.0;
    for (std::uint32_t i = 0; i < size(); ++i) {
        double& source = source_.patch(i)[c];
        source = std::ldexp(source, -exponent_[c]);
        squares += source * source;
    }
    source_norm_[c] = std::sqrt(squares);
}

double RadiositySystem::relative(double squares, std::uint32_t c) const {
    return source_norm_[c] == 0.0 ? 0.0 : std::sqrt(squares) / source_norm_[c];
}

double RadiositySystem::worst_relative(const std::vector<double>& squares) const {
    double worst = 0.0;
    for (std::uint32_t c = 0; c < channels_; ++c) {
        const double of_channel = relative(squares[c], c);
        if (!(of_channel <= worst)) { // std::max would drop NaN
            worst = of_channel;
        }
        if (std::isnan(worst)) {
            break;
        }
    }
    return worst;
}

ChannelField RadiositySystem::scaled(std::span<const double> values) const {
    ChannelField field(size(), channels_);
    for (std::uint32_t i = 0; i < size(); ++i) {
        for (std::uint32_t c = 0; c < channels_; ++c) {
            if (source_norm_[c] > 0.0) {
                field.patch(i)[c] = std::ldexp(values[std::size_t{i} * channels_ + c], -exponent_[c]);
            }
        }
    }
    return field;
}

std::vector<double> RadiositySystem::unscaled(const ChannelField& field) const {
    std::vector<double> values;
    values.reserve(std::size_t{size()} * channels_);
    for (std::uint32_t i = 0; i < size(); ++i) {
        for (std::uint32_t c = 0; c < channels_; ++c) {
            values.push_back(std::ldexp(field.patch(i)[c], exponent_[c]));
        }
    }
    return values;
}

void SolverRun::count(double residual, const std::function<std::vector<double>()>& radiosity) const {
    ++solution.sweeps;
    if (!std::isfinite(residual)) {
        solution.residual = residual;
        fail("the values are no longer finite");
    }
    if (settings.watch && !settings.watch(solution.sweeps, residual, radiosity)) {
        throw Cancelled();
    }
}

void SolverRun::fail(const std::string& reason) const {
    const bool gradients = solution.method == SolverMethod::conjugate_gradient;
    const char* const name = gradients                                 ? "conjugate gradients"
                             : solution.method == SolverMethod::jacobi ? "Jacobi"
                                                                       : "Gauss-Seidel";
    std::string advice = "the nearer to 1, the more sweeps: a larger tolerance, more sweeps, a lower "
                         "reflectance or conjugate gradients help";
    if (solution.dominance >= 1.0) {
        advice = "at 1 or above there need not be a solution: check the row sums (a row sum above 1 makes "
                 "energy), repair the rows or lower the reflectance";
    } else if (gradients) {
        advice = "a larger tolerance or a lower reflectance help";
    }
    throw NotConverged(fmt::format("{}: residual {:.3g} after {} {}, above the tolerance {:.3g}: {}; the "
                                   "largest reflectance times row sum is {:.9g} ({})",
                                   name, solution.residual, solution.sweeps,
                                   gradients ? "iterations" : "sweeps", settings.tolerance, reason,
                                   solution.dominance, advice));
}

} // namespace hemi
