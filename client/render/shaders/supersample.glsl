// A grid of SUBSAMPLES × SUBSAMPLES trilinear samples in each pixel, each on the level of its share of the footprint.
vec2 subsample(int index) {
    return point_at((vec2(index % SUBSAMPLES, index / SUBSAMPLES) + 0.5) / float(SUBSAMPLES) - 0.5);
}

vec4 near_texel(Place place, vec2 offset) {
    place.texel += offset * inverse_power_of_two(place.level);
    return bilinear_at(place);
}

Level supersampled_level(Footprint footprint) {
    return level_of(footprint.longer_squared / float(SUBSAMPLES * SUBSAMPLES));
}

vec4 supersampled(Footprint footprint, out float shown_level) {
    const float count = float(SUBSAMPLES);
    Level level = supersampled_level(footprint);
    shown_level = number_of(level);
    vec2 reach = abs(footprint.dx) + abs(footprint.dy);
    Near fine = find_near(level.finer, footprint.centre, reach);
    Near coarse = find_near(level.coarser, footprint.centre, reach);
    vec4 sum = vec4(0.0);
    // Two loops, since a software rasteriser runs what it skips too
    int near_samples = fine.serves && coarse.serves ? SUBSAMPLES * SUBSAMPLES : 0;
    for (int sampled = 0; sampled < near_samples; ++sampled) {
        vec2 offset = subsample(sampled) - footprint.centre;
        sum += mix(near_texel(fine.place, offset), near_texel(coarse.place, offset), level.part);
    }
    for (int sampled = near_samples; sampled < SUBSAMPLES * SUBSAMPLES; ++sampled)
        sum += trilinear(subsample(sampled), level);
    return sum / (count * count);
}
