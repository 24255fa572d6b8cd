#pragma once

#include "core/box_tree.hpp"
#include "hemi/engine/point_rows.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace hemi {

/// Finds the patches of a mesh that points lie on, whatever mesh the points were made for.
class PatchLocator {
public:
    /// @param mesh  must outlive it
    explicit PatchLocator(const PatchMesh& mesh);

    /// The patch that a point lies on and that looks its way; of several, the one whose middle is nearest.
    /// Nothing where there is none.
    [[nodiscard]] std::optional<std::uint32_t> find(const SurfacePoint& point) const;

    /// Weights of a patch's corners at a point on it: barycentric in triangles, bilinear in quadrilaterals.
    [[nodiscard]] std::array<double, 4> weights(std::uint32_t patch, const Vec3& point) const;

private:
    const PatchMesh* mesh_;
    double tolerance_;
    BoxTree tree_;
};

} // namespace hemi
