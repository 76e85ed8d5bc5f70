// Compiled behind a line "#version 450 core" in variants, by what a frame needs: STORED_TEXELS, FADING, PAGE_BORDERS.
// Software rasterisers run both sides of every branch, so what is not needed must not be there.
//
// The plane under a sky. Each pixel: its ray, the point of the plane it meets, the level of its footprint, the page
// table's entry, the texels. Positions are relative to the point under the eye: floats are exact enough anywhere.

struct LevelOrigin {
    ivec2 page;    // that holds the point under the eye
    vec2 offset;   // of that point in its page, in texels of the level
};

layout(std140, binding = 0) uniform Frame {
    vec4 forward;
    vec4 right;
    vec4 up;
    float height;
    float pixel_step;
    float across_slope;
    float lod_bias;
    vec2 extent_low;
    vec2 extent_high;
    vec2 picture;
    int top_level;
    int window_side;
    uint now_ms;
    float fade_ms;
    float haze;
    float unused;
    LevelOrigin origins[31];
};

layout(binding = 0) uniform sampler2DArray pages;        // decodes to linear light
layout(binding = 1) uniform sampler2DArray coded_pages;  // the same texels as stored
layout(binding = 2) uniform usampler2DArray page_table;

layout(location = 0) out vec4 colour;

const uint NOTHING = 0xffffffffu;
const float PAGE_SIDE = 256.0;
const float GUTTER = 4.0;
const float SLOT_SIDE = PAGE_SIDE + 2.0 * GUTTER;

// Linear light
const vec3 ZENITH = vec3(0.105, 0.235, 0.480);
const vec3 HORIZON = vec3(0.640, 0.740, 0.810);
const vec3 TABLE_TOP = vec3(0.030, 0.033, 0.038);  // beyond the extent, and behind transparent texels
const float HAZE_DEPTH = 0.028;                    // sine of the angle below the horizon where 1/e of the haze is left

struct Place {
    int slot;
    int level;      // of the page in the slot
    vec2 texel;     // in that page, 0 to 256
    uint arrival_ms;
};

// 2^-level, exactly; exp2 is an approximation on some drivers
float inverse_power_of_two(int level) { return uintBitsToFloat(uint(127 - level) << 23); }

// The page shown for the point of this level, or of the next coarser one that has an entry for it
bool find_page(int level, vec2 ground, out Place place) {
    float reach = float(window_side / 2);
    for (; level <= top_level; ++level) {
        vec2 local = ground * inverse_power_of_two(level) + origins[level].offset;
        vec2 steps = floor(local / PAGE_SIDE);
        if (any(lessThan(steps, vec2(-reach))) || any(greaterThanEqual(steps, vec2(reach)))) continue;
        ivec2 last = ivec2((1 << (top_level - level)) - 1);
        ivec2 page = clamp(origins[level].page + ivec2(steps), ivec2(0), last);
        uvec4 entry = texelFetch(page_table, ivec3(page & (window_side - 1), level), 0);
        if (entry.x == NOTHING || ivec2(entry.yz) != page) continue;

        place.slot = int(entry.x & 0xffffu);
        place.level = int(entry.x >> 16);
        place.arrival_ms = entry.w;
        // Where the shown page lies: the entry's own page, or an ancestor of it
        ivec2 from_origin = (page >> (place.level - level)) - origins[place.level].page;
        place.texel = ground * inverse_power_of_two(place.level) + origins[place.level].offset -
                      PAGE_SIDE * vec2(from_origin);
        return true;
    }
    return false;
}

vec4 sample_place(Place place) {
    return textureLod(pages, vec3((place.texel + GUTTER) / SLOT_SIDE, float(place.slot)), 0.0);
}

// Premultiplied linear light of one level, from the finest page there is; a new page fades in over what it replaces
vec4 sample_level(int level, vec2 ground) {
    Place place;
    if (!find_page(level, ground, place)) return vec4(TABLE_TOP, 1.0);
    vec4 texel = sample_place(place);
#ifdef FADING
    float age = float(now_ms - place.arrival_ms);
    if (age < fade_ms && place.level < top_level) {
        Place coarser;
        if (find_page(place.level + 1, ground, coarser))
            texel = mix(sample_place(coarser), texel, smoothstep(0.0, 1.0, age / fade_ms));
    }
#endif
    return texel;
}

