#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "client/residency/page_source.h"
#include "shared/math/hash.h"

namespace tessera::testing {

using Code4 = std::array<std::uint8_t, 4>;

/// Paints a page and its gutter from a function of the lattice: texel (x, y) of a level, any x and y.
inline std::string paint_page(PageKey page,
                              const std::function<Code4(int, std::int64_t, std::int64_t)>& texel) {
    std::string bytes(slot_bytes, '\0');
    std::size_t at = 0;
    for (std::int64_t row = -gutter_texels; row < page_side_texels + gutter_texels; ++row)
        for (std::int64_t column = -gutter_texels; column < page_side_texels + gutter_texels; ++column)
            for (const std::uint8_t code : texel(page.level, std::int64_t{page.x} * page_side_texels + column,
                                                 std::int64_t{page.y} * page_side_texels + row))
                bytes[at++] = static_cast<char>(code);
    return bytes;
}

/// Harsh noise of blue, ochre and white patches, with a tint for each level: any texel at a wrong place
/// shows.
inline Code4 noise_texel(int level, std::int64_t x, std::int64_t y) {
    const std::uint64_t fine = hash(1, stream("noise", static_cast<std::uint64_t>(level)), x, y);
    const std::uint64_t coarse = hash(2, stream("noise", static_cast<std::uint64_t>(level)), x >> 3, y >> 3);
    const auto code = [&](int shift) {
        return static_cast<std::uint8_t>(40 + (fine >> shift) % 100 + (coarse >> shift) % 100);
    };
    return {code(0), code(8), static_cast<std::uint8_t>(20 + 7 * level), 255};
}

}  // namespace tessera::testing
