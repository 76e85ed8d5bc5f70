// One point of one level, and what GL calls nearest, linear and their MIP-mapped kin.

// Premultiplied linear light of one level, from the finest page there is; a new page fades in over what it replaces
vec4 sample_level(int level, vec2 ground) {
    Place place;
    if (!find_place(level, ground, place)) return nothing_yet();
    vec4 texel = bilinear_at(place);
#ifdef FADING
    float age = float(now_ms - place.arrival_ms);
    if (age < fade_ms && place.level < top_level) {
        Place coarser;
        if (find_place(place.level + 1, ground, coarser))
            texel = mix(bilinear_at(coarser), texel, smoothstep(0.0, 1.0, age / fade_ms));
    }
#endif
    return texel;
}

float clamped_level(float level) { return clamp(level + lod_bias, 0.0, float(top_level)); }

// Where the pixel's ray meets the surface when the pixel moves by so many pixels: each picture has its own
vec2 point_at(vec2 offset);

// The pixel's sides on the plane, in texels of level 0
struct Footprint {
    vec2 centre;
    vec2 dx, dy;
    float longer, shorter;
};

Footprint footprint_of(vec2 centre, vec2 dx, vec2 dy) {
    float x = length(dx), y = length(dy);
    return Footprint(centre, dx, dy, max(x, y), max(min(x, y), 1e-20));
}

float isotropic_level(Footprint footprint) { return clamped_level(log2(footprint.longer)); }

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

// The other level that a fractional one reads; where its weight is nothing, none
int coarser_of(float level) { return min(int(ceil(level)), top_level); }

vec4 trilinear(vec2 ground, float level) {
    int finer = int(floor(level));
    return mix(sample_level(finer, ground), sample_level(coarser_of(level), ground), level - float(finer));
}
