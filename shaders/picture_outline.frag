#version 450 core
// Outlines of patches that are looked through, from either side.
layout(location = 2) in vec3 outline;

layout(location = 3) uniform float outline_width; // samples

layout(location = 0) out vec4 radiosity;

void main() {
    vec3 distance_in_samples = outline / max(fwidth(outline), vec3(1e-6));
    float nearest = min(distance_in_samples.x, min(distance_in_samples.y, distance_in_samples.z));
    if (nearest >= outline_width) {
        discard;
    }
    radiosity = vec4(vec3(0.35), 2.0); // not light: a colour for the display, as backs have
}
