#pragma once

#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solution.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hemi::test {

/// Mean irradiance of every group, by area, of a solution of one channel.
inline std::vector<double> group_irradiance(const PatchMesh& mesh, const Solution& solution) {
    std::vector<double> light(mesh.groups().size(), 0.0);
    std::vector<double> area(light.size(), 0.0);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        light[mesh.group(i)] += mesh.areas()[i] * solution.irradiance[i];
        area[mesh.group(i)] += mesh.areas()[i];
    }
    for (std::size_t g = 0; g < light.size(); ++g) {
        light[g] /= area[g];
    }
    return light;
}

} // namespace hemi::test
