#pragma once

#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"
#include "hemi/solver/solution.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Radiosity at the vertices of a mesh that is cut further and further, by rows of new vertices alone. An old
/// vertex keeps what its row gathered, and goes up and down with the mean of the patch that it was a corner of:
/// good enough to see where the radiosity bends (vertex_bends()), not to show it.
class RefinedGather {
public:
    /// @param scene     materials and environment
    /// @param mesh      the one of before, or what it was split() into
    /// @param settings  see VertexGather::compute()
    /// @param solution  of the mesh; gets Solution::vertex_radiosity
    /// @param observer  gets progress and may cancel
    /// @throws as VertexGather::compute()
    void gather(const Scene& scene, const PatchMesh& mesh, const FactorSettings& settings, Solution& solution,
                Observer& observer);

    /// Gathers again where patches have vertices whose rows are of an earlier mesh: sources near them may have
    /// been cut since, which their own patch's mean does not tell.
    /// @param patches  those that count most
    /// @return whether there are such vertices; else nothing was done
    /// @throws as gather()
    bool refresh(const Scene& scene, const PatchMesh& mesh, std::span<const std::uint32_t> patches,
                 const FactorSettings& settings, Solution& solution, Observer& observer);

    /// The mesh has been split.
    /// @param from      before
    /// @param solution  of it
    /// @param to        after
    /// @param parents   of every patch of `to`, the one of `from`
    void split(const PatchMesh& from, const Solution& solution, const PatchMesh& to,
               std::span<const std::uint32_t> parents);

private:
    std::vector<float> known_;           ///< see VertexGather::compute(); after split(), less the parent's mean
    std::vector<bool> old_;              ///< corners whose value is from an earlier mesh, four a patch
    std::vector<std::uint32_t> parents_; ///< of the patches now, since gather(); empty: nothing was split
};

} // namespace hemi
