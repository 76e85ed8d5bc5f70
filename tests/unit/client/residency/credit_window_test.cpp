#include "client/residency/credit_window.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace std::chrono_literals;

/// A link that carries one page after the other, and a client that always wants more.
struct Link {
    double bytes_per_ms, round_trip_ms;
    std::size_t page_bytes = 35'000;

    void run(CreditWindow& window, int frames) {
        for (int frame = 0; frame < frames; ++frame) {
            now += 1000.0 / 60;
            const ClientTime at{std::lround(now)};
            window.frame(at);
            while (!under_way.empty() && under_way.front().second <= now) {
                window.arrived(under_way.front().first, page_bytes, at);
                under_way.pop_front();
            }
            while (under_way.size() < window.answers()) {
                free_at = std::max(free_at, now + round_trip_ms / 2) +
                          static_cast<double>(page_bytes) / bytes_per_ms;
                window.sent(next, at, true);
                under_way.emplace_back(next++, free_at + round_trip_ms / 2);
            }
        }
    }

    double now = 0, free_at = 0;
    std::uint32_t next = 1;
    std::deque<std::pair<std::uint32_t, double>> under_way{};
};

TEST(CreditWindow, HoldsWhatTheLinkCarriesInARoundTripAndAFrame) {
    for (const auto& [megabits, round_trip] :
         {std::pair{20.0, 50.0}, {100.0, 20.0}, {100.0, 100.0}, {5.0, 30.0}}) {
        CreditWindow window{4, 64};
        Link link{megabits * 125, round_trip};
        link.run(window, 600);
        const double pages = megabits * 125 * (round_trip + 17) / 35'000;
        EXPECT_GE(static_cast<double>(window.answers()), std::max(4.0, 0.9 * pages)) << megabits << " Mb/s";
        EXPECT_LE(static_cast<double>(window.answers()), std::max(4.0, 1.7 * pages + 3))
            << megabits << " Mb/s";
        EXPECT_NEAR(window.bytes_per_second() * 8e-6, megabits, 0.35 * megabits);
    }
}

TEST(CreditWindow, ShrinksWhenTheLinkSlowsDownAndGrowsWhenItIsFasterAgain) {
    CreditWindow window{4, 64};
    Link link{100 * 125, 40};
    link.run(window, 300);
    const std::size_t fast = window.answers();
    link.bytes_per_ms = 10 * 125;
    link.run(window, 600);
    EXPECT_LE(window.answers(), fast / 2);
    link.bytes_per_ms = 100 * 125;
    link.run(window, 600);
    EXPECT_GE(window.answers(), fast * 3 / 4);
}

TEST(CreditWindow, StaysWithinItsBounds) {
    CreditWindow window{4, 10};
    EXPECT_EQ(window.answers(), 8u) << "before anything is known";
    Link link{1e6, 100};
    link.run(window, 300);
    EXPECT_EQ(window.answers(), 10u);
    link.bytes_per_ms = 10;
    link.run(window, 2000);
    EXPECT_EQ(window.answers(), 4u);
    EXPECT_EQ((CreditWindow{4, 2}.answers()), 2u);
}

TEST(CreditWindow, IsNotMisledByPausesInWhichNothingIsWanted) {
    CreditWindow window{4, 64};
    Link link{100 * 125, 40};
    link.run(window, 300);
    const std::size_t before = window.answers();
    std::uint32_t id = 1'000'000;
    for (int i = 0; i < 100; ++i) {  // one page now and then
        const ClientTime at{10'000 + 500 * i};
        window.sent(id, at, false);
        window.arrived(id++, 35'000, at + 43ms);
        window.frame(at + 43ms);
    }
    EXPECT_GE(window.answers(), before * 3 / 4);
}

}  // namespace
}  // namespace tessera
