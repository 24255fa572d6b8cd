#pragma once

#include "engine/hemicube/draw_list.hpp"
#include "engine/hemicube/eye.hpp"
#include "hemi/engine/engine.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace hemi {

/// What a patch's hemicube should show, found without OpenGL: a ray through every texel centre against every
/// surface, in double precision.
class ReferenceTracer {
public:
    struct Hit {
        std::uint32_t item = item_nothing;
        std::uint32_t surface = 0xFFFFFFFFu; ///< what was met, front or back; all ones for nothing
    };

    /// @param mesh  must outlive the tracer.
    ReferenceTracer(const PatchMesh& mesh, const HemicubeSettings& settings);

    /// The item buffer of one eye point of a patch, as GlRows::items().
    [[nodiscard]] std::vector<std::uint32_t> items(std::uint32_t patch, std::uint32_t eye_index = 0) const;

    [[nodiscard]] const EyePoints& eyes() const noexcept { return eyes_; }

    /// The nearest surface from `eye`, which lies on `patch`, in `direction`.
    [[nodiscard]] Hit trace(std::uint32_t patch, const Vec3& eye, const Vec3& direction) const;

private:
    static bool inside(const Surface& surface, const Vec3& normal, const Vec3& point);

    const PatchMesh& mesh_;
    HemicubeSettings settings_;
    EyePoints eyes_;
    double tolerance_;
};

/// Rows of F as make_hemicube_engine() has them, without OpenGL: by ReferenceTracer. Slow (resolution² ×
/// surfaces a row) and obviously correct: what the tests compare the engine with.
/// @param mesh  must outlive the engine
/// @throws InvalidArgument for a bad resolution or number of eye points
[[nodiscard]] std::unique_ptr<RowProvider> make_reference_engine(const PatchMesh& mesh,
                                                                 const HemicubeSettings& settings);

} // namespace hemi
