#include "hemi/pipeline/patch_size_error.hpp"

#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/display/vertex_colours.hpp"
#include "hemi/matrix/error_estimate.hpp"
#include "hemi/matrix/source_clusters.hpp"
#include "hemi/pipeline/daylight.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "hemi/solver/solver.hpp"
#include "pipeline/corner_interpolation.hpp"
#include "pipeline/error_sample.hpp"
#include "pipeline/group_factor_errors.hpp"
#include "pipeline/group_importance.hpp"
#include "pipeline/image_count.hpp"
#include "pipeline/patch_error_model.hpp"
#include "pipeline/quarter_rows.hpp"
#include "pipeline/vertex_bends.hpp"
#include "pipeline/visible_radiosity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace hemi {

namespace {

// Patches of the sample: a part of all, in these limits. Four rows each.
constexpr double sampled_share = 1.0 / 64.0;
constexpr double min_sampled = 64.0;
constexpr double max_sampled = 192.0;
// A patch in whose neighbourhood the radiosity is even may still hide something: it is drawn as if its error
// were this share of the mean reflected radiosity.
constexpr double least_doubt = 0.03;
// Edges of shadows of wider suns, degrees across, are no longer sharp: the sun itself has 0.53.
constexpr double widest_sharp_sun = 1.0;
// Variance of a linear field over that of its means over four equal parts.
constexpr double linear_over_quarters = 4.0 / 3.0;

double sample_size(std::size_t patches, double effort) {
    return effort * std::clamp(sampled_share * static_cast<double>(patches), min_sampled, max_sampled);
}

class PatchSizeEstimator {
public:
    PatchSizeEstimator(const Scene& scene, const PatchMesh& mesh, const FormFactors& factors,
                       const Solution& solution)
        : scene_(scene), mesh_(mesh), factors_(factors), solution_(solution), channels_(solution.channels),
          reflectance_(patch_values(mesh, scene.materials, &Material::reflectance)),
          means_(mesh, corner_values(mesh, channels_, solution.radiosity, solution.back_face_share),
                 channels_),
          shown_(solution.vertex_radiosity.empty()
                     ? means_
                     : CornerInterpolation(mesh, solution.vertex_radiosity, channels_)),
          gathered_(!solution.vertex_radiosity.empty()) {
        const std::size_t values = std::size_t{mesh.size()} * channels_;
        if (solution.radiosity.size() != values || reflectance_.size() != values ||
            factors.matrix.size() != mesh.size() ||
            (!solution.vertex_radiosity.empty() && solution.vertex_radiosity.size() != values * 4)) {
            throw InvalidArgument("patch size error: the solution belongs to another mesh");
        }
        find_units();
        near_ = patches_near_surfaces(mesh_);
        if (gathered_) {
            visible_ = visible_radiosity(mesh_, SmoothSurfaces(mesh_), near_, channels_, solution_.radiosity,
                                         solution_.exitance, solution_.back_face_share);
            bends_ = vertex_bends(mesh_, solution_, visible_);
        }
    }

    [[nodiscard]] bool anything_reflects() const {
        return std::any_of(units_.begin(), units_.end(), [](double unit) { return unit > 0.0; });
    }

