// The main job by the library: a scene file becomes a stored solution and a picture.
#include <hemi/hemi.hpp>

#include <iostream>

int main(int argc, char** argv) try {
    const hemi::Scene scene = hemi::io::read_scene(argc > 1 ? argv[1] : "room.json");
    const hemi::PatchMesh mesh(scene);
    const hemi::FormFactors factors = hemi::compute_form_factors(scene, mesh);
    const hemi::Solution solution = hemi::solve_radiosity(scene, mesh, factors);
    hemi::io::write_hres("room.hres", {scene, {}, solution});
    hemi::write_picture("room.png", hemi::draw_solution(scene, mesh, solution).picture);
} catch (const hemi::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
