#include "viewer/line_probe.hpp"

#include "display/visible_point.hpp"
#include "hemi/io/output_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace hemi::viewer {

namespace {

/// The half-line from the eye through a point; of an orthographic camera, along the view.
ViewRay ray_through(const OrbitCamera& orbit, const Vec3& point, double reach) {
    const Camera& camera = orbit.camera();
    if (camera.orthographic) {
        const Vec3 forward = glm::normalize(camera.target - camera.eye);
        return {point - reach * forward, forward};
    }
    return {camera.eye, point - camera.eye};
}

} // namespace

LineProbe probe_line(const PatchMesh& mesh, const OrbitCamera& orbit, const std::array<Vec3, 2>& ends,
                     bool backs, const PictureCut& cut) {
    constexpr int steps = 200;
    LineProbe probe{ends, {}};
    const double reach =
        2.0 * mesh.bounds().diagonal() + glm::length(orbit.camera().eye - mesh.bounds().centre());
    for (int k = 0; k <= steps; ++k) {
        // Not the very ends, which may lie on the edge of what was clicked.
        const double share = k == 0 ? 1e-6 : (k == steps ? 1.0 - 1e-6 : k / static_cast<double>(steps));
        const Vec3 on_line = ends[0] + share * (ends[1] - ends[0]);
        const ViewRay ray = ray_through(orbit, on_line, reach);
        ProbePoint point{k / static_cast<double>(steps) * glm::length(ends[1] - ends[0]), on_line,
                         std::nullopt};
        if (glm::length(ray.direction) > 0.0) {
            if (const auto seen = visible_point(mesh, ray.origin, ray.direction, backs, cut)) {
                point.position = seen->position;
                point.patch = patch_at(mesh, *seen);
            }
        }
        probe.points.push_back(point);
    }
    return probe;
}

void write_probe(const std::filesystem::path& path, const LineProbe& probe, const ShownValues& values) {
    io::OutputFile file(path);
    file.write(fmt::format("length,x,y,z,patch,{}\n", values.word));
    for (const ProbePoint& point : probe.points) {
        const Vec3& at = point.position;
        std::string line = fmt::format("{},{},{},{},", point.length, at.x, at.y, at.z);
        if (point.patch) {
            const double value = values.values[*point.patch];
            line += fmt::format("{},", *point.patch);
            line += std::isnan(value) ? "" : fmt::format("{}", value);
        } else {
            line += ",";
        }
        file.write(line + "\n");
    }
    file.commit();
}

} // namespace hemi::viewer