    [[nodiscard]] std::optional<PatchSizeError> run(const FactorSettings& settings,
                                                    const PatchSizeSample& wanted, Observer& observer) {
        const std::vector<DrawnPatch> sample = draw(wanted.effort);
        const bool clusters = factors_.matrix.clusters() != nullptr;
        cut_ = cut_sample(mesh_, sample, !clusters);
        const std::uint64_t bytes =
            quarter_row_bytes(cut_->rows.size(), cut_->mesh.size() * image_count(mesh_), clusters);
        if (bytes > memory_limit(settings)) {
            observer.warning(fmt::format("what the patches' size does is not estimated: that needs about {}",
                                         memory_text(bytes)),
                             "max-memory");
            return std::nullopt;
        }

        const FormFactorMatrix factors = compute_quarter_rows(*cut_, plan_rows(settings, mesh_.size()),
                                                              settings, scene_, clusters, observer);
        direct_ = direct_irradiances(scene_, cut_->mesh, factors, cut_->rows);
        if (clusters) { // rows that cannot be solved backwards
            observer.detail("errors of groups are not estimated where far patches stand in clusters");
        } else if (wanted.groups) {
            find_importance(bytes, settings, observer);
        }
        find_sources(factors.clusters().get());
        find_variation(factors.clusters().get());
        std::vector<SampledErrors> vertices(channels_);
        std::vector<SampledErrors> field(channels_);
        std::vector<SampledSum> groups(std::size_t{importance_.groups()} * channels_);
        std::vector<double> squares;
        for (std::size_t k = 0; k < sample.size(); ++k) {
            std::vector<double> before;
            for (std::uint32_t c = 0; c < channels_; ++c) {
                before.push_back(vertices[c].squares());
                before.push_back(field[c].squares());
            }
            add_patch(sample[k], cut_->quarters[k], factors, vertices, field, groups);
            const double area = sample[k].weight * mesh_.areas()[sample[k].patch];
            for (std::uint32_t c = 0; c < channels_; ++c) {
                squares.push_back(vertices_over_quarters() * (vertices[c].squares() - before[2 * c]) / area);
                field[c].end_patch(sample[k].weight, field[c].squares() - before[2 * c + 1]);
            }
        }
        if (!observer.progress(Phase::patch_size, 100, 100)) {
            throw Cancelled();
        }
        PatchSizeError result;
        result.groups = group_errors(groups);
        result.patches = model_patches(sample, squares);
        result.sampled = static_cast<std::uint32_t>(sample.size());
        const auto take_worst = [](FieldError& worst, const FieldError& error) {
            worst.rms = std::max(worst.rms, error.rms);
            worst.percentile95 = std::max(worst.percentile95, error.percentile95);
            worst.doubt = std::max(worst.doubt, error.doubt);
        };
        for (std::uint32_t c = 0; c < channels_; ++c) {
            if (units_[c] > 0.0) {
                take_worst(result.vertices, vertex_errors(vertices[c], sample, squares, c));
                take_worst(result.field, field[c].summary(units_[c], linear_over_quarters));
            }
        }
        return result;
    }

private:
    [[nodiscard]] std::size_t at(std::uint32_t patch, std::uint32_t channel) const {
        return std::size_t{patch} * channels_ + channel;
    }

    /// The patches that count, and the rms of what they reflect in every channel.
    void find_units() {
        units_.assign(channels_, 0.0);
        double area = 0.0;
        for (std::uint32_t i = 0; i < mesh_.size(); ++i) {
            const bool buried =
                !solution_.back_face_share.empty() && solution_.back_face_share[i] > buried_above;
            const bool reflects =
                std::any_of(reflectance_.begin() + static_cast<std::ptrdiff_t>(at(i, 0)),
                            reflectance_.begin() + static_cast<std::ptrdiff_t>(at(i + 1, 0)),
                            [](double rho) { return rho > 0.0; });
            if (buried || !reflects) {
                continue;
            }
            patches_.push_back(i);
            area += mesh_.areas()[i];
            for (std::uint32_t c = 0; c < channels_; ++c) {
                units_[c] += mesh_.areas()[i] *
                             std::pow(solution_.radiosity[at(i, c)] - solution_.exitance[at(i, c)], 2.0);
            }
        }
        for (double& unit : units_) {
            unit = area > 0.0 ? std::sqrt(unit / area) : 0.0;
        }
    }

