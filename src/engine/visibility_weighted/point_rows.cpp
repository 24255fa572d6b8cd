#include "hemi/engine/point_rows.hpp"

#include "core/parallel_for.hpp"
#include "engine/clusters/cluster_tree.hpp"
#include "engine/clusters/source_sums.hpp"
#include "engine/environment_verdict.hpp"
#include "engine/image_rows.hpp"
#include "engine/rays/shadow_rays.hpp"
#include "engine/visibility_weighted/coplanar_neighbours.hpp"
#include "engine/visibility_weighted/visibility_sample.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/ranks.hpp"
#include "hemi/scene/image_mesh.hpp"
#include "scene/enclosed_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace hemi {

namespace {

/// Rows whose factors are found at once, by all threads. Memory: 6 bytes a patch that texels cover and row,
/// and the rows.
constexpr std::size_t batch_rows = 128;
constexpr std::size_t least_batch_rows = 8;
/// Entries of these, where rows may be as long as there are patches.
constexpr std::size_t batch_entries = std::size_t{1} << 22;
/// Patches of a row that get shadow rays: enough for the lamps of a room, few enough that rays take about as
/// much time as all else. Chosen, not fitted.
constexpr std::size_t max_traced = 48;
/// … and no more than have this share of the variance of the row's light.
constexpr double traced_share = 0.95;
/// A sphere sees twice as much as a plane, from everywhere alike: so many times the patches, and the rays
/// that are shared out. Chosen, not fitted.
constexpr std::size_t sphere_factor = 4;

/// Where a few patches make most of the variance, as lamps of few patches do, they get more rays: so many
/// times the usual number are shared out by standard deviation, in powers of two, which are spread best; a
/// patch gets at most so many times as many.
constexpr double shared_rays = 24.0;
constexpr double most_rays = 16.0;

/// Texels that see a patch clear may miss a sliver of it: where it is known what matters, so that rays are
/// not spent on all that is near, they leave this part of the variance that their number alone would. Chosen,
/// not fitted.
constexpr double clear_doubt = 0.1;

/// A patch of a cluster far away that may give more than this share of the light is seen by itself, as near
/// ones are, and may get shadow rays. Chosen, not fitted.
constexpr double bright_share = 2e-4;
/// Samples of visibility that a batch has at most, or little more.
constexpr std::size_t batch_samples = std::size_t{1} << 24;

/// A row before its factors.
struct SampledPoint {
    std::uint32_t index = 0;
    std::vector<std::uint32_t> columns;    ///< of patches that texels say something of, ascending
    std::vector<VisibilitySample> samples; ///< of these
    std::vector<JointVisibility> joint;    ///< what texels say of sets of others
    double environment = 0.0;
    double blocked = 0.0;
    bool hides = false; ///< whether it sees nothing of some patch that faces it
};

/// A row of factors.
struct PointRow {
    std::uint32_t index = 0; ///< of the point
    std::vector<std::uint32_t> columns;
    std::vector<float> values;
    double environment = 0.0;
    double blocked = 0.0;
};

/// Factors of single rows; thread-safe.
class PointRows {
public:
    /// All must outlive this.
    PointRows(const ImageMesh& images, std::span<const SurfacePoint> points,
              const VisibilityWeightedSettings& settings, Enclosure enclosure,
              std::span<const double> weights, const PointRowOptions& options)
        : images_(images), points_(points), rays_a_pair_(settings.shadow_rays), enclosure_(enclosure),
          weights_(weights), spheres_(options.measure == DirectionMeasure::solid_angle), rule_(settings.rule),
          areas_(images.mesh(), settings.rule), opening_(options.opening), tree_(options.clusters),
          expands_(tree_ == nullptr) {
        if (tree_ == nullptr && images.mesh().size() > options.singly) {
            tree_ = &own_tree_.emplace(images.mesh());
        }
        if (tree_ != nullptr) {
            find_light();
        } else {
            neighbours_.emplace(images.mesh());
        }
        if (enclosure == Enclosure::automatic) {
            space_.emplace(images.mesh());
        }
        if (rays_a_pair_ > 0) {
            rays_.emplace(images.mesh());
        }
    }

