#include "hemi/engine/baselines.hpp"

#include "core/parallel_for.hpp"
#include "engine/analytic/contour_integral.hpp"
#include "engine/analytic/convex_polygon.hpp"
#include "engine/analytic/direct_integration.hpp"
#include "engine/hemicube/eye.hpp"
#include "engine/image_rows.hpp"
#include "engine/rays/patch_rays.hpp"
#include "engine/rays/ray_tracer.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/engine/exchange_area.hpp"
#include "hemi/scene/image_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hemi {

namespace {

/// A row that owns its entries.
struct Row {
    std::vector<std::uint32_t> columns;
    std::vector<float> values;
    double environment = 0.0;
    double blocked = 0.0;
};

/// Computes a block's worth of rows in parallel, then delivers them in order.
class BaselineRows : public RowProvider {
public:
    explicit BaselineRows(const PatchMesh& mesh) : mesh_(mesh) {}

    [[nodiscard]] std::uint32_t size() const final { return mesh_.size(); }

    void rows(std::span<const std::uint32_t> patches, const RowSink& sink) final {
        std::vector<Row> batch;
        for (std::size_t first = 0; first < patches.size(); first += batch.size()) {
            batch.assign(std::min<std::size_t>(FormFactorMatrix::block_rows, patches.size() - first), {});
            parallel_for(batch.size(), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t k = begin; k < end; ++k) {
                    batch[k] = row(patches[first + k]);
                }
            });
            for (std::size_t k = 0; k < batch.size(); ++k) {
                stop_if_interrupted();
                const Row& done = batch[k];
                RowView view;
                view.columns = done.columns;
                view.values = done.values;
                view.environment = done.environment;
                view.blocked = done.blocked;
                sink(patches[first + k], view);
            }
        }
    }

protected:
    [[nodiscard]] const PatchMesh& mesh() const { return mesh_; }

private:
    [[nodiscard]] virtual Row row(std::uint32_t patch) const = 0;

    const PatchMesh& mesh_;
};

/// Methods that know pairs only.
class PairRows : public BaselineRows {
public:
    using BaselineRows::BaselineRows;

private:
    /// A_i F(i, j), unoccluded.
    [[nodiscard]] virtual double exchange(std::uint32_t i, std::uint32_t j) const = 0;

    [[nodiscard]] Row row(std::uint32_t patch) const final {
        Row row;
        double sum = 0.0;
        for (std::uint32_t j = 0; j < mesh().size(); ++j) {
            const double factor = j == patch ? 0.0 : exchange(patch, j) / mesh().areas()[patch];
            if (factor > 0.0) {
                row.columns.push_back(j);
                row.values.push_back(static_cast<float>(factor));
                sum += factor;
            }
        }
        row.environment = std::max(0.0, 1.0 - sum);
        return row;
    }
};

class DirectRows final : public PairRows {
public:
    using PairRows::PairRows;

    [[nodiscard]] std::string renderer() const override {
        return "direct (closed forms of rectangles, adaptive integration; unoccluded)";
    }

private:
    [[nodiscard]] double exchange(std::uint32_t i, std::uint32_t j) const override {
        const PatchCorners a = mesh().corners(i);
        const PatchCorners b = mesh().corners(j);
        const Vec3 normal_a = mesh().normal(i);
        const Vec3 normal_b = mesh().normal(j);
        const auto closed = rectangle_exchange(a.polygon(), normal_a, b.polygon(), normal_b);
        return closed ? *closed : adaptive_exchange(a.polygon(), normal_a, b.polygon(), normal_b);
    }
};

class ContourRows final : public PairRows {
public:
    using PairRows::PairRows;

    [[nodiscard]] std::string renderer() const override {
        return fmt::format("contour (Gauss rule of {} points; unoccluded)", order);
    }

private:
    static constexpr std::size_t order = 10;

