#pragma once

#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solver.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace hemi {

/// Patches whose rows the radiosity depends on, ascending: those that reflect in some channel.
[[nodiscard]] std::vector<std::uint32_t> reflecting_patches(const Scene& scene, const PatchMesh& mesh);

/// What patches reflect and radiate. Arrays of N·channels hold channel c of patch i at [i·channels + c].
struct PatchValues {
    std::uint32_t channels = 1;      ///< wavelengths, bands or colours
    std::vector<double> reflectance; ///< N·channels, in [0, 1)
    std::vector<double> exitance;    ///< N·channels, >= 0
    std::vector<double> environment; ///< channels, >= 0; empty: dark
    std::vector<double> direct{};    ///< irradiance from sun and sky, N·channels, >= 0; empty: neither
    std::optional<Sun> sun{};        ///< for points beside the patches, which have no `direct`
    std::optional<Sky> sky{};        ///< likewise
    UpAxis up = UpAxis::z;           ///< of the sky
};
/// Those of a scene, without what sun and sky give patches; see direct_irradiance().
[[nodiscard]] PatchValues patch_values(const Scene& scene, const PatchMesh& mesh);

/// The radiosity of a scene, with the estimated error that its form factors bring. Channels that are all the
/// same problem are solved once. Sun and sky count, see direct_irradiance().
/// @param scene            materials and environment
/// @param mesh             its patches
/// @param factors          prepared, see prepare_form_factors()
/// @param settings         solver, tolerance
/// @param observer         gets progress and may cancel; gets a warning where nothing radiates
/// @param with_irradiance  finds the irradiance too
/// @throws InputError if the row of a reflecting patch is not known; NotConverged; Cancelled
[[nodiscard]] Solution solve_radiosity(const Scene& scene, const PatchMesh& mesh, const FormFactors& factors,
                                       const SolverSettings& settings = {},
                                       Observer& observer = no_observer(), bool with_irradiance = true);
/// The same for any values of the patches, one by one.
/// @throws InvalidArgument too, for values that do not fit
[[nodiscard]] Solution solve_radiosity(const FormFactors& factors, PatchValues values,
                                       const SolverSettings& settings = {},
                                       Observer& observer = no_observer(), bool with_irradiance = true);

} // namespace hemi
