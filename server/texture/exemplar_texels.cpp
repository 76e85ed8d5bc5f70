#include "server/texture/exemplar_texels.h"

#include <algorithm>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// The tile, repeated as far as a patch reaches over its border.
Rgb8Image repeated_tile(const ExchangeAsset& asset, std::int32_t radius) {
    std::int32_t reach = 0;
    for (const auto& patch : asset.patches) reach = std::max({reach, patch.width, patch.height});
    const std::int32_t side = asset.tile_side;
    Rgb8Image image{side + reach + 2 * radius, side + reach + 2 * radius, {}};
    image.bytes.reserve(std::size_t(image.width) * std::size_t(image.height) * 3);
    for (std::int32_t y = 0; y < image.height; ++y)
        for (std::int32_t x = 0; x < image.width; ++x) {
            const std::size_t from = (std::size_t(y % side) * std::size_t(side) + std::size_t(x % side)) * 3;
            image.bytes.insert(image.bytes.end(), asset.tile.bytes.begin() + std::ptrdiff_t(from),
                               asset.tile.bytes.begin() + std::ptrdiff_t(from) + 3);
        }
    return image;
}

}  // namespace

TexelSource::TexelSource(const Rgb8Image& image) : width{image.width}, height{image.height} {
    const std::size_t texels = std::size_t(width) * std::size_t(height);
    codes.resize((texels + padding) * 4);
    steps.resize((texels + padding) * 4);
    for (std::size_t i = 0; i < texels; ++i) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const std::uint8_t code = image.bytes[i * 3 + channel];
            codes[i * 4 + channel] = code;
            steps[i * 4 + channel] = srgb_to_steps[code];
        }
        codes[i * 4 + 3] = 255;
        steps[i * 4 + 3] = 65535;
    }
}

ExemplarTexels::ExemplarTexels(const ExchangeAsset& asset, std::int32_t radius)
    : tile_{repeated_tile(asset, radius)}, exemplar_{asset.exemplar} {
    const std::int32_t side = asset.tile_side;
    for (const auto& patch : asset.patches) {
        first_content_.push_back(static_cast<std::uint32_t>(contents_.size()));
        const std::int32_t x = (patch.x - radius) & (side - 1), y = (patch.y - radius) & (side - 1);
        contents_.push_back({&tile_, std::size_t(y) * std::size_t(tile_.width) + std::size_t(x)});
        for (const auto& [offset, shape, standing, corners] : patch.contents)
            contents_.push_back({&exemplar_, std::size_t(offset.y - radius) * std::size_t(exemplar_.width) +
                                                 std::size_t(offset.x - radius)});
    }
    first_content_.push_back(static_cast<std::uint32_t>(contents_.size()));
}

}  // namespace tessera
