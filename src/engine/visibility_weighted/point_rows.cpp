#include "hemi/engine/point_rows.hpp"

#include "core/parallel_for.hpp"
#include "engine/clusters/cluster_tree.hpp"
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
#include <array>
#include <bit>
#include <cmath>
#include <functional>
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

/// Of a part of the scene far away so many patches, strewn over it, are looked at. Those that no texel covers
/// stand for all such: the part is small from where the point is. Chosen, not fitted.
constexpr std::size_t most_looked_at = 32;
/// A part is far where its radius is below this share of its distance from the point. Half of it changes the
/// gathered light of a city by less than 1e-4. Chosen, not fitted.
constexpr double opening = 0.3;
/// Most variance of a patch that texels hide, over its light squared: with a single texel.
constexpr double most_hidden_variance = 0.1;
/// Samples of visibility that a batch has at most, or little more.
constexpr std::size_t batch_samples = std::size_t{1} << 24;

/// A row before its factors.
struct SampledPoint {
    std::uint32_t index = 0;
    std::vector<std::uint32_t> columns;    ///< of patches that texels say something of, ascending
    std::vector<VisibilitySample> samples; ///< of these
    double environment = 0.0;
    double blocked = 0.0;
    bool hides = false; ///< whether it sees nothing of some patch that faces it
};

/// A row of factors.
struct PointRow {
    std::vector<std::uint32_t> columns;
    std::vector<float> values;
    double environment = 0.0;
};

/// Factors of single rows; thread-safe.
class PointRows {
public:
    PointRows(const ImageMesh& images, std::span<const SurfacePoint> points,
              const VisibilityWeightedSettings& settings, Enclosure enclosure,
              std::span<const double> weights, DirectionMeasure measure, std::uint32_t singly)
        : images_(images), points_(points), rays_a_pair_(settings.shadow_rays), enclosure_(enclosure),
          weights_(weights), spheres_(measure == DirectionMeasure::solid_angle), rule_(settings.rule),
          areas_(images.mesh(), settings.rule), neighbours_(images.mesh()) {
        if (images.mesh().size() > singly) {
            tree_.emplace(images.mesh());
            find_most_light();
        }
        if (enclosure == Enclosure::automatic) {
            space_.emplace(images.mesh());
        }
        if (rays_a_pair_ > 0) {
            rays_.emplace(images.mesh());
        }
    }

    [[nodiscard]] PointRow operator()(const SampledPoint& sampled) {
        std::unique_ptr<Bench> bench = take_bench();
        for (std::size_t k = 0; k < sampled.columns.size(); ++k) {
            bench->samples[sampled.columns[k]] = sampled.samples[k];
        }
        std::vector<Entry> entries = tree_ ? entries_by_parts(sampled, *bench) : all_entries(sampled, *bench);
        for (const std::uint32_t column : sampled.columns) {
            bench->samples[column] = {};
        }
        give_back(std::move(bench));
        if (rays_) {
            trace(sampled.index, entries);
        }
        return close(entries, sampled);
    }

private:
    struct Entry {
        std::uint32_t column;
        double unoccluded;
        double visibility;
        double texels; ///< that the visibility rests on; 0: on other patches'
        bool clear;    ///< by texels
        bool single;   ///< stands for its own patch, not for others besides
    };
    /// An entry whose visibility is not certain.
    struct Doubt {
        std::size_t entry;
        double texels;
        double variance;
    };
    /// Where a thread makes rows.
    struct Bench {
        std::vector<VisibilitySample> samples; ///< of all patches; unknown between rows
        std::vector<ClusterTree::Part> parts;  ///< what a point sees
    };

    [[nodiscard]] std::unique_ptr<Bench> take_bench() {
        const std::lock_guard lock(mutex_);
        if (benches_.empty()) {
            auto bench = std::make_unique<Bench>();
            bench->samples.resize(images_.mesh().size());
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
            const VisibilitySample sample = neighbours_.stand_in(bench.samples, j);
            entries.push_back({j, factor, sample.known() ? sample.share() : assumed, 0.0, false, true});
        }
    }

    /// Patch by patch.
    [[nodiscard]] std::vector<Entry> all_entries(const SampledPoint& sampled, const Bench& bench) const {
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
        return entries;
    }

