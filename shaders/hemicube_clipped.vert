#version 450 core
// A vertex of one view (one face of one hemicube), clipped on the CPU and placed in the atlas column.
// Draw ids and cells: defined in src/engine/hemicube/draw_list.hpp.

layout(location = 0) in vec3 position;      // clip x, y, w
layout(location = 1) in vec2 grid_position; // on the polygon's grid
layout(location = 2) in vec2 twist;         // general quadrilaterals only
layout(location = 3) in uvec3 cells;        // first id; grid u | v << 16; split

layout(location = 0) out vec2 grid_at;
layout(location = 1) flat out uvec3 cells_at;
layout(location = 2) flat out vec2 twist_at;

void main() {
    gl_Position = vec4(position.xy, 1.0, position.z); // infinite reversed depth, near plane at 1
    grid_at = grid_position;
    cells_at = cells;
    twist_at = twist;
}
