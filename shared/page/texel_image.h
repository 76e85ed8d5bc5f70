#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

/// What texels are.
enum class TexelKind : std::uint8_t {
    color,  ///< Light: filtered linear, sRGB-coded in pages.
    data,   ///< Numbers, as in normal maps: pages hold 255ths of them, opaque.
};

/// Texels as pages carry them: RGBA, 8 bits a channel, sRGB-coded, premultiplied by alpha; rows from the top.
/// Of TexelKind::data, 255ths.
struct Rgba8Image {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<std::uint8_t> bytes;  ///< 4·width·height

    Rgba8Image() = default;
    Rgba8Image(std::int32_t w, std::int32_t h)
        : width{w}, height{h}, bytes(std::size_t(w) * std::size_t(h) * 4) {}
    std::uint8_t* row(std::int32_t y) noexcept {
        return bytes.data() + std::size_t(y) * std::size_t(width) * 4;
    }
    const std::uint8_t* row(std::int32_t y) const noexcept {
        return bytes.data() + std::size_t(y) * std::size_t(width) * 4;
    }
    bool operator==(const Rgba8Image&) const = default;
};

/// Texels before encoding: RGBA floats in linear light, premultiplied by alpha, nominally 0 to 1.
struct LinearImage {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<float> values;  ///< 4·width·height

    LinearImage() = default;
    LinearImage(std::int32_t w, std::int32_t h)
        : width{w}, height{h}, values(std::size_t(w) * std::size_t(h) * 4) {}
    float* row(std::int32_t y) noexcept { return values.data() + std::size_t(y) * std::size_t(width) * 4; }
    const float* row(std::int32_t y) const noexcept {
        return values.data() + std::size_t(y) * std::size_t(width) * 4;
    }
};

}  // namespace tessera
