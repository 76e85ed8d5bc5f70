// Texels out of the resident pages, found through the page table.
layout(binding = 0) uniform sampler2DArray pages;        // decodes to linear light
layout(binding = 1) uniform sampler2DArray coded_pages;  // the same texels as stored
layout(binding = 2) uniform sampler2DArray page_table;   // PageTableTexture says what its bytes are
layout(binding = 9) uniform sampler2DArray integral_table;  // the same, to places of line integrals
#if defined(FADING) || defined(OVERLAY)
layout(binding = 8) uniform usampler2DArray table_entries;
#endif

#ifdef FEEDBACK
layout(r32ui, binding = 0) uniform writeonly uimage2DArray feedback;
bool gives_feedback = true;
// The pages that this pixel wants, resident or not; those beyond their level's window nobody can show
void tell(int level, ivec2 page) {
    ivec2 away = page - (origin_page >> level);
    int reach = window_side / 2;
    if (gives_feedback && all(greaterThanEqual(away, ivec2(-reach))) && all(lessThan(away, ivec2(reach))))
        imageStore(feedback, ivec3(page & (window_side - 1), level), uvec4(1u));
}
#endif

const float GUTTER = 4.0;
const float SLOT_SIDE = PAGE_SIDE + 2.0 * GUTTER;

// What is shown for a page of a level, in whose window it is
struct Shown {
    bool found;
    float layer;
    int level;
};
Shown shown_for(sampler2DArray table, int level, ivec2 page) {
    ivec2 entry = page & (window_side - 1);
    vec4 bytes = texelFetch(table, ivec3(entry, level), 0);
    ivec2 tag = page >> window_log2 & 15;
    float expected = float(tag.x + 16 * tag.y) / 255.0;
    return Shown(bytes.z < 254.5 / 255.0 && abs(bytes.w - expected) < 0.5 / 255.0, 255.0 * (bytes.x + 256.0 * bytes.y),
                 int(255.0 * bytes.z + 0.5));
}

// How many levels further up all of a distance lies in the window; it may lie in finer ones too, by a page
int levels_above(int level, float distance) {
    return max((floatBitsToInt(distance * window_scale) >> 23) - 126 - level, 0);
}

// Whose line integrals are shown for the page so many steps from the origin's page; from a coarser window where it is in none
bool find_cell(int level, ivec2 steps, out Cell cell) {
    ivec2 page = (origin_page >> level) + steps;
    vec2 away = abs(vec2(steps) + 0.5) + 0.5;
    int above = min(levels_above(0, max(away.x, away.y) * PAGE_SIDE), top_level - level);
    Shown shown = shown_for(integral_table, level + above, page >> above);
    cell.layer = int(shown.layer + 0.5);
    cell.level = shown.level;
    int coarser = cell.level - level;
    cell.corner = vec2(page & ((1 << coarser) - 1)) * (PAGE_SIDE * inverse_power_of_two(coarser));
    return shown.found;
}

bool is_in_extent(int level, ivec2 steps) {
    ivec2 page = (origin_page >> level) + steps;
    return all(greaterThanEqual(page, ivec2(0))) && all(lessThan(page, ivec2(1 << (top_level - level))));
}

bool find_place(int level, vec2 ground, out Place place) {
    vec2 inside = clamp(ground, extent_low, extent_high);
#ifdef FEEDBACK
    ivec2 wanted = (origin_page >> level) + ivec2(floor(inside * inverse_power_of_two(level + 8) + origin_offset(level) / PAGE_SIDE));
    tell(level, clamp(wanted, ivec2(0), ivec2((1 << (top_level - level)) - 1)));
#endif
    // Early, while the level is still waited for: where no window but a coarser one has the point
    level = min(level + levels_above(level, max(abs(inside.x), abs(inside.y))), top_level);
    ivec2 origin = origin_page >> level;
    vec2 origin_texels = vec2(origin_page - (origin << level)) * PAGE_SIDE + origin_texel;
    vec2 at = (inside + origin_texels) * inverse_power_of_two(level + 8);  // in pages
    vec2 steps = clamp(floor(at), vec2(-origin), vec2((1 << (top_level - level)) - 1 - origin));
    ivec2 page = origin + ivec2(steps);
    Shown shown = shown_for(page_table, level, page);
    place.layer = shown.layer;
    place.level = shown.level;
    int coarser = place.level - level;
    place.texel = (at - steps + vec2(page & ((1 << coarser) - 1))) * inverse_power_of_two(coarser - 8);
#if defined(FADING) || defined(OVERLAY)
    place.arrival_ms = texelFetch(table_entries, ivec3(page & (window_side - 1), level), 0).w;
#else
    place.arrival_ms = 0u;
#endif
    return shown.found;
}

// Where a place is in the array texture
vec3 in_array(Place place) { return vec3(place.texel * (1.0 / SLOT_SIDE) + GUTTER / SLOT_SIDE, place.layer); }

vec4 texel_at(vec3 in_array) {
    COUNT(4);
    return textureLod(pages, in_array, 0.0);
}
vec4 bilinear_at(Place place) { return texel_at(in_array(place)); }

vec4 nearest_at(Place place) {
    COUNT(1);
    ivec2 texel = clamp(ivec2(floor(place.texel)), ivec2(0), ivec2(255));
    return texelFetch(pages, ivec3(texel + int(GUTTER), int(place.layer + 0.5)), 0);
}

// Along these gradients, in texels, by the driver
vec4 driver_at(Place place, vec2 dx, vec2 dy) {
    return textureGrad(pages, in_array(place), dx / SLOT_SIDE, dy / SLOT_SIDE);
}

// Whether the four texels around all points so far from the place are in its layer: the gutter makes it so
bool is_around(Place place, vec2 reach) {
    return all(greaterThan(place.texel - reach, vec2(0.5 - GUTTER))) &&
           all(lessThan(place.texel + reach, vec2(PAGE_SIDE + GUTTER - 0.5)));
}

// How many steps lead from the place backwards (≤ 0) and on, while is_around() holds
vec2 steps_around(Place place, vec2 step) {
    vec2 to_low = (0.5 - GUTTER - place.texel) / step, to_high = (PAGE_SIDE + GUTTER - 0.5 - place.texel) / step;
    vec2 back = min(to_low, to_high), on = max(to_low, to_high);
    return vec2(max(back.x, back.y), min(on.x, on.y));
}

// A step in the array texture
vec2 step_in_array(Place place, vec2 step) { return step * (1.0 / SLOT_SIDE); }

vec4 nothing_yet() { return vec4(TABLE_TOP, 1.0); }