    /// What texels see patch by patch, all else by parts of the scene.
    [[nodiscard]] std::vector<Entry> entries_by_parts(const SampledPoint& sampled, Bench& bench) const {
        std::vector<Entry> entries;
        const SurfacePoint& point = points_[sampled.index];
        const double assumed = mean_share(sampled.samples);
        for (std::size_t k = 0; k < sampled.columns.size(); ++k) {
            if (sampled.samples[k].share() > 0.0) {
                add_known(point, sampled.columns[k], sampled.samples[k], entries);
            }
        }
        const auto seen = static_cast<std::ptrdiff_t>(entries.size());
        tree_->seen_from(point.position, spheres_ ? std::nullopt : std::optional(point.normal), opening,
                         bench.parts);
        for (const ClusterTree::Part& part : bench.parts) {
            if (part.far) {
                add_part(point, part.node, bench, assumed, entries);
            } else if (const std::uint32_t j = tree_->clusters()->patches(part.node).front();
                       !bench.samples[j].known()) {
                add_unknown(point, j, bench, assumed, entries);
            } else if (bench.samples[j].share() == 0.0) {
                add_known(point, j, bench.samples[j], entries);
            }
        }
        if (rays_) {
            add_hidden(point, bench, entries);
        }
        const auto by_column = [](const Entry& a, const Entry& b) { return a.column < b.column; };
        std::sort(entries.begin() + seen, entries.end(), by_column);
        std::inplace_merge(entries.begin(), entries.begin() + seen, entries.end(), by_column);
        return entries;
    }

    /// Adds the patches of a part that no texel covers, or some of them for all.
    /// @param assumed  V where nothing is known of the part
    void add_part(const SurfacePoint& point, std::uint32_t part, const Bench& bench, double assumed,
                  std::vector<Entry>& entries) const {
        const std::span<const std::uint32_t> patches = tree_->clusters()->patches(part);
        std::array<std::uint32_t, most_looked_at> looked{};
        const std::size_t looks = std::min(most_looked_at, patches.size());
        const double step = static_cast<double>(patches.size()) / static_cast<double>(looks);
        double area = 0.0;
        double shares = 0.0;
        std::size_t known = 0;
        for (std::size_t k = 0; k < looks; ++k) {
            const std::uint32_t j = patches[static_cast<std::size_t>((static_cast<double>(k) + 0.5) * step)];
            looked[k] = j;
            area += images_.mesh().areas()[j];
            if (const VisibilitySample sample = bench.samples[j]; sample.known()) {
                ++known;
                shares += sample.share();
            }
        }
        const double share = known > 0 ? shares / static_cast<double>(known) : assumed;
        if (known == looks || !(share > 0.0)) {
            return;
        }
        const std::size_t first = entries.size();
        for (const std::uint32_t j : std::span(looked).first(looks)) {
            if (!bench.samples[j].known()) {
                add_unknown(point, j, bench, share, entries);
            }
        }
        if (looks < patches.size()) {
            const double scale = tree_->moments(part).area / area;
            for (std::size_t k = first; k < entries.size(); ++k) {
                entries[k].unoccluded *= scale;
                entries[k].single = false;
            }
        }
    }

    /// Adds those patches far away that texels hide of which one might get shadow rays: not many can be among
    /// the few that matter most.
    void add_hidden(const SurfacePoint& point, const Bench& bench, std::vector<Entry>& entries) const {
        std::vector<double> variances;
        for (const Doubt& doubt : doubts_of(entries)) {
            variances.push_back(doubt.variance);
        }
        double least = 0.0;
        if (const std::size_t most = most_traced(); variances.size() > most) {
            std::nth_element(variances.begin(), variances.begin() + static_cast<std::ptrdiff_t>(most),
                             variances.end(), std::greater<>());
            least = variances[most];
        }
        const double per_distance = spheres_ ? 4.0 : 1.0; // a sphere's factor is a share of 4 pi
        for (const ClusterTree::Part& part : bench.parts) {
            if (!part.far) {
                continue;
            }
            const ClusterShape& shape = tree_->shape(part.node);
            const double gap = glm::distance(point.position, shape.centre) - shape.radius;
            const double light = most_light_[part.node] / (per_distance * std::numbers::pi * gap * gap);
            if (most_hidden_variance * light * light <= least) {
                continue;
            }
            for (const std::uint32_t j : tree_->clusters()->patches(part.node)) {
                if (bench.samples[j].known() && bench.samples[j].share() == 0.0) {
                    add_known(point, j, bench.samples[j], entries);
                }
            }
        }
    }

