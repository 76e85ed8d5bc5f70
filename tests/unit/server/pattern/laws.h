#pragma once

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "server/texture/texture.h"

namespace tessera::testing {

inline LinearImage evaluated(const Texture& texture, const TexelRegion& region,
                             Accuracy accuracy = Accuracy::exact, Evaluation* evaluation = nullptr) {
    LinearImage image;
    const auto done = texture.evaluate(region, Budget{.accuracy = accuracy}, image);
    EXPECT_TRUE(done) << (done ? "" : done.error().detail);
    if (done && evaluation != nullptr) *evaluation = *done;
    return image;
}

inline TexelRegion below(const TexelRegion& r, int levels = 1) {
    return {static_cast<std::uint8_t>(r.level - levels),
            r.x * (std::int64_t{1} << levels),
            r.y * (std::int64_t{1} << levels),
            r.width << levels,
            r.height << levels,
            r.slice};
}

inline LinearImage reduced(const LinearImage& fine, int levels = 1) {
    const std::int32_t side = std::int32_t{1} << levels;
    LinearImage out{fine.width / side, fine.height / side};
    for (std::int32_t y = 0; y < out.height; ++y)
        for (std::int32_t x = 0; x < out.width; ++x)
            for (int c = 0; c < 4; ++c) {
                double sum = 0;
                for (std::int32_t b = 0; b < side; ++b)
                    for (std::int32_t a = 0; a < side; ++a)
                        sum += double{fine.row(y * side + b)[(x * side + a) * 4 + c]};
                out.row(y)[x * 4 + c] = static_cast<float>(sum / side / side);
            }
    return out;
}

/// In 8-bit codes of linear light.
inline double largest_difference(const LinearImage& a, const LinearImage& b) {
    EXPECT_EQ(a.values.size(), b.values.size());
    double most = 0;
    for (std::size_t i = 0; i < std::min(a.values.size(), b.values.size()); ++i)
        most = std::max(most, std::abs(double{a.values[i]} - double{b.values[i]}));
    return most / code_in_linear;
}

/// A region equals itself put together from two parts, to the last bit.
inline void expect_same_bytes_when_split(const Texture& texture, const TexelRegion& region, std::int32_t left,
                                         std::int32_t upper, Accuracy accuracy) {
    const LinearImage whole = evaluated(texture, region, accuracy);
    for (int part = 0; part < 4; ++part) {
        TexelRegion r = region;
        r.width = part % 2 == 0 ? left : region.width - left;
        r.height = part / 2 == 0 ? upper : region.height - upper;
        if (part % 2 == 1) r.x += left;
        if (part / 2 == 1) r.y += upper;
        const LinearImage image = evaluated(texture, r, accuracy);
        for (std::int32_t y = 0; y < r.height; ++y)
            ASSERT_TRUE(
                std::equal(image.row(y), image.row(y) + r.width * 4,
                           whole.row(static_cast<std::int32_t>(r.y - region.y) + y) + (r.x - region.x) * 4))
                << "part " << part << ", row " << y << ", level " << int(region.level);
    }
}

}  // namespace tessera::testing
