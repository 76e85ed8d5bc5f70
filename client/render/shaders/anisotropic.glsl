// The formula of EXT_texture_filter_anisotropic: up to 16 trilinear probes along the footprint's longer side, on the
// level of its shorter one. The reference for what "16x" means: drivers differ, and software ones more so.
const float MAX_PROBES = 16.0;

vec4 probes_of_level(int level, Footprint footprint, vec2 side, float probes) {
    Near found = find_near(level, footprint.centre, 0.5 * abs(side));
    vec4 sum = vec4(0.0);
    // Two loops, since a software rasteriser runs what it skips too
    float near_probes = found.serves ? probes : 0.0, far_probes = probes - near_probes;
    vec2 step = side / (probes + 1.0);
    Place place = found.place;
    place.texel -= 0.5 * inverse_power_of_two(place.level) * side;
    for (float probe = 1.0; probe <= near_probes; ++probe) {
        place.texel += inverse_power_of_two(place.level) * step;
        sum += bilinear_at(place);
    }
    for (float probe = 1.0; probe <= far_probes; ++probe)
        sum += sample_level(level, footprint.centre - 0.5 * side + probe * step);
    return sum / probes;
}

float anisotropic_probes(Footprint footprint) {
    return min(ceil(footprint.longer / footprint.shorter), MAX_PROBES);
}

vec4 anisotropic(Footprint footprint, out float level) {
    float probes = anisotropic_probes(footprint);
    level = clamped_level(log2(footprint.longer / probes));
    vec2 side = dot(footprint.dx, footprint.dx) > dot(footprint.dy, footprint.dy) ? footprint.dx : footprint.dy;
    int finer = int(floor(level));
    return mix(probes_of_level(finer, footprint, side, probes),
               probes_of_level(min(finer + 1, top_level), footprint, side, probes), level - float(finer));
}

// The driver's own, on the levels that the formula would take
vec4 driver_anisotropic(Footprint footprint, out float level) {
    level = clamped_level(log2(footprint.longer / anisotropic_probes(footprint)));
    Place place;
#ifdef WHOLE
    find_place(0, footprint.centre, place);
    return driver_at(place, footprint.dx, footprint.dy);
#else
    int finer = int(floor(level));
    vec4 sum = vec4(0.0);
    for (int next = 0; next < 2; ++next) {
        float weight = next == 0 ? 1.0 - (level - float(finer)) : level - float(finer);
        if (!find_place(min(finer + next, top_level), footprint.centre, place)) {
            sum += weight * nothing_yet();
            continue;
        }
        float scale = inverse_power_of_two(place.level);
        sum += weight * driver_at(place, scale * footprint.dx, scale * footprint.dy);
    }
    return sum;
#endif
}
