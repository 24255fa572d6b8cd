#pragma once

#include "hemi/engine/reference_rows.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/checkpoint.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace hemi {

/// Form factors of a scene by a preset, ready to be used: all rows, buried patches marked, reciprocal and
/// closed as far as that suits them, with an estimate of their error.
/// @param scene     gives the enclosure
/// @param mesh      its patches
/// @param preset    how much is done for them
/// @param observer  gets progress and may cancel
/// @throws NoDevice, GlError; OutOfMemory with figures and advice; Cancelled
[[nodiscard]] FormFactors compute_form_factors(const Scene& scene, const PatchMesh& mesh,
                                               Preset preset = Preset::standard,
                                               Observer& observer = no_observer());
/// The same with single settings.
[[nodiscard]] FormFactors compute_form_factors(const Scene& scene, const PatchMesh& mesh,
                                               const FactorSettings& settings,
                                               Observer& observer = no_observer());

/// Raw rows of some patches, as `.hff` files hold them; prepare_form_factors() makes them ready to be used.
/// Above 256 rows a sample of 64 tells first what they will need; where unoccluded factors times visibility
/// do not fit the memory, plain rows take their place, with a warning.
/// @param scene       gives the enclosure
/// @param mesh        its patches
/// @param patches     whose rows are wanted, ascending; all others stay unknown
/// @param settings    how
/// @param observer    gets progress and may cancel
/// @param checkpoint  where finished rows are kept, and those of before taken from; or null
/// @throws as compute_form_factors
[[nodiscard]] FormFactors compute_raw_form_factors(const Scene& scene, const PatchMesh& mesh,
                                                   std::span<const std::uint32_t> patches,
                                                   const FactorSettings& settings,
                                                   Observer& observer = no_observer(),
                                                   RowCheckpoint* checkpoint = nullptr);

/// Better rows of refined meshes, at most: in an office of 2,600 patches 32 say that the form factors' error
/// is 1.6 to 2.3 %, 128 say 0.5 to 0.8 %, all 0.9 %.
inline constexpr std::uint32_t reference_rows_of_cut_patches = 128;

/// Better rows of a few patches, about a tenth of the work that the rows were, from which errors are
/// estimated. compute_raw_form_factors() adds them itself if the settings say so.
/// @param factors   with known rows; gets `reference`
/// @param mesh      their patches
/// @param settings  that the rows were computed by
/// @param observer  gets progress and may cancel
/// @param most      rows, 12 or more, if so little work allows as many: more of them say it more surely
void add_reference_rows(FormFactors& factors, const PatchMesh& mesh, const FactorSettings& settings,
                        Observer& observer = no_observer(), std::uint32_t most = usual_reference_rows);

/// Makes raw form factors ready to be used, in this order: patches that lie face to face against a surface of
/// a closed scene count as buried (mark_touching_faces_buried), reciprocity and closure are enforced
/// (repair), and the error of what comes out is estimated where there are reference rows (estimate_error).
/// Nothing but the estimate changes where it was done before.
/// @param factors  raw; changed in place
/// @param wanted   what is enforced; empty: closure where factors have visibility, nothing in plain rows
/// @param observer  gets progress and may cancel
/// @throws Cancelled; the factors then have no rows any more
void prepare_form_factors(FormFactors& factors, std::optional<Repair> wanted = {},
                          Observer& observer = no_observer());

/// Estimates the error of the rows as they are now, by the reference rows; none where there are none.
void estimate_error(FormFactors& factors);

/// Raw form factors from a `.hff` file that was made for the same geometry.
/// @throws InputError if it belongs to another geometry, or is no sound file
[[nodiscard]] FormFactors read_form_factors(const std::filesystem::path& path, const Scene& scene,
                                            const PatchMesh& mesh);

/// 0, 1 … size - 1.
[[nodiscard]] std::vector<std::uint32_t> all_patches(std::uint32_t size);

} // namespace hemi
