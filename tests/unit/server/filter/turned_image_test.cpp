#include "server/filter/turned_image.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "server/filter/turning.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

constexpr std::int32_t side = 12;

std::vector<std::uint16_t> noise() {
    std::vector<std::uint16_t> image;
    for (std::int64_t i = 0; i < side * side * 4; ++i)
        image.push_back(static_cast<std::uint16_t>(hash(3, stream("image"), i, 0) >> 48));
    return image;
}

/// By the parallelograms themselves.
std::vector<std::uint16_t> integrated(const ImagePlacement& at, std::int32_t row,
                                      const std::vector<std::uint16_t>& image) {
    FootprintTaps footprints{at.side, at.side};
    const Turning t = turning(at.turns);
    const double c = t.cosine / at.scale, s = t.sine / at.scale;
    std::vector<std::uint16_t> out;
    for (std::int32_t column = 0; column < at.width; ++column) {
        const double x = column - at.middle_x, y = row - at.middle_y;
        const Parallelogram footprint{
            0.5 * at.side + c * x + s * y, 0.5 * at.side - s * x + c * y, c, -s, s, c};
        for (std::size_t channel = 0; channel < 4; ++channel) {
            double sum = 0.5;
            for (const Tap& tap : footprints.of(footprint))
                sum += tap.weight * at.scale * at.scale *
                       image[static_cast<std::size_t>(tap.texel) * 4 + channel];
            out.push_back(static_cast<std::uint16_t>(std::min(sum, 65535.0)));
        }
    }
    return out;
}

TEST(TurnedImage, AlongTheAxesIsTheIntegralToo) {
    const std::vector<std::uint16_t> image = noise();
    for (const double scale : {1.0, 0.25, 4.0, 1.37})
        for (const double turns : {0.0, 0.25, 0.5, 0.75})
            for (const std::int32_t part : {1, 77, 128, 255}) {
                const std::int32_t square = bounding_side(side, scale, turns);
                const ImagePlacement at{.side = side,
                                        .scale = scale,
                                        .turns = turns,
                                        .width = square + 1,
                                        .middle_x = 0.5 * square + part / 256.0,
                                        .middle_y = 0.5 * square + (256 - part) / 256.0};
                TurnedImage turned{at};
                std::vector<std::uint16_t> row(static_cast<std::size_t>(at.width) * 4);
                for (std::int32_t y = 0; y < at.width; ++y) {
                    turned.set_row(y);
                    turned.sum(image.data(), row.data());
                    const auto expected = integrated(at, y, image);
                    ASSERT_EQ(row, expected) << scale << " turned by " << turns << ", " << part << ": " << y;
                }
            }
}

}  // namespace
}  // namespace tessera
