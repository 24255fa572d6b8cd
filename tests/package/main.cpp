// Reads a scene, computes its form factors and its radiosity, and prints the radiosity of every group.
#include <hemi/core/error.hpp>
#include <hemi/engine/engine.hpp>
#include <hemi/io/scene_reader.hpp>
#include <hemi/solver/solver.hpp>

#include <iostream>

int main(int argc, char** argv) try {
    hemi::Diagnostics diagnostics;
    const hemi::Scene scene = hemi::io::read_scene(argc > 1 ? argv[1] : "", {}, diagnostics);
    const hemi::PatchMesh mesh(scene);
    const auto engine = hemi::make_hemicube_engine(mesh, {.resolution = 64}, {.device = "osmesa"});
    const hemi::FormFactorMatrix factors = hemi::compute_matrix(*engine);

    const std::size_t channels = scene.channels.size();
    std::vector<double> reflectance, exitance;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        const hemi::Material& material = scene.materials[mesh.material(i)];
        reflectance.insert(reflectance.end(), material.reflectance.begin(), material.reflectance.end());
        exitance.insert(exitance.end(), material.exitance.begin(), material.exitance.end());
    }
    const hemi::RadiositySolution solution = hemi::solve_radiosity(
        {&factors, static_cast<std::uint32_t>(channels), reflectance, exitance, scene.environment});

    std::vector<double> power(scene.groups.size()), area(scene.groups.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        power[mesh.group(i)] += mesh.areas()[i] * solution.radiosity[i * channels];
        area[mesh.group(i)] += mesh.areas()[i];
    }
    for (std::size_t g = 0; g < scene.groups.size(); ++g) {
        std::cout << scene.groups[g] << ' ' << power[g] / area[g] << '\n';
    }
} catch (const hemi::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
