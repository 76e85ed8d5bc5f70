// Where texels come from, whatever draws: a virtual texture, seen from an origin. All positions ("ground") are texels
// of level 0 relative to the origin, so that floats are exact enough at any place of any extent.
//
// The uniform block `Source` of constants.vert. What is the same for the whole picture comes as flat values of the vertex
// shader: llvmpipe reads uniforms lane by lane, whenever they are used.
flat in ivec4 source[5];
#define origin_page source[0].xy                        // of level 0
#define origin_texel intBitsToFloat(source[0].zw)       // in that page, with its fraction
#define extent_low intBitsToFloat(source[1].xy)         // the extent's corners; pages only
#define extent_high intBitsToFloat(source[1].zw)
#define top_level source[2].x
#define window_side source[2].y                         // pages only
#define now_ms uint(source[2].z)
#define fade_ms intBitsToFloat(source[2].w)
#define lod_bias intBitsToFloat(source[3].x)
#define side_log2 source[3].y                           // of a whole texture
#define most_columns intBitsToFloat(source[3].z)        // of a line integral, across a footprint, before a coarser level serves
#define squared_bias intBitsToFloat(source[3].w)        // 4 to the power of lod_bias
#define window_scale intBitsToFloat(source[4].x)        // 1 / the distance that is in level 0's window for sure; pages only
#define window_log2 source[4].y                          // of window_side

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
float inverse_power_of_two(int level) { return intBitsToFloat((127 - level) << 23); }

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
};

// A point in a layer's texels
struct Place {
    float layer;
    int level;
    vec2 texel;
    uint arrival_ms;  // where new pages fade in, or their age is shown
};
