#pragma once

#include "hemi/core/names.hpp"
#include "hemi/pipeline/checkpoint.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/pipeline/vertex_gather.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solution.hpp"
#include "hemi/solver/solver.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hemi {

/// Which error a target is for, see SolutionError.
enum class ErrorOf {
    vertices, ///< of what pictures show, interpolated between vertices, rms
    field,    ///< of one constant for each patch, rms
    groups,   ///< of the mean irradiance of the group that errs most
    factors,  ///< of the radiosity from the form factors alone, or of these themselves
};

/// Words of ErrorOf.
template <>
struct Names<ErrorOf> {
    /// Every value with its word.
    static constexpr NamedValue<ErrorOf> table[] = {{ErrorOf::vertices, "vertices"},
                                                    {ErrorOf::field, "field"},
                                                    {ErrorOf::groups, "groups"},
                                                    {ErrorOf::factors, "factors"}};
};

/// When patches are fine enough.
struct RefinementGoal {
    std::optional<double> error;          ///< estimated error that will do, relative
    ErrorOf error_of = ErrorOf::vertices; ///< not factors, which do not depend on the patches' size
    std::uint32_t patches = 0;            ///< as many patches will do; 0: only the error counts
    double seconds = 0.0;                 ///< no further step begins after so many; 0: no limit
    Gather gather = Gather::automatic;    ///< whether vertices are gathered in the end
};

/// What a mesh that follows from its solution came to.
struct Refinement {
    /// One mesh on the way.
    struct Step {
        std::uint32_t patches = 0; ///< of the mesh
        std::uint64_t rows = 0;    ///< computed for it: those of new patches
        double error = 0.0;        ///< estimated; not a number where there is no estimate
    };
    PatchMesh mesh;          ///< of the last step
    FormFactors raw;         ///< all rows, as they are stored
    FormFactors factors;     ///< prepared
    Solution solution;       ///< by them, with its errors, gathered if it is to be
    std::vector<Step> steps; ///< from the coarsest mesh on
    /// What ended it before the goal was met or its error was known, a sentence; empty: nothing did.
    std::string stopped;
};

/// Rows that a refinement begins with, and that outlast it.
struct RefinementRows {
    /// Raw rows of all patches of the coarse mesh or, by FormFactors::cuts, of one that was cut from it.
    std::optional<FormFactors> begin{};
    RowCheckpoint* checkpoint = nullptr; ///< keeps rows of a step that is not complete
    /// Is given the rows of every step when they are complete, to be stored; with FormFactors::cuts, by which
    /// a later refinement goes on from them.
    std::function<void(const PatchMesh&, FormFactors&)> store{};
};

/// Solves a scene on patches that become smaller where that tells: begins with a coarse mesh, estimates the
/// error, cuts the patches that add most to it (PatchMesh::split), and computes rows of the new patches
/// alone, from which the columns of the others follow by reciprocity; until the estimate meets the goal.
/// Where patches of one quadrilateral meet, an edge is at most twice as long as the other.
/// @param scene            materials, environment, enclosure
/// @param coarse           to begin with, see coarse_mesh()
/// @param settings         of the form factors; errors of form factors are estimated for the last mesh
/// @param solver           solver, tolerance
/// @param goal             when it ends
/// @param with_irradiance  see solve_radiosity()
/// @param observer         gets progress and may cancel
/// @param rows             to begin with, and what becomes of those that are computed
/// @throws InvalidArgument if rows to begin with are not those of all patches, if nothing in the scene
///   reflects light, if the error of the first mesh cannot be estimated, if the goal is factors or
///   nothing at all, or if the method is no hemicube; as compute_form_factors and solve_radiosity
/// Source: M. F. Cohen, D. P. Greenberg, D. S. Immel, P. J. Brock, "An Efficient Radiosity Approach for
/// Realistic Image Synthesis", IEEE CG&A 6, 1986; D. Lischinski, B. Smits, D. P. Greenberg, "Bounds and Error
/// Estimates for Radiosity", SIGGRAPH 1994.
[[nodiscard]] Refinement solve_refined(const Scene& scene, const PatchMesh& coarse,
                                       const FactorSettings& settings, const SolverSettings& solver,
                                       const RefinementGoal& goal, bool with_irradiance = false,
                                       Observer& observer = no_observer(), RefinementRows rows = {});

} // namespace hemi
