#version 450 core
// Linear radiosity; alpha tells a surface from the background, and a back from a front.
layout(location = 0) in vec3 smooth_radiosity;
layout(location = 1) flat in vec3 flat_radiosity;
layout(location = 2) in vec3 outline;

layout(location = 2) uniform bool flat_shading;   // locations after those of picture.vert
layout(location = 3) uniform float outline_width; // samples; 0: no outlines
layout(location = 4) uniform float stripe_width;  // of backs, samples
layout(location = 5) uniform vec2 first_sample;   // of this part of the picture

layout(location = 0) out vec4 radiosity;

void main() {
    if (!gl_FrontFacing) { // not light: a colour for the display
        vec2 place = gl_FragCoord.xy + first_sample;
        bool stripe = fract((place.x + place.y) / (2.0 * stripe_width)) < 0.5;
        radiosity = vec4(stripe ? vec3(0.35, 0.04, 0.16) : vec3(0.12, 0.02, 0.06), 2.0);
        return;
    }
    radiosity = vec4(flat_shading ? flat_radiosity : smooth_radiosity, 1.0);
    if (outline_width > 0.0) {
        vec3 distance_in_samples = outline / max(fwidth(outline), vec3(1e-6));
        float nearest = min(distance_in_samples.x, min(distance_in_samples.y, distance_in_samples.z));
        radiosity.rgb *= nearest < outline_width ? 0.25 : 1.0;
    }
}
