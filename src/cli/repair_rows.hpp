#pragma once

#include "cli/report.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/matrix/repair.hpp"

#include <optional>
#include <string>

/// Repair of rows after they were computed or read, and what is said of it.
namespace hemi::cli {

/// none, reciprocity or closure.
[[nodiscard]] std::string repair_name(Repair repair);

struct RowRepair {
    RepairReport report;
    double seconds = 0.0;
};

/// Repairs the rows as `--repair` says; by default closure where factors have visibility, none in plain ones.
/// After the raw rows were stored.
[[nodiscard]] RowRepair repair_rows(io::FactorFile& file, std::optional<Repair> wanted);

/// Lines of a summary: what was done, and the errors before and after.
[[nodiscard]] std::string repair_summary(const RowRepair& repair);
/// {"name", "before", "after", …}.
[[nodiscard]] Json repair_json(const RowRepair& repair);

} // namespace hemi::cli
