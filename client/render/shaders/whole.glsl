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
    cell.arrival_ms = 0u;
    return true;
}

bool is_in_extent(int level, ivec2 steps) { return true; }

bool find_place(int level, vec2 ground, out Place place) {
    vec2 local = ground * inverse_power_of_two(level) + origin_offset(level);
    // The origin's page counts too where an image has several
    int pages_log2 = max(side_log2 - level - 8, 0);
    local += vec2((origin_page >> level) & ((1 << pages_log2) - 1)) * PAGE_SIDE;
    float side = float(1 << max(side_log2 - level, 0));
    place.layer = 0;
    place.level = level;
    place.texel = local - floor(local / side) * side;
    place.arrival_ms = 0u;
    return true;
}

vec4 bilinear_at(Place place) {
    COUNT(4);
    return textureLod(whole, place.texel * inverse_power_of_two(side_log2 - place.level), float(place.level));
}

vec4 nearest_at(Place place) {
    COUNT(1);
    return texelFetch(whole, ivec2(place.texel) & ((1 << (side_log2 - place.level)) - 1), place.level);
}

vec4 driver_at(Place place, vec2 dx, vec2 dy) {
    float scale = inverse_power_of_two(side_log2);
    return textureGrad(whole, place.texel * scale, dx * scale, dy * scale);
}

bool is_around(Place place, vec2 reach) { return true; }

vec4 nothing_yet() { return vec4(0.0); }
