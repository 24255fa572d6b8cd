#include "solver/radiosity_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hemi {

namespace {

/// What a sweep changed.
struct Change {
    double relative = 0.0; ///< the worst channel's ||B_new - B_old|| / ||E'||
    bool rounding = true;  ///< in no channel more than the rounding of B
};

class Sweeper {
public:
    explicit Sweeper(const RadiositySystem& system) : system_(system), sums_(system.source().stride()) {}

    /// One sweep over all rows: reads `read`, writes `written` (the same field for Gauss–Seidel).
    Change sweep(ChannelField& read, ChannelField& written) {
        fill_clusters(read, system_.factors()); // as they were before the sweep
        const std::uint32_t channels = system_.channels();
        std::vector<double> squares(channels, 0.0);
        std::vector<double> value_squares(channels, 0.0);
        std::vector<double> old(channels);
        for (std::uint32_t i = 0; i < system_.size(); ++i) {
            // F(i, i) belongs to the divisor: with B_i = 0 the sum leaves it out without a branch.
            double* const old_i = read.patch(i);
            std::copy_n(old_i, channels, old.data());
            std::fill_n(old_i, channels, 0.0);
            row_product(system_.factors().row(i), read, sums_.data());
            std::copy_n(old.data(), channels, old_i);

            const double* const rho = system_.reflectance().patch(i);
            const double* const source = system_.source().patch(i);
            double* const new_i = written.patch(i);
            for (std::uint32_t c = 0; c < channels; ++c) {
                const double value = (source[c] + rho[c] * sums_[c]) / (1.0 - rho[c] * system_.self(i));
                const double change = value - old[c];
                squares[c] += change * change;
                value_squares[c] += value * value;
                new_i[c] = value;
            }
        }
        Change result{.relative = system_.worst_relative(squares)};
        for (std::uint32_t c = 0; c < channels; ++c) {
            constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
            result.rounding = result.rounding && squares[c] <= rounding * rounding * value_squares[c];
        }
        return result;
    }

    /// The worst channel's ||E' - (I - rho F) B|| / ||E'||.
    double residual(ChannelField& radiosity) {
        fill_clusters(radiosity, system_.factors());
        std::vector<double> squares(system_.channels(), 0.0);
        for (std::uint32_t i = 0; i < system_.size(); ++i) {
            row_product(system_.factors().row(i), radiosity, sums_.data());
            const double* const rho = system_.reflectance().patch(i);
            const double* const source = system_.source().patch(i);
            const double* const value = radiosity.patch(i);
            for (std::uint32_t c = 0; c < system_.channels(); ++c) {
                const double arriving = sums_[c] + system_.defect(i) * value[c];
                const double gap = source[c] - value[c] + rho[c] * arriving;
                squares[c] += gap * gap;
            }
        }
        return system_.worst_relative(squares);
    }

private:
    const RadiositySystem& system_;
    std::vector<double> sums_;
};

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

} // namespace

ChannelField solve_by_sweeps(const RadiositySystem& system, const SolverRun& run) {
    const SolverSettings& settings = run.settings;
    Solution& solution = run.solution;
    Sweeper sweeper(system);
    ChannelField radiosity = with_clusters(
        settings.start.empty() ? system.source() : system.scaled(settings.start), system.factors());
    const bool jacobi = solution.method == SolverMethod::jacobi;
    ChannelField previous = jacobi ? radiosity : ChannelField(0, system.channels());

    Forecast forecast(settings.max_sweeps, solution.dominance);
    // The exact residual costs as much as a sweep, so it is looked at only when the change is small enough.
    double goal = settings.tolerance;
    bool converged = false;
    while (!converged && solution.sweeps < settings.max_sweeps) {
        if (jacobi) {
            std::swap(previous, radiosity);
        }
        const Change change = sweeper.sweep(jacobi ? previous : radiosity, radiosity);
        run.count(change.relative, [&] { return system.unscaled(radiosity); });
        const bool hopeless = forecast.hopeless(solution.sweeps, change.relative, goal);
        if (change.relative > goal && !change.rounding && !hopeless) {
            continue;
        }
        solution.residual = sweeper.residual(radiosity);
        converged = solution.residual <= settings.tolerance;
        if (!converged && change.rounding) {
            run.fail("rounding keeps it there");
        }
        if (!converged && hopeless && forecast.contraction() >= 1.0) {
            run.fail("it does not shrink");
        }
        if (!converged && hopeless) {
            run.fail(fmt::format(
                "it shrinks by a factor of only {:.9g} a sweep, about {:.2g} sweeps would be needed "
                "and {} are allowed",
                forecast.contraction(), forecast.needed(), settings.max_sweeps));
        }
        goal = change.relative * std::clamp(settings.tolerance / solution.residual, 0.01, 0.5);
    }
    if (!converged) {
        solution.residual = sweeper.residual(radiosity);
        if (!(solution.residual <= settings.tolerance)) {
            run.fail("no more sweeps are allowed");
        }
    }
    return radiosity;
}

} // namespace hemi
