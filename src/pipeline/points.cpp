#include "hemi/pipeline/points.hpp"

#include "core/parallel_for.hpp"
#include "display/smooth_surfaces.hpp"
#include "engine/visibility_weighted/factor_assembly.hpp"
#include "hemi/core/black_body.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "pipeline/heat_rows.hpp"
#include "pipeline/point_daylight.hpp"
#include "pipeline/visible_radiosity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace hemi {

namespace {

constexpr std::uint32_t plane_count = 6;
/// One hemicube has as many texels as the four of a patch by the same preset.
constexpr std::uint32_t resolution_factor = 2;
/// Spheres whose shares are found at once, by all threads.
constexpr std::size_t spheres_at_once = 32;
constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
const Vec3 upwards(0.0, 0.0, 1.0);

void check(const PatchMesh& mesh, std::span<const Receiver> points, const Radiation& radiation) {
    if (radiation.radiosity.size() != std::size_t{mesh.size()} * radiation.channels ||
        (!radiation.environment.empty() && radiation.environment.size() != radiation.channels)) {
        throw InvalidArgument(fmt::format("points: {} values for {} patches of {} channels",
                                          radiation.radiosity.size(), mesh.size(), radiation.channels));
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

/// Rows that are computed: one of a plane, six of a sphere.
struct Rows {
    std::vector<SurfacePoint> places;
    std::vector<std::uint32_t> point; ///< of every row
    std::vector<std::uint32_t> first; ///< row of every point
};

Rows rows_of(std::span<const Receiver> points, double facing) {
    const std::array<Vec3, plane_count> directions = plane_directions(facing);
    Rows rows;
    for (std::uint32_t k = 0; k < points.size(); ++k) {
        rows.first.push_back(static_cast<std::uint32_t>(rows.places.size()));
        if (points[k].normal) {
            rows.places.push_back({points[k].position, *points[k].normal, points[k].surface});
            rows.point.push_back(k);
            continue;
        }
        for (const Vec3& direction : directions) {
            rows.places.push_back({points[k].position, direction, points[k].surface});
            rows.point.push_back(k);
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
        if (!std::isfinite(total)) {
            return;
        }
        for (std::uint32_t c = 0; c < radiation_.channels; ++c) {
            irradiance_[c] += share * source[c];
        }
        exitance_ += share * total;
        known_ += share;
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
        double total = 0.0;
        for (std::uint32_t c = 0; c < radiation_.channels && !radiation_.environment.empty(); ++c) {
            irradiance_[c] += share * radiation_.environment[c];
            total += radiation_.environment[c];
        }
        if (seen) {
            exitance_ += share * total;
            known_ += share;
        }
    }
    [[nodiscard]] std::span<const double> irradiance() const { return irradiance_; }
    [[nodiscard]] double surroundings() const {
        return known_ > 0.0 ? exitance_ / known_ + direct_ : not_known;
    }

private:
    const Radiation& radiation_;
    std::vector<double> irradiance_;
    double exitance_ = 0.0;
    double known_ = 0.0;
    double direct_ = 0.0;
};

/// The six rows of a sphere, while they come.
struct Sphere {
    std::uint32_t point = 0;
    std::uint32_t rows = 0;
    std::vector<double> seen; ///< sums over the rows, N
    double environment = 0.0; ///< likewise
    double blocked = 0.0;     ///< likewise
};

/// Makes values of rows.
class Values {
public:
    Values(const PatchMesh& mesh, std::span<const Receiver> points, const Radiation& radiation,
           Enclosure enclosure, ExchangeRule rule, double facing)
        : mesh_(mesh), points_(points), radiation_(radiation), enclosure_(enclosure), areas_(mesh, rule),
          directions_(plane_directions(facing)), daylight_(mesh, radiation.sun, radiation.sky) {
        const std::size_t count = points.size();
        values_.channels = radiation.channels;
        values_.groups = static_cast<std::uint32_t>(mesh.groups().size());
        values_.irradiance.assign(count * radiation.channels, 0.0);
        values_.factors.assign(count * values_.groups, 0.0);
        values_.sky.assign(count, 0.0);
        values_.below_horizon.assign(count, 0.0);
        values_.blocked.assign(count, 0.0);
        values_.surroundings.assign(count, not_known);
        values_.planes.assign(count * plane_count, not_known);
    }

    /// @param direction  of the six of a sphere
    void take(std::uint32_t point, std::uint32_t direction, const RowView& row) {
        Sum sum(radiation_);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            sum.add(row.columns[k], static_cast<double>(row.values[k]));
        }
        const bool open = sees_environment(row.environment, enclosure_);
        sum.add_environment(row.environment, open);
        const bool is_plane = points_[point].normal.has_value();
        const Vec3& normal = is_plane ? *points_[point].normal : directions_[direction];
        for (std::size_t k = 0; is_plane && k < row.columns.size(); ++k) {
            values_.factors[std::size_t{point} * values_.groups + mesh_.group(row.columns[k])] +=
                static_cast<double>(row.values[k]);
        }
        const Vec3& at = points_[point].position;
        PointDaylight::Environment seen;
        if (open && (is_plane || daylight_.has_sky())) {
            seen = daylight_.seen_by(at, normal, row);
        } else {
            seen = PointDaylight::split(row.environment, row.blocked, open_sky(normal), {});
        }
        daylight_.irradiance(at, normal, seen, sum.adder());
        if (!is_plane) {
            values_.planes[std::size_t{point} * plane_count + direction] = sum.surroundings();
            take_of_sphere(point, row);
            return;
        }
        set(point, sum, seen, row.blocked);
    }
    /// Finishes what is left. @return the values; call once
    [[nodiscard]] PointValues finish() {
        finish_spheres();
        return std::move(values_);
    }

private:
    void set(std::uint32_t point, const Sum& sum, const PointDaylight::Environment& environment,
             double blocked) {
        values_.sky[point] = environment.above.share;
        values_.below_horizon[point] = environment.below;
        values_.blocked[point] = blocked;
        std::copy(sum.irradiance().begin(), sum.irradiance().end(),
                  values_.irradiance.begin() +
                      static_cast<std::ptrdiff_t>(std::size_t{point} * radiation_.channels));
        values_.surroundings[point] = sum.surroundings();
    }

    void take_of_sphere(std::uint32_t point, const RowView& row) {
        Sphere& sphere = pending_[point];
        if (sphere.rows == 0) {
            sphere.point = point;
            sphere.seen.assign(mesh_.size(), 0.0);
        }
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            sphere.seen[row.columns[k]] += static_cast<double>(row.values[k]);
        }
        sphere.environment += row.environment;
        sphere.blocked += row.blocked;
        if (++sphere.rows < plane_count) {
            return;
        }
        ready_.push_back(std::move(sphere));
        pending_.erase(point);
        if (ready_.size() == spheres_at_once) {
            finish_spheres();
        }
    }

    void finish_spheres() {
        parallel_for(ready_.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                finish_sphere(ready_[k]);
            }
        });
        ready_.clear();
    }

