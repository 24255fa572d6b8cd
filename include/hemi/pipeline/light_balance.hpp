#pragma once

#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/radiosity.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// Where the light of a scene comes from and goes to, all channels together: powers, the exitances' unit
/// times the square of the scene's. emitted = absorbed + environment + lost, but for the errors of the form
/// factors and the solver.
struct LightBalance {
    double emitted = 0.0;     ///< by the patches' own exitance
    double absorbed = 0.0;    ///< by patches: the share that they do not reflect
    double environment = 0.0; ///< to the environment, less what comes from it
    double lost = 0.0;        ///< on backs of one-sided surfaces and in what is buried: nothing comes back
    double incoming = 0.0;    ///< emitted, and what comes from the environment
    std::vector<double> lost_of_group; ///< lost of what leaves each group

    /// Lost over incoming; 0 where nothing comes in.
    [[nodiscard]] double lost_share() const { return incoming > 0.0 ? lost / incoming : 0.0; }
};

/// The balance of a solution.
/// @param factors    that it was solved by
/// @param values     of the patches
/// @param radiosity  N·channels, channel c of patch i at [i·channels + c]
/// @param weights    what each channel counts, channels, such as flux_weights(); empty: 1
/// @return nothing where a row is unknown that light leaves by, or that the environment's light comes by
/// @throws InvalidArgument for spans that do not fit
[[nodiscard]] std::optional<LightBalance> light_balance(const FormFactors& factors, const PatchValues& values,
                                                        std::span<const double> radiosity,
                                                        std::span<const double> weights = {});

/// Patches from which light comes, ascending: those that reflect or radiate in some channel. Their rows are
/// what a light_balance() needs.
[[nodiscard]] std::vector<std::uint32_t> shining_patches(const PatchValues& values);

} // namespace hemi
