#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/exchange.h"
#include "shared/math/srgb.h"

namespace tessera {

/// An image ready to be copied from and blended: codes as pages carry them, and what each is in linear steps
/// of 1/65535. Rows may be read up to `padding` texels past their end.
class TexelSource {
  public:
    static constexpr std::size_t padding = 16;

    TexelSource() = default;
    /// sRGB-coded texels: a table says what step each code is.
    explicit TexelSource(const Rgb8Image& image);
    /// Linear texels of data, which no code holds.
    explicit TexelSource(const Rgb16Image& image);

    /// The image, repeated to the right as far as `to_width`, so that rows can be read without wrapping.
    TexelSource repeated(std::int32_t to_width) const;

    std::int32_t width() const noexcept { return width_; }
    std::int32_t height() const noexcept { return height_; }
    bool has_codes() const noexcept { return !codes_.empty(); }
    /// RGBA, only where has_codes().
    const std::uint8_t* code_row(std::int32_t y) const noexcept {
        return codes_.data() + std::size_t(y) * std::size_t(width_) * 4;
    }
    /// RGBA, only where not has_codes().
    const std::uint16_t* step_row(std::int32_t y) const noexcept {
        return steps_.data() + std::size_t(y) * std::size_t(width_) * 4;
    }
    std::uint16_t step(std::int32_t x, std::int32_t y, std::int32_t channel) const noexcept {
        return has_codes() ? srgb_to_steps[code_row(y)[x * 4 + channel]] : step_row(y)[x * 4 + channel];
    }

    std::size_t memory_bytes() const noexcept {
        return codes_.size() + steps_.size() * sizeof(std::uint16_t);
    }

  private:
    std::int32_t width_ = 0;
    std::int32_t height_ = 0;
    std::vector<std::uint8_t> codes_;   ///< 4·(width·height + padding), or empty
    std::vector<std::uint16_t> steps_;  ///< The same, or empty
};

}  // namespace tessera
