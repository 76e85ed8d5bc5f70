// The sky above the horizon, coded and dithered.
layout(location = 0) out vec4 colour;

vec3 encode(vec3 linear) {
    vec3 low = 12.92 * linear;
    vec3 high = 1.055 * pow(max(linear, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, vec3(lessThanEqual(linear, vec3(0.0031308))));
}

// A bias of less than one code, different in each pixel, hides the steps of slow gradients
float dither() {
    vec2 p = floor(gl_FragCoord.xy);
    return fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715)))) - 0.5;
}

void main() {
    vec3 ray = ray_through(gl_FragCoord.xy - 0.5 * picture);
    float elevation = clamp(ray.z * inversesqrt(dot(ray, ray)), 0.0, 1.0);
    colour = vec4(encode(mix(HORIZON, ZENITH, 1.0 - exp(-4.5 * elevation))) + dither() / 255.0, 1.0);
}
