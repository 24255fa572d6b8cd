#include "hemi/solver/solver.hpp"

#include "hemi/core/error.hpp"
#include "solver/row_product.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace hemi {

namespace {

// ---- What the caller gave ---------------------------------------------------------------------------------

void check_sizes(const RadiosityProblem& problem) {
    if (problem.factors == nullptr || problem.channels == 0) {
        throw InvalidArgument("a radiosity problem needs form factors and at least one channel");
    }
    if (!problem.environment.empty() && problem.environment.size() != problem.channels) {
        throw InvalidArgument(fmt::format("{} values of the environment for {} channels",
                                          problem.environment.size(), problem.channels));
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

double environment_exitance(const RadiosityProblem& problem, std::uint32_t channel) {
    return problem.environment.empty() ? 0.0 : problem.environment[channel];
}

// ---- Sweeps -----------------------------------------------------------------------------------------------

/// What a sweep changed.
struct Change {
    double relative = 0.0; ///< the worst channel's ||B_new - B_old|| / ||E'||
    bool rounding = true;  ///< in no channel more than the rounding of B
};

/// (I - rho F) B = E' in the layout of the sweeps, and the sweeps themselves.
class RadiositySystem {
public:
    explicit RadiositySystem(const RadiosityProblem& problem)
        : factors_(*problem.factors), channels_(problem.channels),
          reflectance_(factors_.size(), problem.channels), source_(factors_.size(), problem.channels),
          self_(factors_.size(), 0.0), exponent_(problem.channels, 0), source_norm_(problem.channels, 0.0),
          sums_(source_.stride()) {
        for (std::uint32_t i = 0; i < factors_.size(); ++i) {
            add_row(problem, i);
        }
        for (std::uint32_t c = 0; c < channels_; ++c) {
            scale_channel(c);
        }
    }

    [[nodiscard]] const ChannelField& source() const { return source_; }
    [[nodiscard]] double dominance() const { return dominance_; }

    /// Values of the sweeps in the caller's units and layout.
    [[nodiscard]] std::vector<double> unscaled(const ChannelField& field) const {
        std::vector<double> values;
        values.reserve(std::size_t{factors_.size()} * channels_);
        for (std::uint32_t i = 0; i < factors_.size(); ++i) {
            for (std::uint32_t c = 0; c < channels_; ++c) {
                values.push_back(std::ldexp(field.patch(i)[c], exponent_[c]));
            }
        }
        return values;
    }

    /// One sweep over all rows: reads `read`, writes `written` (the same field for Gauss–Seidel).
    Change sweep(ChannelField& read, ChannelField& written) {
        std::vector<double> squares(channels_, 0.0);
        std::vector<double> value_squares(channels_, 0.0);
        std::vector<double> old(channels_);
        for (std::uint32_t i = 0; i < factors_.size(); ++i) {
            // F(i, i) belongs to the divisor: with B_i = 0 the sum leaves it out without a branch.
            double* const old_i = read.patch(i);
            std::copy_n(old_i, channels_, old.data());
            std::fill_n(old_i, channels_, 0.0);
            row_product(factors_.row(i), read, sums_.data());
            std::copy_n(old.data(), channels_, old_i);

            const double* const rho = reflectance_.patch(i);
            const double* const source = source_.patch(i);
            double* const new_i = written.patch(i);
            for (std::uint32_t c = 0; c < channels_; ++c) {
                const double value = (source[c] + rho[c] * sums_[c]) / (1.0 - rho[c] * self_[i]);
                const double change = value - old[c];
                squares[c] += change * change;
                value_squares[c] += value * value;
                new_i[c] = value;
            }
        }
        Change result{.relative = worst_relative(squares)};
        for (std::uint32_t c = 0; c < channels_; ++c) {
            constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
            result.rounding = result.rounding && squares[c] <= rounding * rounding * value_squares[c];
        }
        return result;
    }

    /// The worst channel's ||E' - (I - rho F) B|| / ||E'||.
    double residual(const ChannelField& radiosity) {
        std::vector<double> squares(channels_, 0.0);
        for (std::uint32_t i = 0; i < factors_.size(); ++i) {
            row_product(factors_.row(i), radiosity, sums_.data());
            const double* const rho = reflectance_.patch(i);
            const double* const source = source_.patch(i);
            const double* const value = radiosity.patch(i);
            for (std::uint32_t c = 0; c < channels_; ++c) {
                const double gap = source[c] - value[c] + rho[c] * sums_[c];
                squares[c] += gap * gap;
            }
        }
        return worst_relative(squares);
    }

private:
    void add_row(const RadiosityProblem& problem, std::uint32_t i) {
        const RowView row = factors_.row(i);
        const double sum = row.sum();
        const auto diagonal = std::lower_bound(row.columns.begin(), row.columns.end(), i);
        if (diagonal != row.columns.end() && *diagonal == i) {
            self_[i] =
                static_cast<double>(row.values[static_cast<std::size_t>(diagonal - row.columns.begin())]);
        }
        for (std::uint32_t c = 0; c < channels_; ++c) {
            const std::size_t k = std::size_t{i} * channels_ + c;
            const double rho = problem.reflectance[k];
            if (rho * self_[i] >= 1.0) {
                throw InvalidArgument(fmt::format("patch {}, channel {}: reflectance {} times F({}, {}) = {} "
                                                  "must be below 1",
                                                  i, c, rho, i, i, self_[i]));
            }
            const double source =
                problem.exitance[k] + rho * row.environment * environment_exitance(problem, c);
            reflectance_.patch(i)[c] = rho;
            source_.patch(i)[c] = source;
            dominance_ = std::max(dominance_, rho * sum);
        }
    }

    // Sources of any magnitude, without overflow or underflow in the squares: a power of two changes no bit.
    void scale_channel(std::uint32_t c) {
        double largest = 0.0;
        for (std::uint32_t i = 0; i < factors_.size(); ++i) {
            largest = std::max(largest, source_.patch(i)[c]);
        }
        if (largest == 0.0) {
            return;
        }
        exponent_[c] = std::ilogb(largest);
        double squares = 0.0;
        for (std::uint32_t i = 0; i < factors_.size(); ++i) {
            double& source = source_.patch(i)[c];
            source = std::ldexp(source, -exponent_[c]);
            squares += source * source;
        }
        source_norm_[c] = std::sqrt(squares);
    }

    // NaN must come through: std::max would drop it.
    [[nodiscard]] double worst_relative(const std::vector<double>& squares) const {
        double worst = 0.0;
        for (std::uint32_t c = 0; c < channels_; ++c) {
            if (source_norm_[c] == 0.0) {
                continue;
            }
            const double relative = std::sqrt(squares[c]) / source_norm_[c];
            if (!(relative <= worst)) {
                worst = relative;
            }
            if (std::isnan(worst)) {
                break;
            }
        }
        return worst;
    }

    const FormFactorMatrix& factors_;
    std::uint32_t channels_;
    ChannelField reflectance_;
    ChannelField source_;
    std::vector<double> self_; // F(i, i)
    std::vector<int> exponent_;
    std::vector<double> source_norm_;
    std::vector<double> sums_;
    double dominance_ = 0.0;
};

// ---- When to stop -----------------------------------------------------------------------------------------

/// Follows the change per sweep and tells from its decay whether the goal can be reached in time.
class Forecast {
public:
    Forecast(std::uint32_t max_sweeps, double dominance) : max_sweeps_(max_sweeps), dominance_(dominance) {}

    /// @return whether it is hopeless: window after window the rate of the last one says that `goal` is
    ///   farther away than the sweeps that are left.
    bool hopeless(std::uint32_t sweep, double change, double goal) {
        smallest_ = std::min(smallest_, change);
        if (sweep % window != 0) {
            return false;
        }
        const double before = std::exchange(smallest_before_, smallest_);
        smallest_ = std::numeric_limits<double>::infinity();
        contraction_ = std::pow(smallest_before_ / before, 1.0 / window);
        if (contraction_ < 1.0) {
            needed_ = sweep + std::log(goal / smallest_before_) / std::log(contraction_);
            bad_windows_ = needed_ <= slack * max_sweeps_ ? 0 : bad_windows_ + 1;
        } else if (dominance_ >= 1.0) {
            ++bad_windows_; // with a dominance below 1 growth is passing
        }
        return bad_windows_ >= patience;
    }

    /// Factor by which the change shrinks a sweep.
    [[nodiscard]] double contraction() const { return contraction_; }
    /// Sweeps that would be needed in all.
    [[nodiscard]] double needed() const { return needed_; }

private:
    static constexpr std::uint32_t window = 64;
    static constexpr int patience = 3;
    static constexpr double slack = 1.25;

    std::uint32_t max_sweeps_;
    double dominance_;
    double smallest_ = std::numeric_limits<double>::infinity();        // in this window
    double smallest_before_ = std::numeric_limits<double>::infinity(); // in the one before
    double contraction_ = 0.0;
    double needed_ = 0.0;
    int bad_windows_ = 0;
};

const char* method_name(SolverMethod method) {
    return method == SolverMethod::jacobi ? "Jacobi" : "Gauss-Seidel";
}

std::string advice(double dominance) {
    if (dominance >= 1.0) {
        return "at 1 or above the sweeps need not converge: check the row sums (a row sum above 1 makes "
               "energy), "
               "repair the rows or lower the reflectance";
    }
    return "the nearer to 1, the more sweeps: a larger tolerance, more sweeps or a lower reflectance help";
}

} // namespace

RadiositySolution solve_radiosity(const RadiosityProblem& problem, const SolverSettings& settings,
                                  const SweepCallback& callback) {
    check_sizes(problem);
    check_values(problem);
    if (!(settings.tolerance > 0.0) || !std::isfinite(settings.tolerance)) {
        throw InvalidArgument(fmt::format("tolerance {}; it must be finite and above 0", settings.tolerance));
    }

    RadiositySystem system(problem);
    ChannelField radiosity = system.source();
    const bool jacobi = settings.method == SolverMethod::jacobi;
    ChannelField previous = jacobi ? radiosity : ChannelField(0, problem.channels);

    RadiositySolution solution;
    solution.dominance = system.dominance();
    const auto fail = [&](const std::string& reason) {
        throw NotConverged(
            fmt::format("{}: residual {:.3g} after {} sweeps, above the tolerance {:.3g}: {}; the "
                        "largest reflectance times row sum is {:.9g} ({})",
                        method_name(settings.method), solution.residual, solution.sweeps, settings.tolerance,
                        reason, solution.dominance, advice(solution.dominance)));
    };

    Forecast forecast(settings.max_sweeps, solution.dominance);
    // The exact residual costs as much as a sweep, so it is looked at only when the change is small enough.
    double goal = settings.tolerance;
    bool converged = false;
    while (!converged && solution.sweeps < settings.max_sweeps) {
        if (jacobi) {
            std::swap(previous, radiosity);
        }
        const Change change = system.sweep(jacobi ? previous : radiosity, radiosity);
        ++solution.sweeps;
        if (!std::isfinite(change.relative)) {
            solution.residual = change.relative;
            fail("the values are no longer finite");
        }
        if (callback && !callback(solution.sweeps, change.relative)) {
            throw Cancelled();
        }
        const bool hopeless = forecast.hopeless(solution.sweeps, change.relative, goal);
        if (change.relative > goal && !change.rounding && !hopeless) {
            continue;
        }
        solution.residual = system.residual(radiosity);
        converged = solution.residual <= settings.tolerance;
        if (!converged && change.rounding) {
            fail("rounding keeps it there");
        }
        if (!converged && hopeless && forecast.contraction() >= 1.0) {
            fail("it does not shrink");
        }
        if (!converged && hopeless) {
            fail(fmt::format(
                "it shrinks by a factor of only {:.9g} a sweep, about {:.2g} sweeps would be needed "
                "and {} are allowed",
                forecast.contraction(), forecast.needed(), settings.max_sweeps));
        }
        goal = change.relative * std::clamp(settings.tolerance / solution.residual, 0.01, 0.5);
    }
    if (!converged) {
        solution.residual = system.residual(radiosity);
        if (!(solution.residual <= settings.tolerance)) {
            fail("no more sweeps are allowed");
        }
    }

    solution.radiosity = system.unscaled(radiosity);
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
    std::vector<double> sums(field.stride());
    std::vector<double> result;
    result.reserve(radiosity.size());
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        row_product(row, field, sums.data());
        const double known = factors.known(i) ? 1.0 : 0.0;
        for (std::uint32_t c = 0; c < channels; ++c) {
            result.push_back(known * (sums[c] + row.environment * environment_exitance(problem, c)));
        }
    }
    return result;
}

} // namespace hemi
