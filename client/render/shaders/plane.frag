// The plane as a camera sees it, below the horizon: each pixel's ray, its footprint on the plane, and what the filter
// makes of it. Written as linear light. STORED_TEXELS writes codes as they are stored instead.
layout(std140, binding = 1) uniform View {
    vec4 forward;
    vec4 right;
    vec4 up;
    vec2 picture;
    float height;
    float haze;
};

layout(location = 0) out vec4 colour;

vec3 ray_through(vec2 pixel) {
    vec2 across = 2.0 * pixel / picture - 1.0;
    return forward.xyz + across.x * right.xyz + across.y * up.xyz;
}

// The row of pixels at the horizon may have corners beyond it
vec2 point_at(vec2 offset) {
    vec3 ray = ray_through(gl_FragCoord.xy + offset);
    float fall = max(max(-ray.z, -0.3 * ray_through(gl_FragCoord.xy).z), 1e-20);
    return height / fall * ray.xy;
}

#ifdef STORED_TEXELS
vec4 stored_texel(float level, vec2 ground) {
    Place place;
    if (!find_place(int(floor(level + 0.5)), ground, place)) return vec4(0.0);
    ivec2 texel = clamp(ivec2(floor(place.texel)), ivec2(0), ivec2(255));
    return texelFetch(coded_pages, ivec3(texel + int(GUTTER), place.layer), 0);
}
#endif

vec3 hue_of_level(int level) {
    vec3 phase = vec3(0.0, 0.33, 0.67) + 0.381966 * float(level);
    vec3 coded = 0.5 + 0.5 * cos(6.2831853 * phase);
    return coded * coded;
}

// Lines along the borders of the page shown
vec3 with_page_borders(vec3 shaded, float level, Footprint footprint) {
    Place place;
    if (!find_place(int(floor(level + 0.5)), footprint.centre, place)) return shaded;
    vec2 to_edge = min(place.texel, PAGE_SIDE - place.texel) / inverse_power_of_two(place.level);
    vec2 pixels = to_edge / max(max(abs(footprint.dx), abs(footprint.dy)), vec2(1e-20));
    float line = 1.0 - smoothstep(0.6, 1.6, min(pixels.x, pixels.y));
    return mix(shaded, hue_of_level(place.level), 0.85 * line);
}

void main() {
    vec3 ray = ray_through(gl_FragCoord.xy);
    float fall = max(-ray.z, 1e-20);
    vec2 ground = height / fall * ray.xy;
    // How the point moves with the pixel, exactly; PlaneView::level_at has the same
    vec2 dx = height * 2.0 / picture.x / fall * right.xy;
    vec2 dy = height * 2.0 / picture.y / (fall * fall) * (up.xy * fall + ray.xy * up.z);
    Footprint footprint = footprint_of(ground, dx, dy);

    // Beyond the extent there is nothing; its edge is as soft as a pixel is wide
    vec2 to_edge = min(ground - extent_low, extent_high - ground);
    float covered = clamp(0.5 + min(to_edge.x, to_edge.y) / footprint.longer, 0.0, 1.0);

#ifdef FEEDBACK
    gives_feedback = covered > 0.0;
#endif

#ifdef STORED_TEXELS
    colour = covered < 0.5 ? vec4(0.0) : stored_texel(isotropic_level(footprint), ground);
#else
    float level;
    vec4 texel = filtered(footprint, level) * covered;
    vec3 shaded = texel.rgb + (1.0 - texel.a) * TABLE_TOP;
#ifdef PAGE_BORDERS
    shaded = mix(shaded, with_page_borders(shaded, level, footprint), covered);
#endif
    float below_horizon = fall * inversesqrt(dot(ray, ray));
    shaded = mix(shaded, HORIZON, haze * exp(-below_horizon / HAZE_DEPTH));
    colour = vec4(shaded, 1.0);
#endif
}
