#include "scenes/scene_files.hpp"
#include "support/device.hpp"
#include "support/item_agreement.hpp"

#include "engine/hemicube/gl_rows.hpp"
#include "engine/rasteriser/cpu_rows.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>

using namespace hemi;
using namespace hemi::test;

namespace {

std::vector<std::string> scene_files() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(scene_path(""))) {
        if (entry.is_regular_file()) {
            names.push_back(entry.path().filename());
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

/// Software OpenGL through EGL, if the machine has it.
std::optional<std::string> software_egl() {
    for (const DeviceInfo& device : list_devices()) {
        if (device.name.starts_with("egl") && device.software && device.problem.empty()) {
            return device.name;
        }
    }
    return std::nullopt;
}

} // namespace

TEST_CASE("scenes: OSMesa, transforming polygons itself or not, EGL and the CPU rasteriser show the items "
          "that rays meet, but within their "
          "distance of an edge",
          "[scenes][gl][slow]") {
    // What each says of itself, in texels: llvmpipe snaps vertices to 1/256, the rasteriser less than 1/1000.
    constexpr double llvmpipe_margin = 1.0 / 256.0;
    constexpr double cpu_margin = 1e-3;
    constexpr std::uint32_t patches = 6;
    const std::optional<std::string> egl = software_egl();
    REQUIRE(egl);
    for (const std::string& name : scene_files()) {
        const PatchMesh mesh(shipped_scene(name));
        for (const std::uint64_t seed : {0u, 5u}) {
            const HemicubeSettings settings{.resolution = 64, .seed = seed};
            const EngineGeometry geometry = make_engine_geometry(mesh, settings);
            const RasterScene scene(geometry.list);
            GlRows by_osmesa(geometry, settings, RowQuantity::form_factors, "osmesa");
            GlRows by_egl(geometry, settings, RowQuantity::form_factors, *egl);
            std::optional<GlRows> by_gpu_transform;
            {
                const WithTransform transform("gpu");
                by_gpu_transform.emplace(geometry, settings, RowQuantity::form_factors, "osmesa");
            }
            CpuRows by_cpu(geometry, scene, settings, RowQuantity::form_factors);
            for (std::uint32_t k = 0; k < patches; ++k) {
                const auto patch = static_cast<std::uint32_t>(std::uint64_t{k} * 2654435761u % mesh.size());
                INFO(name << ", seed " << seed << ", patch " << patch);
                CHECK(disagreements(mesh, settings, patch, llvmpipe_margin, by_osmesa) == 0);
                CHECK(by_egl.items(patch) == by_osmesa.items(patch));
                CHECK(disagreements(mesh, settings, patch, llvmpipe_margin, *by_gpu_transform) == 0);
                CHECK(disagreements(mesh, settings, patch, cpu_margin, by_cpu) == 0);
            }
        }
    }
}