    /// How many rows are made at once.
    [[nodiscard]] std::size_t at_once() const {
        const std::size_t longest = tree_ != nullptr && expands_ ? images_.mesh().size() : 0;
        return std::clamp<std::size_t>(batch_entries / (longest + 1), least_batch_rows, batch_rows);
    }
    /// Whether rows may tell of sets of patches.
    [[nodiscard]] bool takes_sets() const { return tree_ != nullptr; }
    /// The sets that all rows tell of.
    void set_sets(const PatchSets& sets) {
        if (!places_) {
            places_.emplace(sets, *tree_, images_.mesh());
        }
    }

    [[nodiscard]] PointRow operator()(const SampledPoint& sampled) {
        std::unique_ptr<Bench> bench = take_bench();
        bool hides = sampled.hides;
        std::vector<Entry> entries =
            tree_ != nullptr ? clustered_entries(sampled, *bench, hides) : all_entries(sampled, *bench);
        if (rays_) {
            trace(sampled.index, entries);
        }
        PointRow row = close(entries, sampled, hides);
        if (tree_ != nullptr && expands_) {
            expand(row, *bench);
        }
        give_back(std::move(bench));
        return row;
    }

private:
    struct Entry {
        std::uint32_t column;
        double unoccluded;
        double visibility;
        double texels; ///< that the visibility rests on; 0: on other patches'
        bool clear;    ///< by texels
        bool single;   ///< a patch, no cluster
    };
    /// An entry whose visibility is not certain.
    struct Doubt {
        std::size_t entry;
        double texels;
        double variance;
    };
    /// Where a thread makes rows.
    struct Bench {
        std::vector<VisibilitySample> samples;  ///< of all patches; unknown between rows
        std::optional<SourceSums> sums;         ///< where there are clusters
        std::vector<ClusterTree::Part> parts;   ///< what a point sees
        std::vector<ClusterTree::Part> divided; ///< the same, bright patches by themselves
        std::vector<float> values;              ///< of all patches, where rows are expanded; 0 between rows
    };
    /// What the patches of a cluster give: area times weight.
    struct Light {
        double sum = 0.0;
        double most = 0.0; ///< of a patch
    };

    [[nodiscard]] std::unique_ptr<Bench> take_bench() {
        const std::lock_guard lock(mutex_);
        if (benches_.empty()) {
            auto bench = std::make_unique<Bench>();
            if (tree_ == nullptr) {
                bench->samples.resize(images_.mesh().size());
                return bench;
            }
            bench->sums.emplace(images_.mesh(), *tree_, areas_);
            bench->values.resize(expands_ ? images_.mesh().size() : 0);
            return bench;
        }
        std::unique_ptr<Bench> bench = std::move(benches_.back());
        benches_.pop_back();
        return bench;
    }
    void give_back(std::unique_ptr<Bench> bench) {
        const std::lock_guard lock(mutex_);
        benches_.push_back(std::move(bench));
    }

    /// F0 of a patch.
    [[nodiscard]] double unoccluded(const SurfacePoint& point, std::uint32_t j) const {
        return spheres_ ? areas_.solid_angle_at(point.position, j) / (4.0 * std::numbers::pi)
                        : areas_.at_point(point.position, point.normal, j);
    }

    /// Adds a patch of which texels say something.
    void add_known(const SurfacePoint& point, std::uint32_t j, VisibilitySample sample,
                   std::vector<Entry>& entries) const {
        if (sample.share() == 0.0 && !rays_) {
            return;
        }
        if (const double factor = unoccluded(point, j); factor > 0.0) {
            entries.push_back({j, factor, sample.share(), sample.weight(), sample.is_clear(), true});
        }
    }

    /// Adds a patch that no texel covers: as visible as its neighbours.
    /// @param assumed  V without any
    void add_unknown(const SurfacePoint& point, std::uint32_t j, const Bench& bench, double assumed,
                     std::vector<Entry>& entries) const {
        if (const double factor = unoccluded(point, j); factor > 0.0) {
            const VisibilitySample sample = neighbours_->stand_in(bench.samples, j);
            entries.push_back({j, factor, sample.known() ? sample.share() : assumed, 0.0, false, true});
        }
    }

