#version 450 core
// Puts a triangle of one view (one face of one hemicube) into the view's rectangle of the atlas column.

layout(location = 0) in vec3 position;      // eye's frame; the unit is the near distance
layout(location = 1) in vec2 grid_position; // on the polygon's grid
layout(location = 2) in vec2 twist;         // general quadrilaterals only
layout(location = 3) in uvec3 item;         // first id; grid u | v << 16; view and flags

layout(location = 0) uniform vec2 atlas_size; // texels: resolution, height

layout(location = 0) out vec2 grid_at;
layout(location = 1) flat out uvec3 item_at; // first id, grid, split
layout(location = 2) flat out vec2 twist_at;

invariant gl_Position;

void main() {
    uint face = item.z & 7u;
    float slot = float((item.z >> 3) & 0xFFFFFFFu);

    // Same axes as face_direction() on the CPU.
    float right, up, depth;
    if (face == 0u) {
        right = position.x;
        up = position.y;
        depth = position.z;
    } else {
        up = position.z;
        if (face == 1u) {
            depth = position.x;
            right = position.y;
        } else if (face == 2u) {
            depth = position.y;
            right = -position.x;
        } else if (face == 3u) {
            depth = -position.x;
            right = -position.y;
        } else {
            depth = -position.y;
            right = position.x;
        }
    }

    // Row where up = 0: the middle of the top face, the lower edge of a side.
    float resolution = atlas_size.x;
    float row = 3.0 * resolution * slot +
                (face == 0u ? 0.5 * resolution : resolution + (float(face) - 1.0) * 0.5 * resolution);
    // Infinite reversed depth, near plane at 1.
    gl_Position = vec4(right, (resolution * up + 2.0 * row * depth) / atlas_size.y - depth, 1.0, depth);
    gl_ClipDistance[0] = depth + right;
    gl_ClipDistance[1] = depth - right;
    gl_ClipDistance[2] = face == 0u ? depth + up : up;
    gl_ClipDistance[3] = depth - up;

    grid_at = grid_position;
    item_at = uvec3(item.xy, item.z >> 31);
    twist_at = twist;
}
