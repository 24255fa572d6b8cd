#version 450 core
// Item id of the cell that the fragment lies in, on a parallelogram or triangle.

layout(location = 0) in vec2 grid_at;
layout(location = 1) flat in uvec3 item_at; // first id, grid, split

layout(location = 0) out uint id;

void main() {
    uvec2 grid = uvec2(item_at.y & 0xFFFFu, item_at.y >> 16);
    vec2 at = clamp(grid_at, vec2(0.0), vec2(grid));
    uvec2 cell = min(uvec2(at), grid - 1u);
    vec2 within = at - vec2(cell);
    uint half_cell = within.x + within.y > 1.0 ? item_at.z : 0u;
    id = item_at.x + ((cell.y * grid.x + cell.x) << item_at.z) + half_cell;
}
