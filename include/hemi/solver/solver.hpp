#pragma once

#include "hemi/core/progress.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hemi {

/// B = E + rho (F B + e B_env), all channels at once.
/// Arrays of N·channels hold channel c of patch i at [i·channels + c].
///
/// Rows balance, sum_j F(i, j) + e_i + b_i = 1, and where they miss it by no more than 0.01 the difference is
/// F(i, i): rounding to floats then neither makes nor loses light, which matters as rho comes near 1. In
/// other words (1 - rho_i) B_i + rho_i [sum_j F(i, j) (B_i - B_j) + e_i (B_i - B_env) + b_i B_i] = E_i. In
/// rows of covered patches, where closure does not hold, only an excess of sum + e over 1 is taken off so.
/// Rows that are farther from balance are taken as they are.
struct RadiosityProblem {
    const FormFactorMatrix* factors = nullptr; ///< F, N rows; must outlive the problem
    std::uint32_t channels = 1;                ///< wavelengths, bands or colours that are solved at once
    std::span<const double> reflectance;       ///< rho, N·channels, in [0, 1)
    std::span<const double> exitance;          ///< E, N·channels, >= 0
    std::span<const double> environment;       ///< B_env, channels, >= 0; empty: zero
    std::span<const double> areas = {};        ///< A, N; needed by conjugate gradients
};

/// How the radiosity equation is solved.
enum class SolverMethod {
    gauss_seidel, ///< sweeps that use new values at once
    jacobi,       ///< sweeps that use the values of the sweep before
    /// On the symmetric system of the exchange areas A_i F(i, j), read from one triangle; needs reciprocal
    /// rows. Its iterations hardly depend on the reflectance.
    conjugate_gradient,
    /// Conjugate gradients where reflectance times row sum goes above 0.9 and the rows are reciprocal to the
    /// rounding of floats, else Gauss–Seidel.
    automatic,
};

/// "gauss-seidel", "jacobi", "cg" or "auto".
[[nodiscard]] std::string_view solver_name(SolverMethod method);

/// Shown after every sweep: its number, the estimate of the residual, and a function that gives the radiosity
/// as it is then, N·channels, valid during the call.
using SweepWatcher = std::function<void(std::uint32_t sweep, double residual,
                                        const std::function<std::vector<double>()>& radiosity)>;

/// How far and from where a problem is solved.
struct SolverSettings {
    SolverMethod method = SolverMethod::automatic; ///< the solver
    double tolerance = 1e-6;                       ///< on the relative residual, see RadiositySolution
    std::uint32_t max_sweeps = 100000;             ///< or iterations
    /// Where sweeps begin, N·channels: the solution of a problem that was much the same. Empty: the sources.
    /// Conjugate gradients do not look at it.
    std::span<const double> start = {};
    SweepWatcher watch = {}; ///< for those who want to see it converge; may be empty, may throw Cancelled
};

/// What solve_radiosity() found.
struct RadiositySolution {
    std::vector<double> radiosity;                    ///< B, N·channels
    SolverMethod method = SolverMethod::gauss_seidel; ///< the one that was used, never automatic
    std::string why;                                  ///< a sentence: why this one
    std::uint32_t sweeps = 0;                         ///< sweeps over the rows, or iterations
    double residual = 0.0;  ///< worst channel's ||E' - (I - rho F) B||_2 / ||E'||_2, E' = E + rho e B_env
    double dominance = 0.0; ///< max over i and channels of rho_i·sum_j F(i, j); below 1 the sweeps converge
};

/// Called after every sweep with its number and an estimate of the residual; false cancels.
using SweepCallback = std::function<bool(std::uint32_t sweep, double residual)>;

/// Solves the radiosity equation; sums in double, in fixed order: the same bits on any number of threads.
/// Rows that are not known are allowed where the reflectance is zero in every channel: there B = E.
/// Memory: a few fields of N·channels; conjugate gradients up to 20.
/// Source of the symmetric form: conjugate gradients for I - R^1/2 A^1/2 F A^-1/2 R^1/2, T. Kurc, C. Aykanat,
/// B. Özgüç, "A parallel scaled conjugate-gradient algorithm for the solution phase of gathering radiosity",
/// 1997.
/// @throws InvalidArgument for sizes that do not match, reflectance outside [0, 1), negative or non-finite
///   exitance, an unknown row with reflectance, conjugate gradients without areas or on rows that are not
///   reciprocal; NotConverged when the tolerance is not met.
[[nodiscard]] RadiositySolution solve_radiosity(const RadiosityProblem& problem,
                                                const SolverSettings& settings = {},
                                                const SweepCallback& callback = {});

/// Irradiance H = F B + e B_env of every patch with a known row (0 elsewhere), N·channels; B = E + rho H.
[[nodiscard]] std::vector<double> irradiance(const RadiosityProblem& problem,
                                             std::span<const double> radiosity);

} // namespace hemi
