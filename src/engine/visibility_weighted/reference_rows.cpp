#include "hemi/engine/reference_rows.hpp"

#include "hemi/core/interrupt.hpp"
#include "hemi/engine/visibility_weighted.hpp"

#include <algorithm>
#include <cmath>

namespace hemi {

namespace {

// Fewer rows say too little of the variance of all, see error_estimate.cpp.
constexpr std::uint32_t min_rows = 12;
// The most that a patch can have, and the next lower square, whose points are none of those.
constexpr std::uint32_t max_eye_points = 64;
constexpr std::uint32_t other_eye_points = 49;
// What a hemicube takes besides its texels, in the time of texels.
constexpr double texels_of_overhead = 3e4;

} // namespace

std::vector<std::uint32_t> reference_patches(std::span<const std::uint32_t> patches, std::uint32_t count) {
    std::vector<std::uint32_t> chosen;
    count = static_cast<std::uint32_t>(std::min<std::size_t>(count, patches.size()));
    const bool dense = 2 * std::size_t{count} > patches.size(); // then no two may share a step
    for (std::uint32_t k = 0; k < count; ++k) {
        const double within = dense ? 0.5 : std::fmod(0.6180339887498949 * (k + 1), 1.0);
        chosen.push_back(
            patches[static_cast<std::size_t>((k + within) * static_cast<double>(patches.size()) / count)]);
    }
    return chosen;
}

HemicubeSettings reference_settings(const HemicubeSettings& settings) {
    HemicubeSettings better = settings;
    const bool has_max = std::max(settings.eye_points, settings.near_eye_points) == max_eye_points;
    const std::uint32_t max = has_max ? other_eye_points : max_eye_points; // never the same places
    better.eye_points = std::clamp<std::uint32_t>(4 * settings.eye_points, 16, max);
    better.near_eye_points = max;
    better.resolution = std::max<std::uint32_t>(64, settings.eye_points > 1 ? settings.resolution : 64);
    better.seed = ~settings.seed;
    return better;
}

std::uint32_t reference_count(const HemicubeSettings& settings, std::size_t rows, double share,
                              std::uint32_t most) {
    const auto cost = [](const HemicubeSettings& of) {
        const double texels = 3.0 * of.resolution * of.resolution;
        return of.eye_points * (texels + texels_of_overhead);
    };
    const double affordable =
        share * static_cast<double>(rows) * cost(settings) / cost(reference_settings(settings));
    const auto count = static_cast<std::size_t>(
        std::clamp(affordable, static_cast<double>(min_rows), static_cast<double>(most)));
    return static_cast<std::uint32_t>(std::min(count, rows));
}

FormFactorMatrix compute_reference(VisibilityProvider& visibility, const PatchMesh& mesh,
                                   std::span<const std::uint32_t> patches, const Progress& progress) {
    const Progress stop = [](std::size_t, std::size_t) {
        stop_if_interrupted();
        return true;
    };
    return compute_visibility_weighted(visibility, mesh, patches, {ExchangeRule::exact, 0},
                                       Enclosure::automatic, progress, stop, stop);
}

} // namespace hemi
