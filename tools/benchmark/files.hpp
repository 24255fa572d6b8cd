#pragma once

#include "benchmark/report.hpp"

namespace hemi::bench {

/// Times writers of form factors at two sizes, the larger with 16 times the entries: seconds an entry of
/// both, as a ratio that is 1 where a writer is linear. Then readers of meshes of a million triangles.
/// @param rounds  medians are taken over so many
void measure_files(Report& report, unsigned rounds);

} // namespace hemi::bench
