#include "hemi/pipeline/radiosity_reference.hpp"

#include "core/splitmix.hpp"
#include "display/smooth_surfaces.hpp"
#include "hemi/core/buried.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/core/text.hpp"
#include "hemi/display/vertex_colours.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/radiosity.hpp"
#include "pipeline/corner_interpolation.hpp"
#include "pipeline/gathered_radiosity.hpp"
#include "pipeline/patch_locator.hpp"
#include "pipeline/visible_radiosity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hemi {

namespace {

constexpr std::uint32_t mesh_resolution = 96;
constexpr std::uint32_t mesh_shadow_rays = 32;
constexpr std::uint32_t point_resolution = 192;
constexpr std::uint32_t point_shadow_rays = 64;
/// Of the points one in so many is gathered at a second time.
constexpr std::uint32_t repeated_every = 4;

/// A number in [0, 1) that depends on both.
double hashed(std::uint64_t index, std::uint64_t which) {
    return static_cast<double>(splitmix(splitmix(index) ^ (which * 0xD1B54A32D192ED03u)) >> 11) * 0x1p-53;
}

/// A point of a patch: x chooses the half of a quadrilateral, and with y the place in it.
Vec3 point_of(const PatchCorners& corners, double x, double y) {
    const auto& p = corners.points;
    std::array<Vec3, 3> triangle{p[0], p[1], p[2]};
    if (corners.count == 4) {
        const double first = glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
        const double second = glm::length(glm::cross(p[2] - p[0], p[3] - p[0]));
        const double share = first / (first + second);
        if (x < share) {
            x /= share;
        } else {
            x = (x - share) / (1.0 - share);
            triangle = {p[0], p[2], p[3]};
        }
    }
    const double root = std::sqrt(x);
    return (1.0 - root) * triangle[0] + root * (1.0 - y) * triangle[1] + root * y * triangle[2];
}

/// Points with the patches that they lie on.
struct Points {
    std::vector<SurfacePoint> points;
    std::vector<double> areas; ///< that they stand for
    std::vector<std::uint32_t> hosts;
};

/// Rms of what is reflected, for every channel.
std::vector<double> reflected_units(const PatchMesh& mesh, const std::vector<std::uint32_t>& patches,
                                    const Solution& solution) {
    std::vector<double> units(solution.channels, 0.0);
    double area = 0.0;
    for (const std::uint32_t i : patches) {
        area += mesh.areas()[i];
        for (std::uint32_t c = 0; c < solution.channels; ++c) {
            const std::size_t at = std::size_t{i} * solution.channels + c;
            units[c] += mesh.areas()[i] * std::pow(solution.radiosity[at] - solution.exitance[at], 2.0);
        }
    }
    for (double& unit : units) {
        unit = area > 0.0 ? std::sqrt(unit / area) : 0.0;
    }
    return units;
}

/// One in every share of the area, where shares are smaller the faster the light changes there.
Points spread_points(const Scene& scene, const PatchMesh& mesh, const Solution& solution,
                     std::uint32_t count) {
    // Where the light is even something may change still: as if it did by this share of what is reflected.
    constexpr double least_change = 0.05;
    std::vector<std::uint32_t> patches;
    for (const std::uint32_t i : reflecting_patches(scene, mesh)) {
        if (solution.back_face_share[i] <= buried_above) {
            patches.push_back(i);
        }
    }
    const std::vector<double> units = reflected_units(mesh, patches, solution);
    const CornerInterpolation corners(
        mesh, corner_values(mesh, solution.channels, solution.radiosity, solution.back_face_share),
        solution.channels);
    std::vector<double> densities; // of points, but for a factor
    double total = 0.0;
    for (const std::uint32_t i : patches) {
        densities.push_back(std::sqrt(corners.spread(i, solution, units) + least_change * least_change));
        total += mesh.areas()[i] * densities.back();
    }
    Points result;
    double before = 0.0;
    const double share = total / count;
    for (std::size_t p = 0; p < patches.size(); ++p) {
        const std::uint32_t i = patches[p];
        const PatchCorners polygon = mesh.corners(i);
        before += mesh.areas()[i] * densities[p];
        while ((static_cast<double>(result.points.size()) + 0.5) * share < before) {
            const std::size_t k = result.points.size();
            result.points.push_back(
                {point_of(polygon, hashed(k, 1), hashed(k, 2)), mesh.normal(i), mesh.surface_of()[i]});
            result.areas.push_back(share / densities[p]);
            result.hosts.push_back(i);
        }
    }
    return result;
}

/// Means of the radiosity over the patches of a coarser mesh, for the patches of the finer one.
std::vector<double> averaged(const PatchMesh& mesh, const PatchMesh& coarser, std::uint32_t channels,
                             std::span<const double> radiosity) {
    const PatchLocator locator(coarser);
    std::vector<double> sums(std::size_t{coarser.size()} * channels, 0.0);
    std::vector<double> areas(coarser.size(), 0.0);
    std::vector<std::optional<std::uint32_t>> parents(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        parents[i] = locator.find({mesh.centres()[i], mesh.normal(i), 0});
        if (parents[i]) {
            areas[*parents[i]] += mesh.areas()[i];
            for (std::uint32_t c = 0; c < channels; ++c) {
                sums[std::size_t{*parents[i]} * channels + c] +=
                    mesh.areas()[i] * radiosity[std::size_t{i} * channels + c];
            }
        }
    }
    std::vector<double> result(radiosity.begin(), radiosity.end());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        for (std::uint32_t c = 0; parents[i] && c < channels; ++c) {
            result[std::size_t{i} * channels + c] =
                sums[std::size_t{*parents[i]} * channels + c] / areas[*parents[i]];
        }
    }
    return result;
}

