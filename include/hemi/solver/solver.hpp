#pragma once

#include "hemi/core/progress.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/solver/solution.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hemi {

/// B = E + rho (F B + e B_env + D), all channels at once.
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
    /// D, N·channels, >= 0: irradiance that comes neither from patches nor, as e B_env, from the environment,
    /// such as that of the sun; empty: zero.
    std::span<const double> direct = {};
};

/// Called after every sweep with its number, an estimate of the residual, and a function that gives the
/// radiosity as it is then, N·channels, valid during the call. Returning false cancels.
using SweepWatcher = std::function<bool(std::uint32_t sweep, double residual,
                                        const std::function<std::vector<double>()>& radiosity)>;

/// How far and from where a problem is solved.
struct SolverSettings {
    SolverMethod method = SolverMethod::automatic; ///< the solver
    double tolerance = 1e-6;                       ///< on the relative residual, see Solution
    std::uint32_t max_sweeps = 100000;             ///< or iterations
    /// Where sweeps begin, N·channels: the solution of a problem that was much the same. Empty: the sources.
    /// Conjugate gradients do not look at it.
    std::span<const double> start = {};
    SweepWatcher watch = {}; ///< called after every sweep; may be empty
};

/// Solves the radiosity equation. Of the solution the radiosity and how it was found are set, nothing else;
/// sums in double, in fixed order: the same bits on any number of threads. Rows that are not known are
/// allowed where the reflectance is zero in every channel: there B = E. Memory: a few fields of N·channels;
/// conjugate gradients up to 20. Source of the symmetric form: conjugate gradients for I - R^1/2 A^1/2 F
/// A^-1/2 R^1/2, T. Kurc, C. Aykanat, B. Özgüç, "A parallel scaled conjugate-gradient algorithm for the
/// solution phase of gathering radiosity", 1997.
/// @throws InvalidArgument for sizes that do not match, reflectance outside [0, 1), negative or non-finite
///   exitance, an unknown row with reflectance, conjugate gradients without areas or on rows that are not
///   reciprocal; NotConverged when the tolerance is not met; Cancelled when the watcher returns false.
[[nodiscard]] Solution solve_radiosity(const RadiosityProblem& problem, const SolverSettings& settings = {});

/// Irradiance H = F B + e B_env + D of every patch with a known row (0 elsewhere), N·channels; B = E + rho H.
[[nodiscard]] std::vector<double> irradiance(const RadiosityProblem& problem,
                                             std::span<const double> radiosity);

} // namespace hemi
