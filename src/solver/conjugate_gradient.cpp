#include "matrix/exchange_product.hpp"
#include "solver/radiosity_system.hpp"

#include <algorithm>

namespace hemi {

namespace {

/// Conjugate gradients for the irradiance h = F B of the patches that reflect, B = E' + R h:
///   R (A - X R) h = R X E',  X = A F,
/// symmetric, and positive definite where rows times reflectance stay below 1; a patch without reflectance
/// has the equation 0 = 0 and h = 0. With the diagonal as preconditioner this is the usual form
/// I - R^1/2 A^-1/2 X A^-1/2 R^1/2 without its roots. The residual per area is the residual of
/// B = E' + R F B.
class GradientSolver {
public:
    GradientSolver(const RadiositySystem& system, std::span<const double> areas)
        : system_(system), areas_(areas), stride_(system.source().stride()),
          exchange_(system.factors(), areas, stride_), self_(system.size(), 0.0), lost_(system.size(), 1.0),
          arriving_(system.size(), system.channels()), irradiance_(system.size(), system.channels()),
          residual_(system.size(), system.channels()), direction_(system.size(), system.channels()),
          product_(system.size(), system.channels()), preconditioned_squares_(system.channels(), 0.0),
          residual_squares_(system.channels(), 0.0), done_(system.channels(), false) {
        balance_rows();
    }

    /// Steps until the recurrence says `goal`, or `most` are done.
    void iterate(double goal, const SolverRun& run) {
        bool first = true;
        double relative = relative_residual();
        do {
            // A channel that is done waits for the others; further steps would end in denormal numbers.
            for (std::uint32_t c = 0; c < system_.channels(); ++c) {
                done_[c] = (!first && done_[c]) || system_.relative(residual_squares_[c], c) <= goal;
            }
            step(first, run);
            first = false;
            relative = relative_residual();
            run.count(relative, [this] { return system_.unscaled(radiosity()); });
        } while (relative > goal && run.solution.sweeps < run.settings.max_sweeps);
    }

    /// B = E' + R h.
    [[nodiscard]] ChannelField radiosity() const {
        ChannelField field = system_.source();
        for (std::uint32_t i = 0; i < system_.size(); ++i) {
            for (std::uint32_t c = 0; c < system_.channels(); ++c) {
                field.patch(i)[c] += system_.reflectance().patch(i)[c] * irradiance_.patch(i)[c];
            }
        }
        return field;
    }

    /// Finds the residual afresh. What all patches have in common is taken out of the sums, whose rounding
    /// would be of the size of B: of a constant c the equation leaves c (1 - rho + rho·lost).
    double renew_residual() {
        ChannelField deviation = radiosity();
        const std::vector<double> common = means(deviation);
        for (std::uint32_t i = 0; i < system_.size(); ++i) {
            for (std::uint32_t c = 0; c < system_.channels(); ++c) {
                deviation.patch(i)[c] -= common[c];
            }
        }
        exchange_.apply(self_, deviation.values(), arriving_.values(), true);
        for (std::uint32_t i = 0; i < system_.size(); ++i) {
            for (std::uint32_t c = 0; c < system_.channels(); ++c) {
                const double rho = system_.reflectance().patch(i)[c];
                const double value = deviation.patch(i)[c];
                const double leaving = common[c] * (1.0 - rho + rho * lost_[i]);
                residual_.patch(i)[c] = areas_[i] * (system_.source().patch(i)[c] - leaving - value) +
                                        rho * arriving_.patch(i)[c];
                if (rho == 0.0) {
                    residual_.patch(i)[c] = 0.0;
                }
            }
        }
        return relative_residual();
    }

private:
    /// The rows' sums as the pairs make them, and so their defects.
    void balance_rows() {
        ChannelField ones(system_.size(), system_.channels());
        for (std::uint32_t i = 0; i < system_.size(); ++i) {
            std::fill_n(ones.patch(i), stride_, 1.0);
        }
        exchange_.apply(self_, ones.values(), arriving_.values(), true);
        for (std::uint32_t i = 0; i < system_.size(); ++i) {
            if (system_.factors().known(i)) {
                const RowView row = system_.factors().row(i);
                const double diagonal = diagonal_of(row, i);
                const RowBalance balance =
                    balance_row(arriving_.patch(i)[0] / areas_[i] + diagonal, row.environment, row.blocked);
                self_[i] = diagonal + balance.defect;
                lost_[i] = balance.lost;
            }
        }
    }

