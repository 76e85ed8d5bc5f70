// A surface of flat pieces, each with the three rows that lead from pixels to texels: client/residency/flat_piece.h.
layout(std430, binding = 1) readonly buffer Pieces { vec4 rows[]; };  // s, t and w of each

#ifdef FEEDBACK
layout(early_fragment_tests) in;
#endif
flat in int piece;
in float light;

vec3 row_s, row_t, row_w;
vec3 pixel;  // from the picture's middle, y down

vec2 point_at(vec2 offset) {
    vec3 at = pixel + vec3(offset.x, -offset.y, 0.0);
    float w = max(dot(row_w, at), max(0.3 * dot(row_w, pixel), 1e-30));
    return vec2(dot(row_s, at), dot(row_t, at)) / w;
}

void main() {
    row_s = rows[3 * piece].xyz;
    row_t = rows[3 * piece + 1].xyz;
    row_w = rows[3 * piece + 2].xyz;
    pixel = vec3(gl_FragCoord.x - 0.5 * picture.x, 0.5 * picture.y - gl_FragCoord.y, 1.0);
    float w = max(dot(row_w, pixel), 1e-30);
    vec2 ground = vec2(dot(row_s, pixel), dot(row_t, pixel)) / w;
    vec2 dx = (vec2(row_s.x, row_t.x) - ground * row_w.x) / w;
    vec2 dy = (ground * row_w.y - vec2(row_s.y, row_t.y)) / w;
    vec3 ray = ray_through(gl_FragCoord.xy);
    lit = light;
    shade(footprint_of(ground, dx, dy), height * w * inversesqrt(dot(ray, ray)));
}
