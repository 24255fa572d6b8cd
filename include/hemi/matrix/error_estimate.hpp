#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Estimated error of form factors.
///
/// The error of a row is the root of sum_j (F(i, j) - F*(i, j))²: the error of its irradiance, in units of
/// the radiosity of what it sees, where single factors err independently.
struct FactorErrorEstimate {
    std::uint32_t sampled = 0; ///< rows that were compared with the reference
    double rms = 0.0;          ///< of a factor, over the pairs that see each other
    double max = 0.0;          ///< of a factor, over all pairs
    double row_rms = 0.0;      ///< of a row, over all rows
    double row_max = 0.0;      ///< of a row, the largest
    std::vector<double> rows;  ///< N, the error of every row; 0 where it is unknown
};

/// What the known rows of `factors` are off by, judged by the rows of `reference`.
///
/// In the sampled rows errors are measured. For all others, the variance of a factor is taken to go like F,
/// like F² and, where factors are F0·V with F0(i, j) the unoccluded factor, like F0² V (1 - V), else like F⁴:
/// each of these is scaled to what the sample shows. Totals are made from their mean, the error of a single
/// row from the largest of them, with something on top where the sample is small. The largest error of a
/// factor goes like its row's largest factor.
/// @param factors    N rows
/// @param reference  N rows, some of them known: better ones, see compute_reference()
/// @param columns    compare in these columns only, ascending; empty: in all. What lies in others is taken to
///   be as wrong as what lies in these.
/// @throws InvalidArgument if the sizes differ, or no row of the reference is known in `factors`.
[[nodiscard]] FactorErrorEstimate estimate_factor_error(const FormFactorMatrix& factors,
                                                        const FormFactorMatrix& reference,
                                                        std::span<const std::uint32_t> columns = {});

/// Estimated error of a radiosity, from the errors of the factors alone: not from patches of finite size.
struct RadiosityErrorEstimate {
    /// Relative to what is reflected, B - E: both rms, area-weighted, over patches that reflect; the worst
    /// channel.
    double rms = 0.0;
    std::vector<double> patches; ///< absolute, of channel c of patch i at [i·channels + c]
};

/// What B = E + rho (F B + e B_env) is off by.
///
/// A row's irradiance is off by sum_j (F(i, j) - F*(i, j)) B_j. Its variance is modelled as in
/// estimate_factor_error, each factor's times B_j², and scaled to what the sample's irradiances are off by.
/// Rows count by their areas. To that comes what all rows have in common, the sample's mean and that mean's
/// own error, which the scene amplifies as it does light: by sum A rho / sum A (1 - rho sum_j F).
/// @param factors    N rows
/// @param reference  N rows, some of them known
/// @param areas      N areas
/// @param channels   of the solution
/// @param reflectance,exitance,radiosity  N·channels, channel c of patch i at [i·channels + c]
/// @param columns    as in estimate_factor_error()
/// @throws InvalidArgument as estimate_factor_error, and for spans that do not fit.
[[nodiscard]] RadiosityErrorEstimate
estimate_radiosity_error(const FormFactorMatrix& factors, const FormFactorMatrix& reference,
                         std::span<const double> areas, std::uint32_t channels,
                         std::span<const double> reflectance, std::span<const double> exitance,
                         std::span<const double> radiosity, std::span<const std::uint32_t> columns = {});

/// What the irradiances of sampled rows are off by, sum_j (F(i, j) - F*(i, j)) B_j + (e_i - e*_i) B_env.
struct IrradianceErrors {
    std::vector<std::uint32_t> rows; ///< those that are known in both matrices, ascending
    std::vector<double> errors;      ///< channel c of rows[k] at [k·channels + c]
};

/// @param factors    N rows
/// @param reference  N rows, some of them known
/// @param channels   of the radiosity
/// @param radiosity  N·channels, channel c of patch i at [i·channels + c]
/// @param environment  B_env, channels; empty: zero
/// @throws InvalidArgument as estimate_factor_error, and for spans that do not fit.
[[nodiscard]] IrradianceErrors irradiance_errors(const FormFactorMatrix& factors,
                                                 const FormFactorMatrix& reference, std::uint32_t channels,
                                                 std::span<const double> radiosity,
                                                 std::span<const double> environment);

} // namespace hemi
