#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/page/page_format.h"
#include "shared/page/texel_image.h"
#include "shared/result/result.h"

namespace tessera {

using EncodedBytes = std::vector<std::uint8_t>;

/// The file or message body of `image` in `format`. The same image gives the same bytes on every machine and
/// thread. `image` is 1 to 4096 texels a side; data is opaque. Error: io_failure if a codec refuses, which is
/// a bug or a lack of memory.
Result<EncodedBytes> encode_page(const Rgba8Image& image, PageFormat format,
                                 TexelKind kind = TexelKind::color);

/// One zstd frame of level 1 around `bytes`.
Result<EncodedBytes> compress_zstd(std::span<const std::uint8_t> bytes);

/// Whether every texel has the same colour: such an image is encoded without looking at its texels.
bool is_one_colour(const Rgba8Image& image) noexcept;

/// Premultiplied sRGB-coded texels with their alpha divided out in linear light, as PNG and WebP want them.
/// Texels of alpha 0 become transparent black.
Rgba8Image to_straight_alpha(const Rgba8Image& premultiplied);

}  // namespace tessera
