#include "server/quality/quiet_curves.h"

#include <gtest/gtest.h>

#include "server/quality/lab.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

template <class Paint>
Rgb8Image draw(std::int32_t side, const Paint& paint) {
    Rgb8Image out{side, side, {}};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            for (int channel = 0; channel < 3; ++channel)
                out.bytes.push_back(static_cast<std::uint8_t>(paint(x, y)));
    return out;
}

int noise(std::int32_t x, std::int32_t y) {
    return 60 + static_cast<int>(hash(3, stream("noise"), x, y) % 128);
}

Histogram curves_of(const Rgb8Image& exemplar, std::int32_t side) {
    SilentProgress silent;
    auto steps = steps_of_quiet_curves(exemplar, side, {silent, "measuring"});
    EXPECT_TRUE(steps);
    return std::move(*steps);
}

TEST(QuietCurves, AreTheShortestAroundTheHeartWhereAllIsQuiet) {
    const Histogram steps = curves_of(draw(128, [](auto, auto) { return 80; }), 60);
    EXPECT_EQ(steps.mean(), 0);
    EXPECT_EQ(steps.count(), 9U * 8U * 12U) << "nine squares of 24 texels";
}

TEST(QuietCurves, FollowTheGapsBetweenTiles) {
    // Lines of two texels, 16 apart; between them noise
    const Rgb8Image gaps =
        draw(128, [](std::int32_t x, std::int32_t y) { return x % 16 < 2 || y % 16 < 2 ? 40 : noise(x, y); });
    const Histogram steps = curves_of(gaps, 64);
    EXPECT_EQ(steps.mean(), 0);
    EXPECT_GT(steps.count(), 9U * 100U);
}

TEST(QuietCurves, PayInFullWhereNothingIsQuiet) {
    const Rgb8Image checker =
        draw(128, [](std::int32_t x, std::int32_t y) { return 80 + 40 * ((x + y) % 2); });
    const Histogram steps = curves_of(checker, 64);
    const std::uint8_t dark[] = {80, 80, 80}, light[] = {120, 120, 120};
    EXPECT_NEAR(steps.mean(), double(difference(dark, light)), 0.01);
    EXPECT_EQ(steps.count(), 9U * 8U * 12U);
}

TEST(QuietCurves, CannotAvoidTheStepsOfNoise) {
    const Rgb8Image image = draw(96, noise);
    const Histogram steps = curves_of(image, 32);
    EXPECT_GT(steps.mean(), 1);
    EXPECT_LT(steps.mean(), 12) << "a mean step of noise is 16 units";
}

TEST(QuietCurves, AreNoneWhereTheExemplarIsSmallerThanAPatch) {
    EXPECT_EQ(curves_of(draw(16, noise), 32).count(), 0U);
    EXPECT_EQ(curves_of(draw(16, noise), 4).count(), 0U);
}

TEST(QuietCurves, StopWhenAsked) {
    struct Stopped final : Progress {
        void advance(std::string_view, double) override {}
        void note(const std::string&) override {}
        std::stop_token stop() const override { return source.get_token(); }
        std::stop_source source;
    } stopped;
    stopped.source.request_stop();
    const auto steps = steps_of_quiet_curves(draw(64, noise), 32, {stopped, "measuring"});
    ASSERT_FALSE(steps);
    EXPECT_EQ(steps.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace tessera
