#pragma once

#include "hemi/core/progress.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace hemi {

/// B = E + rho (F B + e B_env), all channels at once.
/// Arrays of N·channels hold channel c of patch i at [i·channels + c].
struct RadiosityProblem {
    const FormFactorMatrix* factors = nullptr;
    std::uint32_t channels = 1;
    std::span<const double> reflectance; ///< rho, N·channels, in [0, 1)
    std::span<const double> exitance;    ///< E, N·channels, >= 0
    std::span<const double> environment; ///< B_env, channels, >= 0; empty: zero
};

enum class SolverMethod { gauss_seidel, jacobi };

struct SolverSettings {
    SolverMethod method = SolverMethod::gauss_seidel;
    double tolerance = 1e-6; ///< on the relative residual, see RadiositySolution
    std::uint32_t max_sweeps = 100000;
};

struct RadiositySolution {
    std::vector<double> radiosity; ///< B, N·channels
    std::uint32_t sweeps = 0;
    double residual = 0.0;  ///< worst channel's ||E' - (I - rho F) B||_2 / ||E'||_2, E' = E + rho e B_env
    double dominance = 0.0; ///< max over i and channels of rho_i·sum_j F(i, j); below 1 the sweeps converge
};

/// Called after every sweep with its number and an estimate of the residual; false cancels.
using SweepCallback = std::function<bool(std::uint32_t sweep, double residual)>;

/// Solves the radiosity equation by Gauss–Seidel or Jacobi sweeps; sums in double, in fixed order.
/// Rows that are not known are allowed where the reflectance is zero in every channel: there B = E.
/// @throws InvalidArgument for sizes that do not match, reflectance outside [0, 1), negative or non-finite
///   exitance, an unknown row with reflectance; NotConverged when the tolerance is not met.
[[nodiscard]] RadiositySolution solve_radiosity(const RadiosityProblem& problem,
                                                const SolverSettings& settings = {},
                                                const SweepCallback& callback = {});

/// Irradiance H = F B + e B_env of every patch with a known row (0 elsewhere), N·channels.
[[nodiscard]] std::vector<double> irradiance(const RadiosityProblem& problem,
                                             std::span<const double> radiosity);

} // namespace hemi
