#include "engine/baselines/reference_engine.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"

#include "hemi/engine/delta_form_factors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hemi {

namespace {

/// Where a point of a quadrilateral lies: (u, v) in [0, 1]², by Newton on the bilinear map.
std::array<double, 2> bilinear_coordinates(const Surface& surface, const Vec3& point) {
    const auto& p = surface.vertices;
    const Vec3 du = p[1] - p[0];
    const Vec3 dv = p[3] - p[0];
    const Vec3 twist = p[2] - p[1] - dv;
    double u = 0.5;
    double v = 0.5;
    for (int step = 0; step < 20; ++step) {
        const Vec3 gap = p[0] + u * du + v * dv + (u * v) * twist - point;
        const Vec3 along_u = du + v * twist;
        const Vec3 along_v = dv + u * twist;
        const double uu = glm::dot(along_u, along_u);
        const double uv = glm::dot(along_u, along_v);
        const double vv = glm::dot(along_v, along_v);
        const double gu = glm::dot(along_u, gap);
        const double gv = glm::dot(along_v, gap);
        const double determinant = uu * vv - uv * uv;
        u -= (vv * gu - uv * gv) / determinant;
        v -= (uu * gv - uv * gu) / determinant;
    }
    return {u, v};
}

std::array<double, 2> barycentric_coordinates(const Surface& surface, const Vec3& point) {
    const Vec3 u = surface.vertices[1] - surface.vertices[0];
    const Vec3 v = surface.vertices[2] - surface.vertices[0];
    const Vec3 cross = glm::cross(u, v);
    const Vec3 offset = point - surface.vertices[0];
    const double squared = glm::dot(cross, cross);
    return {glm::dot(glm::cross(offset, v), cross) / squared,
            glm::dot(glm::cross(u, offset), cross) / squared};
}

std::uint32_t clamp_cell(double value, std::uint32_t cells) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(value), 0.0, static_cast<double>(cells - 1)));
}

/// Index of the patch at a point of a surface, counted on one side.
std::uint32_t local_patch(const Surface& surface, Grid grid, const Vec3& point) {
    if (surface.vertex_count == 4) {
        const auto at = bilinear_coordinates(surface, point);
        return clamp_cell(at[1] * grid.v, grid.v) * grid.u + clamp_cell(at[0] * grid.u, grid.u);
    }
    const std::uint32_t n = grid.u;
    const auto at = barycentric_coordinates(surface, point);
    const double a = at[0] * n;
    const double b = at[1] * n;
    const std::uint32_t strip = clamp_cell(b, n);
    const std::uint32_t along = clamp_cell(a, n - strip);
    const bool inverted = (a - along) + (b - strip) > 1.0 && along + 1 < n - strip;
    return strip * (2 * n - strip) + 2 * along + (inverted ? 1 : 0);
}

/// The same on a surface whose patches may differ in size.
std::uint32_t local_patch(const PatchMesh& mesh, std::uint32_t s, const Vec3& point) {
    const Surface& surface = mesh.surfaces()[s];
    const Grid grid = mesh.grid(s);
    const auto parts = mesh.parts(s);
    if (parts.empty()) {
        return local_patch(surface, grid, point);
    }
    const auto holds = [&](const GridPart& part) {
        return part.cell == local_patch(surface, {grid.u << part.level_u, grid.v << part.level_v}, point);
    };
    const auto found = std::find_if(parts.begin(), parts.end(), holds);
    if (found != parts.end()) {
        return static_cast<std::uint32_t>(found - parts.begin());
    }
    // On the rim rounding may put a point beside every part.
    std::uint32_t nearest = 0;
    const auto way = [&](std::uint32_t k) {
        return glm::distance(mesh.centres()[mesh.first_patch(s) + k], point);
    };
    for (std::uint32_t k = 1; k < parts.size(); ++k) {
        nearest = way(k) < way(nearest) ? k : nearest;
    }
    return nearest;
}

class ReferenceEngine final : public RowProvider {
public:
    ReferenceEngine(const PatchMesh& mesh, const HemicubeSettings& settings)
        : tracer_(mesh, settings), weights_(settings.resolution), mesh_(mesh) {}

    [[nodiscard]] std::uint32_t size() const override { return mesh_.size(); }
    [[nodiscard]] std::string renderer() const override { return "reference (CPU rays, double precision)"; }

