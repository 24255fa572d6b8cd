#include "pipeline/known_corners.hpp"

#include <cstddef>
#include <vector>

namespace hemi {

namespace {

/// A patch that reflects more than so many times what it did, or less than that part, has another light.
constexpr double most_growth = 2.0;

} // namespace

KnownCorners known_corners(const Solution& before, const Solution& now,
                           std::span<const std::uint32_t> parents) {
    KnownCorners known;
    if (before.vertex_radiosity.empty()) {
        return known;
    }
    const std::size_t channels = now.channels;
    std::vector<std::uint32_t> parts(before.radiosity.size() / channels, 0);
    for (const std::uint32_t parent : parents) {
        ++parts[parent];
    }
    known.values.assign(4 * now.radiosity.size(), 0.0F);
    for (std::uint32_t i = 0; i < parents.size(); ++i) {
        if (parts[parents[i]] > 1) {
            known.unknown.push_back(i);
            continue;
        }
        bool is_known = true;
        for (std::size_t c = 0; c < channels; ++c) {
            const std::size_t at = i * channels + c;
            const std::size_t was = parents[i] * channels + c;
            const double was_reflected = before.radiosity[was] - before.exitance[was];
            const double reflected = now.radiosity[at] - now.exitance[at];
            const double growth = reflected == was_reflected ? 1.0 : reflected / was_reflected;
            is_known = is_known && growth >= 1.0 / most_growth && growth <= most_growth;
            for (std::size_t k = 0; k < 4; ++k) {
                const float shown = before.vertex_radiosity[(std::size_t{parents[i]} * 4 + k) * channels + c];
                known.values[(std::size_t{i} * 4 + k) * channels + c] = static_cast<float>(
                    now.exitance[at] + growth * (static_cast<double>(shown) - before.exitance[was]));
            }
        }
        if (!is_known) {
            known.unknown.push_back(i);
        }
    }
    return known;
}

} // namespace hemi
