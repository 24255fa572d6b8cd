#include "engine/rasteriser/shown_cells.hpp"

#include <algorithm>
#include <cmath>

namespace hemi {

Shown shown_cells(const RasterScene& scene, const Projection& projection, int face, std::uint32_t grid,
                  bool front, const Affine& inverse) {
    const DrawPolygon& polygon = scene.list.polygons[scene.grid_polygons[grid].polygon];
    Shown shown;
    shown.first_id = front ? polygon.front_id : polygon.back_id;
    shown.cells = shown.first_id != item_blocked;
    if (!shown.cells) {
        return shown;
    }
    const GridMap& map = scene.grid_maps[grid];
    const Vec3 offset = projection.eye().position - map.origin;
    // u at the eye and its change along a ray; both over depth.
    const auto over_depth = [&](const Vec3& gradient, double at_origin) {
        const double at_eye = at_origin + glm::dot(offset, gradient);
        const Affine along =
            projection.on_texels(face, projection.in_frame(gradient), 1.0 / scene.coordinates.scale);
        return Affine{at_eye * inverse.c + along.c, at_eye * inverse.x + along.x,
                      at_eye * inverse.y + along.y};
    };
    shown.u = over_depth(map.gradient_u, map.u);
    shown.v = over_depth(map.gradient_v, map.v);
    shown.grid_u = static_cast<float>(polygon.grid.u);
    shown.grid_v = static_cast<float>(polygon.grid.v);
    shown.split = polygon.split != 0;
    shown.id_count = polygon.grid.u * polygon.grid.v << polygon.split;
    shown.bilinear = polygon.bilinear != 0;
    shown.twist_u = polygon.twist_u;
    shown.twist_v = polygon.twist_v;
    return shown;
}

void move_base(const Affine& inverse, Shown& shown, const std::array<int, 4>& box) {
    if (shown.bilinear) {
        return;
    }
    double x = 0.0;
    double y = 0.0;
    double nearest = -1.0;
    for (const int i : {box[0], box[1]}) {
        for (const int j : {box[2], box[3]}) {
            if (inverse.at(i, j) > nearest) {
                nearest = inverse.at(i, j);
                x = i;
                y = j;
            }
        }
    }
    if (!(nearest > 0.0)) {
        return;
    }
    const auto move = [&](Affine& f, float& base, float grid) {
        // `f` may have been moved for another piece of the polygon.
        const double at = f.at(x, y) / nearest;
        const double cell =
            std::floor(std::clamp(at + static_cast<double>(base), 0.0, static_cast<double>(grid)));
        const double step = cell - static_cast<double>(base);
        f.c -= step * inverse.c;
        f.x -= step * inverse.x;
        f.y -= step * inverse.y;
        base = static_cast<float>(cell);
    };
    move(shown.u, shown.base_u, shown.grid_u);
    move(shown.v, shown.base_v, shown.grid_v);
}

} // namespace hemi
