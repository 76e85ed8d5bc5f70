// Sprites in hands, over what the pages show: Lefebvre and Neyret 2003, section 3.2. A texel looks into its cell of the
// positioning map and tests no more sprites than the map has layers. Each is filtered as the pages will filter it: its
// box average over the page's texels, with the page's own filter between these.
layout(std140, binding = 2) uniform Held {
    vec2 held_low;
    float held_cell;
    int held_layers;
    ivec2 held_cells;
    float held_side;     // of a pattern's image, in its own texels
    float held_unused;
};
layout(binding = 4) uniform usampler2DArray held_map;
layout(binding = 5) uniform sampler2D held_list;
layout(binding = 6) uniform sampler2DArray held_patterns;  // premultiplied linear light, with MIP levels

struct HeldSprite {
    vec2 middle;
    vec2 along;  // the image's texels for a step of (1, 0) on the plane
    float layer;
    float opacity;
    bool sharp;
};

HeldSprite held_sprite(uint index) {
    vec4 first = texelFetch(held_list, ivec2(0, index), 0), second = texelFetch(held_list, ivec2(1, index), 0);
    // Turned by −turns into the image
    return HeldSprite(first.xy, vec2(first.z, -first.w), second.x, second.y, second.z > 0.5);
}

vec2 into_pattern(HeldSprite sprite, vec2 step) {
    return vec2(sprite.along.x * step.x - sprite.along.y * step.y, sprite.along.y * step.x + sprite.along.x * step.y);
}

// How much of [middle − width/2, middle + width/2] lies in the image, for each axis
vec2 held_share(vec2 middle, vec2 width) {
    return clamp((min(middle + 0.5 * width, held_side) - max(middle - 0.5 * width, 0.0)) / width, 0.0, 1.0);
}

vec4 held_point(HeldSprite sprite, vec2 at, vec2 width, float level) {
    vec2 share = held_share(at, width);
    return share.x * share.y *
           textureLod(held_patterns, vec3(clamp(at, 0.0, held_side) / held_side, sprite.layer), level);
}

// The average over a square of the plane: of SAMPLES² points, each on the MIP level of its share
const int HELD_SAMPLES = 4;
vec4 held_average(HeldSprite sprite, vec2 centre, float side) {
    vec2 across = side * sprite.along, down = vec2(-across.y, across.x);
    vec2 middle = into_pattern(sprite, centre - sprite.middle) + 0.5 * held_side;
    vec2 whole = abs(across) + abs(down);
    if (any(lessThan(middle, -0.5 * whole)) || any(greaterThan(middle, held_side + 0.5 * whole))) return vec4(0.0);
    float image_texels = length(across);
    if (sprite.sharp && side == 1.0) return held_point(sprite, middle, vec2(0.25), 0.0);
    float count = float(HELD_SAMPLES);
    float level = max(log2(image_texels / count) - 0.5, 0.0);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < HELD_SAMPLES * HELD_SAMPLES; ++i) {
        vec2 part = (vec2(i % HELD_SAMPLES, i / HELD_SAMPLES) + 0.5) / count - 0.5;
        sum += held_point(sprite, middle + part.x * across + part.y * down, whole / count, level);
    }
    return sum / (count * count);
}

float power_of_two(int level) { return uintBitsToFloat(uint(127 + level) << 23); }

// One point of one level, between the texels that pages of that level have
vec4 held_level(HeldSprite sprite, int level, vec2 ground) {
    float texel = power_of_two(level);
    vec2 offset = origin_offset(level);
    vec2 local = ground * inverse_power_of_two(level) + offset;
#if FILTER == NEAREST
    return held_average(sprite, (floor(local) + 0.5 - offset) * texel, texel);
#else
    local -= 0.5;
    vec2 base = floor(local), part = local - base;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; ++i) {
        vec2 corner = vec2(i & 1, i >> 1), weight = mix(1.0 - part, part, corner);
        sum += weight.x * weight.y * held_average(sprite, (base + corner + 0.5 - offset) * texel, texel);
    }
    return sum;
#endif
}

// One point between levels, by the image's own MIP levels: where a footprint takes many of them. Four samples spread as
// far as a page's texel and its filter do.
vec4 held_probe(HeldSprite sprite, vec2 ground, float level) {
    vec2 across = exp2(level) * sprite.along, down = vec2(-across.y, across.x), width = abs(across) + abs(down);
    vec2 middle = into_pattern(sprite, ground - sprite.middle) + 0.5 * held_side;
    float image_level = max(log2(length(across)) - 1.0, 0.0);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; ++i) {
        vec2 part = 0.9 * (vec2(i & 1, i >> 1) - 0.5);
        sum += held_point(sprite, middle + part.x * across + part.y * down, width, image_level);
    }
    return 0.25 * sum;
}

vec4 held_filtered(HeldSprite sprite, Footprint footprint) {
#if FILTER == NEAREST || FILTER == BILINEAR
    return held_level(sprite, nearest_level(footprint), footprint.centre);
#elif FILTER == TRILINEAR
    Level level = level_of(footprint.longer_squared);
    vec4 colour = held_level(sprite, level.finer, footprint.centre);
    for (int coarser = level.finer + 1; coarser <= level.coarser; ++coarser)
        colour = mix(colour, held_level(sprite, coarser, footprint.centre), level.part);
    return colour;
#else
    float probes = min(16.0, ceil(sqrt(footprint.longer_squared / footprint.shorter_squared)));
#if FILTER == SUPERSAMPLE
    probes = float(SUBSAMPLES * SUBSAMPLES);
    float level = number_of(level_of(footprint.longer_squared / probes));
#else
    float level = number_of(level_of(footprint.longer_squared / (probes * probes)));
#endif
    if (level <= 0.0 && footprint.longer_squared <= 2.25) return held_level(sprite, 0, footprint.centre);
    vec2 side = dot(footprint.dx, footprint.dx) > dot(footprint.dy, footprint.dy) ? footprint.dx : footprint.dy;
    vec4 sum = vec4(0.0);
    for (float probe = 0.0; probe < probes; ++probe) {
#if FILTER == SUPERSAMPLE
        vec2 at = subsample(int(probe));
#else
        vec2 at = footprint.centre + ((probe + 1.0) / (probes + 1.0) - 0.5) * side;
#endif
        sum += held_probe(sprite, at, level);
    }
    return sum / probes;
#endif
}

vec4 with_held_sprites(vec4 below, Footprint footprint) {
    ivec2 cell = ivec2(floor((footprint.centre - held_low) / held_cell));
    bool inside = all(greaterThanEqual(cell, ivec2(0))) && all(lessThan(cell, held_cells));
    int layers = inside ? held_layers : 0;
    for (int layer = 0; layer < layers; ++layer) {
        uint index = texelFetch(held_map, ivec3(cell, layer), 0).x;
        if (index == 0u) break;
        HeldSprite sprite = held_sprite(index - 1u);
        vec4 colour = sprite.opacity * held_filtered(sprite, footprint);
        below = colour + (1.0 - colour.a) * below;
    }
    return below;
}
