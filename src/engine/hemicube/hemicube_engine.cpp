#include "engine/hemicube/gl_rows.hpp"
#include "engine/image_rows.hpp"
#include "engine/rasteriser/cpu_rows.hpp"
#include "engine/workers/worker_pool.hpp"
#include "gl/context.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/engine/delta_form_factors.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/engine/point_rows.hpp"
#include "hemi/scene/image_mesh.hpp"

#include <fmt/format.h>

namespace hemi {

namespace {

/// Rows by one context of this process.
class InProcessEngine final : public RawRowProvider {
public:
    InProcessEngine(std::unique_ptr<const EngineGeometry> geometry, const HemicubeSettings& settings,
                    RowQuantity quantity, std::string device)
        : geometry_(std::move(geometry)), settings_(settings), quantity_(quantity),
          device_(std::move(device)) {}

    [[nodiscard]] std::uint32_t size() const override { return geometry_->eyes.patches(); }
    [[nodiscard]] std::string renderer() const override { return engine().renderer(); }
    void rows(std::span<const std::uint32_t> patches, const Sink& sink) override {
        engine().rows(patches, [&](std::uint32_t patch, const RawRow& row) {
            stop_if_interrupted();
            hemicubes_ += geometry_->eyes.of(patch).size();
            sink(patch, row);
        });
    }
    [[nodiscard]] std::uint64_t hemicubes() const override { return hemicubes_; }

private:
    GlRows& engine() const {
        if (!engine_) {
            engine_ = std::make_unique<GlRows>(*geometry_, settings_, quantity_, device_);
        }
        return *engine_;
    }

    std::unique_ptr<const EngineGeometry> geometry_;
    HemicubeSettings settings_;
    RowQuantity quantity_;
    std::string device_;
    mutable std::unique_ptr<GlRows> engine_;
    std::uint64_t hemicubes_ = 0;
};

/// Rows of an engine as what they mean.
template <class Row>
class MeaningfulRows final : public BasicRowProvider<Row> {
public:
    explicit MeaningfulRows(std::unique_ptr<RawRowProvider> engine) : engine_(std::move(engine)) {}

    [[nodiscard]] std::uint32_t size() const override { return engine_->size(); }
    [[nodiscard]] std::string renderer() const override { return engine_->renderer(); }
    void rows(std::span<const std::uint32_t> patches,
              const typename BasicRowProvider<Row>::Sink& sink) override {
        engine_->rows(patches, [&sink](std::uint32_t patch, const RawRow& row) {
            sink(patch, row_from_raw<Row>(row));
        });
    }
    [[nodiscard]] std::uint64_t hemicubes() const override { return engine_->hemicubes(); }

private:
    std::unique_ptr<RawRowProvider> engine_;
};

/// The device that `name` stands for: itself, or what `auto` chooses.
std::string resolve_device(const std::string& name) {
    if (name == cpu_device) {
        return name;
    }
    if (name != "auto" && name != "egl" && name != "osmesa" && !name.starts_with("egl:")) {
        throw InvalidArgument(fmt::format("device \"{}\"; must be auto, cpu, egl, egl:N or osmesa", name));
    }
    gl::check_device_name(name);
    return name == "auto" ? gl::find_gpu().value_or(cpu_device) : name;
}

std::unique_ptr<RawRowProvider> make_raw_engine(std::unique_ptr<const EngineGeometry> geometry,
                                                const HemicubeSettings& settings, RowQuantity quantity,
                                                const EngineSettings& engine) {
    const std::string device = resolve_device(engine.device);
    if (device == cpu_device) {
        return make_cpu_engine(std::move(geometry), settings, quantity, engine.jobs);
    }
    if (engine.worker_program.empty()) {
        return std::make_unique<InProcessEngine>(std::move(geometry), settings, quantity, device);
    }
    EngineSettings resolved = engine;
    resolved.device = device;
    return make_worker_pool(std::move(geometry), settings, quantity, resolved);
}

std::unique_ptr<RawRowProvider> make_raw_engine(const PatchMesh& mesh, const HemicubeSettings& settings,
                                                RowQuantity quantity, const EngineSettings& engine) {
    DeltaFormFactors::check_resolution(settings.resolution);
    return make_raw_engine(std::make_unique<const EngineGeometry>(make_engine_geometry(mesh, settings)),
                           settings, quantity, engine);
}

/// One eye point a row; of spheres two, which look up and down.
EyePoints eyes_at(std::span<const SurfacePoint> points, const PatchMesh& mesh, DirectionMeasure measure) {
    EyePoints eyes;
    for (const SurfacePoint& point : points) {
        if (point.surface != no_surface && point.surface >= mesh.surfaces().size()) {
            throw InvalidArgument(fmt::format("point {} lies on surface {}; there are {}", eyes.first.size(),
                                              point.surface, mesh.surfaces().size()));
        }
        eyes.first.push_back(static_cast<std::uint32_t>(eyes.points.size()));
        if (measure == DirectionMeasure::projected_solid_angle) {
            eyes.points.push_back({point.position, point.normal, 1.0, point.surface, 0});
            continue;
        }
        eyes.points.push_back({point.position, {0.0, 0.0, 1.0}, 0.5, point.surface, 0});
        eyes.points.push_back({point.position, {0.0, 0.0, -1.0}, 0.5, point.surface, 1});
    }
    eyes.first.push_back(static_cast<std::uint32_t>(eyes.points.size()));
    return eyes;
}

} // namespace

std::unique_ptr<RowProvider> make_hemicube_engine(const PatchMesh& mesh, const HemicubeSettings& settings,
                                                  const EngineSettings& engine) {
    auto images = std::make_unique<const ImageMesh>(mesh);
    auto rows = std::make_unique<MeaningfulRows<RowView>>(
        make_raw_engine(images->mesh(), settings, RowQuantity::form_factors, engine));
    if (!images->any()) {
        return rows;
    }
    return fold_images(std::move(images), std::move(rows));
}

std::unique_ptr<VisibilityProvider> make_visibility_engine(const PatchMesh& mesh,
                                                           const HemicubeSettings& settings,
                                                           const EngineSettings& engine) {
    const ImageMesh images(mesh);
    return std::make_unique<MeaningfulRows<VisibilityRow>>(
        make_raw_engine(images.mesh(), settings, RowQuantity::visibility, engine));
}

std::unique_ptr<VisibilityProvider> make_point_visibility_engine(const PatchMesh& mesh,
                                                                 std::span<const SurfacePoint> points,
                                                                 const HemicubeSettings& settings,
                                                                 const EngineSettings& engine,
                                                                 DirectionMeasure measure) {
    DeltaFormFactors::check_resolution(settings.resolution);
    const ImageMesh images(mesh);
    auto geometry = std::make_unique<EngineGeometry>();
    geometry->list = make_draw_list(images.mesh(), settings.merge_lattices);
    geometry->eyes = eyes_at(points, mesh, measure);
    geometry->patches = images.mesh().size();
    geometry->measure = measure;
    return std::make_unique<MeaningfulRows<VisibilityRow>>(
        make_raw_engine(std::move(geometry), settings, RowQuantity::visibility, engine));
}

} // namespace hemi
