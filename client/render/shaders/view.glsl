// The camera, of whatever it sees.
layout(std140, binding = 1) uniform View {
    vec4 forward;
    vec4 right;     // × tangent of half the horizontal field of view; w: nothing is nearer than this
    vec4 up;        // × tangent of half the vertical field of view
    vec2 picture;   // pixels
    float height;   // what haze is measured by: of the eye above a plane
    float haze;
};

// Linear light
const vec3 ZENITH = vec3(0.105, 0.235, 0.480);
const vec3 HORIZON = vec3(0.640, 0.740, 0.810);
const float HAZE_DEPTH = 0.028;  // heights over distance, where 1/e of the haze is left

// Of a pixel's place, y up, per unit of depth
vec3 ray_through(vec2 pixel) {
    vec2 across = 2.0 * pixel / picture - 1.0;
    return forward.xyz + across.x * right.xyz + across.y * up.xyz;
}
