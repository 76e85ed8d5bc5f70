// Texels out of the resident pages, found through the page table.
layout(binding = 0) uniform sampler2DArray pages;        // decodes to linear light
layout(binding = 1) uniform sampler2DArray coded_pages;  // the same texels as stored
layout(binding = 2) uniform usampler2DArray page_table;

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

const uint NOTHING = 0xffffffffu;
const float GUTTER = 4.0;
const float SLOT_SIDE = PAGE_SIDE + 2.0 * GUTTER;

// What is shown for the page so many steps from the origin's page; from the next coarser window where it is in none
bool find_cell(int level, ivec2 steps, out Cell cell) {
    int reach = window_side / 2;
    ivec2 page = (origin_page >> level) + steps;
    for (int above = 0; level + above <= top_level; ++above) {
        ivec2 shown_for = page >> above;
        ivec2 away = shown_for - (origin_page >> (level + above));
        if (any(lessThan(away, ivec2(-reach))) || any(greaterThanEqual(away, ivec2(reach)))) continue;
        uvec4 entry = texelFetch(page_table, ivec3(shown_for & (window_side - 1), level + above), 0);
        if (entry.x == NOTHING || ivec2(entry.yz) != shown_for) continue;
        cell.layer = int(entry.x & 0xffffu);
        cell.level = int(entry.x >> 16);
        cell.arrival_ms = entry.w;
        int coarser = cell.level - level;
        cell.corner = vec2(page & ((1 << coarser) - 1)) * (PAGE_SIDE * inverse_power_of_two(coarser));
        return true;
    }
    return false;
}

bool is_in_extent(int level, ivec2 steps) {
    ivec2 page = (origin_page >> level) + steps;
    return all(greaterThanEqual(page, ivec2(0))) && all(lessThan(page, ivec2(1 << (top_level - level))));
}

bool find_place(int level, vec2 ground, out Place place) {
    vec2 local = clamp(ground, extent_low, extent_high) * inverse_power_of_two(level) + origin_offset(level);
    ivec2 origin = origin_page >> level;
    ivec2 steps = clamp(ivec2(floor(local / PAGE_SIDE)), -origin, ivec2((1 << (top_level - level)) - 1) - origin);
    Cell cell;
#ifdef FEEDBACK
    tell(level, origin + steps);
#endif
    if (!find_cell(level, steps, cell)) return false;
    place.layer = cell.layer;
    place.level = cell.level;
    place.arrival_ms = cell.arrival_ms;
    place.texel = (local - PAGE_SIDE * vec2(steps)) * inverse_power_of_two(cell.level - level) + cell.corner;
    return true;
}

vec4 bilinear_at(Place place) {
    COUNT(4);
    return textureLod(pages, vec3((place.texel + GUTTER) / SLOT_SIDE, float(place.layer)), 0.0);
}

vec4 nearest_at(Place place) {
    COUNT(1);
    ivec2 texel = clamp(ivec2(floor(place.texel)), ivec2(0), ivec2(255));
    return texelFetch(pages, ivec3(texel + int(GUTTER), place.layer), 0);
}

// Along these gradients, in texels, by the driver
vec4 driver_at(Place place, vec2 dx, vec2 dy) {
    return textureGrad(pages, vec3((place.texel + GUTTER) / SLOT_SIDE, float(place.layer)), dx / SLOT_SIDE,
                       dy / SLOT_SIDE);
}

// Whether the four texels around all points so far from the place are in its layer: the gutter makes it so
bool is_around(Place place, vec2 reach) {
    return all(greaterThan(place.texel - reach, vec2(0.5 - GUTTER))) &&
           all(lessThan(place.texel + reach, vec2(PAGE_SIDE + GUTTER - 0.5)));
}

vec4 nothing_yet() { return vec4(TABLE_TOP, 1.0); }