    [[nodiscard]] double exchange(std::uint32_t i, std::uint32_t j) const override {
        // About the pair's middle and in units of its size: the logarithms stay small.
        const Vec3 middle = 0.5 * (mesh().centres()[i] + mesh().centres()[j]);
        Bounds bounds;
        const auto local = [&](std::uint32_t patch) {
            const PatchCorners corners = mesh().corners(patch);
            ConvexPolygon polygon;
            for (const Vec3& corner : corners.polygon()) {
                polygon.add(corner - middle);
                bounds.add(corner - middle);
            }
            return polygon;
        };
        ConvexPolygon a = local(i);
        ConvexPolygon b = local(j);
        const double unit = bounds.diagonal();
        for (std::size_t k = 0; k < a.count; ++k) {
            a.points[k] /= unit;
        }
        for (std::size_t k = 0; k < b.count; ++k) {
            b.points[k] /= unit;
        }
        const ConvexPolygon front_a = clip(a.span(), {b.points[0], mesh().normal(j)});
        const ConvexPolygon front_b = clip(b.span(), {a.points[0], mesh().normal(i)});
        if (front_a.count < 3 || front_b.count < 3) {
            return 0.0;
        }
        ContourRule rule;
        rule.fixed_order = order;
        rule.rounding = std::max(2.0 * mesh().rounding() / unit, 1e-14);
        return std::max(0.0, contour_integral(front_a.span(), front_b.span(), rule)) * unit * unit;
    }
};

/// What became of a patch's rays, all of equal weight.
class RayCount {
public:
    explicit RayCount(std::uint32_t patches) : counts_(patches) {}

    void add(const RayTracer::Hit& hit) {
        ++rays_;
        switch (hit.side) {
        case RayTracer::Side::nothing:
            ++nothing_;
            break;
        case RayTracer::Side::front:
            ++counts_[hit.patch];
            break;
        case RayTracer::Side::back:
            ++back_;
            break;
        }
    }

    [[nodiscard]] Row row() const {
        const auto share = [this](std::uint64_t count) {
            return static_cast<double>(count) / static_cast<double>(rays_);
        };
        Row row;
        for (std::uint32_t j = 0; j < counts_.size(); ++j) {
            if (counts_[j] > 0) {
                row.columns.push_back(j);
                row.values.push_back(static_cast<float>(share(counts_[j])));
            }
        }
        row.environment = share(nothing_);
        row.blocked = share(back_);
        return row;
    }

private:
    std::vector<std::uint32_t> counts_;
    std::uint64_t rays_ = 0;
    std::uint64_t nothing_ = 0;
    std::uint64_t back_ = 0;
};

class MonteCarloRows final : public BaselineRows {
public:
    MonteCarloRows(const PatchMesh& mesh, const BaselineSettings& settings)
        : BaselineRows(mesh), tracer_(mesh), settings_(settings) {}

    [[nodiscard]] std::string renderer() const override {
        return fmt::format("montecarlo ({} Sobol rays a patch, seed {}; {})", settings_.rays, settings_.seed,
                           RayTracer::name());
    }

private:
    [[nodiscard]] Row row(std::uint32_t patch) const override {
        const PatchRays sequence(mesh(), patch, settings_.seed);
        RayCount count(mesh().size());
        for (std::uint32_t index = 0; index < settings_.rays; ++index) {
            const PatchRays::Ray ray = sequence[index];
            count.add(tracer_.trace(ray.origin, ray.direction));
        }
        return count.row();
    }

    RayTracer tracer_;
    BaselineSettings settings_;
};

class HemisphereRows final : public BaselineRows {
public:
    HemisphereRows(const PatchMesh& mesh, const BaselineSettings& settings)
        : BaselineRows(mesh), tracer_(mesh), settings_(settings) {}

    [[nodiscard]] std::string renderer() const override {
        return fmt::format("hemisphere (disc of {} x {} cells, seed {}; {})", settings_.resolution,
                           settings_.resolution, settings_.seed, RayTracer::name());
    }

private:
    [[nodiscard]] Row row(std::uint32_t patch) const override {
        const EyeFrame frame(mesh().normal(patch), patch, 0, settings_.seed);
        const Vec3& eye = mesh().centres()[patch];
        RayCount count(mesh().size());
        for (std::uint32_t row = 0; row < settings_.resolution; ++row) {
            const double y = (2.0 * row + 1.0) / settings_.resolution - 1.0;
            for (std::uint32_t column = 0; column < settings_.resolution; ++column) {
                const double x = (2.0 * column + 1.0) / settings_.resolution - 1.0;
                const double squared = x * x + y * y;
                if (squared < 1.0) {
                    const Vec3 direction = x * frame.x + y * frame.y + std::sqrt(1.0 - squared) * frame.z;
                    count.add(tracer_.trace(eye, direction));
                }
            }
        }
        return count.row();
    }

