#include "shared/page/error_limit.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(ErrorLimit, IsReadAndWrittenInOneWay) {
    const struct {
        const char* text;
        std::uint32_t millionths;
        const char* written;
    } cases[] = {{"0", 0, "0"},
                 {"0.5", 500'000, "0.5"},
                 {"0.50", 500'000, "0.5"},
                 {"2.000000", 2'000'000, "2"},
                 {"0.000001", 1, "0.000001"},
                 {"255", 255'000'000, "255"},
                 {"10.25", 10'250'000, "10.25"}};
    for (const auto& [text, millionths, written] : cases) {
        const auto limit = error_limit_named(text);
        ASSERT_TRUE(limit) << text;
        EXPECT_EQ(limit->millionths, millionths) << text;
        EXPECT_EQ(text_of(*limit), written);
    }
}

TEST(ErrorLimit, RefusesAllElse) {
    for (const char* text : {"", ".", ".5", "1.", "-1", "+1", "01", "1e3", "nan", "inf", "0.0000001",
                             "255.000001", "256", "1000", "99999999999", "1.2.3", " 1", "1 ", "0x1"})
        EXPECT_FALSE(error_limit_named(text)) << text;
}

TEST(ErrorLimit, AllowsWhatIsAtMostAsLarge) {
    const ErrorLimit half = *error_limit_named("0.5");
    EXPECT_TRUE(half.allows(0.5));
    EXPECT_TRUE(half.allows(0));
    EXPECT_FALSE(half.allows(0.500001));
}

}  // namespace
}  // namespace tessera
