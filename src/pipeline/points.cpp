#include "hemi/pipeline/points.hpp"

#include "core/parallel_for.hpp"
#include "display/smooth_surfaces.hpp"
#include "engine/environment_verdict.hpp"
#include "hemi/core/black_body.hpp"
#include "hemi/core/error.hpp"
#include "hemi/scene/image_mesh.hpp"
#include "pipeline/heat_rows.hpp"
#include "pipeline/point_daylight.hpp"
#include "pipeline/visible_radiosity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace hemi {

namespace {

constexpr std::uint32_t plane_count = 6;
/// One hemicube has as many texels as the four of a patch by the same preset.
constexpr std::uint32_t resolution_factor = 2;
/// The two of a sphere have to do with about as many as the six of its planes: in the office, their
/// texels 1.5 times as fine, its light is as exact as by those.
std::uint32_t sphere_resolution(std::uint32_t resolution) {
    constexpr std::uint32_t most = 4096;
    const std::uint32_t half = (3 * resolution + 3) / 4;
    return std::min(2 * half, most);
}
/// Rows that are made use of at once, by all threads.
constexpr std::size_t rows_at_once = 64;
/// µm. Source: WMO, Guide to Instruments and Methods of Observation, WMO-No. 8: short-wave radiation.
constexpr double short_wave_end = 4.0;
constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

void check(const PatchMesh& mesh, std::span<const Receiver> points, const Radiation& radiation) {
    if (radiation.radiosity.size() != std::size_t{mesh.size()} * radiation.channels ||
        (!radiation.environment.empty() && radiation.environment.size() != radiation.channels)) {
        throw InvalidArgument(fmt::format("points: {} values for {} patches of {} channels",
                                          radiation.radiosity.size(), mesh.size(), radiation.channels));
    }
    if (!radiation.short_wave.empty() && radiation.short_wave.size() != radiation.channels) {
        throw InvalidArgument(fmt::format("points: short waves are told of {} channels of {}",
                                          radiation.short_wave.size(), radiation.channels));
    }
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Vec3& at = points[k].position;
        if (!std::isfinite(at.x + at.y + at.z)) {
            throw InvalidArgument(fmt::format("point {}: a coordinate is not a finite number", k));
        }
        if (points[k].normal && !(std::abs(glm::length(*points[k].normal) - 1.0) <= 1e-9)) {
            throw InvalidArgument(
                fmt::format("point {}: normal of length {}; must be 1", k, glm::length(*points[k].normal)));
        }
    }
}

/// Rows that are computed: of a plane one, of a sphere one by the solid angle, and of six planes if they are
/// wanted.
struct Rows {
    std::vector<SurfacePoint> planes;
    std::vector<std::uint32_t> point_of_plane;
    std::vector<std::uint32_t> direction; ///< of the six, of every plane; of a point with a normal 0
    std::vector<SurfacePoint> spheres;
    std::vector<std::uint32_t> point_of_sphere;

    [[nodiscard]] std::size_t size() const { return planes.size() + spheres.size(); }
};

Rows rows_of(std::span<const Receiver> points, std::span<const Vec3> directions) {
    Rows rows;
    for (std::uint32_t k = 0; k < points.size(); ++k) {
        const Receiver& point = points[k];
        const auto add_plane = [&](const Vec3& normal, std::uint32_t direction) {
            rows.planes.push_back({point.position, normal, point.surface});
            rows.point_of_plane.push_back(k);
            rows.direction.push_back(direction);
        };
        if (point.normal) {
            add_plane(*point.normal, 0);
            continue;
        }
        rows.spheres.push_back({point.position, {}, point.surface});
        rows.point_of_sphere.push_back(k);
        for (std::uint32_t d = 0; d < directions.size(); ++d) {
            add_plane(directions[d], d);
        }
    }
    return rows;
}

/// What comes from patches and the environment, each with its share of all that is seen.
class Sum {
public:
    explicit Sum(const Radiation& radiation) : radiation_(radiation), irradiance_(radiation.channels, 0.0) {}

