#include "client/residency/residency.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/unit/client/residency/fake_page_source.h"

namespace tessera {
namespace {

using testing::FakePageSource;
using namespace std::chrono_literals;

Camera camera_at(std::int64_t x, std::int64_t y, double height = 600, double pitch = -30) {
    return {.ground = {x, y, 0.25, 0.5}, .height_texels = height, .yaw_degrees = 20, .pitch_degrees = pitch};
}

TEST(Residency, BecomesSharpWithinABoundedNumberInFlight) {
    FakePageSource source{testing::blank_page};
    source.deliver_at_once = 5;
    Residency residency{Extent{20}, source, {}};
    const PlaneView view{camera_at(5'000'000, 7'000'000), 800, 700};
    int frames = 0;
    while (!residency.update(view, ClientTime{16 * frames}).is_sharp()) ASSERT_LT(++frames, 200);
    const ResidencyFrame frame = residency.update(view, ClientTime{16 * frames});
    EXPECT_EQ(frame.resident_share, 1);
    EXPECT_EQ(frame.mip_deficit, 0);
    EXPECT_LE(source.most_under_way, residency.settings().requests.in_flight);
    EXPECT_EQ(source.duplicate_requests, 0);
    EXPECT_LE(source.asked.size(), 2 * frame.needed) << "steps on the way cost something, not a multiple";
}

TEST(Residency, AsksForTheCoarsestPageFirstAndForNothingOutsideTheExtent) {
    const Extent extent{14};
    FakePageSource source{testing::blank_page};
    Residency residency{extent, source, {}};
    for (int frame = 0; frame < 300; ++frame) {
        const std::int64_t corner = frame % 100 < 50 ? 0 : extent.side_texels() - 1;
        residency.update(PlaneView{camera_at(corner, corner, 3000, -20), 800, 700}, ClientTime{16 * frame});
    }
    ASSERT_FALSE(source.asked.empty());
    EXPECT_EQ(source.asked.front(), (PageKey{14, 0, 0}));
    for (const PageKey page : source.asked) EXPECT_TRUE(extent.contains(page));
}

TEST(Residency, ShowsSomethingForEveryPageOnceTheCoarsestHasCome) {
    FakePageSource source{testing::blank_page};
    source.deliver_at_once = 2;
    Residency residency{Extent{16}, source, {.slots = 96}};
    std::mt19937 random{5};
    for (int frame = 0; frame < 400; ++frame) {
        const auto anywhere = [&] { return static_cast<std::int64_t>(random() % (1u << 24)); };
        static Camera camera;
        if (frame % 20 == 0)
            camera = camera_at(anywhere(), anywhere(), 300 + int(random() % 5000), -10 - int(random() % 70));
        const PlaneView view{camera, 800, 700};
        const ResidencyFrame outcome = residency.update(view, ClientTime{16 * frame});
        if (frame < 20) continue;
        for (const NeededPage& page : needed_pages(view, Extent{16}, outcome.lod_bias))
            ASSERT_TRUE(residency.table().shown_for(page.key));
        ASSERT_LE(residency.cache().size(), 96u);
    }
    EXPECT_GT(residency.cache().evictions(), 100u);
}

/// Many columns read pages that lie far outside of their level's window: shaders/pages.glsl looks them up in
/// a coarser one then, whose page has to be there.
TEST(Residency, BringsWhatIsReadFromCoarserWindows) {
    FakePageSource source{testing::blank_page};
    source.deliver_at_once = 100;
    Residency residency{Extent{20}, source, {.slots = 4096, .uploads_per_frame = 500}};
    const Sampling sampling{Sampling::Kind::line_integral, 1, 24};
    const PlaneView view{camera_at(5'000'000, 7'000'000, 600, -10), 800, 700};
    ResidencyFrame frame;
    for (int i = 0; i == 0 || !frame.is_sharp(); ++i) {
        ASSERT_LT(i, 400);
        frame = residency.update(view, ClientTime{16 * i}, sampling);
    }
    EXPECT_EQ(frame.lod_bias, 0);
    int beyond = 0;
    for (const NeededPage& page : needed_pages(view, Extent{20}, 0, sampling)) {
        const PageKey centre = residency.table().centre_page(page.key.level);
        const auto away = [](std::uint32_t to, std::uint32_t from) {
            return std::abs(static_cast<double>(to) - static_cast<double>(from) + 0.5) + 0.5;
        };
        const double x = away(page.key.x, centre.x), y = away(page.key.y, centre.y);
        const int above = std::max(0, std::ilogb(std::max(x, y) / 15) + 1);
        PageKey read = page.key;
        for (int i = 0; i < above; ++i) read = parent(read);
        const auto shown = residency.table().shown_for(read);
        ASSERT_TRUE(shown);
        EXPECT_EQ(shown->level, read.level);
        beyond += above > 0 ? 1 : 0;
    }
    EXPECT_GT(beyond, 300);
}

TEST(Residency, BlursInsteadOfThrashingWhereTheCacheIsTooSmall) {
    FakePageSource source{testing::blank_page};
    Residency residency{Extent{20}, source, {.slots = 40}};
    const PlaneView view{camera_at(5'000'000, 7'000'000, 1400, -25), 1100, 900};
    ResidencyFrame frame;
    for (int i = 0; i < 200; ++i) frame = residency.update(view, ClientTime{16 * i});
    EXPECT_TRUE(frame.is_sharp());
    EXPECT_GT(frame.lod_bias, 0);
    const std::size_t asked = source.asked.size();
    for (int i = 200; i < 400; ++i) frame = residency.update(view, ClientTime{16 * i});
    EXPECT_LE(source.asked.size() - asked, 0u) << "at rest nothing is fetched again";
}

TEST(Residency, ShrinksLiveFrom512SlotsTo64AndFetchesNothingAgainAtRest) {
    FakePageSource source{testing::blank_page};
    Residency residency{Extent{20}, source, {}};
    const PlaneView view{camera_at(5'000'000, 7'000'000, 900, -20), 1000, 800};
    const Sampling sampling{Sampling::Kind::anisotropic};
    ClientTime now{};
    const auto frames = [&](int count) {
        ResidencyFrame frame;
        for (int i = 0; i < count; ++i) frame = residency.update(view, now += 16ms, sampling);
        return frame;
    };
    EXPECT_EQ(frames(100).lod_bias, 0);
    const std::size_t before = source.asked.size();
    const SlotCache::Resized resized = residency.resize(64);
    EXPECT_EQ(residency.cache().capacity(), 64u);
    EXPECT_GT(resized.dropped.size(), 50u);
    const ResidencyFrame small = frames(100);
    EXPECT_TRUE(small.is_sharp());
    EXPECT_GT(small.lod_bias, 0);
    const std::size_t after = source.asked.size();
    EXPECT_LE(after - before, 64u);
    frames(200);
    EXPECT_EQ(source.asked.size(), after);
    residency.resize(512);
    const ResidencyFrame large = frames(200);
    EXPECT_TRUE(large.is_sharp());
    EXPECT_EQ(large.lod_bias, 0);
}

TEST(Residency, WatchesWhatIsSeenAndItsAncestorsAndNotAnewWithEachStepOfTheCamera) {
    class Watcher : public FakePageSource {
      public:
        Watcher() : FakePageSource{testing::blank_page} {}
        void watch(std::span<const PageWindow> now, std::uint64_t) override {
            windows.assign(now.begin(), now.end());
            ++times;
        }
        std::vector<PageWindow> windows;
        int times = 0;
    } source;
    Residency residency{Extent{20}, source, {}};
    for (int i = 0; i < 200; ++i) {
        const PlaneView view{camera_at(5'000'000 + 64 * i, 7'000'000), 800, 700};
        residency.update(view, ClientTime{16 * i});
        std::uint64_t pages = 0;
        for (const PageWindow& window : source.windows) {
            pages += std::uint64_t{window.right - window.left} * (window.bottom - window.top);
            EXPECT_LE(window.right, Extent{20}.side_pages(window.level));
            EXPECT_LE(window.bottom, Extent{20}.side_pages(window.level));
        }
        EXPECT_LE(pages, 8000u);
        for (const NeededPage& page : needed_pages(view, Extent{20}, 0))
            for (PageKey at = page.key; at.level < 20; at = parent(at)) {
                const auto holds = [&](const PageWindow& window) { return window.contains(at); };
                EXPECT_TRUE(std::ranges::any_of(source.windows, holds));
            }
    }
    EXPECT_LE(source.times, 40) << "50 pages of level 0";
}

TEST(Residency, FetchesNothingAgainAfterLookingAwayAndBack) {
    FakePageSource source{testing::blank_page};
    Residency residency{Extent{20}, source, {}};
    const auto look = [&](double yaw) {
        Camera camera = camera_at(5'000'000, 7'000'000);
        camera.yaw_degrees = yaw;
        for (int i = 0; i < 60; ++i) residency.update(PlaneView{camera, 800, 700}, 0ms);
    };
    look(0);
    look(120);
    const std::size_t asked = source.asked.size();
    look(0);
    EXPECT_EQ(source.asked.size(), asked);
}

}  // namespace
}  // namespace tessera