    [[nodiscard]] std::vector<DrawnPatch> draw(double effort) const {
        std::vector<double> importance;
        std::vector<double> at_edges;
        for (const std::uint32_t patch : patches_) {
            // The square root of what a patch is likely to add makes the sum's variance least.
            const double likely = means_.spread(patch, solution_, units_) + least_doubt * least_doubt;
            importance.push_back(mesh_.areas()[patch] * std::sqrt(likely));
            at_edges.push_back(mesh_.areas()[patch] * likely);
        }
        if (scene_.sun) {
            // Edges of its shadows err much on little area: half of the sample is theirs.
            mix_importance(importance, at_edges);
        }
        if (!bends_.empty()) {
            // Gathered vertices err most on little area, where the radiosity bends: half of the sample is
            // theirs. The other half is for the constants, and for what bends do not show.
            std::vector<double> at_bends;
            for (const std::uint32_t patch : patches_) {
                double bend = 0.0;
                for (std::uint32_t c = 0; c < channels_; ++c) {
                    if (units_[c] > 0.0) {
                        bend = std::max(bend, std::sqrt(signs(patch, c)[1]) / units_[c]);
                    }
                }
                at_bends.push_back(std::sqrt(mesh_.areas()[patch]) * bend);
            }
            mix_importance(importance, at_bends);
        }
        return draw_sample(patches_, importance, sample_size(patches_.size(), effort));
    }

    /// What makes the error of a patch large, squared and absolute: how fast the radiosity changes there, how
    /// fast the change changes, and a little everywhere.
    [[nodiscard]] PatchErrorModel::Signs signs(std::uint32_t patch, std::uint32_t channel) const {
        constexpr double least = 1e-3; // of the channel's unit
        const double even = std::pow(least * units_[channel], 2.0);
        if (bends_.empty()) {
            return {means_.square(patch, solution_, channel) + even,
                    means_.bend(patch, solution_, channel) + even};
        }
        return {shown_.square(patch, solution_, channel) + even,
                std::pow(bends_[at(patch, channel)], 2.0) + even};
    }

    /// By how much the bends of all patches that count, squared, are more than the sample says, as means
    /// by area.
    [[nodiscard]] double missed_bends(const std::vector<DrawnPatch>& sample, std::uint32_t channel) const {
        double found = 0.0;
        double area_found = 0.0;
        for (const DrawnPatch& drawn : sample) {
            const double area = drawn.weight * mesh_.areas()[drawn.patch];
            found += area * signs(drawn.patch, channel)[1];
            area_found += area;
        }
        double all = 0.0;
        double area_all = 0.0;
        for (const std::uint32_t patch : patches_) {
            all += mesh_.areas()[patch] * signs(patch, channel)[1];
            area_all += mesh_.areas()[patch];
        }
        return found > 0.0 ? all / area_all / (found / area_found) : 1.0;
    }

    /// Mean square of the error of interpolated vertices over that of its means over four equal parts: for a
    /// quadratic field and true vertices these means are the bend.
    [[nodiscard]] double vertices_over_quarters() const { return gathered_ ? square_error_of_bend : 1.0; }

    /// Errors of the interpolated vertices, of one channel.
    /// @param errors   of the sample
    /// @param squares  of the sample: area means of the squared errors of every patch, channel by channel
    [[nodiscard]] FieldError vertex_errors(SampledErrors& errors, const std::vector<DrawnPatch>& sample,
                                           const std::vector<double>& squares, std::uint32_t channel) const {
        const auto sampled = [&](std::size_t k) { return sample[k].weight * mesh_.areas()[sample[k].patch]; };
        // Gathered vertices err as the radiosity bends, whose sum over all patches is known: few of them
        // have half of it, and a sample has some of these more or less. What is left to chance is how far
        // the error of the sample differs from what its bends say.
        double of_bends = 0.0;
        if (!bends_.empty()) {
            double found = 0.0;
            for (std::size_t k = 0; k < sample.size(); ++k) {
                of_bends += sampled(k) * squares[k * channels_ + channel];
                found += sampled(k) * signs(sample[k].patch, channel)[1];
            }
            of_bends /= std::max(found, std::numeric_limits<double>::min());
        }
        for (std::size_t k = 0; k < sample.size(); ++k) {
            const double expected = of_bends > 0.0 ? of_bends * signs(sample[k].patch, channel)[1] : 0.0;
            errors.end_patch(sample[k].weight, sampled(k) * (squares[k * channels_ + channel] - expected) /
                                                   vertices_over_quarters());
        }
        return errors.summary(units_[channel], vertices_over_quarters(),
                              bends_.empty() ? 1.0 : missed_bends(sample, channel));
    }