    /// Patch by patch.
    [[nodiscard]] std::vector<Entry> all_entries(const SampledPoint& sampled, Bench& bench) const {
        for (std::size_t k = 0; k < sampled.columns.size(); ++k) {
            bench.samples[sampled.columns[k]] = sampled.samples[k];
        }
        std::vector<Entry> entries;
        const SurfacePoint& point = points_[sampled.index];
        const double assumed = mean_share(sampled.samples);
        for (std::uint32_t j = 0; j < bench.samples.size(); ++j) {
            if (bench.samples[j].known()) {
                add_known(point, j, bench.samples[j], entries);
            } else {
                add_unknown(point, j, bench, assumed, entries);
            }
        }
        for (const std::uint32_t column : sampled.columns) {
            bench.samples[column] = {};
        }
        return entries;
    }

    /// What is far by clusters.
    [[nodiscard]] std::vector<Entry> clustered_entries(const SampledPoint& sampled, Bench& bench,
                                                       bool& hides) const {
        const SurfacePoint& point = points_[sampled.index];
        const RowReceiver receiver{.at = point.position,
                                   .normal = spheres_ ? std::nullopt : std::optional(point.normal)};
        tree_->seen_from(receiver.at, receiver.normal, opening_, bench.parts);
        divide_bright(receiver, bench);
        SourceSums& sums = *bench.sums;
        sums.start(receiver, bench.divided, rays_.has_value());
        for (std::size_t k = 0; k < sampled.columns.size(); ++k) {
            const VisibilitySample sample = sampled.samples[k];
            sums.add_patch(sampled.columns[k], {sample.share(), sample.weight(), sample.is_clear()});
        }
        for (const JointVisibility& joint : sampled.joint) {
            const VisibilitySample sample(joint.share, joint.texels);
            sums.add_set(*places_, joint.set, {sample.share(), sample.weight(), sample.is_clear()});
        }
        sums.finish();
        hides = sums.hides();
        std::vector<Entry> entries;
        for (const Source& source : sums.near()) {
            entries.push_back(
                {source.column, source.unoccluded, source.visibility, source.texels, source.clear, true});
        }
        for (const Source& source : sums.far()) {
            entries.push_back(
                {source.column, source.unoccluded, source.visibility, 0.0, source.clear, false});
        }
        return entries;
    }

    /// Takes out of clusters far away what may give much of the light; what of these cannot face the point is
    /// away.
    void divide_bright(const RowReceiver& receiver, Bench& bench) const {
        const Vec3& at = receiver.at;
        // Factors in front of a plane, or a quarter of them on a sphere: the same for all.
        const auto per_area = [&](std::uint32_t node, double gap) {
            const double distance = std::max(gap, tree_->shape(node).radius);
            return 1.0 / (distance * distance);
        };
        const auto gap = [&](std::uint32_t node) {
            return std::max(0.0, glm::distance(at, tree_->shape(node).centre) - tree_->shape(node).radius);
        };
        double all = 0.0;
        for (const ClusterTree::Part& part : bench.parts) {
            if (!part.away) {
                const double distance = glm::distance(at, tree_->shape(part.node).centre);
                all += light_[part.node].sum * per_area(part.node, distance);
            }
        }
        bench.divided.clear();
        std::vector<std::uint32_t> open;
        for (const ClusterTree::Part& part : bench.parts) {
            if (!part.far || part.away) {
                bench.divided.push_back(part);
                continue;
            }
            open.assign(1, part.node);
            while (!open.empty()) {
                const std::uint32_t node = open.back();
                open.pop_back();
                if (node != part.node && !may_face(tree_->shape(node), at, receiver.normal, 0.0)) {
                    bench.divided.push_back({node, true, true});
                    continue;
                }
                const bool bright = light_[node].most * per_area(node, gap(node)) > bright_share * all;
                const std::uint32_t child = tree_->clusters()->nodes()[node].child;
                if (bright && child != 0) {
                    open.push_back(child + 1);
                    open.push_back(child);
                } else {
                    bench.divided.push_back({node, !bright});
                }
            }
        }
    }

