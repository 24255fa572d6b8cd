#pragma once

#include "engine/visibility_weighted/facing_test.hpp"
#include "engine/visibility_weighted/pair_visibility.hpp"
#include "engine/visibility_weighted/row_index.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace hemi {

/// Which pairs get shadow rays: those that are partly hidden, whose visibility rests on few texels, and whose
/// factors are large enough for it to matter. Rays cost more than all else that is done for a pair.
class ShadowRaySelection {
public:
    /// V of a pair before rays. @param row  position of patch i in the rows; @param j  the other patch
    using Estimate = std::function<PairEstimate(std::size_t row, std::uint32_t j)>;

    /// Looks at the pairs of a sample of the rows, which ranks share.
    /// @param mesh,facing  must outlive this
    /// @param patches      that have rows
    /// @param own          rows that can be estimated here
    /// @param rays         a pair
    ShadowRaySelection(const PatchMesh& mesh, const FacingTest& facing,
                       std::span<const std::uint32_t> patches, const OwnRows& own, std::uint32_t rays,
                       const Estimate& estimate);

    /// Whether the pair (i, j) gets rays.
    [[nodiscard]] bool operator()(const PairEstimate& pair, std::uint32_t i, std::uint32_t j) const {
        return is_uncertain(pair) && variance(pair, i, j) >= min_variance_;
    }

private:
    [[nodiscard]] bool is_uncertain(const PairEstimate& pair) const;
    [[nodiscard]] double variance(const PairEstimate& pair, std::uint32_t i, std::uint32_t j) const;
    [[nodiscard]] double find_min_variance(std::span<const std::uint32_t> patches, const OwnRows& own,
                                           const Estimate& estimate) const;

    const PatchMesh& mesh_;
    const FacingTest& facing_;
    double rays_;
    double min_variance_ = 0.0;
};

} // namespace hemi
