#version 450 core
// Draw id of the cell that the fragment lies in, on a parallelogram or triangle.
// Draw ids and cells: defined in src/engine/hemicube/draw_list.hpp.

layout(location = 0) in vec2 grid_at;
layout(location = 1) flat in uvec3 cells_at; // first id, grid, split

layout(location = 0) out uint id;

void main() {
    uvec2 grid = uvec2(cells_at.y & 0xFFFFu, cells_at.y >> 16);
    vec2 at = clamp(grid_at, vec2(0.0), vec2(grid));
    uvec2 cell = min(uvec2(at), grid - 1u);
    vec2 within = at - vec2(cell);
    uint half_cell = within.x + within.y > 1.0 ? cells_at.z : 0u;
    id = cells_at.x + ((cell.y * grid.x + cell.x) << cells_at.z) + half_cell;
}
