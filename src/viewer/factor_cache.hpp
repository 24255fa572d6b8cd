#pragma once

#include "hemi/matrix/form_factors.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <memory>
#include <mutex>

namespace hemi::viewer {

/// Prepared form factors: once found, they serve every scene of the same geometry. Used from several threads.
class FactorCache {
public:
    /// Form factors of this geometry; null: none.
    [[nodiscard]] std::shared_ptr<const FormFactors> find(const Scene& scene, const PatchMesh& mesh) const {
        const std::lock_guard lock(mutex_);
        const bool same = factors_ && factors_->geometry_hash == mesh.geometry_hash() &&
                          factors_->enclosure == scene.enclosure;
        return same ? factors_ : nullptr;
    }
    void keep(std::shared_ptr<const FormFactors> factors) {
        const std::lock_guard lock(mutex_);
        factors_ = std::move(factors);
    }

private:
    mutable std::mutex mutex_;
    std::shared_ptr<const FormFactors> factors_;
};

} // namespace hemi::viewer
