// What a pixel shows of a surface once its footprint is known: the filter's colour, what is laid over it, and haze.
// Written as linear light. STORED_TEXELS writes codes as they are stored instead.
layout(location = 0) out vec4 colour;

// How much light falls on the surface
float lit = 1.0;

#ifdef STORED_TEXELS
vec4 stored_texel(int level, vec2 ground) {
    Place place;
    if (!find_place(level, ground, place)) return vec4(0.0);
    ivec2 texel = clamp(ivec2(floor(place.texel)), ivec2(0), ivec2(255));
    return texelFetch(coded_pages, ivec3(texel + int(GUTTER), int(place.layer + 0.5)), 0);
}
#endif

#ifdef OVERLAY
#define LEVEL 1
#define AGE 2
layout(binding = 7) uniform sampler2D page_marks;  // Of each layer: how long ago its page was edited, 0 to 1; -1: never

vec3 hue_of_level(int level) {
    vec3 phase = vec3(0.0, 0.33, 0.67) + 0.381966 * float(level);
    vec3 coded = 0.5 + 0.5 * cos(6.2831853 * phase);
    return coded * coded;
}

// From new to old; client/render/overlay.h has the same for legends
vec3 hue_of_age(float part) {
    const vec3 stops[4] = vec3[4](vec3(1.0, 0.36, 0.22), vec3(1.0, 0.84, 0.25), vec3(0.25, 0.75, 0.60), vec3(0.20, 0.33, 0.75));
    float at = clamp(part, 0.0, 1.0) * 3.0;
    int first = min(int(at), 2);
    vec3 coded = mix(stops[first], stops[first + 1], at - float(first));
    return coded * coded;
}

// The borders of the page shown, and what is known of it
vec3 with_overlay(vec3 shaded, float level, Footprint footprint) {
    Place place;
    if (!find_place(int(floor(level + 0.5)), footprint.centre, place)) return shaded;
    vec2 to_edge = min(place.texel, PAGE_SIDE - place.texel) / inverse_power_of_two(place.level);
    vec2 pixels = to_edge / max(max(abs(footprint.dx), abs(footprint.dy)), vec2(1e-20));
    float line = 1.0 - smoothstep(0.6, 1.6, min(pixels.x, pixels.y));
#if OVERLAY == LEVEL
    return mix(shaded, hue_of_level(place.level), 0.85 * line);
#else
#if OVERLAY == AGE
    float part = log2(max(float(now_ms - place.arrival_ms), 500.0) / 500.0) / log2(240.0);
#else
    float part = texelFetch(page_marks, ivec2(int(place.layer + 0.5), 0), 0).r;
    if (part < 0.0) return mix(shaded, vec3(0.02), 0.5 * line);
#endif
    float light = dot(shaded, vec3(0.2126, 0.7152, 0.0722));
    vec3 hue = hue_of_age(part);
    return mix(mix(shaded, hue * (0.25 + 1.5 * light), 0.65), hue, 0.8 * line);
#endif
}
#endif

// `nearness`: heights over the distance from the eye
void shade(Footprint footprint, float nearness) {
    // Beyond the extent there is nothing; its edge is as soft as a pixel is wide
    vec2 to_edge = min(footprint.centre - extent_low, extent_high - footprint.centre);
    float covered = clamp(0.5 + min(to_edge.x, to_edge.y) * inversesqrt(footprint.longer_squared), 0.0, 1.0);

#ifdef FEEDBACK
    gives_feedback = covered > 0.0;
#endif

#ifdef STORED_TEXELS
    colour = covered < 0.5 ? vec4(0.0) : stored_texel(nearest_level(footprint), footprint.centre);
#else
    float level;
    vec4 texel = filtered(footprint, level) * covered;
    vec3 shaded = (texel.rgb + (1.0 - texel.a) * TABLE_TOP) * lit;
#ifdef OVERLAY
    shaded = mix(shaded, with_overlay(shaded, level, footprint), covered);
#endif
    shaded = mix(shaded, HORIZON, haze * exp2(nearness * (-1.442695 / HAZE_DEPTH)));
    colour = vec4(shaded, 1.0);
#endif
}
