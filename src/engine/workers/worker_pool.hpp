#pragma once

#include "engine/hemicube/gl_rows.hpp"
#include "hemi/engine/engine.hpp"

#include <cstdint>
#include <memory>

namespace hemi {

/// What a hemicube shows is found on the CPU, so one process leaves a GPU idle. More than these bring little,
/// while each takes a tenth of a second and memory for a context of its own.
inline constexpr std::uint32_t gpu_processes = 4;

/// Rows from worker processes: unless `jobs` says how many, one per core on software OpenGL, up to four on a
/// GPU.
/// @throws InvalidArgument, NoDevice, GlError, Error as make_hemicube_engine, on first use.
[[nodiscard]] std::unique_ptr<RawRowProvider> make_worker_pool(std::unique_ptr<const EngineGeometry> geometry,
                                                               const HemicubeSettings& settings,
                                                               RowQuantity quantity,
                                                               const EngineSettings& engine);

} // namespace hemi