    /// Shares of the full solid angle, in place of what was seen.
    void to_solid_angles(Sphere& sphere) const {
        const Vec3& at = points_[sphere.point].position;
        for (std::uint32_t j = 0; j < mesh_.size(); ++j) {
            if (sphere.seen[j] == 0.0) {
                continue;
            }
            double unoccluded = 0.0;
            for (const Vec3& direction : directions_) {
                unoccluded += areas_.at_point(at, direction, j);
            }
            const PatchCorners corners = mesh_.corners(j);
            sphere.seen[j] = unoccluded > 0.0
                                 ? sphere.seen[j] / unoccluded * solid_angle(at, corners.polygon()) /
                                       (4.0 * std::numbers::pi)
                                 : 0.0;
        }
    }

    void finish_sphere(Sphere& sphere) {
        to_solid_angles(sphere);
        const double measured = sphere.environment / plane_count;
        const double blocked = sphere.blocked / plane_count;
        double sum = 0.0;
        for (const double share : sphere.seen) {
            sum += share;
        }
        const bool open = sees_environment(measured, enclosure_);
        const double environment = open ? std::max(0.0, 1.0 - blocked - sum) : measured;
        const double scale = !open && sum > 0.0 ? (1.0 - environment - blocked) / sum : 1.0;
        Sum light(radiation_);
        SkyMoments above;
        double* const factors = &values_.factors[std::size_t{sphere.point} * values_.groups];
        for (std::uint32_t j = 0; j < mesh_.size(); ++j) {
            const double share = scale * sphere.seen[j];
            if (share == 0.0) {
                continue;
            }
            light.add(j, share);
            factors[mesh_.group(j)] += share;
            if (open) {
                above += share * daylight_.seen_above(points_[sphere.point].position, std::nullopt, j);
            }
        }
        light.add_environment(environment, open);
        const PointDaylight::Environment seen = PointDaylight::split(environment, blocked, open_sky(), above);
        daylight_.spherical_irradiance(points_[sphere.point].position, seen, light.adder());
        set(sphere.point, light, seen, blocked);
    }

    const PatchMesh& mesh_;
    std::span<const Receiver> points_;
    const Radiation& radiation_;
    Enclosure enclosure_;
    ExchangeAreas areas_;
    std::array<Vec3, plane_count> directions_;
    PointDaylight daylight_;
    std::map<std::uint32_t, Sphere> pending_;
    std::vector<Sphere> ready_;
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

} // namespace

std::array<Vec3, 6> plane_directions(double facing) {
    const double angle = facing * std::numbers::pi / 180.0;
    const Vec3 front(std::sin(angle), std::cos(angle), 0.0);
    const Vec3 right(std::cos(angle), -std::sin(angle), 0.0);
    return {upwards, -upwards, right, -right, front, -front};
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
    return {solution.bands, solution.radiosity, environment_exitance(problem)};
}

PointValues compute_point_values(const PatchMesh& mesh, std::span<const Receiver> points,
                                 const Radiation& radiation, Enclosure enclosure,
                                 const FactorSettings& settings, double facing, Observer& observer) {
    check(mesh, points, radiation);
    RowPlan plan = plan_rows(settings, mesh.size());
    if (plan.hemicube.eye_points > 1) {
        plan.hemicube.resolution *= resolution_factor;
    }
    const VisibilityWeightedSettings weighted = plan.weighted.value_or(VisibilityWeightedSettings{});
    Values values(mesh, points, radiation, enclosure, weighted.rule, facing);
    if (points.empty()) {
        return values.finish();
    }
    const Rows rows = rows_of(points, facing);
    const auto engine = make_point_visibility_provider(mesh, rows.places, plan.hemicube, settings);
    compute_point_rows(
        *engine, mesh, rows.places, weighted, enclosure, weights_of(mesh, radiation),
        [&](std::uint32_t index, const RowView& row) {
            const std::uint32_t point = rows.point[index];
            values.take(point, index - rows.first[point], row);
        },
        [&observer](std::size_t done, std::size_t total) {
            return observer.progress(Phase::points, done, total);
        });
    return values.finish();
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
