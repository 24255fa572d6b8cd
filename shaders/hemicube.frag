#version 450 core
// Draw id of the cell that a texel shows. Draw ids and cells: defined in src/engine/hemicube/draw_list.hpp.
//
// CLIPPED: polygons were clipped on the CPU (hemicube_clipped.vert), and what varies over them is interpolated; with
// BILINEAR all are general quadrilaterals, without it none are.
// Else (hemicube.vert) depth and the position on the grid come from the polygon's plane: exact to the last bits
// however far the polygon reaches beyond the face.
// COUNT_COVERED: what covers texels is counted too, hidden or not.

#ifdef CLIPPED
layout(location = 0) in vec2 grid_position;
layout(location = 1) flat in uvec3 cells; // first id; grid u | v << 16; split
layout(location = 2) flat in vec2 twist;
#else
layout(location = 0) flat in vec4 inverse_depth;
layout(location = 1) flat in uvec4 cells; // first id; grid u | v << 16; flags; first id of the front
layout(location = 2) flat in vec3 along_u;
layout(location = 3) flat in vec3 along_v;
layout(location = 4) flat in vec4 grid_at_eye;

layout(std140, binding = 0) uniform View {
    vec3 right, up, depth;
    vec3 eye_high, eye_low;
    uint own_polygon, own_count;
    uint first_row;
    float texel;
    float near, tolerance;
    float grain;
};
#endif

layout(location = 0) out uint id;

#ifdef COUNT_COVERED
layout(std140, binding = 1) uniform Counting {
    uint width;    // of the atlas
    uint draw_ids;
    uvec4 hemicubes[64]; // table of weights and row of tallies
};
layout(std430, binding = 2) readonly buffer Weights {
    uint weights[]; // of texels: tables of whole hemicubes
};
layout(std430, binding = 3) buffer Covered {
    uint covered[]; // for each row and draw id: number of texels, and the sum of their weights
};

void count_covered() {
    uvec2 texel_at = uvec2(gl_FragCoord.xy);
    uint rows = 3u * width; // of a hemicube
    uvec4 hemicube = hemicubes[texel_at.y / rows];
    uint tally = 2u * (hemicube.y * draw_ids + id);
    atomicAdd(covered[tally], 1u);
    atomicAdd(covered[tally + 1u], weights[(hemicube.x * rows + texel_at.y % rows) * width + texel_at.x]);
}
#endif

bool is_bilinear() {
#ifdef BILINEAR
    return true;
#elif defined(CLIPPED)
    return false;
#else
    return (cells.z & 2u) != 0u;
#endif
}

uint cell_at(vec2 at, vec2 twist) {
    uvec2 grid = uvec2(cells.y & 0xFFFFu, cells.y >> 16);
    if (is_bilinear()) {
        // In the frame of corners 0, 1 and 3: at.x = u (1 + v a), at.y = v (1 + u b), a quadratic in v, in the form that
        // stays stable as a goes to 0.
        float k = 1.0 + at.x * twist.y - at.y * twist.x;
        float root = sqrt(max(k * k + 4.0 * twist.x * at.y, 0.0));
        float v = 2.0 * at.y / (k + root);
        at = vec2(at.x / (1.0 + v * twist.x), v) * vec2(grid);
    }
    at = clamp(at, vec2(0.0), vec2(grid));
    uvec2 cell = min(uvec2(at), grid - 1u);
    vec2 within = at - vec2(cell);
    uint split = cells.z & 1u;
    uint half_cell = within.x + within.y > 1.0 ? split : 0u;
    return ((cell.y * grid.x + cell.x) << split) + half_cell;
}

#ifdef CLIPPED
void show() {
    id = cells.x + cell_at(grid_position, twist);
}
#else
void show() {
    vec3 direction = vec3(vec2(gl_FragCoord.x, gl_FragCoord.y - float(first_row)) * texel - 1.0, 1.0);
    float inverse = dot(inverse_depth.xyz, direction);
    // A sliver along a silhouette that snapping of its vertices has turned over: it shows only where nothing else does,
    // and as the front of its patches, so that a closed scene stays closed.
    bool front = (cells.z & 4u) != 0u;
    bool turned_over = gl_FrontFacing != front;
    id = turned_over && cells.x == 1u ? cells.w : cells.x;
    bool one_cell = cells.y == 0x10001u && (cells.z & 1u) == 0u;
    if (!one_cell && id > 1u) {
        float reach = 1.0 / max(inverse, 1e-30);
        vec2 at = grid_at_eye.xy + reach * vec2(dot(along_u, direction), dot(along_v, direction));
        id += cell_at(at, grid_at_eye.zw);
    }
    // Along a silhouette, where a front hides a back that shares its edge, either may come out nearer by its change of
    // depth over a grain. Fronts are set nearer by it and backs farther: the front wins.
    inverse = front ? inverse + inverse_depth.w : (inverse - inverse_depth.w) * (1.0 - 2e-6);
    gl_FragDepth = turned_over ? 1e-37 : clamp(near * inverse, 1e-36, 1.0);
}
#endif

void main() {
    show();
#ifdef COUNT_COVERED
    if (id > 1u) {
        count_covered();
    }
#endif
}
