// Vertices and faces from memory, no file: the radiosity of a box whose walls radiate 1 W/m² and reflect 80
// %.
#include <hemi/hemi.hpp>

#include <array>
#include <iostream>

int main(int argc, char** argv) try {
    const std::vector<hemi::Vec3> vertices{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                           {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    const std::vector<std::array<std::size_t, 4>> faces{{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1},
                                                        {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
    hemi::Scene scene;
    scene.materials = {{"wall", {0.8}, {1.0}}};
    for (const auto& face : faces) {
        hemi::Surface wall;
        for (std::size_t k = 0; k < 4; ++k) {
            wall.vertices[k] = vertices[face[k]];
        }
        wall.group = scene.group_index("wall " + std::to_string(scene.surfaces.size()));
        wall.patches = hemi::Grid{4, 4};
        scene.surfaces.push_back(wall);
    }
    const hemi::PatchMesh mesh(scene);
    hemi::FactorSettings settings;
    settings.preset = hemi::Preset::fast;
    settings.engine.device = argc > 1 ? argv[1] : "auto";
    const hemi::FormFactors factors = hemi::compute_form_factors(scene, mesh, settings);
    for (const double radiosity : hemi::solve_radiosity(scene, mesh, factors).radiosity) {
        std::cout << radiosity << '\n';
    }
} catch (const hemi::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
