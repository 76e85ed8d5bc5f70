#include "server/texture/shapes.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_asset.h"

namespace tessera {
namespace {

class ShapesTest : public testing::TestWithParam<std::int32_t> {
  protected:
    const std::int32_t radius_ = GetParam();
    const ExchangeAsset asset_ =
        tests::make_synthetic_asset({.tile_side = 64, .patches = 12, .blend_texels = 2 * radius_});
    const Shapes shapes_{asset_, radius_};

    /// The weight of a shape at a texel of the torus.
    std::uint32_t weight(const Shapes::Shape& shape, std::int32_t x, std::int32_t y) const {
        const std::int32_t in_x = (x - shape.x) & 63, in_y = (y - shape.y) & 63;
        if (in_y >= shape.height) return 0;
        for (const Shapes::Segment& segment : shapes_.row(shape, in_y))
            if (in_x >= segment.begin && in_x < segment.end)
                return segment.weights == Shapes::Segment::all_one
                           ? Shapes::weight_one
                           : shapes_.weights(segment)[in_x - segment.begin];
        return 0;
    }
    bool covers(const Shapes::Shape& shape, std::int32_t x, std::int32_t y) const {
        const auto& patch = asset_.patches[shape.patch];
        const std::int32_t in_x = (x - patch.x) & 63, in_y = (y - patch.y) & 63;
        return in_x < patch.width && in_y < patch.height &&
               patch.contents[shape.content].shape.at(in_x, in_y);
    }
};

TEST_P(ShapesTest, AWeightIsTheShareOfTheShapeAround) {
    const std::int32_t window = (2 * radius_ + 1) * (2 * radius_ + 1);
    for (std::size_t s = 0; s < shapes_.size(); s += 5)
        for (std::int32_t y = 0; y < 64; ++y)
            for (std::int32_t x = 0; x < 64; ++x) {
                std::int32_t count = 0;
                for (std::int32_t v = -radius_; v <= radius_; ++v)
                    for (std::int32_t u = -radius_; u <= radius_; ++u)
                        count += covers(shapes_[s], x + u, y + v);
                ASSERT_EQ(weight(shapes_[s], x, y),
                          std::uint32_t(count) * Shapes::weight_one / std::uint32_t(window));
            }
}

TEST_P(ShapesTest, WeightsOfShapesThatAreShownTogetherNeverExceedOne) {
    // Content exchange: any content of one patch beside any of another
    for (std::int32_t y = 0; y < 64; ++y)
        for (std::int32_t x = 0; x < 64; ++x) {
            std::uint32_t sum = 0;
            for (std::size_t p = 0; p < shapes_.patch_count(); ++p) {
                std::uint32_t most = 0;
                for (std::uint32_t s = shapes_.first_of(p); s < shapes_.first_of(p + 1); ++s)
                    most = std::max(most, weight(shapes_[s], x, y));
                sum += most;
            }
            ASSERT_LE(sum, Shapes::weight_one) << x << ", " << y;
        }
}

TEST_P(ShapesTest, AShapeBeginsInItsTile) {
    int over = 0;
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
        EXPECT_GE(shapes_[s].x, 0);
        EXPECT_LT(shapes_[s].x, 64);
        over += shapes_[s].x + shapes_[s].width > 64;
    }
    EXPECT_GT(over, 0) << "the asset has no patch to test this with";
}

INSTANTIATE_TEST_SUITE_P(Radii, ShapesTest, testing::Values(0, 1, 4));

}  // namespace
}  // namespace tessera