vec4 stored_texel(float level, vec2 ground) {
    Place place;
    if (!find_page(int(floor(level + 0.5)), ground, place)) return vec4(0.0);
    ivec2 texel = clamp(ivec2(floor(place.texel)), ivec2(0), ivec2(255));
    return texelFetch(coded_pages, ivec3(texel + int(GUTTER), place.slot), 0);
}

vec3 sky(vec3 ray) {
    float elevation = clamp(ray.z / length(ray), 0.0, 1.0);
    return mix(HORIZON, ZENITH, 1.0 - exp(-4.5 * elevation));
}

vec3 hue_of_level(int level) {
    vec3 phase = vec3(0.0, 0.33, 0.67) + 0.381966 * float(level);
    return 0.5 + 0.5 * cos(6.2831853 * phase);
}

// Lines along the borders of the page shown
vec3 with_page_borders(vec3 shaded, float level, vec2 ground, vec2 footprint) {
    Place place;
    if (!find_page(int(floor(level + 0.5)), ground, place)) return shaded;
    vec2 to_edge = min(place.texel, PAGE_SIDE - place.texel) / inverse_power_of_two(place.level);
    vec2 pixels = to_edge / max(footprint, vec2(1e-20));
    float line = 1.0 - smoothstep(0.6, 1.6, min(pixels.x, pixels.y));
    return mix(shaded, hue_of_level(place.level), 0.85 * line);
}

vec3 encode(vec3 linear) {
    vec3 low = 12.92 * linear;
    vec3 high = 1.055 * pow(max(linear, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, vec3(lessThanEqual(linear, vec3(0.0031308))));
}

// A bias of less than one code, different in each pixel, hides the steps of slow gradients
float dither() {
    vec2 p = floor(gl_FragCoord.xy);
    return fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715)))) - 0.5;
}

void main() {
    vec2 across = 2.0 * gl_FragCoord.xy / picture - 1.0;
    vec3 ray = forward.xyz + across.x * right.xyz + across.y * up.xyz;
    float fall = -ray.z;
    if (fall <= 0.0) {
#ifdef STORED_TEXELS
        colour = vec4(0.0);
#else
        colour = vec4(encode(sky(ray)) + dither() / 255.0, 1.0);
#endif
        return;
    }
    vec2 ground = height / fall * ray.xy;

    // The footprint along the picture's axes, in texels of level 0: PlaneView::level_at has the same formula
    float slope = across.x * across_slope;
    float along_row = height * pixel_step / fall;
    float footprint = along_row * max(1.0, sqrt(1.0 + slope * slope) / fall);
    float level = clamp(log2(footprint) + lod_bias, 0.0, float(top_level));

    // Beyond the extent there is nothing; its edge is as soft as a pixel is wide
    vec2 inside = clamp(ground, extent_low, extent_high);
    vec2 to_edge = min(ground - extent_low, extent_high - ground);
    float covered = clamp(0.5 + min(to_edge.x, to_edge.y) / footprint, 0.0, 1.0);

#ifdef STORED_TEXELS
    colour = covered < 0.5 ? vec4(0.0) : stored_texel(level, inside);
#else
    int finer = int(floor(level));
    vec4 texel = mix(sample_level(finer, inside), sample_level(min(finer + 1, top_level), inside),
                     level - float(finer));
    texel *= covered;
    vec3 shaded = texel.rgb + (1.0 - texel.a) * TABLE_TOP;
#ifdef PAGE_BORDERS
    // How far the point moves along x and y when the pixel moves by one
    vec2 by_row = along_row * abs(right.xy) / max(length(right.xy), 1e-20);
    vec2 by_column = footprint * abs(ray.xy) / max(length(ray.xy), 1e-20);
    shaded = mix(shaded, with_page_borders(shaded, level, inside, max(by_row, by_column)), covered);
#endif
    float below_horizon = fall / length(ray);
    shaded = mix(shaded, HORIZON, haze * exp(-below_horizon / HAZE_DEPTH));
    colour = vec4(encode(shaded), 1.0);
#endif
}
