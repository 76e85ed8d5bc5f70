#include "shared/math/srgb.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Srgb, EveryCodeSurvivesTheWayToLinearAndBack) {
    for (int code = 0; code < 256; ++code)
        EXPECT_EQ(steps_to_srgb()[srgb_to_steps[static_cast<std::size_t>(code)]], code);
}

TEST(Srgb, AgreesWithTheFormulaOfTheStandard) {
    for (int code = 0; code < 256; ++code) {
        const double c = code / 255.0;
        const double linear = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
        EXPECT_NEAR(srgb_to_steps[static_cast<std::size_t>(code)], linear * 65535, 0.5001) << code;
    }
}

TEST(Srgb, RoundsToTheNearestCode) {
    for (int step = 0; step < 65536; step += 7) {
        const double linear = step / 65535.0;
        const double code =
            255 * (linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
        EXPECT_NEAR(steps_to_srgb()[static_cast<std::size_t>(step)], code, 0.501) << step;
    }
}

TEST(Srgb, ClampsWhatIsOutOfRange) {
    EXPECT_EQ(to_steps(-1.0F), 0);
    EXPECT_EQ(to_steps(2.0F), 65535);
    EXPECT_EQ(to_steps(NAN), 0);
    EXPECT_EQ(to_steps(1.0F), 65535);
}

}  // namespace
}  // namespace tessera
