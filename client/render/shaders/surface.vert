// Triangles of flat pieces. Three corners each, from the eye; w: the piece's index.
layout(std430, binding = 0) readonly buffer Corners { vec4 corners[]; };

// s, t and w of each; last in each row: a corner's light
layout(std430, binding = 1) readonly buffer Pieces { vec4 rows[]; };

invariant gl_Position;
flat out vec3 row_s, row_t, row_w;
out float light;

void main() {
    vec4 corner = corners[gl_VertexID];
    int piece = floatBitsToInt(corner.w);
    row_s = rows[3 * piece].xyz;
    row_t = rows[3 * piece + 1].xyz;
    row_w = rows[3 * piece + 2].xyz;
    light = rows[3 * piece + gl_VertexID % 3].w;
    float depth = dot(corner.xyz, forward);
    vec2 half_picture = 0.5 * picture;
    // The nearer, the greater; without end
    gl_Position = vec4(dot(corner.xyz, right) / dot(right, right) / half_picture.x,
                       dot(corner.xyz, up) / dot(up, up) / half_picture.y, least_depth, depth);
    pass_constants();
}