    /// Errors of all patches that count, modelled by their signs, see PatchErrorModel; then scaled to
    /// the whole. Patches of the sample have no less than was found there.
    /// @param squares  of the sample: area means of the squared errors of every patch, channel by channel
    [[nodiscard]] std::vector<double> model_patches(const std::vector<DrawnPatch>& sample,
                                                    const std::vector<double>& squares) const {
        std::vector<double> result(std::size_t{mesh_.size()} * channels_, 0.0);
        for (std::uint32_t c = 0; c < channels_; ++c) {
            PatchErrorModel model;
            for (std::size_t k = 0; k < sample.size(); ++k) {
                model.add(signs(sample[k].patch, c), squares[k * channels_ + c],
                          sample[k].weight * mesh_.areas()[sample[k].patch]);
            }
            model.fit();
            for (const std::uint32_t patch : patches_) {
                if (reflectance_[at(patch, c)] > 0.0) {
                    result[at(patch, c)] = std::sqrt(model.square(signs(patch, c)));
                }
            }
            for (std::size_t k = 0; k < sample.size(); ++k) {
                double& error = result[at(sample[k].patch, c)];
                error = std::max(error, std::sqrt(squares[k * channels_ + c]));
            }
        }
        return result;
    }

    /// Importance of every patch for every group, where there are not too many groups.
    /// @param bytes  that are needed besides
    void find_importance(std::uint64_t bytes, const FactorSettings& settings, Observer& observer) {
        const std::size_t groups = factors_.groups.size();
        if (groups > GroupImportance::most_groups) {
            observer.detail(fmt::format("errors of groups are not estimated: there are {}, more than {}",
                                        groups, GroupImportance::most_groups));
            return;
        }
        bytes += GroupImportance::memory_bytes(mesh_.size(), groups, channels_);
        if (bytes > memory_limit(settings)) {
            observer.detail(
                fmt::format("errors of groups are not estimated: that needs about {}", memory_text(bytes)));
            return;
        }
        try {
            importance_ =
                GroupImportance(factors_, reflectance_, channels_, quarter_of_progress(observer, 3));
        } catch (const NotConverged& error) {
            observer.detail(fmt::format("errors of groups are not estimated: {}", error.what()));
            return;
        }
        RadiosityProblem problem;
        problem.factors = &factors_.matrix;
        problem.channels = channels_;
        problem.reflectance = reflectance_;
        problem.exitance = solution_.exitance;
        problem.environment = scene_.environment;
        problem.direct = solution_.direct;
        irradiance_ = irradiance(problem, solution_.radiosity);
    }

    /// What a quarter gets of a field of the patches by its own row. What the row's factors miss of the share
    /// that its texels leave for them is made up for.
    /// @param field  values of a column, as many for each
    template <class Field>
    static std::vector<double> gathered(const RowView& row, std::size_t values, const Field& field) {
        std::vector<double> light(values, 0.0);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            const std::span<const double> source = field(row.columns[k]);
            for (std::size_t c = 0; c < values; ++c) {
                light[c] += static_cast<double>(row.values[k]) * source[c];
            }
        }
        const double sum = row.sum();
        const double scale = sum > 0.0 ? (1.0 - row.environment - row.blocked) / sum : 0.0;
        for (double& value : light) {
            value *= scale;
        }
        return light;
    }