/// Errors at points, one channel.
class PointErrors {
public:
    /// @param area  that the point stands for
    void add(double area, double error, double reflected) {
        errors_.push_back({std::abs(error), area});
        reflected_ += area * reflected * reflected;
    }
    /// @return nothing where nothing is reflected
    [[nodiscard]] std::optional<FieldError> summary() {
        if (!(reflected_ > 0.0)) {
            return std::nullopt;
        }
        double sum = 0.0;
        double squares = 0.0;
        double area = 0.0;
        for (const auto& [error, of] : errors_) {
            sum += of * error * error;
            squares += std::pow(of * error * error, 2.0);
            area += of;
        }
        const double variance = std::max(0.0, squares - sum * sum / static_cast<double>(errors_.size()));
        FieldError result;
        result.rms = std::sqrt(sum / reflected_);
        result.doubt = std::sqrt((sum + std::sqrt(variance)) / reflected_) - result.rms;
        std::sort(errors_.begin(), errors_.end());
        double below = 0.0;
        for (const auto& [error, of] : errors_) {
            result.percentile95 = error * std::sqrt(area / reflected_);
            below += of;
            if (below >= 0.95 * area) {
                break;
            }
        }
        return result;
    }

private:
    std::vector<std::pair<double, double>> errors_; ///< with areas
    double reflected_ = 0.0;
};

/// @return whether there was one to take
bool take_worst(FieldError& worst, const std::optional<FieldError>& error) {
    if (error) {
        worst.rms = std::max(worst.rms, error->rms);
        worst.percentile95 = std::max(worst.percentile95, error->percentile95);
        worst.doubt = std::max(worst.doubt, error->doubt);
    }
    return error.has_value();
}

} // namespace