    void step(bool first, const SolverRun& run) {
        const std::uint32_t channels = system_.channels();
        std::vector<double> squares(channels, 0.0);
        for_reflecting([&](std::uint32_t i, std::uint32_t c, double diagonal) {
            squares[c] += residual_.patch(i)[c] * residual_.patch(i)[c] / diagonal;
        });
        std::vector<double> beta(channels, 0.0);
        for (std::uint32_t c = 0; c < channels; ++c) {
            beta[c] = first || done_[c] ? 0.0 : squares[c] / preconditioned_squares_[c];
        }
        preconditioned_squares_ = squares;

        ChannelField& scaled = product_; // R p, then the product
        for_reflecting([&](std::uint32_t i, std::uint32_t c, double diagonal) {
            double& p = direction_.patch(i)[c];
            p = residual_.patch(i)[c] / diagonal + beta[c] * p;
            scaled.patch(i)[c] = system_.reflectance().patch(i)[c] * p;
        });
        exchange_.apply(self_, scaled.values(), arriving_.values(), false);
        std::vector<double> curvature(channels, 0.0);
        for_reflecting([&](std::uint32_t i, std::uint32_t c, double) {
            const double rho = system_.reflectance().patch(i)[c];
            const double p = direction_.patch(i)[c];
            const double q = rho * (areas_[i] * p - arriving_.patch(i)[c]);
            arriving_.patch(i)[c] = q;
            curvature[c] += p * q;
        });
        std::vector<double> alpha(channels, 0.0);
        for (std::uint32_t c = 0; c < channels; ++c) {
            if (done_[c]) {
                continue;
            }
            if (!(curvature[c] > 0.0)) {
                run.solution.residual = relative_residual();
                run.fail("the system is not positive definite");
            }
            alpha[c] = squares[c] / curvature[c];
        }
        for_reflecting([&](std::uint32_t i, std::uint32_t c, double) {
            irradiance_.patch(i)[c] += alpha[c] * direction_.patch(i)[c];
            residual_.patch(i)[c] -= alpha[c] * arriving_.patch(i)[c];
        });
    }

    /// Calls `visit(i, c, diagonal of R (A - X R))` where the reflectance is not 0.
    template <class Visit>
    void for_reflecting(const Visit& visit) const {
        for (std::uint32_t i = 0; i < system_.size(); ++i) {
            for (std::uint32_t c = 0; c < system_.channels(); ++c) {
                const double rho = system_.reflectance().patch(i)[c];
                if (rho > 0.0) {
                    visit(i, c, areas_[i] * rho * (1.0 - rho * self_[i]));
                }
            }
        }
    }

    /// The worst channel's, from the residual as it is.
    double relative_residual() {
        std::fill(residual_squares_.begin(), residual_squares_.end(), 0.0);
        for (std::uint32_t i = 0; i < system_.size(); ++i) {
            for (std::uint32_t c = 0; c < system_.channels(); ++c) {
                const double gap = residual_.patch(i)[c] / areas_[i];
                residual_squares_[c] += gap * gap;
            }
        }
        return system_.worst_relative(residual_squares_);
    }

    /// Per channel, over all patches.
    [[nodiscard]] std::vector<double> means(const ChannelField& field) const {
        std::vector<double> sums(system_.channels(), 0.0);
        for (std::uint32_t i = 0; i < system_.size(); ++i) {
            for (std::uint32_t c = 0; c < system_.channels(); ++c) {
                sums[c] += field.patch(i)[c] / system_.size();
            }
        }
        return sums;
    }

    const RadiositySystem& system_;
    std::span<const double> areas_;
    std::size_t stride_;
    ExchangeProduct exchange_;
    std::vector<double> self_; // F(i, i) with the defect of the pairs' sums
    std::vector<double> lost_;
    ChannelField arriving_;
    ChannelField irradiance_;
    ChannelField residual_; // R (X B - A h)
    ChannelField direction_;
    ChannelField product_;
    std::vector<double> preconditioned_squares_; // of the step before
    std::vector<double> residual_squares_;
    std::vector<bool> done_; // per channel
};

} // namespace

ChannelField solve_by_conjugate_gradients(const RadiositySystem& system, std::span<const double> areas,
                                          const SolverRun& run) {
    GradientSolver solver(system, areas);
    Solution& solution = run.solution;
    const double tolerance = run.settings.tolerance;
    solution.residual = solver.renew_residual();
    while (solution.residual > tolerance) {
        if (solution.sweeps >= run.settings.max_sweeps) {
            run.fail("no more iterations are allowed");
        }
        const double before = solution.residual;
        solver.iterate(0.5 * tolerance, run);
        solution.residual = solver.renew_residual();
        if (solution.residual > tolerance && solution.residual > 0.5 * before) {
            run.fail("rounding keeps it there");
        }
    }
    return solver.radiosity();
}

} // namespace hemi
