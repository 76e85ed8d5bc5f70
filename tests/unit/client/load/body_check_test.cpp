#include "client/load/body_check.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using Verdict = BodyCheck::Verdict;

TEST(BodyCheck, TellsHowAPageDiffersFromTheLastTimeItCame) {
    BodyCheck check;
    EXPECT_EQ(check.compare("/a", "\"1\"", "stones"), Verdict::first_seen);
    EXPECT_EQ(check.compare("/b", "\"1\"", "leaves"), Verdict::first_seen);
    EXPECT_EQ(check.compare("/a", "\"1\"", "stones"), Verdict::same);
    EXPECT_EQ(check.compare("/a", "\"1\"", "STONES"), Verdict::mismatch);
    EXPECT_EQ(check.compare("/a", "\"2\"", "stones"), Verdict::changed);
    EXPECT_EQ(check.compare("/a", "\"3\"", "stones"), Verdict::retagged);
    EXPECT_EQ(check.compare("/b", "\"1\"", "leaves"), Verdict::same);
}

TEST(BodyCheck, RemembersNoMoreThanItMay) {
    BodyCheck check{1};
    EXPECT_EQ(check.compare("/a", "", "x"), Verdict::first_seen);
    EXPECT_EQ(check.compare("/b", "", "x"), Verdict::no_room);
    EXPECT_EQ(check.compare("/a", "", "y"), Verdict::mismatch);
}

}  // namespace
}  // namespace tessera
