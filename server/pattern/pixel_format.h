#pragma once

#include <cstddef>
#include <type_traits>

#include "shared/page/texel_image.h"

namespace tessera {

/// What code that fills images of either kind asks of them.
template <class Image>
inline constexpr std::size_t texel_bytes = std::is_same_v<Image, LinearImage> ? 4 * sizeof(float) : 4;

inline auto& texels_of(LinearImage& image) noexcept { return image.values; }
inline auto& texels_of(Rgba8Image& image) noexcept { return image.bytes; }
inline const auto& texels_of(const LinearImage& image) noexcept { return image.values; }
inline const auto& texels_of(const Rgba8Image& image) noexcept { return image.bytes; }

/// Makes room for an image whose every texel is about to be written: what it held is not cleared.
template <class Image>
void reshape(Image& image, std::int32_t width, std::int32_t height) {
    image.width = width;
    image.height = height;
    texels_of(image).resize(std::size_t(width) * std::size_t(height) * 4);
}

}  // namespace tessera