    RayTracer tracer_;
    BaselineSettings settings_;
};

/// Share of a patch that a point sees, weighted as the point factor is.
double visible_share(const RayTracer& tracer, const PatchMesh& mesh, std::uint32_t patch, const Vec3& point,
                     const Vec3& normal) {
    constexpr int grid = 16;
    const Vec3 facing = mesh.normal(patch);
    const PatchCorners corners = mesh.corners(patch);
    const BilinearMap map(corners.polygon(), facing);
    double seen = 0.0;
    double all = 0.0;
    for (int row = 0; row < grid; ++row) {
        const double t = (2.0 * row + 1.0) / grid - 1.0;
        for (int column = 0; column < grid; ++column) {
            const double s = (2.0 * column + 1.0) / grid - 1.0;
            const Vec3 ray = map.point(s, t) - point;
            const double cosine = glm::dot(ray, normal);
            if (cosine <= 0.0) {
                continue;
            }
            const double squared = glm::dot(ray, ray);
            const double weight =
                map.jacobian_at(s, t) * cosine * -glm::dot(ray, facing) / (squared * squared);
            const RayTracer::Hit hit = tracer.trace(point, ray);
            all += weight;
            if (hit.side == RayTracer::Side::front && hit.patch == patch) {
                seen += weight;
            }
        }
    }
    return all > 0.0 ? seen / all : 1.0;
}

std::unique_ptr<RowProvider> make_rows(const PatchMesh& mesh, const BaselineSettings& settings) {
    if (mesh.size() > max_baseline_patches) {
        throw InvalidArgument(fmt::format("{} patches; baseline methods are slow and take at most {}: choose "
                                          "larger patches, or hemicubes",
                                          mesh.size(), max_baseline_patches),
                              {"patch-size"});
    }
    switch (settings.method) {
    case Method::direct:
        return std::make_unique<DirectRows>(mesh);
    case Method::contour:
        return std::make_unique<ContourRows>(mesh);
    case Method::montecarlo:
        if (settings.rays < 1 || settings.rays > 0x80000000u) {
            throw InvalidArgument(fmt::format("{} rays a patch; must be 1 to 2^31", settings.rays));
        }
        return std::make_unique<MonteCarloRows>(mesh, settings);
    case Method::hemisphere:
        if (settings.resolution < 1 || settings.resolution > 16384) {
            throw InvalidArgument(fmt::format("disc resolution {}; must be 1 to 16384", settings.resolution));
        }
        return std::make_unique<HemisphereRows>(mesh, settings);
    case Method::hemicube:
        break;
    }
    throw InvalidArgument("hemicube is no baseline method; make_hemicube_engine() makes it");
}

} // namespace

std::unique_ptr<RowProvider> make_baseline(const PatchMesh& mesh, const BaselineSettings& settings) {
    auto images = std::make_unique<const ImageMesh>(mesh);
    auto rows = make_rows(images->mesh(), settings);
    return images->any() ? fold_images(std::move(images), std::move(rows)) : std::move(rows);
}

std::vector<double> point_factors(const PatchMesh& mesh, const Vec3& point, const Vec3& normal,
                                  bool occlusion) {
    if (std::abs(glm::length(normal) - 1.0) > 1e-9) {
        throw InvalidArgument(fmt::format("normal of length {}; must be 1", glm::length(normal)));
    }
    if (mesh.symmetry()) {
        const ImageMesh images(mesh);
        const std::vector<double> all = point_factors(images.mesh(), point, normal, occlusion);
        std::vector<double> folded(mesh.size(), 0.0);
        for (std::uint32_t patch = 0; patch < all.size(); ++patch) {
            folded[images.original(patch)] += all[patch];
        }
        return folded;
    }
    std::vector<double> factors(mesh.size());
    std::unique_ptr<RayTracer> tracer;
    if (occlusion) {
        tracer = std::make_unique<RayTracer>(mesh);
    }
    parallel_for(mesh.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (auto patch = static_cast<std::uint32_t>(begin); patch < end; ++patch) {
            const PatchCorners corners = mesh.corners(patch);
            factors[patch] = point_factor(point, normal, corners.polygon());
            if (tracer && factors[patch] > 0.0) {
                factors[patch] *= visible_share(*tracer, mesh, patch, point, normal);
            }
        }
    });
    return factors;
}

} // namespace hemi
