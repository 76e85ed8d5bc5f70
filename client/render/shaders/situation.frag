// Flat surfaces that are given by matrices from pixels to texels; the one with the greatest w is seen. Writes premultiplied linear
// light, and in alpha how many texels were read; −1 where there is no surface.
layout(std140, binding = 1) uniform Surfaces {
    vec4 rows[12];   // three a surface: s, t and w of a pixel counted from the picture's middle, y down
    vec2 middle;     // of the picture, in pixels
    int surfaces;
};

layout(location = 0) out vec4 colour;

vec3 row_s, row_t, row_w;
vec3 pixel;

vec2 point_at(vec2 offset) {
    vec3 at = pixel + vec3(offset.x, -offset.y, 0.0);
    float w = max(dot(row_w, at), 0.3 * dot(row_w, pixel));
    return vec2(dot(row_s, at), dot(row_t, at)) / w;
}

void main() {
    pixel = vec3(gl_FragCoord.x - middle.x, middle.y - gl_FragCoord.y, 1.0);
    float nearest = 0.0;
    for (int surface = 0; surface < surfaces; ++surface) {
        float w = dot(rows[3 * surface + 2].xyz, pixel);
        if (w <= nearest) continue;
        nearest = w;
        row_s = rows[3 * surface].xyz;
        row_t = rows[3 * surface + 1].xyz;
        row_w = rows[3 * surface + 2].xyz;
    }
    if (nearest <= 0.0) {
        colour = vec4(0.0, 0.0, 0.0, -1.0);
        return;
    }
    vec2 ground = vec2(dot(row_s, pixel), dot(row_t, pixel)) / nearest;
    vec2 dx = (vec2(row_s.x, row_t.x) - ground * row_w.x) / nearest;
    vec2 dy = (ground * row_w.y - vec2(row_s.y, row_t.y)) / nearest;
    float level;
    vec4 texel = filtered(footprint_of(ground, dx, dy), level);
#ifdef COUNT_FETCHES
    colour = vec4(texel.rgb, fetches);
#else
    colour = vec4(texel.rgb, 1.0);
#endif
}
