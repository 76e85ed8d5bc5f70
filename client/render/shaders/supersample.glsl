// A grid of SUBSAMPLES × SUBSAMPLES trilinear samples in each pixel, each on the level of its share of the footprint.
vec4 supersampled(Footprint footprint, out float level) {
    const float count = float(SUBSAMPLES);
    level = clamped_level(log2(footprint.longer) - log2(count));
    int finer = int(floor(level));
    vec2 reach = abs(footprint.dx) + abs(footprint.dy);
    Near fine = find_near(finer, footprint.centre, reach);
    Near coarse = find_near(min(finer + 1, top_level), footprint.centre, reach);
    vec4 sum = vec4(0.0);
    for (float y = 0.5; y < count; ++y) {
        for (float x = 0.5; x < count; ++x) {
            vec2 offset = point_at(vec2(x, y) / count - 0.5) - footprint.centre;
            sum += mix(sample_near(fine, footprint.centre, offset), sample_near(coarse, footprint.centre, offset),
                       level - float(finer));
        }
    }
    return sum / (count * count);
}
