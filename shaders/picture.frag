#version 450 core
// Linear radiosity; alpha tells a surface from the background, and a back from a front.
layout(location = 0) in vec3 smooth_radiosity;
layout(location = 1) flat in vec3 flat_radiosity;
layout(location = 2) in vec3 outline;

layout(location = 2) uniform bool flat_shading;   // locations after those of picture.vert
layout(location = 3) uniform float outline_width; // samples; 0: no outlines
layout(location = 4) uniform float stripe_width;  // of backs, samples
layout(location = 5) uniform vec2 first_sample;   // of this part of the picture

layout(location = 7) uniform int line_count;      // of lines, where the smooth value's first channel is one of them
layout(location = 8) uniform float line_width;    // samples
layout(location = 9) uniform float lines[32];     // ascending

layout(location = 0) out vec4 radiosity;

// Samples to the nearest line.
float distance_to_line(float value) {
    float nearest = 1e30;
    for (int k = 0; k < line_count; ++k) {
        nearest = min(nearest, abs(value - lines[k]));
    }
    return nearest / fwidth(value);
}

void main() {
    if (!gl_FrontFacing) { // not light: a colour for the display
        vec2 place = gl_FragCoord.xy + first_sample;
        bool stripe = fract((place.x + place.y) / (2.0 * stripe_width)) < 0.5;
        radiosity = vec4(stripe ? vec3(0.35, 0.04, 0.16) : vec3(0.12, 0.02, 0.06), 2.0);
        return;
    }
    radiosity = vec4(flat_shading ? flat_radiosity : smooth_radiosity, 1.0);
    if (line_count > 0 && distance_to_line(smooth_radiosity.r) < 0.5 * line_width) {
        bool dark = dot(radiosity.rgb, vec3(0.2126, 0.7152, 0.0722)) < 0.12;
        radiosity.rgb = vec3(dark ? 0.8 : 0.0);
    }
    if (outline_width > 0.0) {
        vec3 distance_in_samples = outline / max(fwidth(outline), vec3(1e-6));
        float nearest = min(distance_in_samples.x, min(distance_in_samples.y, distance_in_samples.z));
        radiosity.rgb *= nearest < outline_width ? 0.25 : 1.0;
    }
}
