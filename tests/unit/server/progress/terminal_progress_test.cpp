#include "server/progress/terminal_progress.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(ProgressLine, ShowsStagePercentageAndRemainingTime) {
    EXPECT_EQ(progress_line("tile", 0.2, 16.25),
              "[######........................]  20 %  tile, 1 min 6 s left");
    EXPECT_EQ(progress_line("contents", 0.5, 10),
              "[###############...............]  50 %  contents, 11 s left");
    EXPECT_EQ(progress_line("writing", 1, 30), "[##############################] 100 %  writing, 1 s left");
}

TEST(ProgressLine, DoesNotGuessBeforeItCan) {
    EXPECT_EQ(progress_line("tile", 0.01, 3), "[..............................]   1 %  tile");
}

TEST(TerminalProgress, ElsewhereThanOnATerminalIsALineForEachStage) {
    testing::internal::CaptureStderr();
    {
        TerminalProgress progress{"tessera test", {{"first", 0.5}, {"second", 0.5}}, false, {}};
        for (const double fraction : {0.0, 0.5, 1.0}) progress.advance("first", fraction);
        progress.note("something was decided");
        progress.advance("one that nobody announced", 0.5);
        progress.advance("second", 0);
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              "tessera test: first\ntessera test: something was decided\n"
              "tessera test: one that nobody announced\ntessera test: second\n");
}

TEST(TerminalProgress, SaysNothingWhenQuiet) {
    testing::internal::CaptureStderr();
    {
        TerminalProgress progress{"tessera test", {{"first", 1}}, true, {}};
        progress.advance("first", 0.5);
        progress.note("something was decided");
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace tessera
