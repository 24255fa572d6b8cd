#pragma once

#include "cli/report/text.hpp"
#include "cli/terminal.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/diagnosis.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <optional>
#include <string>

/// What is said of form factors: lines of a summary for people, and the same values as JSON.
namespace hemi::cli {

/// Lines on a scene's size.
[[nodiscard]] std::string scene_summary(const PatchMesh& mesh);
/// Lines on the rows: renderer, hemicubes/s, entries and memory, row sums, enclosure.
[[nodiscard]] std::string rows_summary(const FormFactors& factors, const RowSums& sums,
                                       const EnclosureFinding& enclosure);

/// Lines on what was enforced, and how far the rows were and are from it.
[[nodiscard]] std::string repair_summary(const RepairReport& report);
/// {"name", "before", "after", …}.
[[nodiscard]] Json repair_json(const RepairReport& report, double seconds);

/// A line on settings that the program chose; none where the user did.
[[nodiscard]] std::string chosen_summary(const std::string& chosen_for);
/// Lines on estimated errors; none where nothing is known.
[[nodiscard]] std::string error_summary(const std::optional<FactorErrorEstimate>& factors,
                                        const std::optional<RadiosityErrorEstimate>& radiosity = {});
/// {"rows_compared", "factor": {"rms", "max"}, "row": {"rms", "max"}, "radiosity"}; null where nothing is
/// known, "radiosity" only where it is.
[[nodiscard]] Json error_json(const std::optional<FactorErrorEstimate>& factors,
                              const std::optional<RadiosityErrorEstimate>& radiosity = {});

/// Errors on stderr about leaks: how many and the worst few, with the direction in which they go. Says
/// nothing if there are none.
/// @param mesh  the patches; null: not known
void report_leaks(const EnclosureFinding& finding, const FormFactorMatrix& factors, const PatchNames& names,
                  const PatchMesh* mesh, double max_row_error, const Terminal& terminal);
/// A warning if patches are buried.
void report_buried(const RowSums& sums, const Terminal& terminal);

} // namespace hemi::cli