    void rows(std::span<const std::uint32_t> patches, const RowSink& sink) override {
        std::vector<std::uint32_t> columns;
        std::vector<float> values;
        for (const std::uint32_t patch : patches) {
            stop_if_interrupted();
            std::vector<std::uint64_t> sums(std::size_t{item_first_patch} + mesh_.size());
            std::uint64_t total = 0;
            const auto eyes = tracer_.eyes().of(patch);
            for (std::uint32_t eye = 0; eye < eyes.size(); ++eye) {
                const DeltaFormFactors weights = weights_.scaled(eyes[eye].share);
                const std::vector<std::uint32_t> items = tracer_.items(patch, eye);
                const std::uint32_t resolution = weights.resolution();
                for (std::uint32_t y = 0; y < weights.rows(); ++y) {
                    for (std::uint32_t x = 0; x < resolution; ++x) {
                        sums[items[std::size_t{y} * resolution + x]] += weights.weight(y, x);
                    }
                }
                total += weights.sum();
            }
            const double unit = 1.0 / static_cast<double>(total);
            columns.clear();
            values.clear();
            for (std::uint32_t j = 0; j < mesh_.size(); ++j) {
                if (sums[item_first_patch + j] > 0) {
                    columns.push_back(j);
                    values.push_back(
                        static_cast<float>(static_cast<double>(sums[item_first_patch + j]) * unit));
                }
            }
            RowView row;
            row.columns = columns;
            row.values = values;
            row.environment = static_cast<double>(sums[item_nothing]) * unit;
            row.blocked = static_cast<double>(sums[item_blocked]) * unit;
            sink(patch, row);
        }
    }

private:
    ReferenceTracer tracer_;
    DeltaFormFactors weights_;
    const PatchMesh& mesh_;
};

} // namespace

ReferenceTracer::ReferenceTracer(const PatchMesh& mesh, const HemicubeSettings& settings)
    : mesh_(mesh), settings_(settings),
      eyes_(make_eye_points(mesh, settings.eye_points, settings.near_eye_points)),
      tolerance_(mesh.rounding()) {}

std::vector<std::uint32_t> ReferenceTracer::items(std::uint32_t patch, std::uint32_t eye_index) const {
    const std::uint32_t resolution = settings_.resolution;
    const Vec3 normal = mesh_.normal(patch);
    const EyeFrame frame(normal, patch, eye_index, settings_.seed);
    const Vec3& eye = eyes_.of(patch)[eye_index].position;
    std::vector<std::uint32_t> items;
    items.reserve(std::size_t{3} * resolution * resolution);
    for (int face = 0; face < hemicube_faces; ++face) {
        const std::uint32_t rows = face == 0 ? resolution : resolution / 2;
        for (std::uint32_t y = 0; y < rows; ++y) {
            for (std::uint32_t x = 0; x < resolution; ++x) {
                const double right = (2.0 * x + 1.0) / resolution - 1.0;
                const double up =
                    face == 0 ? (2.0 * y + 1.0) / resolution - 1.0 : (2.0 * y + 1.0) / resolution;
                const Vec3 local = face_direction(face, right, up);
                items.push_back(
                    trace(patch, eye, local.x * frame.x + local.y * frame.y + local.z * frame.z).item);
            }
        }
    }
    return items;
}

ReferenceTracer::Hit ReferenceTracer::trace(std::uint32_t patch, const Vec3& eye,
                                            const Vec3& direction) const {
    const Vec3 eye_normal = mesh_.normal(patch);
    Hit hit;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t s = 0; s < mesh_.surfaces().size(); ++s) {
        if (s == mesh_.surface_of()[patch]) {
            continue;
        }
        const Surface& surface = mesh_.surfaces()[s];
        const Vec3& normal = mesh_.surface_normal(s);
        const double height = glm::dot(eye - surface.vertices[0], normal);
        const double approach = glm::dot(direction, normal);
        double highest = -std::numeric_limits<double>::infinity();
        for (const Vec3& vertex : surface.polygon()) {
            highest = std::max(highest, glm::dot(vertex - eye, eye_normal));
        }
        if (std::abs(height) <= tolerance_ || highest <= tolerance_ || approach == 0.0) {
            continue;
        }
        const bool back = height < 0.0;
        // A front at the same depth wins over a back: backs lie a hair behind.
        const double depth = -height / approach;
        const double compared = back ? depth * (1.0 + 2e-6) : depth;
        if (!(depth > 0.0) || compared >= nearest || !inside(surface, normal, eye + depth * direction)) {
            continue;
        }
        nearest = compared;
        hit.surface = s;
        if (back && !surface.two_sided) {
            hit.item = item_blocked;
        } else {
            hit.item = item_first_patch + mesh_.first_patch(s) +
                       local_patch(mesh_, s, eye + depth * direction) +
                       (back ? mesh_.patches_per_side(s) : 0);
        }
    }
    return hit;
}

bool ReferenceTracer::inside(const Surface& surface, const Vec3& normal, const Vec3& point) {
    const auto polygon = surface.polygon();
    for (std::size_t c = 0; c < polygon.size(); ++c) {
        const Vec3 edge = polygon[(c + 1) % polygon.size()] - polygon[c];
        // A hair of width, so that no ray slips between neighbours.
        if (glm::dot(glm::cross(edge, point - polygon[c]), normal) < -1e-12 * glm::dot(edge, edge)) {
            return false;
        }
    }
    return true;
}

std::unique_ptr<RowProvider> make_reference_engine(const PatchMesh& mesh, const HemicubeSettings& settings) {
    DeltaFormFactors::check_resolution(settings.resolution);
    check_eye_points(settings.eye_points);
    return std::make_unique<ReferenceEngine>(mesh, settings);
}

} // namespace hemi
