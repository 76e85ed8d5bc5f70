// Where texels come from, whatever draws: a virtual texture, seen from an origin. All positions ("ground") are texels
// of level 0 relative to the origin, so that floats are exact enough at any place of any extent.
layout(std140, binding = 0) uniform Source {
    ivec2 origin_page;    // of level 0
    vec2 origin_texel;    // in that page, with its fraction
    vec2 extent_low;      // the extent's corners; pages only
    vec2 extent_high;
    int top_level;
    int window_side;      // pages only
    uint now_ms;
    float fade_ms;
    float lod_bias;
    int side_log2;        // of a whole texture
    float most_columns;   // of a line integral, across a footprint, before a coarser level serves
};

const float PAGE_SIDE = 256.0;

// Linear light: beyond the extent, behind transparent texels, and where nothing has come yet
const vec3 TABLE_TOP = vec3(0.030, 0.033, 0.038);

#ifdef COUNT_FETCHES
float fetches = 0.0;  // texels read for this pixel; entries of the page table are not texels
#define COUNT(texels) fetches += float(texels)
#else
#define COUNT(texels)
#endif

// 2^-level, exactly; exp2 is an approximation on some drivers
float inverse_power_of_two(int level) { return uintBitsToFloat(uint(127 - level) << 23); }

// Where the origin lies in its page of a level, in texels of that level
vec2 origin_offset(int level) {
    ivec2 finer_pages = origin_page & ((1 << level) - 1);
    return (vec2(finer_pages) * PAGE_SIDE + origin_texel) * inverse_power_of_two(level);
}

// The texels that stand for a page of some level: in which layer, of which level (its own, or an ancestor's), and where
// in that layer the page's corner lies
struct Cell {
    int layer;
    int level;
    vec2 corner;
    uint arrival_ms;
};

// A point in a layer's texels
struct Place {
    int layer;
    int level;
    vec2 texel;
    uint arrival_ms;
};
