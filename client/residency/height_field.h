#pragma once

#include <cstdint>
#include <vector>

namespace tessera {

/// Heights of a terrain from a grey picture, that repeats mirrored in all directions.
class HeightImage {
  public:
    static constexpr std::int64_t spacing_texels = 256;  ///< From one pixel to the next.

    /// `codes`: width·height of 0 to 65535, rows from the top. 2 to 8192 pixels each way.
    HeightImage(std::int32_t width, std::int32_t height, std::vector<std::uint16_t> codes);

    std::int32_t width() const { return width_; }
    std::int32_t height() const { return height_; }
    const std::vector<std::uint16_t>& codes() const { return codes_; }

    /// 0 to 65535, linear between pixels. `x`, `y`: texels, any.
    double at(std::int64_t x, std::int64_t y) const;

  private:
    std::int32_t width_, height_;
    std::vector<std::uint16_t> codes_;
};

/// Hills of all sizes from `made_height_shortest` to 2^20 texels, made from integers by hashing: the same on
/// every machine, at any place. Left out are those shorter than 4 `spacing`, which a mesh of that spacing
/// cannot show. In 1/64 texel, 0 or more.
std::int64_t made_height(std::int64_t x, std::int64_t y, std::int64_t spacing);

inline constexpr std::int64_t made_height_shortest = 1024;

}  // namespace tessera
