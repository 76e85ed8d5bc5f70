#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/exchange.h"

namespace tessera {

/// An image ready to be copied from and blended: codes as pages carry them, and linear steps of 1/65535. Rows
/// may be read up to `padding` texels past their end.
struct TexelSource {
    static constexpr std::size_t padding = 16;

    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<std::uint8_t> codes;   ///< RGBA, 4·(width·height + padding)
    std::vector<std::uint16_t> steps;  ///< RGBA, as many

    TexelSource() = default;
    /// sRGB-coded texels, decoded.
    explicit TexelSource(const Rgb8Image& image);
    /// Linear texels; their codes are 255ths.
    explicit TexelSource(const Rgb16Image& image);

    /// The image, repeated to the right as far as `to_width`, so that rows can be read without wrapping.
    TexelSource repeated(std::int32_t to_width) const;

    const std::uint8_t* code_row(std::int32_t y) const noexcept {
        return codes.data() + std::size_t(y) * std::size_t(width) * 4;
    }
    const std::uint16_t* step_row(std::int32_t y) const noexcept {
        return steps.data() + std::size_t(y) * std::size_t(width) * 4;
    }
    std::size_t memory_bytes() const noexcept { return codes.size() + steps.size() * sizeof(std::uint16_t); }
};

}  // namespace tessera