    /// Finds the light of each cluster of the tree.
    void find_light() {
        const std::span<const SourceClusters::Node> nodes = tree_->clusters()->nodes();
        light_.resize(nodes.size());
        for (std::size_t k = nodes.size(); k-- > 0;) { // children stand behind their parents
            if (nodes[k].child != 0) {
                const Light& a = light_[nodes[k].child];
                const Light& b = light_[nodes[k].child + 1];
                light_[k] = {a.sum + b.sum, std::max(a.most, b.most)};
            } else {
                const std::uint32_t j = tree_->clusters()->order()[nodes[k].begin];
                const double light = images_.mesh().areas()[j] * weight(j);
                light_[k] = {light, light};
            }
        }
    }

    /// Shares out what comes of clusters among their patches.
    void expand(PointRow& row, Bench& bench) const {
        const SourceClusters& clusters = *tree_->clusters();
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            if (row.columns[k] < bench.values.size()) {
                bench.values[row.columns[k]] = row.values[k];
                continue;
            }
            const auto node = static_cast<std::uint32_t>(row.columns[k] - bench.values.size());
            for (const std::uint32_t j : clusters.patches(node)) {
                bench.values[j] = row.values[k] * static_cast<float>(clusters.share(j, node));
            }
        }
        row.columns.clear();
        row.values.clear();
        for (std::uint32_t j = 0; j < bench.values.size(); ++j) {
            if (bench.values[j] > 0.0F) {
                row.columns.push_back(j);
                row.values.push_back(std::exchange(bench.values[j], 0.0F));
            }
        }
    }

    /// How much a patch's light matters.
    [[nodiscard]] double weight(std::uint32_t j) const {
        return weights_.empty() ? 1.0 : weights_[images_.original(j)];
    }

    /// Patches of a row that may get shadow rays.
    [[nodiscard]] std::size_t most_traced() const { return (spheres_ ? sphere_factor : 1) * max_traced; }

    /// Of the light that comes from the patch: that of a share found from so many independent trials, of
    /// which one more could have come out either way.
    [[nodiscard]] double variance(const Entry& entry, double texels) const {
        const double share = (entry.visibility * texels + 0.5) / (texels + 1.0);
        const double light = entry.unoccluded * weight(entry.column);
        return light * light * share * (1.0 - share) / (texels + 1.0);
    }

    /// What is not certain of a row.
    [[nodiscard]] std::vector<Doubt> doubts_of(const std::vector<Entry>& entries) const {
        std::vector<Doubt> doubts;
        for (std::size_t k = 0; k < entries.size(); ++k) {
            const Entry& entry = entries[k];
            if (entry.single && !(entry.clear && weights_.empty())) {
                const double share = entry.clear ? clear_doubt : 1.0;
                doubts.push_back({k, entry.texels, share * variance(entry, entry.texels)});
            }
        }
        return doubts;
    }

    /// Adds shadow rays where most of the variance is.
    void trace(std::uint32_t index, std::vector<Entry>& entries) const {
        std::vector<Doubt> doubts = doubts_of(entries);
        const double total =
            std::accumulate(doubts.begin(), doubts.end(), 0.0,
                            [](double sum, const Doubt& doubt) { return sum + doubt.variance; });
        const std::size_t most = std::min(most_traced(), doubts.size());
        std::partial_sort(doubts.begin(), doubts.begin() + static_cast<std::ptrdiff_t>(most), doubts.end(),
                          [](const Doubt& a, const Doubt& b) {
                              return a.variance != b.variance ? a.variance > b.variance : a.entry < b.entry;
                          });
        std::size_t count = 0;
        double traced = 0.0;
        double deviations = 0.0;
        for (; count < most && traced < traced_share * total; ++count) {
            traced += doubts[count].variance;
            deviations += std::sqrt(doubts[count].variance);
        }
        for (std::size_t k = 0; k < count; ++k) {
            const Doubt& doubt = doubts[k];
            Entry& entry = entries[doubt.entry];
            const double times = std::clamp(static_cast<double>(spheres_ ? sphere_factor : 1) * shared_rays *
                                                std::sqrt(doubt.variance) / deviations,
                                            1.0, most_rays);
            const ShadowRays::Estimate estimate = rays_->visibility_from(
                points_[index].position, spheres_ ? std::nullopt : std::optional(points_[index].normal),
                entry.column, std::bit_floor(static_cast<std::uint32_t>(times)) * rays_a_pair_, index);
            if (const double sum = doubt.texels + estimate.rays; estimate.rays > 0.0) {
                entry.visibility =
                    (doubt.texels * entry.visibility + estimate.rays * estimate.visibility) / sum;
            }
        }
    }

