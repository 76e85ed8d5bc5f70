// Animated pages change on time: the next interval's texels are asked for before this one ends, wait, and are
// swapped in whole.
#include <map>

#include <gtest/gtest.h>

#include "client/residency/residency.h"
#include "tests/simulation/simulated_stream.h"

namespace tessera {
namespace {

using testing::SimulatedStream;

constexpr Extent extent{20};

struct Player {
    explicit Player(Step interval, double bytes_per_second = 20e6)
        : stream{{.bytes_per_second = bytes_per_second, .one_way_ms = 25},
                 [](PageKey, std::uint32_t, std::uint64_t) { return std::string(slot_bytes, '\0'); }},
          residency{extent, stream, {}} {
        stream.interval = interval;
    }
    ResidencyFrame frame(double steps_per_second) {
        now += ClientTime{16};
        step = static_cast<Step>(static_cast<double>(now.count()) * steps_per_second / 1000);
        stream.advance(now);
        return residency.update({camera, 800, 700}, {now, step, steps_per_second});
    }
    SimulatedStream stream;
    Residency residency;
    Camera camera{.ground = {50'000'000, 60'000'000, 0.5, 0.5}, .height_texels = 700, .pitch_degrees = -50};
    ClientTime now{};
    Step step = 0;
};

TEST(AnimatedPages, AreThereWhenTheirIntervalBeginsAndAreAskedForOnce) {
    Player player{30};  // half a second at 60 steps a second
    for (int i = 0; i < 120; ++i) player.frame(60);
    std::size_t late = 0, swapped = 0;
    player.stream.asked.clear();
    const int frames = 600;
    for (int i = 0; i < frames; ++i) {
        const ResidencyFrame frame = player.frame(60);
        EXPECT_EQ(frame.missing, 0u);
        late += frame.stale;
        for (const SlotUpload& upload : frame.uploads) {
            EXPECT_TRUE(player.residency.versions().held(upload.page)->validity.holds(player.step))
                << "not before its time";
            ++swapped;
        }
    }
    const auto needed = needed_pages({player.camera, 800, 700}, extent, 0).size();
    EXPECT_GT(swapped, needed * 15);
    // 8 uploads a frame: some of the view's pages follow a frame or more later
    EXPECT_LE(static_cast<double>(late) / frames, 0.15 * static_cast<double>(needed));
    std::map<std::pair<PageKey, Step>, int> asked;
    for (const PageRequest& request : player.stream.asked)
        EXPECT_EQ(++(asked[{request.page, request.step / 30}]), 1);
}

TEST(AnimatedPages, OfACoarseClockStayAsTheyAre) {
    Player player{30};
    for (int i = 0; i < 120; ++i) player.frame(0);
    player.stream.asked.clear();
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(player.frame(0).is_current());
    EXPECT_TRUE(player.stream.asked.empty());
}

TEST(AnimatedPages, ThatChangeFasterThanTheyComeDoNotKeepTheRestOfTheViewBlurred) {
    constexpr double pages_a_second = 10;
    Player player{1, pages_a_second * 35'000};  // each of 60 steps a second is another
    const auto needed = static_cast<double>(needed_pages({player.camera, 800, 700}, extent, 0).size());
    int frames = 0;
    while (player.frame(60).missing > 0)
        // As if half of what comes were steps on the way, and of the rest each second page newer, not sharper
        ASSERT_LT(++frames, static_cast<int>(4 * needed / pages_a_second * 62.5));
    std::map<PageKey, int> asked;
    int again = 0;
    for (const PageRequest& request : player.stream.asked) again += ++asked[request.page] > 1 ? 1 : 0;
    EXPECT_GT(again, 0) << "meanwhile what is shown goes on";
}

}  // namespace
}  // namespace tessera
