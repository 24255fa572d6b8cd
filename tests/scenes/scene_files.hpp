#pragma once

#include "support/device.hpp"
#include "support/places.hpp"

#include "hemi/core/diagnostics.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solver.hpp"

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

/// The scenes that come with hemi, and what a run of the whole chain makes of them.
namespace hemi::test {

inline std::string scene_path(const std::string& name) {
    return std::string(HEMI_SOURCE_DIR "/scenes/") + name;
}

/// Reads a scene of scenes/, which must give no warning.
inline Scene shipped_scene(const std::string& name) {
    Diagnostics diagnostics;
    Scene scene = io::read_scene(scene_path(name), {}, diagnostics);
    if (!diagnostics.warnings().empty()) {
        throw std::runtime_error(name + ": " + diagnostics.warnings().front());
    }
    return scene;
}

inline FormFactorMatrix hemicube_rows(const PatchMesh& mesh, std::uint32_t resolution,
                                      const std::vector<std::uint32_t>& patches) {
    const auto engine =
        make_hemicube_engine(mesh, {.resolution = resolution}, {test_device(), 2, find_worker_program()});
    return compute_matrix(*engine, patches);
}

/// Every `step`-th patch.
inline std::vector<std::uint32_t> every(std::uint32_t step, const PatchMesh& mesh) {
    std::vector<std::uint32_t> patches;
    for (std::uint32_t i = 0; i < mesh.size(); i += step) {
        patches.push_back(i);
    }
    return patches;
}

/// Radiosity, channel c of patch i at [i·channels + c].
inline std::vector<double> solved(const Scene& scene, const PatchMesh& mesh,
                                  const FormFactorMatrix& factors) {
    std::vector<double> reflectance;
    std::vector<double> exitance;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const Material& material = scene.materials[mesh.material(i)];
        reflectance.insert(reflectance.end(), material.reflectance.begin(), material.reflectance.end());
        exitance.insert(exitance.end(), material.exitance.begin(), material.exitance.end());
    }
    const auto channels = static_cast<std::uint32_t>(scene.channels.size());
    return solve_radiosity({&factors, channels, reflectance, exitance, scene.environment}).radiosity;
}

} // namespace hemi::test
