#include "tests/support/synthetic_channels.h"

#include <utility>

#include "shared/math/hash.h"

namespace tessera::tests {
namespace {

template <class Code>
Rgb8Image painted(const Rgb8Image& like, const Code& code) {
    Rgb8Image image{like.width, like.height, {}};
    for (std::int32_t y = 0; y < image.height; ++y)
        for (std::int32_t x = 0; x < image.width; ++x)
            for (const std::uint8_t channel : Code3{code(x, y)}) image.bytes.push_back(channel);
    return image;
}

template <class Code>
void add(ExchangeAsset& asset, const std::string& name, const Code& code) {
    asset.channels.push_back({name, painted(asset.exemplar, code), painted(asset.tile, code)});
}

/// From − to + `spread`.
std::int32_t noise(std::uint64_t seed, std::uint64_t axis, std::int32_t x, std::int32_t y,
                   std::uint32_t spread) {
    return static_cast<std::int32_t>(uniform_below(hash(seed, stream("bump", axis), x, y), 2 * spread + 1)) -
           static_cast<std::int32_t>(spread);
}

}  // namespace

void add_flat_channel(ExchangeAsset& asset, const std::string& name, Code3 code) {
    add(asset, name, [&](std::int32_t, std::int32_t) { return code; });
}

void add_bumps(ExchangeAsset& asset, std::uint32_t steep, std::uint64_t seed) {
    add(asset, "normal", [&](std::int32_t x, std::int32_t y) {
        const std::int32_t right = noise(seed, 0, x / 3, y / 3, steep),
                           up = noise(seed, 1, x / 3, y / 3, steep);
        return Code3{static_cast<std::uint8_t>(128 + right), static_cast<std::uint8_t>(128 + up), 220};
    });
}

void add_grey_noise(ExchangeAsset& asset, const std::string& name, std::uint8_t from, std::uint8_t to) {
    add(asset, name, [&](std::int32_t x, std::int32_t y) {
        const auto above =
            uniform_below(hash(7, stream("grey", 0), x, y), static_cast<std::uint32_t>(to - from) + 1);
        const auto code = static_cast<std::uint8_t>(from + above);
        return Code3{code, code, code};
    });
}

void add_copy_of_albedo(ExchangeAsset& asset, const std::string& name) {
    asset.channels.push_back({name, asset.exemplar, asset.tile});
}

}  // namespace tessera::tests
