// The plane as a camera sees it, below the horizon: each pixel's ray, and its footprint on the plane.

// The row of pixels at the horizon may have corners beyond it
vec2 point_at(vec2 offset) {
    vec2 place = gl_FragCoord.xy - 0.5 * picture;
    vec3 ray = ray_through(place + offset);
    float fall = max(max(-ray.z, -0.3 * ray_through(place).z), 1e-20);
    return height / fall * ray.xy;
}

void main() {
    vec3 ray = ray_through(gl_FragCoord.xy - 0.5 * picture);
    float fall = max(-ray.z, 1e-20), depth = height / fall;
    vec2 ground = depth * ray.xy;
    // How the point moves with the pixel, exactly (a camera does not roll: right.z = 0); PlaneView::level_at has the same
    vec2 dx = depth * right.xy, dy = depth * up.xy + (depth / height * up.z) * ground;
    shade(footprint_of(ground, dx, dy), fall * inversesqrt(dot(ray, ray)));
}