    void add(std::uint32_t patch, double share) {
        const double* const source = radiation_.radiosity.data() + std::size_t{patch} * radiation_.channels;
        double total = 0.0;
        for (std::uint32_t c = 0; c < radiation_.channels; ++c) {
            total += source[c];
        }
        if (std::isfinite(total)) {
            add(source, share);
            known_ += share;
        }
    }
    /// Of sun and sky, in addition to what was added for the share.
    [[nodiscard]] auto adder() {
        return [this](std::uint32_t channel, double irradiance) {
            irradiance_[channel] += irradiance;
            direct_ += irradiance;
        };
    }
    /// @param seen  else it is a leak, which counts as light but not among the surroundings
    void add_environment(double share, bool seen) {
        if (seen) {
            if (!radiation_.environment.empty()) {
                add(radiation_.environment.data(), share);
            }
            known_ += share;
            return;
        }
        for (std::uint32_t c = 0; c < radiation_.channels && !radiation_.environment.empty(); ++c) {
            irradiance_[c] += share * radiation_.environment[c];
        }
    }
    [[nodiscard]] std::span<const double> irradiance() const { return irradiance_; }
    [[nodiscard]] double surroundings() const {
        return known_ > 0.0 ? (long_ + short_) / known_ + direct_ : not_known;
    }
    [[nodiscard]] double long_wave() const { return known_ > 0.0 ? long_ / known_ : not_known; }
    [[nodiscard]] double short_wave() const { return known_ > 0.0 ? short_ / known_ + direct_ : not_known; }

private:
    void add(const double* source, double share) {
        for (std::uint32_t c = 0; c < radiation_.channels; ++c) {
            irradiance_[c] += share * source[c];
            const bool is_short = !radiation_.short_wave.empty() && radiation_.short_wave[c];
            (is_short ? short_ : long_) += share * source[c];
        }
    }

    const Radiation& radiation_;
    std::vector<double> irradiance_;
    double long_ = 0.0;
    double short_ = 0.0;
    double known_ = 0.0;
    double direct_ = 0.0;
};

/// A row that waits for its turn.
struct WaitingRow {
    std::uint32_t point = 0;
    std::optional<std::uint32_t> direction; ///< of the six; none: of the point itself
    std::vector<std::uint32_t> columns;
    std::vector<float> values;
    double environment = 0.0;
    double blocked = 0.0;
};

/// Makes values of rows.
class Values {
public:
    Values(const PatchMesh& mesh, std::span<const Receiver> points, const Radiation& radiation,
           Enclosure enclosure, std::span<const Vec3> directions)
        : mesh_(mesh), points_(points), radiation_(radiation), enclosure_(enclosure), directions_(directions),
          daylight_(mesh, radiation.sun, radiation.sky, radiation.up) {
        const std::size_t count = points.size();
        values_.channels = radiation.channels;
        values_.groups = static_cast<std::uint32_t>(mesh.groups().size());
        values_.irradiance.assign(count * radiation.channels, 0.0);
        values_.factors.assign(count * values_.groups, 0.0);
        values_.sky.assign(count, 0.0);
        values_.below_horizon.assign(count, 0.0);
        values_.blocked.assign(count, 0.0);
        values_.surroundings.assign(count, not_known);
        values_.planes.assign(count * directions.size(), not_known);
        values_.planes_short.assign(count * directions.size(), not_known);
    }

    /// @param direction  of the six of a sphere; none: the row of the point itself
    void take(std::uint32_t point, std::optional<std::uint32_t> direction, const RowView& row) {
        waiting_.push_back({point,
                            direction,
                            {row.columns.begin(), row.columns.end()},
                            {row.values.begin(), row.values.end()},
                            row.environment,
                            row.blocked});
        if (waiting_.size() == rows_at_once) {
            finish_rows();
        }
    }
    /// Finishes what is left. @return the values; call once
    [[nodiscard]] PointValues finish() {
        finish_rows();
        return std::move(values_);
    }

private:
    void finish_rows() {
        parallel_for(waiting_.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const WaitingRow& waiting = waiting_[k];
                finish_row(waiting,
                           {waiting.columns, waiting.values, {}, waiting.environment, waiting.blocked});
            }
        });
        waiting_.clear();
    }

    void finish_row(const WaitingRow& waiting, const RowView& row) {
        const std::uint32_t point = waiting.point;
        Sum sum(radiation_);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            sum.add(row.columns[k], static_cast<double>(row.values[k]));
        }
        const bool open = sees_environment(row.environment, enclosure_);
        sum.add_environment(row.environment, open);
        const std::optional<Vec3> normal =
            waiting.direction ? std::optional(directions_[*waiting.direction]) : points_[point].normal;
        const Vec3& at = points_[point].position;
        const bool of_point = !waiting.direction;
        const PointDaylight::Environment seen =
            open && (of_point || daylight_.has_sky())
                ? daylight_.seen_by(at, normal, row)
                : PointDaylight::split(row.environment, row.blocked, daylight_.available(normal), {});
        daylight_.irradiance(at, normal, seen, sum.adder());
        if (of_point) {
            set(point, sum, seen, row);
        } else {
            const std::size_t plane = std::size_t{point} * plane_count + *waiting.direction;
            values_.planes[plane] = sum.long_wave();
            values_.planes_short[plane] = sum.short_wave();
        }
    }

    void set(std::uint32_t point, const Sum& sum, const PointDaylight::Environment& environment,
             const RowView& row) {
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            values_.factors[std::size_t{point} * values_.groups + mesh_.group(row.columns[k])] +=
                static_cast<double>(row.values[k]);
        }
        values_.sky[point] = environment.above.share;
        values_.below_horizon[point] = environment.below;
        values_.blocked[point] = row.blocked;
        std::copy(sum.irradiance().begin(), sum.irradiance().end(),
                  values_.irradiance.begin() +
                      static_cast<std::ptrdiff_t>(std::size_t{point} * radiation_.channels));
        values_.surroundings[point] = sum.surroundings();
    }

    const PatchMesh& mesh_;
    std::span<const Receiver> points_;
    const Radiation& radiation_;
    Enclosure enclosure_;
    std::span<const Vec3> directions_;
    PointDaylight daylight_;
    std::vector<WaitingRow> waiting_;
    PointValues values_;
};

