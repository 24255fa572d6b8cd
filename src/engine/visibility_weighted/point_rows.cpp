#include "hemi/engine/point_rows.hpp"

#include "core/parallel_for.hpp"
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
#include <numbers>
#include <numeric>
#include <optional>
#include <vector>

namespace hemi {

namespace {

/// Rows whose factors are found at once, by all threads. Memory: 2 bytes a patch and row, and the rows.
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

/// A row before its factors.
struct SampledPoint {
    std::uint32_t index = 0;
    std::vector<VisibilitySample> samples; ///< N
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
              std::span<const double> weights, DirectionMeasure measure)
        : images_(images), points_(points), rays_a_pair_(settings.shadow_rays), enclosure_(enclosure),
          weights_(weights), spheres_(measure == DirectionMeasure::solid_angle), rule_(settings.rule),
          areas_(images.mesh(), settings.rule), neighbours_(images.mesh()) {
        if (enclosure == Enclosure::automatic) {
            space_.emplace(images.mesh());
        }
        if (rays_a_pair_ > 0) {
            rays_.emplace(images.mesh());
        }
    }

    [[nodiscard]] PointRow operator()(const SampledPoint& sampled) const {
        std::vector<Entry> entries;
        std::vector<Doubt> doubts;
        const SurfacePoint& point = points_[sampled.index];
        const double assumed = mean_share(sampled.samples);
        for (std::uint32_t j = 0; j < sampled.samples.size(); ++j) {
            VisibilitySample sample = sampled.samples[j];
            const bool known = sample.known();
            if (known && sample.share() == 0.0 && !rays_) {
                continue;
            }
            const double unoccluded =
                spheres_ ? areas_.solid_angle_at(point.position, j) / (4.0 * std::numbers::pi)
                         : areas_.at_point(point.position, point.normal, j);
            if (unoccluded <= 0.0) {
                continue;
            }
            if (!known) {
                sample = neighbours_.stand_in(sampled.samples, j);
            }
            const bool clear = known && sample.is_clear();
            Entry entry{j, unoccluded, sample.known() ? sample.share() : assumed, clear};
            if (rays_ && !(clear && weights_.empty())) {
                const double texels = known ? sample.weight() : 0.0;
                const double share = clear ? clear_doubt : 1.0;
                doubts.push_back({entries.size(), texels, share * variance(entry, texels)});
            }
            entries.push_back(entry);
        }
        if (rays_) {
            trace(sampled.index, entries, doubts);
        }
        return close(entries, sampled);
    }

private:
    struct Entry {
        std::uint32_t column;
        double unoccluded;
        double visibility;
        bool clear; ///< by texels
    };
    /// An entry whose visibility is not certain.
    struct Doubt {
        std::size_t entry;
        double texels;
        double variance;
    };

    /// Of the light that comes from the patch: that of a share found from so many independent trials, of
    /// which one more could have come out either way.
    [[nodiscard]] double variance(const Entry& entry, double texels) const {
        const double share = (entry.visibility * texels + 0.5) / (texels + 1.0);
        const double light =
            entry.unoccluded * (weights_.empty() ? 1.0 : weights_[images_.original(entry.column)]);
        return light * light * share * (1.0 - share) / (texels + 1.0);
    }

    /// Adds shadow rays where most of the variance is.
    void trace(std::uint32_t index, std::vector<Entry>& entries, std::vector<Doubt>& doubts) const {
        const double total =
            std::accumulate(doubts.begin(), doubts.end(), 0.0,
                            [](double sum, const Doubt& doubt) { return sum + doubt.variance; });
        const std::size_t times_more = spheres_ ? sphere_factor : 1;
        const std::size_t most = std::min(times_more * max_traced, doubts.size());
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
            const double times = std::clamp(static_cast<double>(times_more) * shared_rays *
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
    std::optional<EnclosedSpace> space_;
    std::optional<ShadowRays> rays_;
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
                        const Progress& progress, DirectionMeasure measure) {
    if (visibility.size() != points.size() || (!weights.empty() && weights.size() != mesh.size())) {
        throw InvalidArgument(fmt::format("point rows: {} rows for {} points, {} weights for {} patches",
                                          visibility.size(), points.size(), weights.size(), mesh.size()));
    }
    const ImageMesh images(mesh);
    ImageFold fold(images);
    const PointRows rows(images, points, settings, enclosure, weights, measure);
    std::vector<SampledPoint> batch;
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
        if (progress && !progress(done, points.size())) {
            throw Cancelled();
        }
    };
    std::vector<std::uint32_t> all(points.size());
    std::iota(all.begin(), all.end(), 0u);
    visibility.rows(all, [&](std::uint32_t index, const VisibilityRow& row) {
        SampledPoint& sampled = batch.emplace_back();
        sampled.index = index;
        sampled.samples.resize(images.mesh().size());
        for (std::size_t entry = 0; entry < row.columns.size(); ++entry) {
            sampled.samples[row.columns[entry]] = {row.shares[entry], row.texels[entry]};
        }
        sampled.environment = row.environment;
        sampled.blocked = row.blocked;
        sampled.hides = std::find(row.shares.begin(), row.shares.end(), 0.0F) != row.shares.end();
        if (batch.size() == batch_rows) {
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
