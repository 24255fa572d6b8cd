#include "io/results/baked_mesh.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hemi::io {

void check_baked(const PatchMesh& mesh, std::span<const float> radiosity, double exposure) {
    if (radiosity.size() != std::size_t{mesh.size()} * 12) {
        throw InvalidArgument(
            fmt::format("{} radiosities for {} patches; must be 12 for each", radiosity.size(), mesh.size()));
    }
    if (!(exposure >= 0.0) || !std::isfinite(exposure) ||
        !std::all_of(radiosity.begin(), radiosity.end(), [](float b) { return std::isfinite(b); })) {
        throw InvalidArgument(
            "an exposure that is negative or not finite, or a radiosity that is not finite");
    }
}

} // namespace hemi::io
