#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "shared/result/result.h"

namespace tessera {

/// PNG's colour types (ISO/IEC 15948, 11.2.2).
enum class PngColor : std::uint8_t { grey = 0, rgb = 2, palette = 3, rgba = 6 };

/// Signature and header: what every PNG starts with. `bits` a sample.
std::vector<std::uint8_t> start_png(std::int32_t width, std::int32_t height, PngColor color, int bits);

/// Length, name of four letters, data, and a checksum of name and data.
void append_png_chunk(std::vector<std::uint8_t>& png, std::string_view name,
                      std::span<const std::uint8_t> data);

/// A PNG of nothing but its texels, grey, RGB or RGBA: no date, no text, so that the same texels give the
/// same bytes. `rows` from the top, each of whole bytes: samples of `bits` (1 from the highest bit on, grey
/// only; 8; or 16 with the high byte first).
std::vector<std::uint8_t> to_png(std::int32_t width, std::int32_t height, PngColor color, int bits,
                                 std::span<const std::uint8_t> rows);

/// Walks the chunks of a PNG to its end, and checks their checksums: what is truncated or was damaged on its
/// way is told before a decoder sees it. Error: the reason alone, without the file's name.
Result<void> check_png(const std::filesystem::path& file);

}  // namespace tessera
