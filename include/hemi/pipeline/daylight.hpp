#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// What comes straight from sun and sky to every patch, W/m² (or lx): D of B = E + rho (F B + e B_env + D).
///
/// The sun's share is irradiance times cosine times the share of the patch that it reaches, by shadow rays
/// from stratified points; what ends at surfaces in the patch's own plane does not count. The sky's is what
/// an unobstructed patch would get, exactly, less what the other patches hide of it: of each its share in the
/// row times the mean of the sky behind it, which is exact for all that is seen of a patch, and for patches
/// partly hidden off by how much the sky changes over them. What of the environment is below the horizon
/// gets the ground's light. So a row serves for any sky.
/// @param scene     its sun and sky, channels and groups
/// @param mesh      its patches
/// @param factors   rows of these patches; the sky's part is 0 where a row is not known
/// @return channel c of patch i at [i·channels + c]; empty where there is neither sun nor sky
/// @throws InvalidArgument for rows of another mesh
[[nodiscard]] std::vector<double> direct_irradiance(const Scene& scene, const PatchMesh& mesh,
                                                    const FormFactorMatrix& factors);

/// The two parts of direct_irradiance(), each empty where there is none; channel c of the k-th patch at
/// [k·channels + c].
struct DirectIrradiance {
    std::vector<double> sun; ///< of the beam
    std::vector<double> sky; ///< of sky and ground
    std::vector<double> lit; ///< share of the beam that nothing hides from a patch, one a patch; with `sun`
};
/// They one by one, as direct_irradiance() adds them.
[[nodiscard]] DirectIrradiance direct_irradiances(const Scene& scene, const PatchMesh& mesh,
                                                  const FormFactorMatrix& factors);
/// The same of some patches.
/// @param scene    as in direct_irradiance()
/// @param mesh     likewise
/// @param factors  likewise
/// @param patches  whose rows are known
/// @return channel c of patches[k] at [k·channels + c]
[[nodiscard]] DirectIrradiance direct_irradiances(const Scene& scene, const PatchMesh& mesh,
                                                  const FormFactorMatrix& factors,
                                                  std::span<const std::uint32_t> patches);

/// direct_irradiance() by the bands of a heat problem, for HeatProblem::direct.
/// @param scene    as in direct_irradiance()
/// @param mesh     likewise
/// @param factors  likewise
/// @param bands    as many as the scene's channels, or 1 where those are equal
/// @throws InvalidArgument for other numbers of bands; as direct_irradiance()
[[nodiscard]] std::vector<double> direct_heat(const Scene& scene, const PatchMesh& mesh,
                                              const FormFactorMatrix& factors, std::uint32_t bands);

} // namespace hemi