    /// G of a quarter, a value a channel.
    [[nodiscard]] std::vector<double> irradiance_at(std::uint32_t quarter, const RowView& row) const {
        std::vector<double> light = gathered(row, channels_, [this](std::uint32_t column) {
            return std::span(sources_).subspan(at(column, 0), channels_);
        });
        for (std::uint32_t c = 0; c < channels_; ++c) {
            light[c] += scene_.environment.empty() ? 0.0 : row.environment * scene_.environment[c];
        }
        for (const std::vector<double>* part : {&direct_.sun, &direct_.sky}) {
            for (std::uint32_t c = 0; c < channels_ && !part->empty(); ++c) {
                light[c] += (*part)[direct_at(quarter) + c];
            }
        }
        return light;
    }

    /// Means of the clusters behind values of fine patches.
    void fill_clusters(const SourceClusters* clusters, std::vector<double>& values) const {
        if (clusters != nullptr) {
            values.resize((std::size_t{cut_->mesh.size()} + clusters->nodes().size()) * channels_);
            clusters->fill(values, channels_);
        }
    }

    /// What leaves the columns of the quarters' rows.
    void find_sources(const SourceClusters* clusters) {
        sources_.reserve(std::size_t{cut_->mesh.size()} * channels_);
        for (const std::uint32_t parent : cut_->parents) {
            const auto own = std::span(solution_.radiosity).subspan(at(parent, 0), channels_);
            sources_.insert(sources_.end(), own.begin(), own.end());
        }
        fill_clusters(clusters, sources_);
    }

    /// Of a quarter among those with rows: where its values in direct_ begin.
    [[nodiscard]] std::size_t direct_at(std::uint32_t quarter) const {
        const auto found = std::lower_bound(cut_->rows.begin(), cut_->rows.end(), quarter);
        return static_cast<std::size_t>(found - cut_->rows.begin()) * channels_;
    }

    /// A part of a quarter in which the light is even, and by how much of the sun's normal irradiance that
    /// is more than the quarter's mean.
    struct EvenPart {
        double share;
        double more;
    };
    /// Where the edge of a shadow of the sun crosses a quarter, what is in the sun and what is not; else all
    /// of it. An edge is sharp: whatever the size of patches, the light changes there within one.
    /// @param to_seen  the quarter's area over what nothing stands on, which the sun can reach
    [[nodiscard]] std::vector<EvenPart> even_parts(std::uint32_t quarter, double to_seen) const {
        if (scene_.sun && scene_.sun->diameter <= widest_sharp_sun) {
            const std::vector<double>& normal = scene_.sun->irradiance;
            const auto c =
                static_cast<std::size_t>(std::max_element(normal.begin(), normal.end()) - normal.begin());
            const std::size_t at = direct_at(quarter);
            const double lit = direct_.lit[at / channels_];
            const double seen_lit = std::min(1.0, to_seen * lit);
            if (lit > 0.0 && seen_lit < 1.0 && normal[c] > 0.0) {
                const double whole = direct_.sun[at + c] / (normal[c] * lit);
                return {{seen_lit, (1.0 - seen_lit) * whole}, {1.0 - seen_lit, -seen_lit * whole}};
            }
        }
        return {{1.0, 0.0}};
    }

    /// How the radiosity varies within the patches that are cut, where it is known well enough: at gathered
    /// vertices. A gather takes patches for even, which is the error that it leaves.
    void find_variation(const SourceClusters* clusters) {
        if (!gathered_) {
            return;
        }
        const PatchMesh& fine = cut_->mesh;
        variation_.assign(std::size_t{fine.size()} * channels_, 0.0);
        std::vector<double> means(std::size_t{mesh_.size()} * channels_, 0.0);
        for (std::uint32_t k = 0; k < fine.size(); ++k) {
            if (cut_->whole[k] != 0) {
                continue;
            }
            const std::uint32_t patch = cut_->parents[k];
            const auto weights = shown_.weights(patch, fine.corners(k));
            for (std::uint32_t c = 0; c < channels_; ++c) {
                double value = 0.0;
                for (std::uint32_t corner = 0; corner < mesh_.corners(patch).count; ++corner) {
                    value += weights[corner] * shown_.at_corner(patch, corner, c);
                }
                variation_[at(k, c)] = value;
                means[at(patch, c)] += value * fine.areas()[k] / mesh_.areas()[patch];
            }
        }
        for (std::uint32_t k = 0; k < fine.size(); ++k) {
            for (std::uint32_t c = 0; c < channels_; ++c) {
                const std::size_t parent = at(cut_->parents[k], c);
                variation_[at(k, c)] += visible_[parent] - solution_.radiosity[parent] - means[parent];
            }
        }
        fill_clusters(clusters, variation_);
    }

