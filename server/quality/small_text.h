#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "shared/page/texel_image.h"

namespace tessera {

/// Letters for pictures that must explain themselves without a font: capitals (small letters become
/// capitals), digits and `- . , : / % ( ) _`, five by seven texels each. Others are blanks.
inline constexpr std::int32_t letter_width = 6, letter_height = 7;  ///< With the gap behind.

constexpr std::int32_t text_width(std::string_view text, std::int32_t scale) noexcept {
    return static_cast<std::int32_t>(text.size()) * letter_width * scale;
}

/// With its top-left corner at (x, y); what is outside the image is cut.
void draw_text(Rgba8Image& image, std::int32_t x, std::int32_t y, std::string_view text, std::int32_t scale,
               std::array<std::uint8_t, 3> color);

/// The same with a dark rim, to be read on any ground.
void draw_text_on_picture(Rgba8Image& image, std::int32_t x, std::int32_t y, std::string_view text,
                          std::int32_t scale);

}  // namespace tessera
