#version 450 core
// Corners and centres of patches, in scene units relative to the scene's centre.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 gouraud_radiosity;
layout(location = 2) in vec3 patch_radiosity;
layout(location = 3) in vec3 outline_distance; // in triangle heights, from the edges that are a patch's own
layout(location = 4) in uint item;             // patch and 1

layout(location = 0) uniform vec3 eye;                 // relative to the scene's centre
layout(location = 1) uniform mat4 clip_from_direction; // infinite reversed-Z: clip.z is the near distance, clip.w the depth

layout(location = 6) uniform vec4 clip;                // plane that cuts: dot(clip.xyz, position) <= clip.w is kept

layout(location = 0) out vec3 smooth_radiosity;
layout(location = 1) flat out vec3 flat_radiosity;
layout(location = 2) out vec3 outline;
layout(location = 3) flat out uint patch_item;

void main() {
    gl_Position = clip_from_direction * vec4(position - eye, 1.0);
    gl_ClipDistance[0] = clip.w - dot(clip.xyz, position);
    smooth_radiosity = gouraud_radiosity;
    flat_radiosity = patch_radiosity;
    outline = outline_distance;
    patch_item = item;
}
