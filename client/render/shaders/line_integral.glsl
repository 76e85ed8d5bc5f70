// The area integral of a pixel's quadrilateral by sums along lines of texels: "Anisotropic Texture Filtering using Line
// Integral Textures", with the improvements that its section 4.3 asks for.
//
// A layer of `integrals` holds, for each texel of a page, the sum of the texels before it in its line, and the texel
// itself; the sum of a stretch of a line is then two fetches, ends that lie inside a texel included. Lines run both ways:
// layer 2n holds the sums along y, 2n + 1 those along x, transposed. Each channel is one 32-bit word: 24 bits of the sum
// of 16-bit linear light, modulo 2^24, above the texel's 8-bit code. A stretch has at most 256 texels of at most 65535,
// less than 2^24: differences are exact, wherever the sums wrap.
layout(binding = 3) uniform usampler2DArray integrals;

const float MOST_PIECES = 40.0;   // columns × pages that each of them crosses
const float LEAST_COLUMNS = 8.0;  // fewer are cut into parts, so that slanted sides count for what they cover

// Linear light of sRGB codes 0 to 255 over 255, within 0.012 code: a polynomial, since pow is slow
vec3 decoded(vec3 code) {
    vec3 high = 0.000924181158 +
                code * (0.0325729018 +
                        code * (0.520609576 + code * (0.663719516 + code * (0.0856006875 * code - 0.303322549))));
    vec3 low = code * (1.0 / 12.92);
    return vec3(code.r < 0.04045 ? low.r : high.r, code.g < 0.04045 ? low.g : high.g, code.b < 0.04045 ? low.b : high.b);
}

// The end of a stretch: so far into the texel, in steps of 1/65535
vec4 part_of_texel(uvec4 word, float part) {
    vec4 code = vec4(ivec4(word & 0xffu)) * (1.0 / 255.0);
    return vec4(decoded(code.rgb), code.a) * (part * 65535.0);
}

// How fine a level the quadrilateral needs. Long ones cross many pages with each column: they get fewer columns.
float line_integral_level(float across, float along) {
    float pages = along / (across * PAGE_SIDE);
    float columns = min(most_columns, 2.0 * MOST_PIECES / (1.0 + sqrt(1.0 + 4.0 * MOST_PIECES * pages)));
    return max(ceil(log2(across / columns) + lod_bias), 0.0);
}

// One instruction less than min and max, which mind what is no number
float less(float a, float b) { return a < b ? a : b; }
float greater(float a, float b) { return a > b ? a : b; }

// Corners in texels of the cell's layer; columns are along its first axis. Adds up area × colour, and area.
void add_cell(vec2 corners[4], vec2 low, vec2 high, int layer, float parts, inout vec4 sum, inout float area) {
    // A convex outline: y lies above all of its sides that run one way, and below those that run the other
    vec4 floor_at = vec4(-1e30), floor_slope = vec4(0.0), ceiling_at = vec4(1e30), ceiling_slope = vec4(0.0);
    vec2 first_diagonal = corners[2] - corners[0], second_diagonal = corners[3] - corners[1];
    bool turns_left = first_diagonal.x * second_diagonal.y > first_diagonal.y * second_diagonal.x;
    for (int i = 0; i < 4; ++i) {
        vec2 side = corners[(i + 1) & 3] - corners[i];
        float slope = side.y / (side.x == 0.0 ? 1.0 : side.x);
        float at = corners[i].y - corners[i].x * slope;
        bool is_below = (side.x > 0.0) == turns_left;
        if (side.x != 0.0 && is_below) {
            floor_at[i] = at;
            floor_slope[i] = slope;
        }
        if (side.x != 0.0 && !is_below) {
            ceiling_at[i] = at;
            ceiling_slope[i] = slope;
        }
    }
    float inverse_parts = 1.0 / parts;
    for (float part = floor(low.x * parts); part < high.x * parts; ++part) {
        float left = greater(part * inverse_parts, low.x), right = less((part + 1.0) * inverse_parts, high.x);
        float x = 0.5 * (left + right);
        // Where the quadrilateral begins and ends on this line
        vec4 floors = floor_at + x * floor_slope, ceilings = ceiling_at + x * ceiling_slope;
        // Where it does not meet the line, a stretch of nothing: cheaper than a branch where all branches run
        vec2 floors2 = vec2(greater(floors.x, floors.y), greater(floors.z, floors.w));
        vec2 ceilings2 = vec2(less(ceilings.x, ceilings.y), less(ceilings.z, ceilings.w));
        float begin = less(greater(greater(floors2.x, floors2.y), low.y), high.y);
        float end = less(greater(less(ceilings2.x, ceilings2.y), begin), high.y);
        float width = greater(right - left, 0.0);
        vec2 texel = min(floor(vec2(begin, end)), 255.0);
        // Of one level, and so faster than texelFetch
        vec3 column = vec3((floor(x) + 0.5) * (1.0 / PAGE_SIDE), 0.0, layer);
        vec2 in_column = (texel + 0.5) * (1.0 / PAGE_SIDE);
        uvec4 first = textureLod(integrals, vec3(column.x, in_column.x, column.z), 0.0);
        uvec4 last = textureLod(integrals, vec3(column.x, in_column.y, column.z), 0.0);
        COUNT(end > begin && width > 0.0 ? 2 : 0);
        vec4 between = vec4(ivec4(((last & 0xffffff00u) - (first & 0xffffff00u)) >> 8));
        sum += width * (between + part_of_texel(last, end - texel.y) - part_of_texel(first, begin - texel.x));
        area += width * (end - begin);
    }
}

