#pragma once

#include "hemi/core/enclosure.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "pipeline/error_sample.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// A mesh of which the patches of a sample are cut in four, and others as sources of their light.
struct CutSample {
    PatchMesh mesh;                                     ///< the finer one
    std::vector<std::uint32_t> parents;                 ///< of its patches, those that they lie in
    std::vector<std::uint8_t> whole;                    ///< of its patches, whether they are not cut
    std::vector<std::array<std::uint32_t, 4>> quarters; ///< of the sample
    std::vector<std::uint32_t> rows;                    ///< all of these, ascending
};

/// @param mesh    N patches
/// @param sample  of them, ascending
/// @param all     whether all patches are cut; else those that are near the sample besides it: what varies
///   within a patch far away is not seen from there
[[nodiscard]] CutSample cut_sample(const PatchMesh& mesh, std::span<const DrawnPatch> sample, bool all);

/// At most what compute_quarter_rows() and the finer mesh take.
/// @param rows      of quarters
/// @param columns   patches of the finer mesh, with their images
/// @param clusters  as there
[[nodiscard]] std::uint64_t quarter_row_bytes(std::uint64_t rows, std::uint64_t columns, bool clusters);

/// Rows of the quarters, as unoccluded factors times visibility.
/// @param cut        the sample
/// @param plan       sample points and texels of a solution's rows; the random numbers are others
/// @param settings   device, workers and memory
/// @param scene      gives the enclosure, and what emits light
/// @param clusters   what is far away stands together in clusters, as in compute_clustered(); else all pairs
///   are kept meanwhile
/// @param observer   gets the first three quarters of the progress of Phase::patch_size, and may cancel
[[nodiscard]] FormFactorMatrix compute_quarter_rows(const CutSample& cut, RowPlan plan,
                                                    const FactorSettings& settings, const Scene& scene,
                                                    bool clusters, Observer& observer);

/// Progress of one of four parts of the estimate: rows, pairs, factors, importance for groups.
[[nodiscard]] Progress quarter_of_progress(Observer& observer, std::size_t index);

} // namespace hemi
