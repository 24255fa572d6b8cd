#include "engine/hemicube/engine_geometry.hpp"

namespace hemi {

EngineGeometry make_engine_geometry(const PatchMesh& mesh, const HemicubeSettings& settings) {
    return {make_draw_list(mesh, settings.merge_lattices),
            make_eye_points(mesh, settings.eye_points, settings.near_eye_points), mesh.size(),
            DirectionMeasure::projected_solid_angle};
}

} // namespace hemi