    /// Finds the most light of a patch in each cluster of the tree.
    void find_most_light() {
        const std::span<const SourceClusters::Node> nodes = tree_->clusters()->nodes();
        most_light_.resize(nodes.size());
        for (std::size_t k = nodes.size(); k-- > 0;) { // children stand behind their parents
            if (nodes[k].child != 0) {
                most_light_[k] = std::max(most_light_[nodes[k].child], most_light_[nodes[k].child + 1]);
            } else {
                const std::uint32_t j = tree_->clusters()->order()[nodes[k].begin];
                most_light_[k] = images_.mesh().areas()[j] * weight(j);
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

    [[nodiscard]] PointRow close(const std::vector<Entry>& entries, const SampledPoint& sampled) const {
        double sum = 0.0;
        double partly_hidden = 0.0;
        for (const Entry& entry : entries) {
            sum += entry.unoccluded * entry.visibility;
            partly_hidden += entry.clear ? 0.0 : entry.unoccluded;
        }
        const SurfacePoint& point = points_[sampled.index];
        const bool unknown = sampled.hides || sampled.blocked > 0.0;
        const EnvironmentEvidence evidence{
            .texels = sampled.environment,
            .remainder = 1.0 - sampled.blocked - sum,
            .error = unknown ? std::numeric_limits<double>::infinity()
                             : unoccluded_error(rule_) * sum + partly_hidden,
            .enclosed = space_ && space_->contains_in_front(point.position, point.normal, 0.0)};
        const bool open = is_open({&evidence, 1}, enclosure_);
        PointRow row;
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
    CoplanarNeighbours neighbours_;
    std::optional<ClusterTree> tree_; ///< of scenes that are not taken patch by patch
    std::vector<double> most_light_;  ///< of a patch of each cluster: its area times its weight
    std::optional<EnclosedSpace> space_;
    std::optional<ShadowRays> rays_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<Bench>> benches_; ///< idle
};

/// Gives all ranks the rows of all, of which this one has made those from `first` to before `last`.
void exchange_rows(std::span<PointRow> rows, std::size_t first, std::size_t last) {
    std::vector<double> environment;
    std::vector<std::uint64_t> counts;
    std::vector<std::uint32_t> columns;
    std::vector<float> values;
    for (const PointRow& row : rows.subspan(first, last - first)) {
        environment.push_back(row.environment);
        counts.push_back(row.columns.size());
        columns.insert(columns.end(), row.columns.begin(), row.columns.end());
        values.insert(values.end(), row.values.begin(), row.values.end());
    }
    environment = gather_values(ranks(), std::span<const double>(environment));
    counts = gather_values(ranks(), std::span<const std::uint64_t>(counts));
    columns = gather_values(ranks(), std::span<const std::uint32_t>(columns));
    values = gather_values(ranks(), std::span<const float>(values));
    std::ptrdiff_t next = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const auto end = next + static_cast<std::ptrdiff_t>(counts[k]);
        rows[k].columns.assign(columns.begin() + next, columns.begin() + end);
        rows[k].values.assign(values.begin() + next, values.begin() + end);
        rows[k].environment = environment[k];
        next = end;
    }
}

} // namespace

void compute_point_rows(VisibilityProvider& visibility, const PatchMesh& mesh,
                        std::span<const SurfacePoint> points, const VisibilityWeightedSettings& settings,
                        Enclosure enclosure, std::span<const double> weights, const PointRowSink& sink,
                        const Progress& progress, DirectionMeasure measure, std::uint32_t singly) {
    if (visibility.size() != points.size() || (!weights.empty() && weights.size() != mesh.size())) {
        throw InvalidArgument(fmt::format("point rows: {} rows for {} points, {} weights for {} patches",
                                          visibility.size(), points.size(), weights.size(), mesh.size()));
    }
    const ImageMesh images(mesh);
    ImageFold fold(images);
    PointRows rows(images, points, settings, enclosure, weights, measure, singly);
    std::vector<SampledPoint> batch;
    std::size_t samples = 0; // of the batch
    std::size_t done = 0;
    const auto finish_batch = [&] {
        // All ranks have the same batch, and each finishes some of it.
        std::vector<PointRow> finished(batch.size());
        const std::size_t first = begin_of_share(ranks(), ranks().rank(), batch.size());
        const std::size_t last = begin_of_share(ranks(), ranks().rank() + 1, batch.size());
        parallel_for(last - first, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = first + begin; k < first + end; ++k) {
                finished[k] = rows(batch[k]);
            }
        });
        if (ranks().size() > 1) {
            exchange_rows(std::span(finished), first, last);
        }
        for (std::size_t k = 0; k < batch.size(); ++k) {
            const RowView row{
                finished[k].columns, finished[k].values, {}, finished[k].environment, batch[k].blocked};
            sink(batch[k].index, images.any() ? fold(row) : row);
        }
        done += batch.size();
        batch.clear();
        samples = 0;
        if (progress && !progress(done, points.size())) {
            throw Cancelled();
        }
    };
    std::vector<std::uint32_t> all(points.size());
    std::iota(all.begin(), all.end(), 0u);
    visibility.rows(all, [&](std::uint32_t index, const VisibilityRow& row) {
        SampledPoint& sampled = batch.emplace_back();
        sampled.index = index;
        sampled.columns.assign(row.columns.begin(), row.columns.end());
        sampled.samples.reserve(row.columns.size());
        for (std::size_t entry = 0; entry < row.columns.size(); ++entry) {
            sampled.samples.emplace_back(row.shares[entry], row.texels[entry]);
        }
        sampled.environment = row.environment;
        sampled.blocked = row.blocked;
        sampled.hides = std::find(row.shares.begin(), row.shares.end(), 0.0F) != row.shares.end();
        samples += row.columns.size();
        if (batch.size() == batch_rows || samples >= batch_samples) {
            finish_batch();
        }
    });
    if (!batch.empty()) {
        finish_batch();
    }
    if (done != points.size()) {
        throw Error(
            fmt::format("{} gave {} of {} rows of points", visibility.renderer(), done, points.size()));
    }
}

} // namespace hemi
