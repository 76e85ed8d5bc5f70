// Triangles of flat pieces. Three corners each, from the eye; w: the piece's index.
layout(std430, binding = 0) readonly buffer Corners { vec4 corners[]; };

layout(std430, binding = 1) readonly buffer Pieces { vec4 rows[]; };    // last in each: the corner's light

invariant gl_Position;
flat out int piece;
out float light;

void main() {
    vec4 corner = corners[gl_VertexID];
    piece = floatBitsToInt(corner.w);
    light = rows[3 * piece + gl_VertexID % 3].w;
    float depth = dot(corner.xyz, forward.xyz);
    // The nearer, the greater; without end
    gl_Position = vec4(dot(corner.xyz, right.xyz) / dot(right.xyz, right.xyz),
                       dot(corner.xyz, up.xyz) / dot(up.xyz, up.xyz), right.w, depth);
}
