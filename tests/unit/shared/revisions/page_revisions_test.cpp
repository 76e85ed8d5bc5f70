#include "shared/revisions/page_revisions.h"

#include <limits>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(PageRevisions, AreZeroBeforeTheFirstEdit) {
    const PageRevisions revisions;
    EXPECT_EQ(revisions.of({0, 0, 0}, 16), 0u);
    EXPECT_EQ(revisions.of({30, 0, 0}, 16), 0u);
    EXPECT_EQ(revisions.used_bytes(), 0u);
}

TEST(PageRevisions, OneTexelTouchesOnePageOfEachLevelAndThoseWhoseGutterSeesIt) {
    PageRevisions revisions;
    revisions.mark({256 * 5, 256 * 9 + 100, 256 * 5 + 1, 256 * 9 + 101}, 3);
    EXPECT_EQ(revisions.of({0, 5, 9}, 0), 3u);
    EXPECT_EQ(revisions.of({0, 4, 9}, 0), 0u);
    EXPECT_EQ(revisions.of({0, 4, 9}, 1), 3u) << "its right gutter";
    EXPECT_EQ(revisions.of({0, 6, 9}, 16), 0u);
    for (std::uint8_t level = 0; level <= 20; ++level) {
        EXPECT_EQ(revisions.of({level, 5u >> level, 9u >> level}, 0), 3u);
        EXPECT_EQ(revisions.of({level, (5u >> level) + 2, 9u >> level}, 16), 0u);
    }
}

TEST(PageRevisions, ALaterEditElsewhereLeavesAPageAsItWas) {
    PageRevisions revisions;
    revisions.mark({0, 0, 64, 64}, 1);
    for (Revision revision = 2; revision < 2000; ++revision) {
        const auto x = static_cast<std::int64_t>(1024 + revision * 7);
        revisions.mark({x, 5, x + 64, 69}, revision);
        ASSERT_EQ(revisions.of({0, 0, 0}, 16), 1u);
        ASSERT_EQ(revisions.of({1, 0, 0}, 0), 1u);
    }
}

TEST(PageRevisions, SeeBeyondTheExtentAndNoFurtherThanAnyPage) {
    PageRevisions revisions;
    revisions.mark({-10, 5, -9, 6}, 1);
    EXPECT_EQ(revisions.of({0, 0, 0}, 9), 0u);
    EXPECT_EQ(revisions.of({0, 0, 0}, 10), 1u);
    constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
    constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
    revisions.mark({most - 1, most - 1, most, most}, 2);
    revisions.mark({least, least, least + 5, least + 5}, 3);
    EXPECT_EQ(revisions.of({30, 0, 0}, 16), 1u);
    revisions.mark({least, least, most, most}, 4);
    EXPECT_EQ(revisions.of({0, 4'000'000, 17}, 0), 4u);
    revisions.mark({7, 7, 7, 9}, 5);
    EXPECT_EQ(revisions.of({30, 0, 0}, 16), 4u) << "empty";
}

TEST(PageRevisions, ReachTheLastTexelOfTheLargestExtent) {
    PageRevisions revisions;
    const std::int64_t side = Extent{30}.side_texels();
    revisions.mark({side - 1, side - 1, side, side}, 8);
    const std::uint32_t last = Extent{30}.side_pages(0) - 1;
    EXPECT_EQ(revisions.of({0, last, last}, 0), 8u);
    EXPECT_EQ(revisions.of({0, last - 1, last}, 0), 0u);
    EXPECT_EQ(revisions.of({30, 0, 0}, 0), 8u);
}

TEST(PageRevisions, AnEditOfAllForgetsWhatLaysUnderIt) {
    PageRevisions revisions;
    for (std::int64_t i = 0; i < 1000; ++i) revisions.mark({i * 700, i * 300, i * 700 + 9, i * 300 + 9}, 1);
    const std::size_t before = revisions.used_bytes();
    revisions.mark({0, 0, 1 << 20, 1 << 20}, 2);
    EXPECT_LT(revisions.used_bytes(), before / 50);
    EXPECT_EQ(revisions.of({0, 3, 3}, 0), 2u);
}

TEST(PageRevisions, LoadOnlyWhatWasSaved) {
    PageRevisions revisions;
    for (std::int64_t i = 0; i < 50; ++i)
        revisions.mark({i * 7000, i * i * 300, i * 7000 + 90, i * i * 300 + 9}, 1);
    const std::string bytes = revisions.save();
    ASSERT_TRUE(PageRevisions::load(bytes, 1 << 20));
    EXPECT_FALSE(PageRevisions::load("", 1 << 20));
    for (std::size_t i = 0; i < bytes.size(); i += 7)
        EXPECT_FALSE(PageRevisions::load(std::string_view{bytes}.substr(0, i), 1 << 20)) << i;
    EXPECT_FALSE(PageRevisions::load(bytes + '\0', 1 << 20));
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string other = bytes;
        other[i] = static_cast<char>(other[i] ^ 0x55);
        const auto loaded = PageRevisions::load(other, 1 << 20);  // either answer, and no crash
        EXPECT_TRUE(!loaded || loaded->save() == other) << i;
    }
}

}  // namespace
}  // namespace tessera
