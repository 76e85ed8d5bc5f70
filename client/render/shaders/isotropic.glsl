// One point of one level, and what GL calls nearest, linear and their MIP-mapped kin.

// Premultiplied linear light of one level, from the finest page there is; a new page fades in over what it replaces
vec4 sample_level(int level, vec2 ground) {
    Place place;
    bool found = find_place(level, ground, place);
    vec4 texel = bilinear_at(place);
#ifdef FADING
    float age = float(now_ms - place.arrival_ms);
    Place coarser;
    if (age < fade_ms && place.level < top_level && find_place(place.level + 1, ground, coarser))
        texel = mix(bilinear_at(coarser), texel, smoothstep(0.0, 1.0, age / fade_ms));
#endif
    return found ? texel : nothing_yet();
}

// Where the pixel's ray meets the surface when the pixel moves by so many pixels: each picture has its own
vec2 point_at(vec2 offset);

// The pixel's sides on the plane, in texels of level 0, and the squares of their lengths
struct Footprint {
    vec2 centre;
    vec2 dx, dy;
    float longer_squared, shorter_squared;
};

Footprint footprint_of(vec2 centre, vec2 dx, vec2 dy) {
    float x = dot(dx, dx), y = dot(dy, dy);
    return Footprint(centre, dx, dy, x < y ? y : x, max(x < y ? x : y, 1e-36));
}

// Between which levels, and how far from the finer to the coarser; at either end of all levels they are the same.
struct Level {
    int finer, coarser;
    float part;
};

// The level whose texels are as long as this, by its square. Floats' exponents tell the level at once, which is what the
// page table waits for; the logarithm is needed later.
Level level_of(float squared) {
    int bits = floatBitsToInt(squared * squared_bias);
    int finer = (bits - 0x3f800000) >> 24;  // half the exponent
    float rest = intBitsToFloat(bits - (finer << 24));
    bool between = finer >= 0 && finer < top_level;
    finer = clamp(finer, 0, top_level);
    return Level(finer, finer + int(between), between ? min(0.5 * log2(rest), 1.0) : 0.0);
}

float number_of(Level level) { return float(level.finer) + level.part; }
int nearest_level(Footprint footprint) { return level_of(2.0 * footprint.longer_squared).finer; }

// A level's page under the footprint's centre: where all that a footprint samples lies around it, one look into the
// page table serves for all
struct Near {
    bool serves;
    Place place;
};

Near find_near(int level, vec2 centre, vec2 reach) {
    Near found;
    found.serves = find_place(level, centre, found.place) &&
                   is_around(found.place, reach * inverse_power_of_two(found.place.level));
#ifdef FADING
    found.serves = found.serves && float(now_ms - found.place.arrival_ms) >= fade_ms;
#endif
    return found;
}

vec4 trilinear(vec2 ground, Level level) {
    return mix(sample_level(level.finer, ground), sample_level(level.coarser, ground), level.part);
}
