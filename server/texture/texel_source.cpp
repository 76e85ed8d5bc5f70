#include "server/texture/texel_source.h"

#include <algorithm>

namespace tessera {
namespace {

/// RGB to RGBA, with room behind the last texel.
template <class Value>
std::vector<Value> with_alpha(const std::vector<Value>& rgb, Value opaque) {
    std::vector<Value> out;
    out.reserve((rgb.size() / 3 + TexelSource::padding) * 4);
    for (std::size_t i = 0; i < rgb.size(); i += 3)
        out.insert(out.end(), {rgb[i], rgb[i + 1], rgb[i + 2], opaque});
    out.resize(out.size() + TexelSource::padding * 4);
    return out;
}

template <class Value>
std::vector<Value> repeat_rows(const std::vector<Value>& rgba, std::int32_t width, std::int32_t height,
                               std::int32_t to_width) {
    std::vector<Value> out;
    if (rgba.empty()) return out;
    out.reserve((std::size_t(to_width) * std::size_t(height) + TexelSource::padding) * 4);
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < to_width; x += width) {
            const auto row = rgba.begin() + std::ptrdiff_t{y} * width * 4;
            out.insert(out.end(), row, row + std::ptrdiff_t{std::min(width, to_width - x)} * 4);
        }
    out.resize(out.size() + TexelSource::padding * 4);
    return out;
}

}  // namespace

TexelSource::TexelSource(const Rgb8Image& image)
    : width_{image.width}, height_{image.height}, codes_{with_alpha(image.bytes, std::uint8_t{255})} {}

TexelSource::TexelSource(const Rgb16Image& image)
    : width_{image.width}, height_{image.height}, steps_{with_alpha(image.values, std::uint16_t{65535})} {}

TexelSource TexelSource::repeated(std::int32_t to_width) const {
    TexelSource out;
    out.width_ = to_width;
    out.height_ = height_;
    out.codes_ = repeat_rows(codes_, width_, height_, to_width);
    out.steps_ = repeat_rows(steps_, width_, height_, to_width);
    return out;
}

}  // namespace tessera
