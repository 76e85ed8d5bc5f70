#include "client/load/level_weights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(LevelWeights, ReadsLevelsRangesAndWeights) {
    const Extent extent{8};
    EXPECT_THAT(parse_level_weights("3", extent).value(), ElementsAre(LevelWeight{3, 1}));
    EXPECT_THAT(parse_level_weights("0-2", extent).value(),
                ElementsAre(LevelWeight{0, 1}, LevelWeight{1, 1}, LevelWeight{2, 1}));
    EXPECT_THAT(parse_level_weights("7-8=2,0=5", extent).value(),
                ElementsAre(LevelWeight{0, 5}, LevelWeight{7, 2}, LevelWeight{8, 2}));
    EXPECT_EQ(parse_level_weights("", extent).value().size(), 9u);
}

TEST(LevelWeights, SaysWhatIsWrong) {
    const auto problem = [](std::string_view text) {
        const auto parsed = parse_level_weights(text, Extent{8});
        EXPECT_FALSE(parsed) << text;
        return parsed ? std::string{} : parsed.error().detail;
    };
    EXPECT_THAT(problem("9"), HasSubstr("coarsest level is 8"));
    EXPECT_THAT(problem("5-2"), HasSubstr("finer"));
    EXPECT_THAT(problem("0-3,2"), HasSubstr("level 2 is named twice"));
    EXPECT_THAT(problem("0=0"), HasSubstr("weight"));
    EXPECT_THAT(problem("x"), HasSubstr("write a level"));
    EXPECT_THAT(problem("-1"), HasSubstr("write a level"));
    EXPECT_THAT(problem("0-"), HasSubstr("write a level"));
    EXPECT_THAT(problem("0-4000000000"), HasSubstr("coarsest"));
}

}  // namespace
}  // namespace tessera
