#include "shared/math/footprint.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Footprint, AxesOfAParallelogramAreItsSidesTheLongerOneFirst) {
    const Footprint footprint = footprint_around(1000, -7, {0.5, 0.25}, {1, 2}, {-8, 4});
    const FootprintAxes axes = axes_of(footprint);
    EXPECT_EQ(axes.centre, (TexelPoint{0.5, 0.25}));
    EXPECT_EQ(axes.major, (TexelPoint{-8, 4}));
    EXPECT_EQ(axes.minor, (TexelPoint{1, 2}));
    EXPECT_EQ(area_of(footprint), 20);
    EXPECT_FALSE(check_footprint(footprint).has_error());
}

TEST(Footprint, MayBeGivenEitherWayAround) {
    Footprint footprint = footprint_around(0, 0, {0, 0}, {3, 0}, {0, 2});
    std::swap(footprint.corners[1], footprint.corners[3]);
    EXPECT_EQ(area_of(footprint), 6);
    EXPECT_FALSE(check_footprint(footprint).has_error());
}

TEST(Footprint, WithoutAnyAreaIsAFootprint) {
    EXPECT_FALSE(check_footprint(Footprint{}).has_error());
    EXPECT_FALSE(check_footprint(footprint_around(0, 0, {0.1, 0.7}, {0.3, 1e9}, {0, 0})).has_error());
    // Three corners and a fourth on their side, off it by rounding alone
    EXPECT_FALSE(check_footprint({0, 0, {{{0, 0}, {0.1, 0.3}, {0.2, 0.6}, {0, 0.6}}}, 0}).has_error());
}

TEST(Footprint, RefusesWhatIsNotConvexAndNamesTheCorner) {
    const auto refusal = [](const Footprint& footprint) {
        const auto checked = check_footprint(footprint);
        return checked.has_error() ? checked.error().detail : std::string{};
    };
    EXPECT_NE(refusal({0, 0, {{{0, 0}, {4, 0}, {1, 1}, {0, 4}}}, 0}).find("convex"), std::string::npos);
    EXPECT_NE(refusal({0, 0, {{{0, 0}, {4, 0}, {0, 4}, {4, 4}}}, 0}).find("in order"), std::string::npos);
}

TEST(Footprint, RefusesWhatIsNotANumberOrTooFarOut) {
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -0x1p41}) {
        Footprint footprint = footprint_around(0, 0, {0, 0}, {1, 0}, {0, 1});
        footprint.corners[2].y = bad;
        const auto checked = check_footprint(footprint);
        ASSERT_TRUE(checked.has_error());
        EXPECT_NE(checked.error().detail.find("corner 2"), std::string::npos) << checked.error().detail;
    }
    EXPECT_TRUE(check_footprint({max_footprint_origin + 1, 0, {}, 0}).has_error());
    EXPECT_FALSE(check_footprint({max_footprint_origin, -max_footprint_origin, {}, 0}).has_error());
}

}  // namespace
}  // namespace tessera
