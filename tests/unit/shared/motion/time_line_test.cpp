#include "shared/motion/time_line.h"

#include <array>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(TimeLine, HoldsEachFrameForItsSteps) {
    const TimeLine line{std::array<std::uint32_t, 4>{3, 1, 5, 2}};
    EXPECT_EQ(line.frames(), 4);
    EXPECT_EQ(line.lead(), 2);
    EXPECT_EQ(line.run(), 9);
    const std::array<std::int32_t, 9> frames{0, 1, 2, 2, 2, 2, 2, 3, 3};
    for (std::int64_t position = 0; position < line.run(); ++position)
        EXPECT_EQ(line.frame_at(position), frames[static_cast<std::size_t>(position)]) << position;
    for (std::int32_t frame = 0; frame < 4; ++frame) {
        EXPECT_EQ(line.frame_at(line.begin_of(frame)), frame);
        EXPECT_EQ(line.frame_at(line.end_of(frame) - 1), frame);
    }
}

TEST(TimeLine, OfStepsOfOneIsThePapersSequence) {
    const TimeLine line{std::array<std::uint32_t, 5>{1, 1, 1, 1, 1}};
    EXPECT_EQ(line.run(), 5);
    EXPECT_EQ(line.lead(), 0);
    for (std::int32_t frame = 0; frame < 5; ++frame) EXPECT_EQ(line.frame_at(frame), frame);
}

}  // namespace
}  // namespace tessera
