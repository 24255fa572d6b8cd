#version 450 core
// Linear radiosity; alpha tells a surface from the background.
in vec3 smooth_radiosity;
flat in vec3 flat_radiosity;
in vec3 outline;

uniform bool flat_shading;
uniform float outline_width; // samples; 0: no outlines

layout(location = 0) out vec4 radiosity;

void main() {
    radiosity = vec4(flat_shading ? flat_radiosity : smooth_radiosity, 1.0);
    if (outline_width > 0.0) {
        vec3 distance_in_samples = outline / max(fwidth(outline), vec3(1e-6));
        float nearest = min(distance_in_samples.x, min(distance_in_samples.y, distance_in_samples.z));
        radiosity.rgb *= nearest < outline_width ? 0.25 : 1.0;
    }
}