    [[nodiscard]] PointRow close(const std::vector<Entry>& entries, const SampledPoint& sampled,
                                 bool hides) const {
        double sum = 0.0;
        double partly_hidden = 0.0;
        for (const Entry& entry : entries) {
            sum += entry.unoccluded * entry.visibility;
            partly_hidden += entry.clear ? 0.0 : entry.unoccluded;
        }
        const SurfacePoint& point = points_[sampled.index];
        const bool unknown = hides || sampled.blocked > 0.0;
        const EnvironmentEvidence evidence{
            .texels = sampled.environment,
            .remainder = 1.0 - sampled.blocked - sum,
            .error = unknown ? std::numeric_limits<double>::infinity()
                             : unoccluded_error(rule_) * sum + partly_hidden,
            .enclosed = space_ && space_->contains_in_front(point.position, point.normal, 0.0)};
        const bool open = is_open({&evidence, 1}, enclosure_);
        PointRow row;
        row.index = sampled.index;
        row.blocked = sampled.blocked;
        row.environment = environment_share(evidence, enclosure_, open);
        // What the environment has is what the factors leave, or else they are scaled for it.
        const bool scaled = sum > 0.0 && !(open && row.environment > 0.0);
        const double scale = scaled ? (1.0 - row.environment - sampled.blocked) / sum : 1.0;
        for (const Entry& entry : entries) {
            const auto value = static_cast<float>(scale * entry.unoccluded * entry.visibility);
            if (value > 0.0f) {
                row.columns.push_back(entry.column);
                row.values.push_back(value);
            }
        }
        return row;
    }

    const ImageMesh& images_;
    std::span<const SurfacePoint> points_;
    std::uint32_t rays_a_pair_;
    Enclosure enclosure_;
    std::span<const double> weights_;
    bool spheres_;
    ExchangeRule rule_;
    ExchangeAreas areas_;
    std::optional<CoplanarNeighbours> neighbours_; ///< where rows are made patch by patch
    double opening_;
    const ClusterTree* tree_; ///< of scenes that are not taken patch by patch, or null
    std::optional<ClusterTree> own_tree_;
    bool expands_;             ///< whether columns must be patches
    std::vector<Light> light_; ///< of the nodes of the tree
    std::optional<SetPlaces> places_;
    std::optional<EnclosedSpace> space_;
    std::optional<ShadowRays> rays_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<Bench>> benches_; ///< idle
};

/// The rows of all ranks, of which this one has made some.
std::vector<PointRow> rows_of_ranks(std::span<const PointRow> own) {
    struct Head {
        std::uint64_t index;
        std::uint64_t entries;
        double environment;
        double blocked;
    };
    std::vector<Head> heads;
    std::vector<std::uint32_t> columns;
    std::vector<float> values;
    for (const PointRow& row : own) {
        heads.push_back({row.index, row.columns.size(), row.environment, row.blocked});
        columns.insert(columns.end(), row.columns.begin(), row.columns.end());
        values.insert(values.end(), row.values.begin(), row.values.end());
    }
    heads = gather_values(ranks(), std::span<const Head>(heads));
    columns = gather_values(ranks(), std::span<const std::uint32_t>(columns));
    values = gather_values(ranks(), std::span<const float>(values));
    std::vector<PointRow> rows;
    std::ptrdiff_t next = 0;
    for (const Head& head : heads) {
        const auto end = next + static_cast<std::ptrdiff_t>(head.entries);
        rows.push_back({static_cast<std::uint32_t>(head.index),
                        {columns.begin() + next, columns.begin() + end},
                        {values.begin() + next, values.begin() + end},
                        head.environment,
                        head.blocked});
        next = end;
    }
    return rows;
}

} // namespace

