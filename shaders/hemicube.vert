#version 450 core
// A corner of a triangle of a drawn polygon, on one face of one hemicube.
// Draw ids and cells: defined in src/engine/hemicube/draw_list.hpp. Blocks: see src/engine/hemicube/gpu_polygons.hpp.

layout(location = 0) in vec3 high; // position in raster coordinates, as the sum of two floats
layout(location = 1) in vec3 low;
layout(location = 2) in uint polygon;

struct Polygon {
    dvec4 plane; // unit normal of the front, and its product with a position on the plane
    uint front_id, back_id;
    uint grid;   // u | v << 16
    uint flags;  // 1: every cell is two triangles, 2: bilinear cells
    uint grid_map;
    uint unused;
    vec2 twist;  // general quadrilaterals only
};
// Grid coordinates of a position p: (u.xyz · p + u.w, v.xyz · p + v.w).
struct GridMap {
    dvec4 u, v;
};

layout(std140, binding = 0) uniform View {
    vec3 right, up, depth; // axes of the face
    vec3 eye_high, eye_low;
    uint own_polygon;      // the first of those that the eye lies on
    uint own_count;        // and how many they are
    uint first_row;        // of the square that the face, made whole, has in the atlas
    float texel;           // on the face at depth 1
    float near, tolerance;
    float grain;           // of the rasteriser's vertices, at depth 1
};
layout(std430, binding = 0) readonly buffer Polygons {
    Polygon polygons[];
};
layout(std430, binding = 1) readonly buffer GridMaps {
    GridMap grid_maps[];
};

layout(location = 0) flat out vec4 inverse_depth; // in the direction (x, y, 1): dot(xyz); w: its change over a grain
layout(location = 1) flat out uvec4 cells;        // first id; grid; flags, 4: the front; first id of the front
layout(location = 2) flat out vec3 along_u;       // change of u in the direction (x, y, 1), for each unit of depth
layout(location = 3) flat out vec3 along_v;
layout(location = 4) flat out vec4 grid_at_eye;   // u, v, twist

// How far beyond the face polygons are clipped: what is cut is inexact, and coordinates far off the face are coarse.
const float guard = 1.25;

vec3 on_face(vec3 direction) {
    return vec3(dot(right, direction), dot(up, direction), dot(depth, direction));
}

void main() {
    Polygon p = polygons[polygon];
    dvec3 eye = dvec3(eye_high) + dvec3(eye_low);
    float height = float(dot(p.plane.xyz, eye) - p.plane.w);
    inverse_depth = vec4(0.0);
    cells = uvec4(0u);
    along_u = along_v = vec3(0.0);
    grid_at_eye = vec4(0.0);
    if (polygon - own_polygon < own_count || abs(height) <= tolerance) { // its own, or edge-on
        gl_Position = vec4(0.0, 0.0, 1.0, -1.0);
        gl_ClipDistance[0] = gl_ClipDistance[1] = gl_ClipDistance[2] = gl_ClipDistance[3] = -1.0;
        return;
    }
    precise vec3 offset = (high - eye_high) + (low - eye_low);
    precise vec3 at;
    at.x = right.x * offset.x + right.y * offset.y + right.z * offset.z;
    at.y = up.x * offset.x + up.y * offset.y + up.z * offset.z;
    at.z = depth.x * offset.x + depth.y * offset.y + depth.z * offset.z;
    gl_Position = vec4(at.x, at.y, near, at.z);
    gl_ClipDistance[0] = guard * at.z - at.x;
    gl_ClipDistance[1] = guard * at.z + at.x;
    gl_ClipDistance[2] = guard * at.z - at.y;
    gl_ClipDistance[3] = guard * at.z + at.y;

    bool front = height > 0.0;
    inverse_depth.xyz = on_face(vec3(p.plane.xyz)) / -height;
    inverse_depth.w = grain * max(abs(inverse_depth.x), abs(inverse_depth.y));
    cells = uvec4(front ? p.front_id : p.back_id, p.grid, p.flags | (front ? 4u : 0u), p.front_id);
    if (p.grid_map != 0xFFFFFFFFu) {
        GridMap map = grid_maps[p.grid_map];
        along_u = on_face(vec3(map.u.xyz));
        along_v = on_face(vec3(map.v.xyz));
        grid_at_eye = vec4(float(dot(map.u.xyz, eye) + map.u.w), float(dot(map.v.xyz, eye) + map.v.w), p.twist);
    }
}
