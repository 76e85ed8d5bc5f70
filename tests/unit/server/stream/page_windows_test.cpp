#include "server/stream/page_windows.h"

#include <gtest/gtest.h>

#include "shared/math/hash.h"

namespace tessera {
namespace {

using Asked = PageWindows::Asked;

/// What take_stale() must find, page by page.
std::vector<ChangedPage> stale_one_by_one(const std::vector<Asked>& windows, const PageRevisions& revisions,
                                          Revision told) {
    std::vector<ChangedPage> stale;
    for (const Asked& window : windows)
        for (std::int64_t x = window.x0; x < window.x1; ++x)
            for (std::int64_t y = window.y0; y < window.y1; ++y) {
                const PageKey key{static_cast<std::uint8_t>(window.level), static_cast<std::uint32_t>(x),
                                  static_cast<std::uint32_t>(y)};
                const Revision revision = revisions.of(key, max_gutter_texels);
                if (revision > told) stale.push_back({key, revision});
            }
    std::sort(stale.begin(), stale.end(),
              [](const ChangedPage& a, const ChangedPage& b) { return a.key < b.key; });
    return stale;
}

TEST(PageWindows, FindExactlyThePagesThatEditsTouched) {
    PageRevisions revisions;
    PageWindows windows{64, 16384};
    const std::vector<Asked> asked{{0, 10, 20, 42, 39}, {3, 0, 0, 9, 7}, {7, 0, 0, 1, 1}};
    ASSERT_TRUE(windows.replace(asked, Extent{12}, std::nullopt, 0));
    for (Revision revision = 1; revision <= 200; ++revision) {
        const auto n = static_cast<std::int64_t>(revision);
        const auto draw = [&](std::uint64_t what, std::int64_t below) {
            return static_cast<std::int64_t>(hash(3, what, n, 0)) % below;
        };
        const std::int64_t x = std::abs(draw(1, 20000)), y = std::abs(draw(2, 20000));
        revisions.mark({x, y, x + 1 + std::abs(draw(3, 600)), y + 1 + std::abs(draw(4, 600))}, revision);
        if (revision % 7 != 0) continue;  // several are told as one
        EXPECT_EQ(windows.take_stale(revisions, revision), stale_one_by_one(asked, revisions, revision - 7));
        EXPECT_TRUE(windows.take_stale(revisions, revision).empty());
    }
}

TEST(PageWindows, ThatOverlapTellAPageOnce) {
    PageRevisions revisions;
    PageWindows windows{64, 16384};
    ASSERT_TRUE(windows.replace({{0, 0, 0, 4, 4}, {0, 2, 2, 6, 6}}, Extent{12}, std::nullopt, 0));
    revisions.mark({700, 700, 701, 701}, 1);
    EXPECT_EQ(windows.take_stale(revisions, 1), (std::vector<ChangedPage>{{{0, 2, 2}, 1}}));
}

TEST(PageWindows, ThatMoveTellWhatWasNotToldYet) {
    PageRevisions revisions;
    PageWindows windows{64, 16384};
    ASSERT_TRUE(windows.replace({{0, 0, 0, 4, 4}}, Extent{12}, std::nullopt, 0));
    revisions.mark({700, 700, 701, 701}, 1);
    // The client moves before it has heard of the edit
    ASSERT_TRUE(windows.replace({{0, 1, 1, 5, 5}}, Extent{12}, std::nullopt, 1));
    EXPECT_EQ(windows.take_stale(revisions, 1).size(), 1u);
    // One that is elsewhere and has nothing is told nothing old
    ASSERT_TRUE(windows.replace({{0, 2, 0, 3, 2}}, Extent{12}, std::nullopt, 1));
    EXPECT_TRUE(windows.take_stale(revisions, 1).empty());
    // and one that has pages of revision 0 is told
    ASSERT_TRUE(windows.replace({{0, 2, 2, 3, 3}}, Extent{12}, 0, 1));
    EXPECT_EQ(windows.take_stale(revisions, 1).size(), 1u);
    // A revision from nowhere is the present one
    ASSERT_TRUE(windows.replace({{0, 2, 2, 3, 3}}, Extent{12}, 99, 1));
    revisions.mark({700, 700, 701, 701}, 2);
    EXPECT_EQ(windows.take_stale(revisions, 2).size(), 1u);
}

TEST(PageWindows, AreCutToTheExtentAndToTheirLimits) {
    PageWindows windows{2, 100};
    constexpr std::int64_t far = std::int64_t{1} << 62;
    ASSERT_TRUE(windows.replace({{0, -far, -5, 3, 2}, {40, 0, 0, 1, 1}}, Extent{4}, std::nullopt, 0));
    ASSERT_EQ(windows.windows().size(), 1u);
    EXPECT_EQ(windows.windows()[0].pages(), 6u);
    ASSERT_TRUE(windows.replace({{2, -far, -far, far, far}, {1, 3, 3, 3, 9}}, Extent{4}, std::nullopt, 0));
    ASSERT_EQ(windows.windows().size(), 1u);
    EXPECT_EQ(windows.windows()[0].pages(), 16u);
    EXPECT_FALSE(windows.replace({{0, 0, 0, 16, 16}}, Extent{4}, std::nullopt, 0));
    EXPECT_FALSE(windows.replace({{0, -far, -far, far, far}}, Extent{30}, std::nullopt, 0));
    EXPECT_FALSE(windows.replace({{}, {}, {}}, Extent{4}, std::nullopt, 0));
    EXPECT_EQ(windows.windows()[0].pages(), 16u) << "a refused message changes nothing";
}

}  // namespace
}  // namespace tessera
