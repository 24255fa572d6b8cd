#pragma once

#include "engine/hemicube/gl_rows.hpp"
#include "hemi/engine/engine.hpp"

#include <memory>

namespace hemi {

/// Rows from worker processes: one per core on software OpenGL, a single one on a GPU.
/// @throws InvalidArgument, NoDevice, GlError, Error as make_hemicube_engine, on first use.
[[nodiscard]] std::unique_ptr<RawRowProvider> make_worker_pool(std::unique_ptr<const EngineGeometry> geometry,
                                                               const HemicubeSettings& settings,
                                                               RowQuantity quantity,
                                                               const EngineSettings& engine);

} // namespace hemi
