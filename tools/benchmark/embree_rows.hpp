#pragma once

#include "engine/hemicube/eye.hpp"
#include "engine/hemicube/row_accumulator.hpp"
#include "hemi/engine/engine.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace hemi {
class EmbreeScene;
}

namespace hemi::bench {

/// Rows by rays, to measure hemicubes against: Embree on all patches, packets of 16 rays, one thread.
class EmbreeRows final : public RowProvider {
public:
    enum class Rays {
        /// One through the centre of every texel of the engine's hemicube, in tiles of 4 x 4: the same rows.
        texels,
        /// As many, from Sobol points of the patch in cosine-weighted Sobol directions, each worth the same.
        monte_carlo,
    };

    /// @param mesh  must outlive this.
    /// @throws Error if Embree cannot be set up; InvalidArgument for a resolution that is no multiple of 8.
    EmbreeRows(const PatchMesh& mesh, const HemicubeSettings& settings, Rays rays);
    ~EmbreeRows() override;
    EmbreeRows(const EmbreeRows&) = delete;
    EmbreeRows& operator=(const EmbreeRows&) = delete;

    [[nodiscard]] std::uint32_t size() const override { return mesh_.size(); }
    [[nodiscard]] std::string renderer() const override;
    void rows(std::span<const std::uint32_t> patches, const RowSink& sink) override;
    [[nodiscard]] std::uint32_t rays_a_row() const { return static_cast<std::uint32_t>(items_.size()); }

private:
    void trace_texels(std::uint32_t patch);
    void trace_random(std::uint32_t patch);
    [[nodiscard]] std::uint32_t item(std::uint32_t primitive, const Vec3& direction) const;

    const PatchMesh& mesh_;
    HemicubeSettings settings_;
    Rays rays_;
    EyePoints eyes_;
    DeltaFormFactors weights_;
    std::vector<std::uint32_t> patch_of_; ///< patch of every primitive
    std::unique_ptr<EmbreeScene> scene_;
    std::vector<std::uint32_t> identity_; ///< items are their own draw ids
    RowAccumulator accumulator_;
    std::vector<std::uint32_t> items_;  ///< per texel
    std::vector<std::uint32_t> counts_; ///< Monte Carlo: rays per item
    std::vector<std::uint32_t> columns_;
    std::vector<float> values_;
};

} // namespace hemi::bench
