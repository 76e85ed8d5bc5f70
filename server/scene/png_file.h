#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "shared/result/result.h"

namespace tessera {

enum class PngColor : std::uint8_t { grey = 0, rgb = 2 };

/// A PNG of nothing but its texels: no date, no text, so that the same texels give the same bytes.
/// `rows` holds height·width·channels samples of `bits` (8, or 16 with the high byte first), rows from the
/// top.
std::vector<std::uint8_t> to_png(std::int32_t width, std::int32_t height, PngColor color, int bits,
                                 std::span<const std::uint8_t> rows);

/// Walks the chunks of a PNG to its end, and checks their checksums: what is truncated or was damaged on its
/// way is told before a decoder sees it. Error: the reason alone, without the file's name.
Result<void> check_png(const std::filesystem::path& file);

}  // namespace tessera
