#pragma once

#include "engine/hemicube/gl_rows.hpp"
#include "hemi/engine/engine.hpp"

#include <memory>

namespace hemi {

/// Rows from worker processes: unless `jobs` says how many, one per core on software OpenGL, up to four on a
/// GPU.
/// @throws InvalidArgument, NoDevice, GlError, Error as make_hemicube_engine, on first use.
[[nodiscard]] std::unique_ptr<RawRowProvider> make_worker_pool(std::unique_ptr<const EngineGeometry> geometry,
                                                               const HemicubeSettings& settings,
                                                               RowQuantity quantity,
                                                               const EngineSettings& engine);

} // namespace hemi
