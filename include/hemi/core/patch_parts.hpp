#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Which patches of one mesh make up those of another: what is left of faces where others touch them, and the
/// patches of the faces as they were read. Nothing at all where each patch is its own only part.
struct PatchParts {
    std::vector<std::uint32_t> patch_of; ///< of every part, the patch that it is part of
    /// Of every patch that has parts or had, the index of its group: as many as there are patches.
    std::vector<std::uint32_t> group_of;

    /// Whether patches have parts.
    [[nodiscard]] bool any() const noexcept { return !group_of.empty(); }
    /// Number of patches.
    [[nodiscard]] std::uint32_t patches() const noexcept {
        return static_cast<std::uint32_t>(group_of.size());
    }

    bool operator==(const PatchParts&) const = default; ///< member by member
};

/// Area of what is left of patches; 0 where nothing is.
/// @param parts  parts of the patches
/// @param areas  of every part
/// @return one for every patch
/// @throws InvalidArgument if the areas are not as many as the parts, or a part belongs to no patch
[[nodiscard]] std::vector<double> areas_of_patches(const PatchParts& parts, std::span<const double> areas);

/// Means over patches of what is known of their parts, by area; 0 of a patch of which nothing is left.
/// @param parts     parts of the patches
/// @param areas     of every part
/// @param values    of every part, `channels` for each: channel c of part k at [k·channels + c]
/// @param channels  1 or more
/// @return the same for every patch
/// @throws InvalidArgument if areas or values are not as many as the parts, or a part belongs to no patch
[[nodiscard]] std::vector<double> means_of_patches(const PatchParts& parts, std::span<const double> areas,
                                                   std::span<const double> values, std::size_t channels = 1);

} // namespace hemi
