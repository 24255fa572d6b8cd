#pragma once

#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace hemi {

class EmbreeScene;

/// Nearest patches along rays, by Embree.
///
/// Surfaces in whose plane a
/// ray starts are not met, and a front at the depth of a back wins, as with the hemicubes.
/// Thread-safe after construction.
class RayTracer {
public:
    enum class Side { nothing, front, back };
    struct Hit {
        Side side = Side::nothing; ///< back: of a one-sided surface, which blocks and receives nothing
        std::uint32_t patch = 0; ///< what receives; of a two-sided surface the patch on the side that was met
    };

    /// @param mesh  must outlive the tracer.
    /// @throws Error if Embree cannot be set up.
    explicit RayTracer(const PatchMesh& mesh);
    ~RayTracer();

    /// @param origin,direction  in scene units; the length of `direction` does not matter.
    [[nodiscard]] Hit trace(const Vec3& origin, const Vec3& direction) const;

    /// Name and version of the library.
    [[nodiscard]] static std::string name();

private:
    struct Query;

    /// Which side of the surface of `patch`, a front patch, the origin sees; nothing if it lies in its plane.
    [[nodiscard]] Side side(const Vec3& origin, std::uint32_t patch) const;

    const PatchMesh& mesh_;
    double rounding_;
    std::vector<std::uint32_t> patch_of_; ///< patch of every primitive
    std::unique_ptr<EmbreeScene> scene_;
};

} // namespace hemi
