#pragma once

#include "cli/pipeline.hpp"
#include "cli/report.hpp"
#include "cli/solution.hpp"
#include "hemi/matrix/error_estimate.hpp"

#include <optional>
#include <string>

/// Estimates of what results are off by, and what is said of them.
namespace hemi::cli {

/// Computes better rows of a few patches, about a tenth of the work that `rows` were, for the estimates.
/// Does nothing where no row was computed, there is a reference, or `--no-estimate` was given.
void add_reference(Rows& rows, const LoadedScene& loaded, const RowOptions& options,
                   const Terminal& terminal);

/// Estimates the error of the rows as they are now: again after they were repaired. Nothing is known where
/// there is no reference.
void estimate_rows(io::FactorFile& file);

/// Of a solution from these rows.
[[nodiscard]] std::optional<RadiosityErrorEstimate>
estimate_solution(const LoadedScene& loaded, const io::FactorFile& file, const Solution& solution);

/// A line of a summary on settings that the program chose; none where the user did.
[[nodiscard]] std::string chosen_summary(const std::string& chosen_for);
/// Lines of a summary; none where nothing is known.
[[nodiscard]] std::string error_summary(const std::optional<FactorErrorEstimate>& factors,
                                        const std::optional<RadiosityErrorEstimate>& radiosity = {});
/// {"rows_compared", "factor": {"rms", "max"}, "row": {"rms", "max"}, "radiosity"}; null where nothing is
/// known, "radiosity" only where it is.
[[nodiscard]] Json error_json(const std::optional<FactorErrorEstimate>& factors,
                              const std::optional<RadiosityErrorEstimate>& radiosity = {});

} // namespace hemi::cli