/// How much each patch's light matters, for the choice of shadow rays.
std::vector<double> weights_of(const PatchMesh& mesh, const Radiation& radiation) {
    std::vector<double> weights(mesh.size(), 0.0);
    double largest = 0.0;
    for (std::uint32_t j = 0; j < mesh.size(); ++j) {
        for (std::uint32_t c = 0; c < radiation.channels; ++c) {
            const double value = radiation.radiosity[std::size_t{j} * radiation.channels + c];
            weights[j] = value > weights[j] ? value : weights[j];
        }
        largest = std::max(largest, weights[j]);
    }
    if (largest == 0.0) {
        return {};
    }
    return weights;
}

/// Of every band, whether it ends where short waves do, or before.
std::vector<bool> short_waves(const std::vector<double>& band_limits) {
    std::vector<bool> result;
    for (const double limit : band_limits) {
        result.push_back(limit <= short_wave_end);
    }
    result.push_back(false);
    return result;
}

} // namespace

std::array<Vec3, 6> plane_directions(double facing, UpAxis up) {
    const double angle = facing * std::numbers::pi / 180.0;
    const Vec3 above = upwards(up);
    const Vec3 front = turned_upright({std::sin(angle), std::cos(angle), 0.0}, up);
    const Vec3 right = turned_upright({std::cos(angle), -std::sin(angle), 0.0}, up);
    return {above, -above, right, -right, front, -front};
}

Radiation radiation_of(const PatchMesh& mesh, const PatchValues& values, const Solution& solution) {
    const std::size_t count = std::size_t{mesh.size()} * values.channels;
    if (solution.channels != values.channels || solution.radiosity.size() != count ||
        values.exitance.size() != count) {
        throw InvalidArgument(fmt::format("points: a radiosity of {} values for {} patches of {} channels",
                                          solution.radiosity.size(), mesh.size(), values.channels));
    }
    return {values.channels,
            visible_radiosity(mesh, SmoothSurfaces(mesh), patches_near_surfaces(mesh), values.channels,
                              solution.radiosity, values.exitance, solution.back_face_share),
            values.environment};
}

Radiation radiation_of(const HeatProblem& problem, const HeatSolution& solution) {
    Radiation radiation{solution.bands, solution.radiosity, environment_exitance(problem)};
    radiation.short_wave = short_waves(problem.band_limits);
    return radiation;
}

Radiation radiation_of(const Scene& scene, const Solution& solution) {
    const std::vector<double> limits = scene.thermal ? scene.thermal->band_limits : std::vector<double>();
    const auto bands = static_cast<std::uint32_t>(limits.size()) + 1; // one: the channels are equal
    const std::size_t patches = solution.net_flux.size();
    if (patches == 0 || (bands != 1 && bands != solution.channels) ||
        solution.radiosity.size() != patches * solution.channels) {
        throw InvalidArgument(fmt::format("points: heat of {} bands in {} channels, of {} patches", bands,
                                          solution.channels, patches));
    }
    Radiation radiation{bands, {}, scene.environment};
    radiation.environment.resize(bands, 0.0);
    for (std::size_t i = 0; i < patches; ++i) {
        for (std::uint32_t band = 0; band < bands; ++band) {
            radiation.radiosity.push_back(solution.radiosity[i * solution.channels + band]);
        }
    }
    radiation.short_wave = short_waves(limits);
    return radiation;
}