    /// What a quarter gets of the variation within the patches, a value a channel.
    [[nodiscard]] std::vector<double> varying_light(const RowView& row) const {
        std::vector<double> light(channels_, 0.0);
        for (std::size_t k = 0; k < row.columns.size() && !variation_.empty(); ++k) {
            for (std::uint32_t c = 0; c < channels_; ++c) {
                light[c] += static_cast<double>(row.values[k]) * variation_[at(row.columns[k], c)];
            }
        }
        return light;
    }

    /// Errors of the mean irradiance of the groups.
    /// @param sums  of A (G(s) - G_i) (h_i + rho_i z(s)) over the sample, see estimate_patch_size_error():
    ///   channel c of group g at [g·channels + c]
    [[nodiscard]] std::vector<GroupError> group_errors(const std::vector<SampledSum>& sums) const {
        if (importance_.groups() == 0) {
            return {};
        }
        std::vector<double> light(sums.size(), 0.0); // irradiance times area
        std::vector<bool> known(importance_.groups(), true);
        for (std::uint32_t i = 0; i < mesh_.size(); ++i) {
            known[mesh_.group(i)] = known[mesh_.group(i)] && factors_.matrix.known(i);
            for (std::uint32_t c = 0; c < channels_; ++c) {
                light[std::size_t{mesh_.group(i)} * channels_ + c] +=
                    mesh_.areas()[i] * irradiance_[at(i, c)];
            }
        }
        const std::vector<SampledSum> by_factors =
            factor_error_sums(scene_, mesh_, factors_, solution_, importance_);
        std::vector<GroupError> errors(importance_.groups());
        for (std::size_t g = 0; g < errors.size(); ++g) {
            bool lit = false;
            for (std::size_t k = g * channels_; k < (g + 1) * channels_; ++k) {
                if (known[g] && light[k] > 0.0) {
                    lit = true;
                    errors[g].patch_size =
                        std::max(errors[g].patch_size,
                                 linear_over_quarters * sums[k].with_standard_error() / light[k]);
                    errors[g].factors =
                        std::max(errors[g].factors, by_factors[k].with_standard_error() / light[k]);
                }
            }
            if (!lit) {
                errors[g] = {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::quiet_NaN()};
            }
        }
        return errors;
    }

    /// Share of a patch, or of a quarter of it, that something stands on: of its back-face share, where that
    /// comes of a surface near in front of it.
    [[nodiscard]] double covered(std::uint32_t patch, double back_face_share) const {
        return std::binary_search(near_.begin(), near_.end(), patch) ? back_face_share : 0.0;
    }

