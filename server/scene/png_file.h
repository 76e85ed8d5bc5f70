#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

enum class PngColor : std::uint8_t { grey = 0, rgb = 2 };

/// A PNG of nothing but its texels: no date, no text, so that the same texels give the same bytes.
/// `rows` holds height·width·channels samples of `bits` (8, or 16 with the high byte first), rows from the
/// top.
std::vector<std::uint8_t> to_png(std::int32_t width, std::int32_t height, PngColor color, int bits,
                                 std::span<const std::uint8_t> rows);

}  // namespace tessera
