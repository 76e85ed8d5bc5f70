#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace tessera::painting {

/// A line of text on a board, one value a place.
struct Board {
    std::int32_t width = 0, height = 0;
    std::vector<std::uint8_t> codes;  ///< Rows from the top.
};

/// Writes `text` (of the letters A C E L R S T V X Y and blanks), about the middle of the board, `unit`
/// places for a sixth of a letter's height: `inside` in its strokes, `rim` along their edges, other places as
/// they are.
void write_text(Board& board, std::string_view text, std::int32_t unit, std::uint8_t inside,
                std::uint8_t rim);

}  // namespace tessera::painting
