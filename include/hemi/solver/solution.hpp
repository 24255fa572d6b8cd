#pragma once

#include "hemi/core/names.hpp"
#include "hemi/matrix/error_estimate.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hemi {

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

/// Words of SolverMethod.
template <>
struct Names<SolverMethod> {
    /// Every value with its word.
    static constexpr NamedValue<SolverMethod> table[] = {{SolverMethod::automatic, "auto"},
                                                         {SolverMethod::gauss_seidel, "gauss-seidel"},
                                                         {SolverMethod::jacobi, "jacobi"},
                                                         {SolverMethod::conjugate_gradient, "cg"}};
};

/// How far a field is from the exact one: relative to the reflected part of the radiosity, B - E. Both are
/// taken over the patches that reflect and are not buried, by area, in the worst channel.
struct FieldError {
    double rms = 0.0;          ///< rms of the error over rms of B - E
    double percentile95 = 0.0; ///< what 95 % of the area stays below, over rms of B - E
    /// By how much the rms may be off since it is from a sample of the patches: one standard error; not
    /// stored.
    double doubt = 0.0;
};

/// What the mean irradiance of a group is off by, relative to it, in the worst channel. Not a number where
/// the group gets no light or its rows are unknown.
struct GroupError {
    double patch_size = 0.0; ///< from the patches' size
    double factors = 0.0;    ///< from the form factors
};

/// What patches of finite size do to a radiosity. @see estimate_patch_size_error
struct PatchSizeError {
    FieldError vertices;            ///< of the interpolated vertex values that pictures show
    FieldError field;               ///< of one constant for each patch
    std::vector<GroupError> groups; ///< of every group; empty where there are too many
    /// Absolute, as RadiosityErrorEstimate::patches: rms of the interpolated values over a patch. Modelled,
    /// from how fast the radiosity changes there, to agree with the sample, whose patches have no less than
    /// was found there.
    std::vector<double> patches;
    std::uint32_t sampled = 0; ///< patches whose quarters were looked at
    double seconds = 0.0;      ///< that took
};

/// The radiosity of every patch of a scene, and what is known of it. Arrays of N·channels hold channel c of
/// patch i at [i·channels + c]; W/m² (or lm/m²).
struct Solution {
    std::uint32_t channels = 1;     ///< wavelengths, bands or colours
    std::vector<double> radiosity;  ///< B, N·channels
    std::vector<double> exitance;   ///< E, what patches radiate by themselves, N·channels
    std::vector<double> irradiance; ///< H = F B + e B_env + D, N·channels; empty where it was not asked for
    std::vector<double> direct;     ///< D, what comes straight from sun and sky, N·channels; empty: neither

    /// K, N; not a number where it is not known. Empty but of heat_as_solution(), as the next; not stored.
    std::vector<double> temperature;
    std::vector<double> net_flux; ///< over all channels, leaving positive, W/m², N; likewise

    /// B at the corners of the patches, gathered by rows of their own (see VertexGather): channel c of corner
    /// k of patch i at [(i·4 + k)·channels + c]. Empty: corners have means over the patches that meet there.
    std::vector<float> vertex_radiosity;

    std::vector<double> row_sum;           ///< sum_j F(i, j), N; 0 where the row was not computed
    std::vector<double> environment_share; ///< e_i, N; likewise
    std::vector<double> back_face_share;   ///< b_i, N; likewise

    SolverMethod method = SolverMethod::gauss_seidel; ///< the one that was used, never automatic
    std::string reason;                               ///< a sentence: why this method
    std::uint32_t channels_solved = 1; ///< 1 where all channels are equal, and one was solved for all
    std::uint32_t sweeps = 0;          ///< sweeps over the rows, or iterations
    double residual =
        0.0; ///< worst channel's ||E' - (I - rho F) B||_2 / ||E'||_2, E' = E + rho (e B_env + D)
    double dominance = 0.0; ///< max over i and channels of rho_i·sum_j F(i, j); below 1 the sweeps converge

    double seconds = 0.0; ///< spent on solving; not stored

    std::string renderer;   ///< what computed the rows of F
    std::string chosen_for; ///< why the settings are what they are, where hemi chose them; else empty
    std::optional<FactorErrorEstimate> factor_error; ///< of the form factors
    std::optional<RadiosityErrorEstimate> error;     ///< of the radiosity, from the form factors alone
    std::optional<PatchSizeError> patch_size_error;  ///< of the radiosity, from the patches' size alone
};

/// Estimated error of every patch's radiosity, absolute, channel c of patch i at [i·channels + c]: from the
/// form factors, and from the patches' size where that is known. Empty where neither is.
[[nodiscard]] std::vector<double> radiosity_errors(const Solution& solution);

} // namespace hemi
