#pragma once

#include "engine/hemicube/engine_geometry.hpp"
#include "engine/rasteriser/rasteriser.hpp"
#include "engine/rasteriser/side_sets.hpp"
#include "engine/raw_row.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace hemi {

/// Rows by item buffers of the CPU rasteriser, on the calling thread. What a thread has of its own: the
/// rest, RasterScene, is shared.
class CpuRows {
public:
    /// @param geometry  and `scene`, which is made of its draw list, must outlive this
    /// @param quantity  what the rows mean
    /// @param sets      what rows of visibility of one eye point tell of as a whole; null: nothing. Must
    ///   outlive this.
    CpuRows(const EngineGeometry& geometry, const RasterScene& scene, const HemicubeSettings& settings,
            RowQuantity quantity, const SideSets* sets = nullptr);
    ~CpuRows();
    CpuRows(const CpuRows&) = delete;
    CpuRows& operator=(const CpuRows&) = delete;

    /// The row of a patch, valid until the next call.
    [[nodiscard]] RawRow row(std::uint32_t patch);

    /// The item buffer of one eye point of a patch, as GlRows::items().
    [[nodiscard]] std::vector<std::uint32_t> items(std::uint32_t patch, std::uint32_t eye = 0);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Rows by the CPU rasteriser in threads of this process, handed out in order.
/// @param threads  0: one per core
[[nodiscard]] std::unique_ptr<RawRowProvider> make_cpu_engine(std::unique_ptr<const EngineGeometry> geometry,
                                                              const HemicubeSettings& settings,
                                                              RowQuantity quantity, std::uint32_t threads);

/// What a CPU engine calls itself: "hemi CPU rasteriser (avx2)".
/// @throws InvalidArgument where HEMI_SIMD names an instruction set that is not there
[[nodiscard]] std::string cpu_renderer();

} // namespace hemi
