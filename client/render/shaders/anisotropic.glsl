// The formula of EXT_texture_filter_anisotropic: up to 16 trilinear probes along the footprint's longer side, on the
// level of its shorter one. The reference for what "16x" means: drivers differ, and software ones more so.
const float MAX_PROBES = 16.0;

// The sum of the probes on a level whose page under the centre serves for all of them; else nothing
vec4 near_probes(Near found, vec2 side, float probes) {
    vec4 sum = vec4(0.0);
    Place place = found.place;
    float scale = inverse_power_of_two(place.level);
    vec2 step = scale / (probes + 1.0) * side;
    place.texel -= 0.5 * scale * side;
    float last = found.serves ? probes : 0.0;
    for (float probe = 1.0; probe <= last; ++probe) {
        place.texel += step;
        sum += bilinear_at(place);
    }
    return sum;
}

float anisotropic_probes(Footprint footprint) {
    return min(ceil(footprint.longer / footprint.shorter), MAX_PROBES);
}

vec4 anisotropic(Footprint footprint, out float level) {
    float probes = anisotropic_probes(footprint);
    level = clamped_level(log2(footprint.longer / probes));
    vec2 side = dot(footprint.dx, footprint.dx) > dot(footprint.dy, footprint.dy) ? footprint.dx : footprint.dy;
    int finer = int(floor(level)), coarser = coarser_of(level);
    Near fine = find_near(finer, footprint.centre, 0.5 * abs(side));
    Near coarse = find_near(coarser, footprint.centre, 0.5 * abs(side));
    float weight = level - float(finer);
    vec4 sum = mix(near_probes(fine, side, probes), near_probes(coarse, side, probes), weight);
    // The rest: one loop for both levels, since a software rasteriser runs what it skips too
    float first = fine.serves ? probes : 0.0, last = coarse.serves ? probes : 2.0 * probes;
    for (float index = first; index < last; ++index) {
        bool is_coarse = index >= probes;
        float probe = is_coarse ? index - probes + 1.0 : index + 1.0;
        sum += (is_coarse ? weight : 1.0 - weight) *
               sample_level(is_coarse ? coarser : finer, footprint.centre + (probe / (probes + 1.0) - 0.5) * side);
    }
    return sum / probes;
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
        if (!find_place(next == 0 ? finer : coarser_of(level), footprint.centre, place)) {
            sum += weight * nothing_yet();
            continue;
        }
        float scale = inverse_power_of_two(place.level);
        sum += weight * driver_at(place, scale * footprint.dx, scale * footprint.dy);
    }
    return sum;
#endif
}