RadiosityReference find_radiosity_reference(const Scene& scene, const PatchMesh& mesh,
                                            const PatchMesh& coarser, const FactorSettings& settings,
                                            std::uint32_t count, Observer& observer) {
    if (reflecting_patches(scene, mesh).empty()) {
        throw InvalidArgument("nothing in the scene reflects, so that no radiosity is to be found");
    }
    if (scene.sun || scene.sky) {
        throw InvalidArgument("what sun and sky light is not found at the points of a reference");
    }
    const Stopwatch watch;
    FactorSettings other = settings;
    other.method = Method::hemicube;
    other.preset = Preset::fast;
    other.eye_points.reset();
    other.resolution = mesh_resolution;
    other.shadow_rays = mesh_shadow_rays;
    other.seed = ~plan_rows(settings, mesh.size()).hemicube.seed;
    other.estimate_error = false;
    other.repair.reset();
    RadiosityReference reference;
    reference.patches = mesh.size();
    Solution solution;
    {
        const FormFactors factors = compute_form_factors(scene, mesh, other, observer);
        solution = solve_radiosity(scene, mesh, factors, {}, observer, false);
    }
    const PatchValues values = patch_values(scene, mesh);
    const std::uint32_t channels = values.channels;
    reference.channels = channels;
    const std::vector<double> seen =
        visible_radiosity(mesh, SmoothSurfaces(mesh), patches_near_surfaces(mesh), channels,
                          solution.radiosity, values.exitance, solution.back_face_share);
    const std::vector<double> coarse = averaged(mesh, coarser, channels, seen);
    const auto mean_area = [](const PatchMesh& of) {
        double area = 0.0;
        for (const double one : of.areas()) {
            area += one;
        }
        return area / of.size();
    };
    // Errors like h^1.5 where walls touch (in smooth light h²): those of the fine patches from the difference
    // to those of the coarse ones.
    const double ratio = std::pow(std::min(mean_area(mesh) / mean_area(coarser), 0.75), 0.75);
    const double own = ratio / (1.0 - ratio);

    const Points spread = spread_points(scene, mesh, solution, count);
    std::vector<double> weights(mesh.size());
    for (std::uint32_t j = 0; j < mesh.size(); ++j) {
        weights[j] = *std::max_element(seen.begin() + std::ptrdiff_t{j} * channels,
                                       seen.begin() + (std::ptrdiff_t{j} + 1) * channels);
    }
    const auto gather = [&](std::span<const SurfacePoint> points, const PointRowSink& sink) {
        RowPlan plan = plan_rows(other, mesh.size());
        plan.hemicube.resolution = point_resolution;
        const auto engine = make_point_visibility_provider(mesh, points, plan.hemicube, other);
        compute_point_rows(*engine, mesh, points, {ExchangeRule::standard, point_shadow_rays},
                           scene.enclosure, weights, sink, [&observer](std::size_t done, std::size_t total) {
                               return observer.progress(Phase::gather, done, total);
                           });
    };
    std::vector<double> light(spread.points.size() * channels, 0.0);
    std::vector<double> coarse_light(light.size(), 0.0);
    std::vector<std::uint8_t> buried(spread.points.size(), 0);
    gather(spread.points, [&](std::uint32_t index, const RowView& row) {
        const std::size_t at = std::size_t{index} * channels;
        gathered_radiosity(row, values, seen, spread.hosts[index], std::span(light).subspan(at, channels));
        gathered_radiosity(row, values, coarse, spread.hosts[index],
                           std::span(coarse_light).subspan(at, channels));
        buried[index] = row.blocked > buried_above ? 1 : 0;
    });
    // Some of them again with other rotations and rays.
    std::vector<SurfacePoint> repeated;
    for (std::size_t k = 0; k < spread.points.size(); k += repeated_every) {
        repeated.push_back(spread.points[k]);
    }
    std::vector<double> light_again(repeated.size() * channels, 0.0);
    other.seed = splitmix(*other.seed);
    gather(repeated, [&](std::uint32_t index, const RowView& row) {
        gathered_radiosity(row, values, seen, spread.hosts[std::size_t{index} * repeated_every],
                           std::span(light_again).subspan(std::size_t{index} * channels, channels));
    });
    std::vector<PointErrors> of_patches(channels);
    std::vector<PointErrors> of_rows(channels);
    for (std::uint32_t k = 0; k < spread.points.size(); ++k) {
        if (buried[k] != 0) {
            continue;
        }
        reference.points.push_back(spread.points[k]);
        reference.areas.push_back(spread.areas[k]);
        for (std::uint32_t c = 0; c < channels; ++c) {
            const std::size_t at = std::size_t{k} * channels + c;
            const double reflected = light[at] - values.exitance[std::size_t{spread.hosts[k]} * channels + c];
            reference.radiosity.push_back(light[at]);
            reference.reflected.push_back(reflected);
            of_patches[c].add(spread.areas[k], own * (coarse_light[at] - light[at]), reflected);
            if (k % repeated_every == 0) {
                const double again = light_again[std::size_t{k} / repeated_every * channels + c];
                of_rows[c].add(spread.areas[k], (again - light[at]) / std::sqrt(2.0), reflected);
            }
        }
    }
    FieldError worst_of_patches;
    FieldError worst_of_rows;
    for (std::uint32_t c = 0; c < channels; ++c) {
        take_worst(worst_of_patches, of_patches[c].summary());
        take_worst(worst_of_rows, of_rows[c].summary());
    }
    reference.own_error = std::hypot(worst_of_patches.rms, worst_of_rows.rms);
    reference.seconds = watch.seconds();
    observer.detail(fmt::format("reference: {}, {} points, {}", plural(mesh.size(), "patch", "patches"),
                                count_text(reference.points.size()), seconds_text(reference.seconds)));
    return reference;
}

