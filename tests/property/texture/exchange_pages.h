#pragma once

#include <gtest/gtest.h>

#include "server/texture/exchange.h"
#include "tests/support/synthetic_asset.h"

namespace tessera::tests {

inline LinearImage linear(const Texture& texture, const TexelRegion& region,
                          Accuracy accuracy = Accuracy::exact) {
    LinearImage image;
    EXPECT_TRUE(texture.evaluate(region, Budget{.accuracy = accuracy}, image).has_value());
    return image;
}

inline Rgba8Image codes(const Texture& texture, const TexelRegion& region) {
    Rgba8Image image;
    EXPECT_TRUE(texture.evaluate(region, Budget{.accuracy = Accuracy::exact}, image).has_value());
    return image;
}

/// The four texels below each texel, averaged.
inline TexelRegion below(const TexelRegion& region) {
    return {static_cast<std::uint8_t>(region.level - 1), region.x * 2, region.y * 2, region.width * 2,
            region.height * 2};
}

inline ExchangeAsset make_asset(ExchangeMethod method, const SyntheticAssetOptions& options) {
    switch (method) {
        case ExchangeMethod::interchange:
            return make_synthetic_interchange(options);
        case ExchangeMethod::wang:
            return make_synthetic_wang(options);
        case ExchangeMethod::content_exchange:
            break;
    }
    return make_synthetic_asset(options);
}

}  // namespace tessera::tests
