#pragma once

#include "hemi/core/patch_parts.hpp"
#include "io/formats/chunk_file.hpp"

#include <cstddef>
#include <cstdint>

namespace hemi::io {

/// PatchParts as a whole payload: the patch that each row is a part of, then the group of each patch.
/// @param rows     how many there are
/// @param patches  that they are parts of
/// @param groups   how many there are
/// @throws InputError
[[nodiscard]] PatchParts read_patch_parts(Payload payload, std::uint32_t rows, std::uint32_t patches,
                                          std::size_t groups);

} // namespace hemi::io
