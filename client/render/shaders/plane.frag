// The plane as a camera sees it, below the horizon: each pixel's ray, and its footprint on the plane.

// The row of pixels at the horizon may have corners beyond it
vec2 point_at(vec2 offset) {
    vec3 ray = ray_through(gl_FragCoord.xy + offset);
    float fall = max(max(-ray.z, -0.3 * ray_through(gl_FragCoord.xy).z), 1e-20);
    return height / fall * ray.xy;
}

void main() {
    vec3 ray = ray_through(gl_FragCoord.xy);
    float fall = max(-ray.z, 1e-20);
    vec2 ground = height / fall * ray.xy;
    // How the point moves with the pixel, exactly; PlaneView::level_at has the same
    vec2 dx = height * 2.0 / picture.x / fall * right.xy;
    vec2 dy = height * 2.0 / picture.y / (fall * fall) * (up.xy * fall + ray.xy * up.z);
    shade(footprint_of(ground, dx, dy), fall * inversesqrt(dot(ray, ray)));
}
