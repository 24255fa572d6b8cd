#pragma once

#include "cli/pipeline.hpp"
#include "cli/terminal.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/matrix/error_estimate.hpp"
#include "hemi/solver/solver.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// From rows to radiosity, as solve and view do it.
namespace hemi::cli {

/// Radiosity of every patch. Arrays of N·channels hold channel c of patch i at [i·channels + c].
struct Solution {
    std::uint32_t channels = 1;
    std::uint32_t channels_solved = 1; ///< 1 when all channels are equal
    std::vector<double> exitance;      ///< what the patches radiate by themselves
    std::vector<double> radiosity;
    std::vector<double> irradiance; ///< empty unless asked for
    std::vector<double> blocked;    ///< b_i per patch, 0 where the row was not computed
    std::string solver;
    std::string why; ///< a sentence: why this solver
    std::uint32_t sweeps = 0;
    double residual = 0.0;
    double dominance = 0.0;
    double seconds = 0.0;
    std::optional<RadiosityErrorEstimate> error; ///< estimated, see estimate_solution
};

/// Patches whose rows the radiosity depends on: those that reflect in some channel.
[[nodiscard]] std::vector<std::uint32_t> reflecting_patches(const LoadedScene& loaded);

/// @param with_irradiance  also find the irradiance, of all patches whose rows are known
/// @throws InputError if a reflecting patch's row is not known; NotConverged; Cancelled.
[[nodiscard]] Solution solve_scene(const LoadedScene& loaded, const FormFactorMatrix& factors,
                                   const SolverSettings& settings, bool with_irradiance,
                                   const Terminal& terminal);

/// All of a solution that a `.hres` file holds.
[[nodiscard]] io::ResultFile make_result(const LoadedScene& loaded, const SceneOptions& options,
                                         const Rows& rows, const Solution& solution);

/// Exitance, reflectance of every patch, N·channels.
[[nodiscard]] std::vector<double> patch_exitance(const Scene& scene, const PatchMesh& mesh);
[[nodiscard]] std::vector<double> patch_reflectance(const Scene& scene, const PatchMesh& mesh);

} // namespace hemi::cli
