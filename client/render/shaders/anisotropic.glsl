// The formula of EXT_texture_filter_anisotropic: up to 16 trilinear probes along the footprint's longer side, on the
// level of its shorter one. The reference for what "16x" means: drivers differ, and software ones more so.
const float MAX_PROBES = 16.0;

float anisotropic_probes(Footprint footprint) {
    return min(MAX_PROBES, ceil(sqrt(footprint.longer_squared / footprint.shorter_squared)));
}

// The probes of a level, numbered from 1, that lie in the layer of the page under the middle: nearly always all, and
// surely all where there are at most five, which reach no further than the gutter
struct Probes {
    float first, count;
    vec3 start;  // where the first of them is in the array texture
    vec2 step;
};

Probes probes_of(int level, vec2 middle, vec2 step, float count) {
    Place place;
    bool serves = find_place(level, middle, place);
#ifdef FADING
    serves = serves && float(now_ms - place.arrival_ms) >= fade_ms;
#endif
    step *= inverse_power_of_two(place.level);
    vec2 around = 0.5 * (count + 1.0) + steps_around(place, step);
    Probes probes;
    probes.first = max(ceil(around.x), 1.0);
    probes.count = serves ? max(min(floor(around.y), count) - probes.first + 1.0, 0.0) : 0.0;
    place.texel += (probes.first - 0.5 * (count + 1.0)) * step;
    probes.start = in_array(place);
    probes.step = step_in_array(place, step);
    return probes;
}

vec4 anisotropic(Footprint footprint, out float shown_level) {
    float count = anisotropic_probes(footprint);
    Level level = level_of(footprint.longer_squared / (count * count));
    shown_level = number_of(level);
    vec2 side = dot(footprint.dx, footprint.dx) > dot(footprint.dy, footprint.dy) ? footprint.dx : footprint.dy;
    vec2 step = side / (count + 1.0);
    Probes fine = probes_of(level.finer, footprint.centre, step, count);
    Probes coarse = probes_of(level.coarser, footprint.centre, step, count);
    bool two_levels = level.coarser > level.finer;
    float fine_weight = 1.0 - level.part, coarse_weight = level.part;
    vec4 sum = vec4(0.0);
    // One loop for both levels, since a software rasteriser runs each once at least
    float probes = fine.count + (two_levels ? coarse.count : 0.0);
    for (float index = 0.0; index < probes; ++index) {
        bool is_coarse = index >= fine.count;
        float probe = is_coarse ? index - fine.count : index;
        vec3 start = is_coarse ? coarse.start : fine.start;
        vec2 along = is_coarse ? coarse.step : fine.step;
        sum += (is_coarse ? coarse_weight : fine_weight) * texel_at(vec3(start.xy + probe * along, start.z));
    }
    float fine_left = count - fine.count, coarse_left = two_levels ? count - coarse.count : 0.0;
#ifdef FEW_PROBES
    sum += (fine_weight * fine_left + coarse_weight * coarse_left) * nothing_yet();
#else
    // The rest, before the first or after the last
    for (float index = 0.0; index < fine_left + coarse_left; ++index) {
        bool is_coarse = index >= fine_left;
        float probe = 1.0 + (is_coarse ? index - fine_left : index);
        float first = is_coarse ? coarse.first : fine.first, taken = is_coarse ? coarse.count : fine.count;
        probe += probe < first ? 0.0 : taken;
        sum += (is_coarse ? coarse_weight : fine_weight) *
               sample_level(is_coarse ? level.coarser : level.finer, footprint.centre + (probe - 0.5 * (count + 1.0)) * step);
    }
#endif
    return sum / count;
}

// The driver's own, on the levels that the formula would take
vec4 driver_anisotropic(Footprint footprint, out float shown_level) {
    float probes = anisotropic_probes(footprint);
    Level level = level_of(footprint.longer_squared / (probes * probes));
    shown_level = number_of(level);
    Place place;
#ifdef WHOLE
    find_place(0, footprint.centre, place);
    return driver_at(place, footprint.dx, footprint.dy);
#else
    vec4 sum = vec4(0.0);
    for (int next = 0; next < 2; ++next) {
        float weight = next == 0 ? 1.0 - level.part : level.part;
        if (!find_place(next == 0 ? level.finer : level.coarser, footprint.centre, place)) {
            sum += weight * nothing_yet();
            continue;
        }
        float scale = inverse_power_of_two(place.level);
        sum += weight * driver_at(place, scale * footprint.dx, scale * footprint.dy);
    }
    return sum;
#endif
}