    void add_patch(const DrawnPatch& drawn, const std::array<std::uint32_t, 4>& quarters,
                   const FormFactorMatrix& factors, std::vector<SampledErrors>& vertices,
                   std::vector<SampledErrors>& field, std::vector<SampledSum>& groups) const {
        const std::uint32_t patch = drawn.patch;
        const PatchMesh& fine = cut_->mesh;
        std::array<std::vector<double>, 4> light;
        std::array<double, 4> seen{}; // area that nothing stands on
        std::vector<double> mean(channels_, 0.0);
        for (std::size_t q = 0; q < 4; ++q) {
            const RowView row = factors.row(quarters[q]);
            light[q] = irradiance_at(quarters[q], row);
            seen[q] = fine.areas()[quarters[q]] * (1.0 - covered(patch, row.blocked));
            for (std::uint32_t c = 0; c < channels_; ++c) {
                mean[c] += light[q][c] * fine.areas()[quarters[q]];
            }
        }
        const double seen_of_patch = std::accumulate(seen.begin(), seen.end(), 0.0);
        for (double& value : mean) {
            value /= std::max(seen_of_patch, std::numeric_limits<double>::min());
        }
        const double covered_by =
            solution_.back_face_share.empty() ? 0.0 : covered(patch, solution_.back_face_share[patch]);
        std::vector<double> for_groups(groups.size(), 0.0);
        for (std::size_t q = 0; q < 4; ++q) {
            const RowView row = factors.row(quarters[q]);
            if (row.blocked > buried_above) {
                continue; // nobody sees it; the patch's mean has its part of it all the same
            }
            const std::vector<double> importance =
                groups.empty() ? std::vector<double>() // there is none of clusters
                               : gathered(row, groups.size(), [this](std::uint32_t column) {
                                     return importance_.of(cut_->parents[column]);
                                 });
            const std::vector<double> varying = varying_light(row);
            const auto weights = shown_.weights(patch, fine.corners(quarters[q]));
            const double to_seen = fine.areas()[quarters[q]] / seen[q];
            const std::vector<EvenPart> parts = even_parts(quarters[q], to_seen);
            for (std::uint32_t c = 0; c < channels_; ++c) {
                const double rho = reflectance_[at(patch, c)];
                const double emitted = solution_.exitance[at(patch, c)];
                const double change = rho * (to_seen * light[q][c] - mean[c]);
                double shown = -emitted - (solution_.radiosity[at(patch, c)] - emitted) / (1.0 - covered_by);
                for (std::uint32_t corner = 0; corner < mesh_.corners(patch).count; ++corner) {
                    shown += weights[corner] * shown_.at_corner(patch, corner, c);
                }
                for (const EvenPart& part : parts) {
                    const double here =
                        change + (part.more != 0.0 ? rho * part.more * scene_.sun->irradiance[c] : 0.0);
                    const double area = drawn.weight * seen[q] * part.share;
                    field[c].add(here, area);
                    vertices[c].add(shown - here - rho * varying[c], area);
                }
                // Here the quarters' mean counts, too: it differs from what the patch's own row gets where
                // visibility and F0 change together.
                if (groups.empty()) {
                    continue;
                }
                const double error = light[q][c] - irradiance_[at(patch, c)];
                for (std::size_t column = c; column < groups.size(); column += channels_) {
                    const double own = column / channels_ == mesh_.group(patch) ? 1.0 : 0.0;
                    for_groups[column] += fine.areas()[quarters[q]] * error *
                                          (own + reflectance_[at(patch, c)] * importance[column]);
                }
            }
        }
        for (std::size_t column = 0; column < groups.size(); ++column) {
            groups[column].add(for_groups[column], drawn.weight);
        }
    }

    const Scene& scene_;
    const PatchMesh& mesh_;
    const FormFactors& factors_;
    const Solution& solution_;
    std::uint32_t channels_;
    std::vector<double> reflectance_;
    CornerInterpolation means_;          // over the patches that meet at a corner
    CornerInterpolation shown_;          // what pictures show
    bool gathered_;                      // whether these are gathered values
    std::vector<std::uint32_t> patches_; // those that reflect and are not buried, ascending
    std::vector<double> units_;          // a channel: rms of B - E over them
    std::vector<std::uint32_t> near_;    // patches with a surface near in front of them, ascending
    std::vector<double> visible_;        // see visible_radiosity(); where vertices are gathered
    std::vector<double> bends_;          // see vertex_bends(); empty: not all vertices are gathered
    GroupImportance importance_;
    std::vector<double> variation_;  // of the same columns; empty: not known
    std::vector<double> irradiance_; // of all patches, N·channels; with the importance
    std::optional<CutSample> cut_;
    std::vector<double> sources_; // radiosity of the columns of the quarters' rows, with their channels
    DirectIrradiance direct_;     // of the quarters
};

} // namespace

