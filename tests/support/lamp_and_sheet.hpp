#pragma once

#include "support/scenes.hpp"

#include "hemi/engine/exchange_area.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace hemi::test {

/// A floor that a lamp lights past a sheet half way up, in the open. Lamp and sheet are black, so that the
/// floor reflects half, once.
inline Scene lamp_and_sheet(std::uint32_t cells, std::uint32_t lamp_cells) {
    Scene scene = empty_scene();
    scene.materials.push_back({"lamp", {0.0}, {10.0}});
    scene.materials.push_back({"black", {0.0}, {0.0}});
    add_polygon(scene, "floor", {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {cells, cells});
    add_polygon(scene, "lamp", {{-0.1, -0.1, 2}, {-0.1, 0.1, 2}, {0.1, 0.1, 2}, {0.1, -0.1, 2}},
                {lamp_cells, lamp_cells});
    scene.surfaces.back().material = 1;
    add_polygon(scene, "sheet", {{-0.15, -0.2, 1}, {0.25, -0.2, 1}, {0.25, 0.2, 1}, {-0.15, 0.2, 1}});
    scene.surfaces.back().material = 2;
    scene.surfaces.back().two_sided = true;
    return scene;
}

/// Radiosity of the floor there, in closed form: the lamp less the part behind the sheet, whose image on the
/// lamp's plane is a rectangle twice as large.
inline double exact_floor(const Vec3& at) {
    const auto lamp_part = [&at](double x0, double x1, double y0, double y1) {
        if (!(x0 < x1 && y0 < y1)) {
            return 0.0;
        }
        const std::vector<Vec3> part{{x0, y0, 2}, {x0, y1, 2}, {x1, y1, 2}, {x1, y0, 2}};
        return point_factor(at, {0, 0, 1}, part);
    };
    const double hidden = lamp_part(std::max(-0.1, -0.3 - at.x), std::min(0.1, 0.5 - at.x),
                                    std::max(-0.1, -0.4 - at.y), std::min(0.1, 0.4 - at.y));
    return 0.5 * 10.0 * (lamp_part(-0.1, 0.1, -0.1, 0.1) - hidden);
}

} // namespace hemi::test
