#version 450 core
// The samples of a pixel become its colour: each is tone-mapped before the mean is taken, so that the edge of
// a bright lamp is as smooth as any other.
layout(location = 0, binding = 0) uniform sampler2D samples;
layout(location = 1) uniform int samples_per_edge;
layout(location = 2) uniform ivec2 target_origin; // pixel of the target that holds the first samples
layout(location = 3) uniform float exposure;
layout(location = 4) uniform bool filmic;
layout(location = 5) uniform vec3 environment;     // radiosity of what lies behind all surfaces
layout(location = 6) uniform bool has_environment; // or it is not shown
layout(location = 7) uniform vec3 nothing;         // in its place, display linear

layout(location = 0) out vec4 srgb;
layout(location = 1) out vec4 linear_radiosity;

// Fit of the ACES reference curve: K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2016.
vec3 filmic_curve(vec3 x) {
    return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

bool is_back(vec4 surface) {
    return surface.a > 1.0;
}

vec3 display(vec4 surface) {
    if (is_back(surface)) {
        return surface.rgb;
    }
    if (surface.a == 0.0 && !has_environment) {
        return nothing;
    }
    // The curve is flat long before; larger values would overflow its squares.
    vec3 exposed = clamp(surface.rgb * exposure, 0.0, 1e6);
    return clamp(filmic ? filmic_curve(exposed) : exposed, 0.0, 1.0);
}

vec3 encode_srgb(vec3 linear) {
    vec3 low = linear * 12.92;
    vec3 high = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, lessThanEqual(linear, vec3(0.0031308)));
}

// A lone empty sample between two of surfaces is a rounding hole, where a corner of one patch lies on the edge
// of another; it takes their mean. A gap of a whole sample at one sample a pixel is real.
vec4 sample_at(ivec2 place) {
    vec4 surface = texelFetch(samples, place, 0);
    if (surface.a > 0.0) {
        return surface;
    }
    ivec2 last = textureSize(samples, 0) - 1;
    for (int axis = 0; axis < 2 && samples_per_edge > 1; ++axis) {
        ivec2 one = axis == 0 ? ivec2(1, 0) : ivec2(0, 1);
        vec4 before = texelFetch(samples, clamp(place - one, ivec2(0), last), 0);
        vec4 after = texelFetch(samples, clamp(place + one, ivec2(0), last), 0);
        if (before.a > 0.0 && after.a > 0.0) {
            return is_back(before) || is_back(after) ? after : 0.5 * (before + after);
        }
    }
    return vec4(environment, 0.0);
}

void main() {
    ivec2 first = (ivec2(gl_FragCoord.xy) - target_origin) * samples_per_edge;
    vec3 shown = vec3(0.0);
    vec3 linear = vec3(0.0);
    for (int y = 0; y < samples_per_edge; ++y) {
        for (int x = 0; x < samples_per_edge; ++x) {
            vec4 surface = sample_at(first + ivec2(x, y));
            shown += display(surface);
            linear += is_back(surface) ? vec3(0.0) : surface.rgb;
        }
    }
    float share = 1.0 / float(samples_per_edge * samples_per_edge);
    srgb = vec4(encode_srgb(shown * share), 1.0);
    linear_radiosity = vec4(linear * share, 1.0);
}