std::uint64_t patch_size_error_bytes(const PatchMesh& mesh, const PatchSizeSample& sample,
                                     std::uint32_t channels) {
    const double sampled = std::ceil(std::min<double>(sample_size(mesh.size(), sample.effort), mesh.size()));
    const auto rows = static_cast<std::uint64_t>(4.0 * sampled);
    const std::uint64_t bytes =
        quarter_row_bytes(rows, std::uint64_t{4} * mesh.size() * image_count(mesh), false);
    const std::size_t groups = mesh.groups().size();
    return sample.groups && groups <= GroupImportance::most_groups
               ? bytes + GroupImportance::memory_bytes(mesh.size(), groups, channels)
               : bytes;
}

std::optional<PatchSizeError> estimate_patch_size_error(const Scene& scene, const PatchMesh& mesh,
                                                        const FormFactors& factors, const Solution& solution,
                                                        const FactorSettings& settings, Observer& observer,
                                                        const PatchSizeSample& sample) {
    const Stopwatch watch;
    PatchSizeEstimator estimator(scene, mesh, factors, solution);
    if (!estimator.anything_reflects()) {
        return std::nullopt;
    }
    std::optional<PatchSizeError> error = estimator.run(settings, sample, observer);
    if (error) {
        error->seconds = watch.seconds();
        observer.detail(fmt::format("patch size: {} of {} patches cut in four in {:.2g} s", error->sampled,
                                    mesh.size(), error->seconds));
    }
    return error;
}

std::optional<PatchSizeError>
try_estimate_patch_size_error(const Scene& scene, const PatchMesh& mesh, const FormFactors& factors,
                              const Solution& solution, const FactorSettings& settings, Observer& observer) {
    std::string reason;
    try {
        return estimate_patch_size_error(scene, mesh, factors, solution, settings, observer);
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& error) {
        reason = error.what();
    }
    observer.warning(fmt::format("what the patches' size does is not estimated: {}", reason), "");
    return std::nullopt;
}

std::optional<SolutionError> solution_error(const Solution& solution) {
    // Where a row reflects more than it gets, the residual says nothing of what is left.
    if (!solution.patch_size_error || !solution.error || solution.dominance >= 1.0) {
        return std::nullopt;
    }
    double all = 0.0;
    double reflected = 0.0;
    for (std::size_t k = 0; k < solution.radiosity.size(); ++k) {
        all += std::pow(solution.radiosity[k], 2.0);
        reflected += std::pow(solution.radiosity[k] - solution.exitance[k], 2.0);
    }
    SolutionError error;
    error.patch_size = solution.patch_size_error->vertices.rms;
    error.factors = solution.error->rms;
    // About ||B - B*|| = ||residual|| / (1 - dominance) at worst, and what is emitted is at most B.
    const double amplified = solution.residual / (1.0 - solution.dominance);
    error.solver = reflected > 0.0 ? amplified * std::sqrt(all / reflected) : 0.0;
    constexpr double normal95 = 1.96; // 95 % of a normal distribution, in standard deviations
    const auto total = [&error](const FieldError& patch_size) {
        const double others = std::hypot(error.factors, error.solver);
        return FieldError{std::hypot(patch_size.rms, others),
                          std::hypot(patch_size.percentile95, normal95 * others)};
    };
    error.vertices = total(solution.patch_size_error->vertices);
    error.field = total(solution.patch_size_error->field);
    for (const GroupError& group : solution.patch_size_error->groups) {
        error.groups.push_back(std::hypot(group.patch_size, group.factors, error.solver));
    }
    return error;
}

} // namespace hemi