namespace {

/// The same of all images.
Radiation of_images(const ImageMesh& images, const Radiation& radiation) {
    Radiation all = radiation;
    all.radiosity.resize(std::size_t{images.mesh().size()} * radiation.channels);
    for (std::uint32_t p = 0; p < images.mesh().size(); ++p) {
        std::copy_n(radiation.radiosity.begin() + std::ptrdiff_t{images.original(p)} * radiation.channels,
                    radiation.channels, all.radiosity.begin() + std::ptrdiff_t{p} * radiation.channels);
    }
    return all;
}

} // namespace

PointValues compute_point_values(const PatchMesh& mesh, std::span<const Receiver> points,
                                 const Radiation& radiation, Enclosure enclosure,
                                 const FactorSettings& settings, std::optional<double> facing,
                                 Observer& observer) {
    check(mesh, points, radiation);
    if (mesh.symmetry()) { // every image hides a part of the sky of its own
        const ImageMesh images(mesh);
        return compute_point_values(images.mesh(), points, of_images(images, radiation), enclosure, settings,
                                    facing, observer);
    }
    RowPlan plan = plan_rows(settings, mesh.size());
    if (plan.hemicube.eye_points > 1) {
        plan.hemicube.resolution *= resolution_factor;
    }
    const VisibilityWeightedSettings weighted = plan.weighted.value_or(VisibilityWeightedSettings{});
    std::vector<Vec3> directions;
    if (facing) {
        const std::array<Vec3, plane_count> six = plane_directions(*facing, radiation.up);
        directions.assign(six.begin(), six.end());
    }
    Values values(mesh, points, radiation, enclosure, directions);
    const Rows rows = rows_of(points, directions);
    const std::vector<double> weights = weights_of(mesh, radiation);
    std::size_t before = 0;
    const auto compute = [&](std::span<const SurfacePoint> places, DirectionMeasure measure,
                             const PointRowSink& sink) {
        if (places.empty()) {
            return;
        }
        HemicubeSettings hemicube = plan.hemicube;
        if (measure == DirectionMeasure::solid_angle) {
            hemicube.resolution = sphere_resolution(hemicube.resolution);
        }
        // A sphere has two hemicubes: what one does not show, the other may.
        hemicube.joint =
            measure == DirectionMeasure::projected_solid_angle && mesh.size() > points_ask_singly;
        const auto engine = make_point_visibility_provider(mesh, places, hemicube, settings, measure);
        compute_point_rows(*engine, mesh, places, weighted, enclosure, weights, sink,
                           [&](std::size_t done, std::size_t) {
                               return observer.progress(Phase::points, before + done, rows.size());
                           },
                           {.measure = measure});
        before += places.size();
    };
    compute(rows.spheres, DirectionMeasure::solid_angle, [&](std::uint32_t index, const RowView& row) {
        values.take(rows.point_of_sphere[index], std::nullopt, row);
    });
    compute(rows.planes, DirectionMeasure::projected_solid_angle,
            [&](std::uint32_t index, const RowView& row) {
                const std::uint32_t point = rows.point_of_plane[index];
                values.take(point, points[point].normal ? std::nullopt : std::optional(rows.direction[index]),
                            row);
            });
    return values.finish();
}

std::array<double, 6> plane_exitances(const PointValues& values, std::size_t point,
                                      const BodyAbsorption& body) {
    std::array<double, plane_count> exitances{};
    for (std::size_t d = 0; d < plane_count; ++d) {
        const std::size_t plane = point * plane_count + d;
        exitances[d] =
            values.planes.at(plane) + body.short_wave / body.long_wave * values.planes_short.at(plane);
    }
    return exitances;
}

double person_radiant_temperature(std::span<const double, 6> planes, Posture posture, bool faces) {
    std::array<double, 3> areas =
        posture == Posture::standing ? std::array{0.08, 0.23, 0.35} : std::array{0.18, 0.22, 0.30};
    if (!faces) {
        areas[1] = areas[2] = 0.5 * (areas[1] + areas[2]);
    }
    double sum = 0.0;
    double weights = 0.0;
    for (std::size_t k = 0; k < planes.size(); ++k) {
        if (!std::isfinite(planes[k])) {
            return not_known;
        }
        sum += areas[k / 2] * black_body_temperature(planes[k]);
        weights += areas[k / 2];
    }
    return sum / weights;
}

} // namespace hemi
