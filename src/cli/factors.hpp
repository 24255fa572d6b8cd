#pragma once

#include "cli/arguments/arguments.hpp"
#include "cli/exit_status.hpp"
#include "cli/output_paths.hpp"
#include "cli/report/seconds.hpp"
#include "cli/terminal.hpp"
#include "hemi/matrix/form_factors.hpp"

/// The parts of `hemi factors`: rows of a scene are computed, those of a file are shown.
namespace hemi::cli {

/// All rows of a scene, or one: computed, written, reported.
[[nodiscard]] ExitStatus factors_of_scene(const FactorsArguments& arguments, const Outputs& outputs,
                                          const Terminal& terminal);
/// --rows: a part of the rows of a scene, computed and written.
[[nodiscard]] ExitStatus factors_part(const FactorsArguments& arguments, const Outputs& outputs,
                                      const Terminal& terminal);
/// A row of a `.hff`, or its table of groups.
[[nodiscard]] ExitStatus factors_of_file(const FactorsArguments& arguments, const Terminal& terminal);

/// Whether -o names a file of the rows, rather than one of the table of groups.
[[nodiscard]] bool writes_rows(const FactorsArguments& arguments);
/// Whether rows are kept beside the file of -o while they are computed from a scene.
[[nodiscard]] bool keeps_rows(const FactorsArguments& arguments);
/// The stages that both parts time.
[[nodiscard]] Seconds factor_stages();
/// --by-group: writes the table, or prints it.
void show_groups(const FactorsArguments& arguments, const FormFactors& factors, const Seconds& seconds);

} // namespace hemi::cli
