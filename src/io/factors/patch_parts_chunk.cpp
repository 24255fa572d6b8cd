#include "io/factors/patch_parts_chunk.hpp"

#include <fmt/format.h>

#include <vector>

namespace hemi::io {

PatchParts read_patch_parts(Payload payload, std::uint32_t rows, std::uint32_t patches, std::size_t groups) {
    const auto take = [&](std::size_t count, std::size_t below, const char* what) {
        std::vector<std::uint32_t> indices = payload.take_array<std::uint32_t>(count);
        for (const std::uint32_t index : indices) {
            if (index >= below) {
                payload.fail(fmt::format("{} {}; there are {}", what, index, below));
            }
        }
        return indices;
    };
    PatchParts parts;
    parts.patch_of = take(rows, patches, "patch");
    parts.group_of = take(patches, groups, "group");
    payload.expect_end();
    return parts;
}

} // namespace hemi::io
