#include "hemi/core/ranks.hpp"
#include "solver/radiosity_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace hemi {

namespace {

/// What a sweep changed.
struct Change {
    double relative = 0.0; ///< the worst channel's ||B_new - B_old|| / ||E'||
    bool rounding = true;  ///< in no channel more than the rounding of B
};

/// Rows that a rank multiplies, where ranks share them.
struct RowShare {
    std::uint32_t first;
    std::uint32_t end;

    /// @param divided  else all rows are its own
    RowShare(std::uint32_t size, bool divided) : first(0), end(size), divided_(divided) {
        if (divided) {
            first = begin_of(ranks().rank(), size);
            end = begin_of(ranks().rank() + 1, size);
        }
    }

    /// Gives all ranks the values of all rows.
    void exchange(std::span<double> values, std::size_t of_row) const {
        if (divided_) { // also of a rank that has all of them, or none
            const auto own = values.subspan(first * of_row, (end - first) * of_row);
            const std::vector<double> all = gather_values(ranks(), std::span<const double>(own));
            std::copy(all.begin(), all.end(), values.begin());
        }
    }

private:
    bool divided_;

    static std::uint32_t begin_of(std::uint32_t rank, std::uint32_t size) {
        return static_cast<std::uint32_t>(begin_of_share(ranks(), rank, size));
    }
};

class Sweeper {
public:
    explicit Sweeper(const RadiositySystem& system) : system_(system), sums_(system.source().stride()) {}

    /// One sweep over all rows: reads `read`, writes `written` (the same field for Gauss–Seidel, which goes
    /// from row to row and cannot be shared out).
    Change sweep(ChannelField& read, ChannelField& written) {
        fill_clusters(read, system_.factors()); // as they were before the sweep
        const std::uint32_t channels = system_.channels();
        std::vector<double> squares(channels, 0.0);
        std::vector<double> value_squares(channels, 0.0);
        std::vector<double> old(channels);
        const auto tally = [&](const double* before, const double* after) {
            for (std::uint32_t c = 0; c < channels; ++c) {
                const double change = after[c] - before[c];
                squares[c] += change * change;
                value_squares[c] += after[c] * after[c];
            }
        };
        const bool divided = ranks().size() > 1 && &read != &written;
        const RowShare share(system_.size(), divided);
        for (std::uint32_t i = share.first; i < share.end; ++i) {
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
                new_i[c] = (source[c] + rho[c] * sums_[c]) / (1.0 - rho[c] * system_.self(i));
            }
            if (!divided) {
                tally(old.data(), new_i);
            }
        }
        if (divided) {
            const std::size_t values = std::size_t{system_.size()} * written.stride();
            share.exchange(written.values().first(values), written.stride());
            for (std::uint32_t i = 0; i < system_.size(); ++i) {
                tally(read.patch(i), written.patch(i));
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
        const std::uint32_t channels = system_.channels();
        std::vector<double> gaps(std::size_t{system_.size()} * channels);
        const RowShare share(system_.size(), ranks().size() > 1);
        for (std::uint32_t i = share.first; i < share.end; ++i) {
            row_product(system_.factors().row(i), radiosity, sums_.data());
            const double* const rho = system_.reflectance().patch(i);
            const double* const source = system_.source().patch(i);
            const double* const value = radiosity.patch(i);
            for (std::uint32_t c = 0; c < channels; ++c) {
                const double arriving = sums_[c] + system_.defect(i) * value[c];
                gaps[std::size_t{i} * channels + c] = source[c] - value[c] + rho[c] * arriving;
            }
        }
        share.exchange(gaps, channels);
        std::vector<double> squares(channels, 0.0);
        for (std::size_t k = 0; k < gaps.size(); ++k) {
            squares[k % channels] += gaps[k] * gaps[k];
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
