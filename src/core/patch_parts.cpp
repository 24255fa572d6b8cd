#include "hemi/core/patch_parts.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

namespace hemi {

std::vector<double> areas_of_patches(const PatchParts& parts, std::span<const double> areas) {
    if (areas.size() != parts.patch_of.size()) {
        throw InvalidArgument(
            fmt::format("{} areas for {} parts; must be one for each", areas.size(), parts.patch_of.size()));
    }
    std::vector<double> result(parts.patches(), 0.0);
    for (std::size_t k = 0; k < areas.size(); ++k) {
        if (parts.patch_of[k] >= result.size()) {
            throw InvalidArgument(fmt::format("part {} belongs to patch {}; there are {}", k,
                                              parts.patch_of[k], result.size()));
        }
        result[parts.patch_of[k]] += areas[k];
    }
    return result;
}

std::vector<double> means_of_patches(const PatchParts& parts, std::span<const double> areas,
                                     std::span<const double> values, std::size_t channels) {
    const std::vector<double> whole = areas_of_patches(parts, areas);
    if (values.size() != areas.size() * channels) {
        throw InvalidArgument(fmt::format("{} values for {} parts; must be {} for each", values.size(),
                                          areas.size(), channels));
    }
    std::vector<double> result(whole.size() * channels, 0.0);
    for (std::size_t k = 0; k < areas.size(); ++k) {
        const std::size_t patch = parts.patch_of[k];
        const double share = whole[patch] > 0.0 ? areas[k] / whole[patch] : 0.0;
        for (std::size_t c = 0; c < channels; ++c) {
            result[patch * channels + c] += share * values[k * channels + c];
        }
    }
    return result;
}

} // namespace hemi
