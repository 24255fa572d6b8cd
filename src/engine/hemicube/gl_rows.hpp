#pragma once

#include "engine/hemicube/engine_geometry.hpp"
#include "engine/raw_row.hpp"
#include "hemi/engine/engine.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hemi::gl {
class Context;
}

namespace hemi {

/// Rows by item buffers on one context of this process and thread.
class GlRows {
public:
    /// @param quantity  what the rows mean
    /// @throws NoDevice, GlError
    GlRows(const EngineGeometry& geometry, const HemicubeSettings& settings, RowQuantity quantity,
           const std::string& device);
    /// The same on a context that is there already, for what a window shows of the hemicubes: items() only.
    /// The context must outlive it, and be current when it is made and destroyed.
    GlRows(const EngineGeometry& geometry, const HemicubeSettings& settings, gl::Context& context);
    ~GlRows();
    GlRows(const GlRows&) = delete;
    GlRows& operator=(const GlRows&) = delete;

    [[nodiscard]] const std::string& renderer() const;
    [[nodiscard]] bool software() const;

    /// Computes rows in the order given and hands each on.
    void rows(std::span<const std::uint32_t> patches, const RawRowProvider::Sink& sink);

    /// The item buffer of one eye point of a patch: 3·resolution rows of `resolution` items (see
    /// draw_list.hpp). For tests and for looking at what a patch sees. Leaves OpenGL's default state behind.
    [[nodiscard]] std::vector<std::uint32_t> items(std::uint32_t patch, std::uint32_t eye = 0);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace hemi
