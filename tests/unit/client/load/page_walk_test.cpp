#include "client/load/page_walk.h"

#include <cstdlib>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "client/load/camera_walk.h"

namespace tessera {
namespace {

std::vector<LevelWeight> levels(std::string_view text, Extent extent) {
    return parse_level_weights(text, extent).value();
}

TEST(RandomWalk, AsksForLevelsByTheirWeightsAndForPagesAllOverThem) {
    const Extent extent{30};
    RandomWalk walk{extent, levels("0=6,28=3,30=1", extent), 7, 0};
    std::map<int, int> count;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> of_level_28;
    std::uint32_t furthest = 0;
    for (int i = 0; i < 10'000; ++i) {
        const PageKey page = walk.next();
        ASSERT_TRUE(extent.contains(page));
        ++count[page.level];
        if (page.level == 28) ++of_level_28[{page.x, page.y}];
        if (page.level == 0) furthest = std::max({furthest, page.x, page.y});
    }
    EXPECT_NEAR(count[0], 6000, 250);  // five standard deviations
    EXPECT_NEAR(count[28], 3000, 230);
    EXPECT_NEAR(count[30], 1000, 150);
    EXPECT_EQ(of_level_28.size(), 16u);
    for (const auto& [place, times] : of_level_28) EXPECT_NEAR(times, 3000 / 16, 70);
    EXPECT_GT(furthest, (1u << 30) - (1u << 22));
}

TEST(RandomWalk, StaysWithinItsWorkingSetAndIsTheSameForTheSameSeed) {
    const Extent extent{20};
    RandomWalk walk{extent, levels("", extent), 3, 50}, same{extent, levels("", extent), 3, 50},
        other{extent, levels("", extent), 4, 50};
    std::set<PageKey> pages;
    bool differs = false;
    for (int i = 0; i < 2000; ++i) {
        const PageKey page = walk.next();
        EXPECT_EQ(page, same.next());
        differs = differs || page != other.next();
        pages.insert(page);
    }
    EXPECT_LE(pages.size(), 50u);
    EXPECT_GT(pages.size(), 30u);  // coarse levels have few pages, so some are drawn twice
    EXPECT_TRUE(differs);
}

TEST(SweepWalk, GoesThroughNeighboursLevelByLevelAroundOnePlace) {
    const Extent extent{20};
    SweepWalk walk{extent, levels("0-2", extent), 5, 8};
    std::vector<PageKey> pages;
    for (int i = 0; i < 3 * 64; ++i) pages.push_back(walk.next());
    EXPECT_EQ(std::set<PageKey>(pages.begin(), pages.end()).size(), pages.size()) << "each page once";
    for (std::size_t i = 1; i < pages.size(); ++i) {
        const PageKey a = pages[i - 1], b = pages[i];
        if (a.level != b.level) {
            EXPECT_EQ(i % 64, 0u);
            EXPECT_EQ(b.level, a.level + 1);
            continue;
        }
        const auto step = std::abs(std::int64_t{a.x} - b.x) + std::abs(std::int64_t{a.y} - b.y);
        EXPECT_EQ(step, 1) << i;
    }
    // The squares of the levels lie over the same place
    const PageKey fine = pages[32 + 4], coarse = pages[128 + 32 + 4];
    EXPECT_LE(std::abs(std::int64_t{fine.x / 4} - coarse.x), 8);
    EXPECT_LE(std::abs(std::int64_t{fine.y / 4} - coarse.y), 8);
    EXPECT_EQ(walk.next().level, 0);
}

TEST(SweepWalk, StaysInsideSmallExtentsForEver) {
    for (std::uint8_t n = 0; n <= 4; ++n) {
        const Extent extent{n};
        SweepWalk walk{extent, levels("", extent), n, 5};
        std::set<PageKey> pages;
        for (int i = 0; i < 2000; ++i) {
            const PageKey page = walk.next();
            ASSERT_TRUE(extent.contains(page)) << int{page.level} << " " << page.x << " " << page.y;
            pages.insert(page);
        }
        EXPECT_TRUE(pages.contains(PageKey{n, 0, 0}));
    }
}

TEST(CameraWalk, AsksForEveryPageOfItsFramesOnceWhileItHoldsThem) {
    const Extent extent{20};
    const auto all = levels("", extent);
    CameraWalk walk{extent, all, generated_flight(extent, all, 1, 2, 10), {}};
    std::map<PageKey, int> times;
    std::set<int> seen_levels;
    for (int i = 0; i < 400; ++i) {
        const PageKey page = walk.next();
        ASSERT_TRUE(extent.contains(page));
        ++times[page];
        seen_levels.insert(page.level);
    }
    EXPECT_GT(seen_levels.size(), 3u);
    EXPECT_GT(times.size(), 100u);
}

TEST(CameraWalk, KeepsToItsLevelsAndNeverRunsDry) {
    const Extent extent{20};
    const auto fine = levels("0-1", extent);
    CameraWalk walk{extent, fine, {Camera{.ground = {1 << 20, 1 << 20}}}, {}};
    for (int i = 0; i < 500; ++i) EXPECT_LE(walk.next().level, 1);
    CameraWalk nothing{
        extent, levels("7", extent), {Camera{.ground = {1 << 20, 1 << 20}, .pitch_degrees = -90}}, {}};
    EXPECT_TRUE(extent.contains(nothing.next()));
}

TEST(CameraWalk, FliesTheSameWayForTheSameSeed) {
    const Extent extent{20};
    EXPECT_EQ(generated_flight(extent, levels("", extent), 9),
              generated_flight(extent, levels("", extent), 9));
    EXPECT_NE(generated_flight(extent, levels("", extent), 9),
              generated_flight(extent, levels("", extent), 10));
    for (const Camera& camera : generated_flight(Extent{0}, levels("", Extent{0}), 9)) {
        EXPECT_GE(camera.ground.x, 0);
        EXPECT_LT(camera.ground.x, 256);
    }
}

}  // namespace
}  // namespace tessera
