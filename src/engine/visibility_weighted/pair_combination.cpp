#include "engine/visibility_weighted/pair_combination.hpp"

#include "core/parallel_for.hpp"
#include "engine/rays/shadow_rays.hpp"
#include "engine/visibility_weighted/coplanar_neighbours.hpp"
#include "engine/visibility_weighted/facing_test.hpp"
#include "engine/visibility_weighted/shadow_ray_selection.hpp"
#include "hemi/core/error.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <utility>

namespace hemi {

namespace {

constexpr std::size_t rows_per_task = 16;

/// V from both directions: their mean, weighted by the texels that each rests on.
/// @param assumed  V where neither is known
PairEstimate combine(VisibilitySample a, VisibilitySample b, double assumed) {
    if (!a.known() && !b.known()) {
        return {PairVisibility::from(assumed), 0.0};
    }
    const double weight_a = a.known() ? a.weight() : 0.0;
    const double weight_b = b.known() ? b.weight() : 0.0;
    const double texels = weight_a + weight_b;
    if ((a.is_clear() || !a.known()) && (b.is_clear() || !b.known())) {
        return {PairVisibility::clear(), texels};
    }
    return {PairVisibility::from((weight_a * a.share() + weight_b * b.share()) / texels), texels};
}

/// V of single pairs, by texels alone.
class PairEstimator {
public:
    /// All must outlive this.
    PairEstimator(const VisibilityTable& table, const ImageMesh& images, const FacingTest& facing)
        : table_(table), images_(images), facing_(facing), neighbours_(images.mesh()) {}

    /// Of row k and patch j, which may be an image.
    [[nodiscard]] PairEstimate operator()(std::size_t k, std::uint32_t j) const {
        const std::uint32_t i = table_.index.patches()[k];
        const auto [from, to] = images_.counterpart(i, j);
        const std::uint32_t other = table_.index.row_of(from);
        // A patch and its mirror image see one another by the same sample.
        const bool one_way = other == RowIndex::no_row || (from == i && to == j);
        VisibilitySample there = table_.samples[k][j];
        VisibilitySample back = one_way ? VisibilitySample() : table_.samples[other][to];
        const auto is_hidden = [](VisibilitySample one) { return one.known() && one.share() == 0.0; };
        if ((is_hidden(there) && !back.known()) || (is_hidden(back) && !there.known()) || !facing_(i, j)) {
            return {PairVisibility(), 1.0}; // known, not assumed: so 1 texel says so
        }
        // The best guess without any texel: what the two patches see of others.
        double assumed = 1.0;
        if (!there.known() && !back.known()) {
            there = neighbours_.stand_in(table_.samples[k], j);
            back = one_way ? VisibilitySample() : neighbours_.stand_in(table_.samples[other], to);
            assumed = one_way ? table_.mean[k] : 0.5 * (table_.mean[k] + table_.mean[other]);
        }
        return combine(there, back, assumed);
    }

private:
    const VisibilityTable& table_;
    const ImageMesh& images_;
    const FacingTest& facing_;
    CoplanarNeighbours neighbours_;
};

/// Texels and rays together, each weighted by their number.
void add_rays(const ShadowRays::Estimate& traced, PairEstimate& pair) {
    if (const double total = pair.texels + traced.rays; total > 0.0) {
        pair.visibility = PairVisibility::from(
            (pair.texels * pair.visibility.value() + traced.rays * traced.visibility) / total);
    }
}

} // namespace

PairTable combine_pairs(VisibilityTable samples, const ImageMesh& images, std::uint32_t shadow_rays,
                        const Progress& progress) {
    const std::span<const std::uint32_t> patches = samples.index.patches();
    const std::uint32_t size = samples.index.size();
    std::vector<std::vector<PairVisibility>> visibility(patches.size());
    const OwnRows own = samples.own;
    parallel_for(own.count(), rows_per_task, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            visibility[own[k]].resize(size);
        }
    });
    const PatchMesh& mesh = images.mesh();
    const FacingTest facing(mesh);
    const PairEstimator estimate(samples, images, facing);
    std::optional<ShadowRays> rays;
    std::optional<ShadowRaySelection> selected;
    if (shadow_rays > 0) {
        rays.emplace(mesh);
        selected.emplace(mesh, facing, patches, own, shadow_rays, std::cref(estimate));
    }
    // A pair of two rows is combined by the lower one, which alone writes both entries.
    const auto combine_part = [&](std::size_t k, std::uint32_t from, std::uint32_t upto) {
        const std::uint32_t i = patches[k];
        for (std::uint32_t j = from; j < upto; ++j) {
            const auto [from_end, to] = images.counterpart(i, j);
            const std::uint32_t other = samples.index.row_of(from_end);
            const bool by_other = from_end < i || (from_end == i && to < j);
            if (j == i || (other != RowIndex::no_row && by_other)) {
                continue;
            }
            PairEstimate pair = estimate(k, j);
            if (selected && (*selected)(pair, i, j)) {
                add_rays(rays->visibility(i, j, shadow_rays), pair);
            }
            visibility[k][j] = pair.visibility;
            if (other != RowIndex::no_row && own.contains(other)) {
                visibility[other][to] = pair.visibility;
            }
        }
    };
    // By tiles, few enough columns for the caches: what lies on the other side of the diagonal is far
    // apart from column to column, but side by side from row to row.
    constexpr std::size_t rows_at_once = 64;
    constexpr std::size_t columns_at_once = 64;
    for (std::size_t first = 0; first < own.count(); first += rows_at_once) {
        const std::size_t end = std::min(first + rows_at_once, own.count());
        parallel_for(size, columns_at_once, [&](std::size_t from, std::size_t upto) {
            for (std::size_t k = first; k < end; ++k) {
                combine_part(own[k], static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(upto));
            }
        });
        if (progress && !progress(end, own.count())) {
            throw Cancelled();
        }
    }
    return {samples.index, own, std::move(visibility), std::move(samples.environment),
            std::move(samples.blocked)};
}

} // namespace hemi
