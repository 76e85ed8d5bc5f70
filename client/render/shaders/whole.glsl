// Texels of one square image that repeats for ever, all levels of it at hand: no pages, no table. Its side is
// 2^side_log2; a level smaller than a page repeats inside its layer.
layout(binding = 0) uniform sampler2D whole;  // decodes to linear light; repeats

bool find_cell(int level, ivec2 steps, out Cell cell) {
    ivec2 page = (origin_page >> level) + steps;
    int first = 0, side = max(side_log2 - 8, 0);
    for (int finer = 0; finer < level; ++finer, side = max(side - 1, 0)) first += 1 << (2 * side);
    ivec2 wrapped = page & ((1 << side) - 1);
    cell.layer = first + (wrapped.y << side) + wrapped.x;
    cell.level = level;
    cell.corner = vec2(0.0);
    return true;
}

bool is_in_extent(int level, ivec2 steps) { return true; }

bool find_place(int level, vec2 ground, out Place place) {
    vec2 local = ground * inverse_power_of_two(level) + origin_offset(level);
    // The origin's page counts too where an image has several
    int pages_log2 = max(side_log2 - level - 8, 0);
    local += vec2((origin_page >> level) & ((1 << pages_log2) - 1)) * PAGE_SIDE;
    float side = float(1 << max(side_log2 - level, 0));
    place.layer = float(level);
    place.level = level;
    place.texel = local - floor(local / side) * side;
    place.arrival_ms = 0u;
    return true;
}

// Where a place is in the texture; last its level
vec3 in_array(Place place) {
    return vec3(place.texel * inverse_power_of_two(side_log2 - place.level), place.layer);
}

vec4 texel_at(vec3 in_array) {
    COUNT(4);
    return textureLod(whole, in_array.xy, in_array.z);
}
vec4 bilinear_at(Place place) { return texel_at(in_array(place)); }

vec4 nearest_at(Place place) {
    COUNT(1);
    return texelFetch(whole, ivec2(place.texel) & ((1 << (side_log2 - place.level)) - 1), place.level);
}

vec4 driver_at(Place place, vec2 dx, vec2 dy) {
    float scale = inverse_power_of_two(side_log2);
    return textureGrad(whole, place.texel * scale, dx * scale, dy * scale);
}

bool is_around(Place place, vec2 reach) { return true; }
vec2 steps_around(Place place, vec2 step) { return vec2(-100.0, 100.0); }
vec2 step_in_array(Place place, vec2 step) { return step * inverse_power_of_two(side_log2 - place.level); }

vec4 nothing_yet() { return vec4(0.0); }
