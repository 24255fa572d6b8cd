#pragma once

#include "cli/report/report.hpp"
#include "cli/terminal.hpp"
#include "hemi/matrix/balance.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/diagnosis.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <optional>
#include <string>

/// Report of form factors.
namespace hemi::cli {

/// The rows just computed or read: renderer, hemicubes/s, entries and memory, row sums, shares, enclosure.
[[nodiscard]] Report rows_report(const FormFactors& factors, const RowSums& sums,
                                 const EnclosureFinding& enclosure);
/// Rows after prepare_form_factors(): those of rows_report(), repair, chosen settings and estimated errors.
[[nodiscard]] Report prepared_rows_report(const FormFactors& factors, const RowSums& sums,
                                          const EnclosureFinding& enclosure, double repair_seconds);
/// Contents of a `.hff`.
[[nodiscard]] Report stored_factors_report(const FormFactors& file);
/// Contents of a file that holds F alone.
[[nodiscard]] Report matrix_report(const FormFactorMatrix& factors);

/// Line and key "chosen_for": what the program chose the settings for. No line, and null, where the user
/// chose them.
[[nodiscard]] Report chosen_report(const std::string& chosen_for);
/// Lines and key "error_estimate": estimated errors of form factors and of the radiosity by them. No line,
/// and null, where nothing is known.
/// @param say_radiosity  whether the radiosity's has a line, or another report says more of it
[[nodiscard]] Report error_report(const std::optional<FactorErrorEstimate>& factors,
                                  const std::optional<RadiosityErrorEstimate>& radiosity = {},
                                  bool say_radiosity = true);

/// Errors on stderr about leaks: how many and the worst few, with the direction in which they go. Says
/// nothing if there are none.
/// @param mesh  the patches; null: not known
void report_leaks(const EnclosureFinding& finding, const FormFactorMatrix& factors, const PatchNames& names,
                  const PatchMesh* mesh, double max_row_error, const Terminal& terminal);
/// A warning if no patch of several sees the front of another.
/// @param sums  of all rows
void report_no_fronts(const RowSums& sums, const FormFactorMatrix& factors, const Terminal& terminal);
/// A warning if patches are buried.
void report_buried(const RowSums& sums, const Terminal& terminal);

} // namespace hemi::cli
