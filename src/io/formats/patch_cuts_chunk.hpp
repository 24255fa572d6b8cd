#pragma once

#include "hemi/core/patch_cuts.hpp"
#include "io/formats/chunk_file.hpp"

#include <cstdint>
#include <vector>

namespace hemi::io {

/// Numbers of parts of all surfaces, and then the parts: three numbers each.
[[nodiscard]] std::vector<std::uint32_t> stored_parts(const std::vector<std::vector<GridPart>>& parts);
/// The same from a file, up to the payload's end.
/// @param surfaces  how many there are
/// @param most      parts that there may be
/// @throws InputError
[[nodiscard]] std::vector<std::vector<GridPart>> read_parts(Payload payload, std::uint64_t surfaces,
                                                            std::uint64_t most);

} // namespace hemi::io
