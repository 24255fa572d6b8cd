#include "pipeline/quarter_rows.hpp"

#include "engine/clusters/cluster_tree.hpp"
#include "hemi/engine/clustered_rows.hpp"
#include "hemi/engine/visibility_weighted.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "pipeline/row_computation.hpp"

#include <algorithm>
#include <utility>

namespace hemi {

namespace {

/// Patches whose radius, and the sample's, are not below this share of the gap between them are near, see
/// ClusterTree::seen_from(). Whatever it is, printed errors of a city and of an office stay within 3 % of
/// what they are where all patches are cut. Chosen, not fitted.
constexpr double near_opening = 0.2;

/// Those of the sample, and those near them.
std::vector<std::uint32_t> near_patches(const PatchMesh& mesh, std::span<const DrawnPatch> sample) {
    const ClusterTree tree(mesh);
    std::vector<std::uint8_t> near(mesh.size(), 0);
    std::vector<ClusterTree::Part> parts;
    for (const DrawnPatch& drawn : sample) {
        near[drawn.patch] = 1;
        tree.seen_from(drawn.patch, near_opening, parts);
        for (const ClusterTree::Part& part : parts) {
            if (!part.far) {
                near[tree.clusters()->patches(part.node).front()] = 1;
            }
        }
    }
    std::vector<std::uint32_t> patches;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        if (near[i] != 0) {
            patches.push_back(i);
        }
    }
    return patches;
}

} // namespace

CutSample cut_sample(const PatchMesh& mesh, std::span<const DrawnPatch> sample, bool all) {
    const std::vector<std::uint32_t> patches = all ? all_patches(mesh.size()) : near_patches(mesh, sample);
    SplitMesh split = mesh.split(patches, Cut::in_four);
    CutSample cut{std::move(split.mesh), std::move(split.parents), {}, {}, {}};
    std::vector<std::uint8_t> parts(mesh.size(), 0);
    for (const std::uint32_t parent : cut.parents) {
        ++parts[parent];
    }
    cut.quarters.resize(sample.size());
    std::vector<std::uint32_t> found(sample.size(), 0);
    for (std::uint32_t k = 0; k < cut.parents.size(); ++k) {
        cut.whole.push_back(parts[cut.parents[k]] == 1 ? 1 : 0);
        const auto drawn = std::lower_bound(
            sample.begin(), sample.end(), cut.parents[k],
            [](const DrawnPatch& entry, std::uint32_t patch) { return entry.patch < patch; });
        if (drawn != sample.end() && drawn->patch == cut.parents[k]) {
            const auto index = static_cast<std::size_t>(drawn - sample.begin());
            cut.quarters[index][found[index]++ % 4] = k;
        }
    }
    for (const auto& four : cut.quarters) {
        cut.rows.insert(cut.rows.end(), four.begin(), four.end());
    }
    std::sort(cut.rows.begin(), cut.rows.end());
    return cut;
}

std::uint64_t quarter_row_bytes(std::uint64_t rows, std::uint64_t columns, bool clusters) {
    constexpr std::uint64_t pair = 4 + 9;
    constexpr std::uint64_t patch = 500; // with what the engine knows of it
    constexpr std::uint64_t tree = 300;  // and what rows of clusters need
    constexpr std::uint64_t entries = 4096;
    return clusters ? rows * entries * pair + columns * (patch + tree)
                    : rows * columns * pair + columns * patch;
}

FormFactorMatrix compute_quarter_rows(const CutSample& cut, RowPlan plan, const FactorSettings& settings,
                                      const Scene& scene, bool clusters, Observer& observer) {
    plan.hemicube.seed = ~plan.hemicube.seed; // not the rows that the solution rests on
    const auto engine = make_visibility_provider(cut.mesh, plan.hemicube, settings);
    if (clusters) {
        ClusterSettings far;
        far.max_memory = memory_limit(settings);
        far.apart = emitting_patches(scene, cut.mesh);
        return compute_clustered(rows_of_rank(*engine), cut.mesh, cut.rows, far, scene.enclosure,
                                 quarter_of_progress(observer, 0));
    }
    return compute_visibility_weighted(*engine, cut.mesh, cut.rows, {ExchangeRule::standard, 0},
                                       scene.enclosure, quarter_of_progress(observer, 0),
                                       quarter_of_progress(observer, 1), quarter_of_progress(observer, 2));
}

Progress quarter_of_progress(Observer& observer, std::size_t index) {
    return [&observer, index](std::size_t done, std::size_t total) {
        return observer.progress(Phase::patch_size, 25 * index + 25 * done / std::max<std::size_t>(total, 1),
                                 100);
    };
}

} // namespace hemi
