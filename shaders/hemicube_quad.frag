#version 450 core
// Draw id of the cell that the fragment lies in, on a general planar quadrilateral with bilinear cells.
// Draw ids and cells: defined in src/engine/hemicube/draw_list.hpp.

layout(location = 0) in vec2 grid_at;        // in the frame of corners 0, 1 and 3
layout(location = 1) flat in uvec3 cells_at; // first id, grid, unused
layout(location = 2) flat in vec2 twist_at;  // corner 2 in that frame, less (1, 1)

layout(location = 0) out uint id;

void main() {
    // x = u (1 + v a), y = v (1 + u b): a quadratic in v, in the form that stays stable as a goes to 0.
    float k = 1.0 + grid_at.x * twist_at.y - grid_at.y * twist_at.x;
    float root = sqrt(max(k * k + 4.0 * twist_at.x * grid_at.y, 0.0));
    float v = 2.0 * grid_at.y / (k + root);
    float u = grid_at.x / (1.0 + v * twist_at.x);
    uvec2 grid = uvec2(cells_at.y & 0xFFFFu, cells_at.y >> 16);
    uvec2 cell = min(uvec2(clamp(vec2(u, v) * vec2(grid), vec2(0.0), vec2(grid))), grid - 1u);
    id = cells_at.x + cell.y * grid.x + cell.x;
}
