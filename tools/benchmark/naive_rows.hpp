#pragma once

#include "engine/hemicube/eye.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "hemi/engine/engine.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace hemi::bench {

/// What the back of a front patch counts as: its back patch, or blocked.
[[nodiscard]] std::uint32_t item_of_back(const PatchMesh& mesh, std::uint32_t patch);

/// The textbook hemicube, to measure against: every row draws all patches five times, each patch with an item
/// id of its own, reads the five faces back one by one and sums texel by texel on the CPU. Same eyes,
/// rotation, facing and delta form factors as the engine; conventional perspective and depth.
class NaiveRows final : public RowProvider {
public:
    /// @param mesh  must outlive this.
    /// @throws NoDevice, GlError
    NaiveRows(const PatchMesh& mesh, const HemicubeSettings& settings, const std::string& device);
    ~NaiveRows() override;
    NaiveRows(const NaiveRows&) = delete;
    NaiveRows& operator=(const NaiveRows&) = delete;

    [[nodiscard]] std::uint32_t size() const override { return static_cast<std::uint32_t>(eyes_.size()); }
    [[nodiscard]] std::string renderer() const override { return context_->renderer(); }
    void rows(std::span<const std::uint32_t> patches, const RowSink& sink) override;

private:
    /// What a face is drawn into: res x res for the top, res x res / 2 for a side.
    struct Target {
        gl::Texture2D ids;
        gl::Texture2D depth;
        gl::Framebuffer framebuffer;
        GLsizei width = 0;
        GLsizei height = 0;
    };
    static void allocate(Target& target, GLsizei width, GLsizei height);
    void upload(const PatchMesh& mesh);
    static void set_state();
    void draw_hemicube(std::uint32_t patch);
    void draw_face(const std::array<float, 16>& clip_from_world, const Target& target, std::uint32_t* ids);
    [[nodiscard]] std::array<float, 16> clip_from_world(const EyePoint& eye, const EyeFrame& frame,
                                                        int face) const;
    [[nodiscard]] RowView take_row();

    std::unique_ptr<gl::Context> context_; // before the objects that live in it
    HemicubeSettings settings_;
    std::vector<EyePoint> eyes_;
    double near_;
    double far_;
    gl::Program program_;
    gl::VertexArray layout_;
    gl::Buffer vertices_;
    GLsizei vertex_count_ = 0;
    Target top_;
    Target side_;
    std::vector<std::uint32_t> weights_; ///< delta form factor per texel
    std::vector<std::uint32_t> ids_;     ///< item per texel, as weights_
    std::vector<std::uint32_t> sums_;    ///< per item
    std::vector<std::uint32_t> columns_;
    std::vector<float> values_;
};

} // namespace hemi::bench
