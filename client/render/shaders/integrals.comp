// The running sums of one page's lines, both ways (line_integral.glsl tells their form). One invocation a line.
layout(local_size_x = 64) in;

layout(binding = 0) uniform sampler2DArray coded;
layout(binding = 0, rgba32ui) uniform writeonly uimage2DArray integrals;
layout(std430, binding = 0) readonly buffer Steps { uint steps_of_code[256]; };
layout(location = 0) uniform int layer;
layout(location = 1) uniform int gutter;

void main() {
    int line = int(gl_GlobalInvocationID.x), direction = int(gl_GlobalInvocationID.y);
    uvec4 sum = uvec4(0);
    for (int at = 0; at < 256; ++at) {
        ivec2 texel = direction == 0 ? ivec2(line, at) : ivec2(at, line);
        uvec4 code = uvec4(texelFetch(coded, ivec3(texel + gutter, layer), 0) * 255.0 + 0.5);
        imageStore(integrals, ivec3(line, at, 2 * layer + direction), sum << 8 | code);
        sum += uvec4(steps_of_code[code.r], steps_of_code[code.g], steps_of_code[code.b], 257u * code.a);
    }
}
