// A surface of flat pieces, each with the three rows that lead from pixels to texels: client/residency/flat_piece.h.
#ifdef FEEDBACK
layout(early_fragment_tests) in;
#endif
flat in vec3 row_s, row_t, row_w;
in float light;

vec3 pixel;  // from the picture's middle, y down

vec2 point_at(vec2 offset) {
    vec3 at = pixel + vec3(offset.x, -offset.y, 0.0);
    float w = max(dot(row_w, at), max(0.3 * dot(row_w, pixel), 1e-30));
    return vec2(dot(row_s, at), dot(row_t, at)) / w;
}

void main() {
    vec2 place = gl_FragCoord.xy - 0.5 * picture;
    pixel = vec3(place.x, -place.y, 1.0);
    float w = max(dot(row_w, pixel), 1e-30), inverse = 1.0 / w;
    vec2 ground = vec2(dot(row_s, pixel), dot(row_t, pixel)) * inverse;
    vec2 dx = (vec2(row_s.x, row_t.x) - ground * row_w.x) * inverse;
    vec2 dy = (ground * row_w.y - vec2(row_s.y, row_t.y)) * inverse;
    vec3 ray = ray_through(place);
    lit = light;
    shade(footprint_of(ground, dx, dy), height * w * inversesqrt(dot(ray, ray)));
}
