#pragma once

#include "hemi/io/factor_part_file.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <cstdint>
#include <filesystem>
#include <span>

/// Form factors of a scene in parts, each computed by a process of its own, on one machine or on many.
namespace hemi {

/// Rows that follow each other.
struct RowRange {
    std::uint32_t first = 0; ///< from 0
    std::uint32_t end = 0;   ///< one past the last
};

/// Computes some rows as the engine makes them. What needs rows of other parts is left to
/// merge_factor_parts(): both directions of a pair, shadow rays, unoccluded factors, what the environment
/// gets, and the error estimate, of which a part holds those better rows whose patches are its own. Rows are
/// of visibility unless the preset is plain; where pairs do not fit the memory is seen in the merge.
/// Memory: 9 bytes for every patch of a row that faces the row's own, hidden or not.
/// @param scene       gives the enclosure
/// @param mesh        its patches
/// @param rows        which rows
/// @param settings    how; all parts must have the same
/// @param observer    gets progress and may cancel
/// @param checkpoint  where finished rows are kept, or null
/// @return all but FactorPart::groups and FactorPart::surfaces, which are the mesh's, and FactorPart::parts
/// @throws InvalidArgument for a range that is empty or goes beyond the mesh, and for a mesh of patches that
///   were cut further; as compute_form_factors
[[nodiscard]] io::FactorPart compute_factor_part(const Scene& scene, const PatchMesh& mesh, RowRange rows,
                                                 const FactorSettings& settings,
                                                 Observer& observer = no_observer(),
                                                 RowCheckpoint* checkpoint = nullptr);

/// Raw form factors of a scene whose rows are in parts: to the bit those of one run with the same renderer,
/// the CPU rasteriser or software OpenGL (a GPU may draw a few texels another way). The instruction set of
/// the CPU rasteriser does not count; of several, the first part's is named. Memory: as
/// compute_visibility_weighted() for all rows, and the largest part.
/// @param files     the parts, in any order
/// @param settings  max_memory of them, nothing else
/// @param observer  gets progress and may cancel
/// @throws InputError for a part that is not sound, of another scene, renderer or setting than the first, or
///   with rows of another, and for rows that are in none; OutOfMemory
[[nodiscard]] FormFactors merge_factor_parts(std::span<const std::filesystem::path> files,
                                             const FactorSettings& settings = {},
                                             Observer& observer = no_observer());

} // namespace hemi
