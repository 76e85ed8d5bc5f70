// What an edit costs: exactly the resident dirty pages that are seen, once each; the others when they are
// seen again.
#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "client/residency/residency.h"
#include "tests/simulation/simulated_stream.h"

namespace tessera {
namespace {

using testing::SimulatedStream;

constexpr Extent extent{20};

/// A client that looks at one place over a link of 20 ms there and back.
class Client {
  public:
    Client()
        : stream{{.one_way_ms = 10},
                 [](PageKey, std::uint32_t, std::uint64_t) { return std::string(slot_bytes, '\0'); }},
          residency{extent, stream, {}} {
        look(0);
        settle();
    }

    ResidencyFrame frame() {
        now += ClientTime{16};
        stream.advance(now);
        return residency.update(view(), now);
    }
    int settle() {
        for (int frames = 0;; ++frames)
            if (const ResidencyFrame f = frame();
                (f.is_current() && residency.requests().in_flight() == 0) || frames > 500)
                return frames;
    }
    void look(double yaw) { camera.yaw_degrees = yaw; }
    PlaneView view() const { return {camera, 800, 700}; }
    std::set<PageKey> seen() const {
        std::set<PageKey> keys;
        for (const NeededPage& page : needed_pages(view(), extent, 0)) keys.insert(page.key);
        return keys;
    }

    SimulatedStream stream;
    Residency residency;
    Camera camera{.ground = {50'000'000, 60'000'000, 0.5, 0.5}, .height_texels = 700, .pitch_degrees = -35};
    ClientTime now{};
};

/// The pages that a square of level-0 texels touches, on all levels.
std::vector<PageKey> pages_of(std::int64_t x, std::int64_t y, std::int64_t side) {
    std::vector<PageKey> pages;
    for (std::uint8_t level = 0; level <= extent.n; ++level)
        for (std::int64_t row = y >> (8 + level); row <= (y + side - 1) >> (8 + level); ++row)
            for (std::int64_t column = x >> (8 + level); column <= (x + side - 1) >> (8 + level); ++column)
                pages.push_back({level, static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row)});
    return pages;
}

TEST(AnEdit, RefetchesExactlyTheResidentDirtyPagesThatAreSeenAndAtMostFourOfALevel) {
    Client client;
    std::mt19937 random{23};
    int refetched = 0;
    for (int round = 0; round < 60; ++round) {
        // A sprite of at most 248 texels that moves by a few: the square around both places
        const PlanePoint at = client.camera.ground.moved(static_cast<double>(random() % 1600) - 800.0,
                                                         -400.0 - static_cast<double>(random() % 1500));
        const std::vector<PageKey> dirty =
            pages_of(at.x, at.y, 240 + static_cast<std::int64_t>(random() % 16));
        std::set<PageKey> expected;
        for (const PageKey page : dirty)
            if (client.residency.cache().find(page) && client.seen().contains(page)) expected.insert(page);
        client.stream.asked.clear();
        client.stream.edit(dirty);
        client.frame();
        const int frames = client.settle();
        EXPECT_LE(frames, 6) << "a round trip and a frame or two";
        std::multiset<PageKey> asked;
        std::map<int, int> of_level;
        for (const PageRequest& request : client.stream.asked) {
            asked.insert(request.page);
            ++of_level[request.page.level];
            EXPECT_EQ(request.least_revision, client.stream.scene_revision());
        }
        EXPECT_EQ(std::vector(asked.begin(), asked.end()), std::vector(expected.begin(), expected.end()))
            << "round " << round;
        for (const auto& [level, count] : of_level) EXPECT_LE(count, 4) << "level " << level;
        for (const PageKey page : expected)
            EXPECT_EQ(client.residency.versions().held(page)->revision, client.stream.scene_revision());
        refetched += static_cast<int>(expected.size());
    }
    EXPECT_GT(refetched, 60);
    EXPECT_EQ(client.stream.duplicate_requests, 0u);
}

TEST(AnEdit, OfPagesThatAreResidentAndOutOfSightCostsNothingUntilTheyAreSeen) {
    Client client;
    client.look(180);
    client.settle();
    const std::set<PageKey> behind = client.seen();
    client.look(0);
    client.settle();
    std::vector<PageKey> dirty;
    for (const PageKey page : behind)
        if (!client.seen().contains(page)) dirty.push_back(page);
    ASSERT_GT(dirty.size(), 8u);
    client.stream.asked.clear();
    client.stream.edit(dirty);
    client.frame();
    client.settle();
    EXPECT_TRUE(client.stream.asked.empty());
    client.look(180);
    client.settle();
    std::set<PageKey> asked;
    for (const PageRequest& request : client.stream.asked) EXPECT_TRUE(asked.insert(request.page).second);
    EXPECT_EQ(asked, std::set(dirty.begin(), dirty.end()));
}

TEST(AnEdit, AfterABreakThatTheServerRemembersOnlyWhatChangedIsFetchedAgain) {
    Client client;
    const std::vector<PageKey> dirty = pages_of(client.camera.ground.x, client.camera.ground.y - 900, 200);
    std::set<PageKey> expected;
    for (const PageKey page : dirty)
        if (client.seen().contains(page)) expected.insert(page);
    ASSERT_FALSE(expected.empty());
    client.stream.asked.clear();
    client.stream.disconnect(500, true);
    client.stream.edit(dirty);
    for (int i = 0; i < 60; ++i) client.frame();
    client.settle();
    std::set<PageKey> asked;
    for (const PageRequest& request : client.stream.asked) asked.insert(request.page);
    EXPECT_EQ(asked, expected);
}

TEST(AnEdit, OfWhichNobodyKnowsAnythingMakesAllThatIsSeenBeAskedForAgain) {
    Client client;
    client.stream.edit({});
    client.stream.asked.clear();
    client.stream.disconnect(500, false);
    client.stream.edit({*client.seen().begin()});
    for (int i = 0; i < 60; ++i) client.frame();
    client.settle();
    std::set<PageKey> asked;
    for (const PageRequest& request : client.stream.asked) asked.insert(request.page);
    EXPECT_EQ(asked, client.seen());
    for (const PageRequest& request : client.stream.asked)
        EXPECT_EQ(request.least_revision, client.stream.scene_revision());
}

TEST(AnEdit, StaysInvisibleUntilItsPagesAreThereAndNeverLeavesAHole) {
    Client client;
    const std::set<PageKey> seen = client.seen();
    client.stream.edit({seen.begin(), seen.end()});
    std::size_t swapped = 0;
    for (int i = 0; i < 200; ++i) {
        const ResidencyFrame frame = client.frame();
        EXPECT_EQ(frame.missing, 0u) << "the old version stays";
        EXPECT_EQ(frame.resident_share, 1);
        for (const SlotUpload& upload : frame.uploads) {
            EXPECT_EQ(client.residency.cache().find(upload.page), upload.slot) << "in place, in one piece";
            ++swapped;
        }
    }
    EXPECT_EQ(swapped, seen.size());
}

}  // namespace
}  // namespace tessera