std::optional<RadiosityError> judge_radiosity(const PatchMesh& mesh, const Solution& solution,
                                              const RadiosityReference& reference) {
    const std::uint32_t channels = reference.channels;
    const std::size_t values = std::size_t{mesh.size()} * channels;
    if (solution.channels != channels || solution.radiosity.size() != values ||
        (!solution.vertex_radiosity.empty() && solution.vertex_radiosity.size() != values * 4)) {
        throw InvalidArgument(fmt::format("reference: of {} channels, the solution has {} values for {}",
                                          channels, solution.radiosity.size(),
                                          plural(mesh.size(), "patch", "patches")));
    }
    const std::vector<float> means =
        solution.vertex_radiosity.empty()
            ? corner_values(mesh, channels, solution.radiosity, solution.back_face_share)
            : std::vector<float>();
    const std::vector<float>& corners = means.empty() ? solution.vertex_radiosity : means;
    const PatchLocator locator(mesh);
    std::vector<PointErrors> vertices(channels);
    std::vector<PointErrors> field(channels);
    for (std::size_t k = 0; k < reference.points.size(); ++k) {
        const auto patch = locator.find(reference.points[k]);
        if (!patch ||
            (!solution.back_face_share.empty() && solution.back_face_share[*patch] > buried_above)) {
            continue;
        }
        const std::array<double, 4> weights = locator.weights(*patch, reference.points[k].position);
        for (std::uint32_t c = 0; c < channels; ++c) {
            double shown = 0.0;
            for (std::size_t corner = 0; corner < weights.size(); ++corner) {
                if (weights[corner] != 0.0) { // the fourth of a triangle has no value
                    shown += weights[corner] *
                             static_cast<double>(corners[(std::size_t{*patch} * 4 + corner) * channels + c]);
                }
            }
            const std::size_t at = k * channels + c;
            const double right = reference.radiosity[at];
            vertices[c].add(reference.areas[k], shown - right, reference.reflected[at]);
            field[c].add(reference.areas[k], solution.radiosity[std::size_t{*patch} * channels + c] - right,
                         reference.reflected[at]);
        }
    }
    RadiosityError result;
    bool lit = false;
    for (std::uint32_t c = 0; c < channels; ++c) {
        lit = take_worst(result.vertices, vertices[c].summary()) || lit;
        take_worst(result.field, field[c].summary());
    }
    return lit ? std::optional(result) : std::nullopt;
}

} // namespace hemi
