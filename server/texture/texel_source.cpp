#include "server/texture/texel_source.h"

#include <algorithm>
#include <tuple>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// Lays out the source; `texel(i)` is a code and a step of channel i of the image.
template <class Channel>
void fill(TexelSource& source, const Channel& channel) {
    const std::size_t texels = std::size_t(source.width) * std::size_t(source.height);
    source.codes.resize((texels + TexelSource::padding) * 4);
    source.steps.resize((texels + TexelSource::padding) * 4);
    for (std::size_t i = 0; i < texels; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            std::tie(source.codes[i * 4 + c], source.steps[i * 4 + c]) = channel(i * 3 + c);
        source.codes[i * 4 + 3] = 255;
        source.steps[i * 4 + 3] = 65535;
    }
}

}  // namespace

TexelSource::TexelSource(const Rgb8Image& image) : width{image.width}, height{image.height} {
    fill(*this, [&](std::size_t i) { return std::tuple{image.bytes[i], srgb_to_steps[image.bytes[i]]}; });
}

TexelSource::TexelSource(const Rgb16Image& image) : width{image.width}, height{image.height} {
    fill(*this, [&](std::size_t i) {
        const std::uint32_t value = image.values[i];
        return std::tuple{static_cast<std::uint8_t>((value * 255 + 32767) / 65535), image.values[i]};
    });
}

TexelSource TexelSource::repeated(std::int32_t to_width) const {
    TexelSource out;
    out.width = to_width;
    out.height = height;
    const std::size_t values = (std::size_t(to_width) * std::size_t(height) + padding) * 4;
    out.codes.reserve(values);
    out.steps.reserve(values);
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < to_width; x += width) {
            const std::ptrdiff_t count = std::ptrdiff_t{std::min(width, to_width - x)} * 4;
            out.codes.insert(out.codes.end(), code_row(y), code_row(y) + count);
            out.steps.insert(out.steps.end(), step_row(y), step_row(y) + count);
        }
    out.codes.resize(values);
    out.steps.resize(values);
    return out;
}

}  // namespace tessera