vec4 line_integral(Footprint footprint, out float shown_level) {
    // A footprint smaller than a texel grows to the size of one: over squares, that is bilinear interpolation
    float x = length(footprint.dx), y = length(footprint.dy);
    vec2 grow_x = x < 1.0 ? footprint.dx * (0.5 / max(x, 1e-6) - 0.5) : vec2(0.0);
    vec2 grow_y = y < 1.0 ? footprint.dy * (0.5 / max(y, 1e-6) - 0.5) : vec2(0.0);
    vec2 corners[4] = vec2[4](point_at(vec2(-0.5, -0.5)) - grow_x - grow_y, point_at(vec2(0.5, -0.5)) + grow_x - grow_y,
                              point_at(vec2(0.5, 0.5)) + grow_x + grow_y, point_at(vec2(-0.5, 0.5)) - grow_x + grow_y);
    vec2 low = min(min(corners[0], corners[1]), min(corners[2], corners[3]));
    vec2 high = max(max(corners[0], corners[1]), max(corners[2], corners[3]));
    vec2 size = max(high - low, vec2(1e-6));

    // Lines run along the longer side: fewer of them
    bool upright = size.y >= size.x;
    float across = upright ? size.x : size.y;
    shown_level = line_integral_level(across, upright ? size.y : size.x);
    // Larger than the coarsest level resolves: its middle stands for all of it
    float shrink = min(1.0, inverse_power_of_two(int(min(shown_level, 100.0)) - top_level));
    shown_level = min(shown_level, float(top_level));
    for (int i = 0; i < 4; ++i) corners[i] = footprint.centre + shrink * (corners[i] - footprint.centre);
    low = footprint.centre + shrink * (low - footprint.centre);
    high = footprint.centre + shrink * (high - footprint.centre);
    across *= shrink;
    int level = int(shown_level);
    float scale = inverse_power_of_two(level);
    vec2 offset = origin_offset(level);
    for (int i = 0; i < 4; ++i) {
        corners[i] = corners[i] * scale + offset;
        if (!upright) corners[i] = corners[i].yx;
    }
    low = low * scale + offset;
    high = high * scale + offset;
    if (!upright) {
        low = low.yx;
        high = high.yx;
    }
    float parts = clamp(floor(LEAST_COLUMNS / (across * scale) + 0.5), 1.0, LEAST_COLUMNS);

    vec4 sum = vec4(0.0);
    float area = 0.0;
    vec2 first = floor(low * (1.0 / PAGE_SIDE)), last = floor(high * (1.0 / PAGE_SIDE));
    // One loop over all cells: loops within loops are dear
    float columns = last.x - first.x + 1.0, cells = columns * (last.y - first.y + 1.0);
    for (float index = 0.0; index < cells; ++index) {
        float whole_rows = floor((index + 0.5) / columns);
        float row = first.y + whole_rows, column = first.x + index - columns * whole_rows;
        ivec2 steps = upright ? ivec2(column, row) : ivec2(row, column);
        Cell cell;
        if (!is_in_extent(level, steps) || !find_cell(level, steps, cell)) continue;
        // Into the texels of the layer that shows this cell, and no further than the cell
        float coarser = inverse_power_of_two(cell.level - level);
        vec2 corner = upright ? cell.corner : cell.corner.yx;
        vec2 shift = corner - PAGE_SIDE * coarser * vec2(column, row);
        vec2 shown[4];
        for (int i = 0; i < 4; ++i) shown[i] = corners[i] * coarser + shift;
        vec4 cell_sum = vec4(0.0);
        float cell_area = 0.0;
        add_cell(shown, max(low * coarser + shift, corner), min(high * coarser + shift, corner + PAGE_SIDE * coarser),
                 2 * cell.layer + (upright ? 0 : 1), parts, cell_sum, cell_area);
#ifdef FEEDBACK
        if (cell_area > 0.0) tell(level, (origin_page >> level) + steps);
#endif
        sum += cell_sum / (coarser * coarser);
        area += cell_area / (coarser * coarser);
    }
    return area > 0.0 ? sum / (area * 65535.0) : nothing_yet();
}
