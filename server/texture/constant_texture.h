#pragma once

#include <array>
#include <memory>

#include "server/texture/texture.h"

namespace tessera {

/// A colour as pages carry it: sRGB codes and a straight alpha code.
struct Rgba8 {
    std::uint8_t red = 0, green = 0, blue = 0, alpha = 255;
};

/// Linear light, premultiplied.
std::array<float, 4> to_linear(Rgba8 color) noexcept;

/// One colour everywhere.
std::shared_ptr<const Texture> make_constant_texture(Rgba8 color);

/// A board of squares of `cell_texels` (1 to 2^20) a side, `first` at the origin. Every level is the exact
/// box filter in closed form: along each axis the board is a square wave, whose integral over a texel is an
/// integer.
std::shared_ptr<const Texture> make_checker_texture(std::int64_t cell_texels, Rgba8 first, Rgba8 second);

}  // namespace tessera
