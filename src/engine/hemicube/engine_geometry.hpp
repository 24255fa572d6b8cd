#pragma once

#include "engine/hemicube/draw_list.hpp"
#include "engine/hemicube/eye.hpp"
#include "hemi/engine/delta_form_factors.hpp"
#include "hemi/engine/engine.hpp"

namespace hemi {

/// All that an engine needs to know of a mesh: what to draw, and from where. Can be sent to a worker.
struct EngineGeometry {
    DrawList list;
    EyePoints eyes;                                                     ///< of every row
    std::uint32_t patches = 0;                                          ///< N, the columns of a row
    DirectionMeasure measure = DirectionMeasure::projected_solid_angle; ///< of texels' weights
};
[[nodiscard]] EngineGeometry make_engine_geometry(const PatchMesh& mesh, const HemicubeSettings& settings);

} // namespace hemi