void compute_point_rows(VisibilityProvider& visibility, const PatchMesh& mesh,
                        std::span<const SurfacePoint> points, const VisibilityWeightedSettings& settings,
                        Enclosure enclosure, std::span<const double> weights, const PointRowSink& sink,
                        const Progress& progress, const PointRowOptions& options) {
    if (visibility.size() != points.size() || (!weights.empty() && weights.size() != mesh.size())) {
        throw InvalidArgument(fmt::format("point rows: {} rows for {} points, {} weights for {} patches",
                                          visibility.size(), points.size(), weights.size(), mesh.size()));
    }
    if (options.clusters != nullptr && options.clusters->clusters()->size() != mesh.size()) {
        throw InvalidArgument(fmt::format("point rows: clusters of {} patches for {}",
                                          options.clusters->clusters()->size(), mesh.size()));
    }
    const ImageMesh images(mesh);
    if (options.clusters != nullptr && images.any()) {
        throw InvalidArgument("point rows: there are no clusters of images");
    }
    ImageFold fold(images);
    PointRows rows(images, points, settings, enclosure, weights, options);
    std::vector<SampledPoint> batch;
    std::size_t samples = 0; // of the batch
    std::size_t done = 0;    // by all ranks
    std::size_t made = 0;    // samples, by this one
    const auto finish_batch = [&] {
        std::vector<PointRow> finished(batch.size());
        parallel_for(batch.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                finished[k] = rows(batch[k]);
            }
        });
        if (ranks().size() > 1) {
            finished = rows_of_ranks(finished);
        }
        for (const PointRow& of_point : finished) {
            const RowView row{of_point.columns, of_point.values, {}, of_point.environment, of_point.blocked};
            sink(of_point.index, images.any() ? fold(row) : row);
        }
        done += finished.size();
        batch.clear();
        samples = 0;
        if (progress && !progress(done, points.size())) {
            throw Cancelled();
        }
    };
    const std::size_t first = begin_of_share(ranks(), ranks().rank(), points.size());
    std::vector<std::uint32_t> own(begin_of_share(ranks(), ranks().rank() + 1, points.size()) - first);
    std::iota(own.begin(), own.end(), static_cast<std::uint32_t>(first));
    visibility.rows(own, [&](std::uint32_t index, const VisibilityRow& row) {
        SampledPoint& sampled = batch.emplace_back();
        sampled.index = index;
        sampled.columns.assign(row.columns.begin(), row.columns.end());
        sampled.samples.reserve(row.columns.size());
        for (std::size_t entry = 0; entry < row.columns.size(); ++entry) {
            sampled.samples.emplace_back(row.shares[entry], row.texels[entry]);
        }
        if (!row.joint.empty()) {
            if (!rows.takes_sets()) {
                throw InvalidArgument("point rows: sets of patches are told of where each is taken singly");
            }
            rows.set_sets(*row.sets);
            sampled.joint.assign(row.joint.begin(), row.joint.end());
        }
        sampled.environment = row.environment;
        sampled.blocked = row.blocked;
        sampled.hides = std::find(row.shares.begin(), row.shares.end(), 0.0F) != row.shares.end();
        samples += row.columns.size();
        if (batch.size() == rows.at_once() || samples >= batch_samples) {
            finish_batch();
        }
        ++made;
    });
    if (made != own.size()) {
        throw Error(fmt::format("{} gave {} of {} rows of points", visibility.renderer(), made, own.size()));
    }
    while (done < points.size()) { // the last batches, which other ranks may have more of
        finish_batch();
    }
}

} // namespace hemi
