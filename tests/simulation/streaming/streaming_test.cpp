// What a user sees over a link, in virtual time: the client's policy against first in, first out.
#include <algorithm>
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/simulation/streaming/flight.h"

namespace tessera::testing {
namespace {

constexpr LinkSettings slow_link{.bytes_per_second = 20e6 / 8, .one_way_ms = 25};
constexpr LinkSettings fast_link{.bytes_per_second = 100e6 / 8, .one_way_ms = 10};

Camera standing() {
    return {.ground = {100'000'123, 90'000'456, 0.5, 0.25}, .height_texels = 750, .pitch_degrees = -25};
}

/// 90° a second for two seconds.
Flight turn(const LinkSettings& link) {
    return {.name = "turn 90 deg/s", .link = link, .camera = [](double seconds) {
                Camera camera = standing();
                camera.yaw_degrees = 90 * std::min(seconds, 2.0);
                return camera;
            }};
}

/// From nothing at all to one view.
Flight teleport(const LinkSettings& link) {
    return {
        .name = "teleport", .link = link, .camera = [](double) { return standing(); }, .moving_seconds = 0};
}

void print(const Flight& flight, const char* policy, const FlightResult& result) {
    std::printf(
        "%-14s %3.0f Mb/s %3.0f ms  %-9s deficit %5.2f  sharp %4.2f  sharp after %5.2f s  pages %4llu  late "
        "%3llu (%.1f %%)\n",
        flight.name.c_str(), flight.link.bytes_per_second * 8e-6, 2 * flight.link.one_way_ms, policy,
        result.mip_deficit, result.sharp_share, result.sharp_after_seconds,
        static_cast<unsigned long long>(result.pages_sent), static_cast<unsigned long long>(result.late),
        100 * result.late_share());
}

TEST(Streaming, AFastTurnOverASlowLinkStaysCoarselyRightAndWastesNothing) {
    const Flight flight = turn(slow_link);
    const FlightResult fifo = fly_first_in_first_out(flight), ours = fly(flight, {});
    print(flight, "fifo", fifo);
    print(flight, "ours", ours);
    EXPECT_LE(ours.mip_deficit, 1.7);
    EXPECT_LE(ours.late_share(), 0.02);
    EXPECT_LE(2 * ours.pages_sent, fifo.pages_sent);
    EXPECT_LT(ours.sharp_after_seconds, fifo.sharp_after_seconds / 2);
}

TEST(Streaming, AFastTurnOverAFastLinkIsSharperThanFirstInFirstOut) {
    const Flight flight = turn(fast_link);
    const FlightResult fifo = fly_first_in_first_out(flight), ours = fly(flight, {});
    print(flight, "fifo", fifo);
    print(flight, "ours", ours);
    EXPECT_LE(ours.mip_deficit, 0.6);
    EXPECT_LT(ours.mip_deficit, fifo.mip_deficit / 4);
    EXPECT_GT(ours.sharp_share, 0.85);
}

/// While nothing has come, all levels are missing: of how many there are, the figure tells as much as of the
/// client. With 2^20 texels a side they are 13, and not 21.
TEST(Streaming, AFastTurnOverAFastLinkIsSharpAlmostAtOnceWhereThereAreFewLevels) {
    Flight flight = turn(fast_link);
    flight.extent = Extent{12};
    const auto camera = flight.camera;
    flight.camera = [camera](double seconds) {
        Camera moved = camera(seconds);
        moved.ground.x = moved.ground.y = 1 << 19;
        return moved;
    };
    const FlightResult ours = fly(flight, {});
    print(flight, "ours, 13 levels", ours);
    EXPECT_LE(ours.mip_deficit, 0.35);
}

TEST(Streaming, AfterATeleportTheViewIsSharpAboutAsSoonAsTheLinkAllows) {
    for (const LinkSettings& link : {slow_link, fast_link}) {
        const Flight flight = teleport(link);
        const FlightResult fifo = fly_first_in_first_out(flight), ours = fly(flight, {});
        print(flight, "fifo", fifo);
        print(flight, "ours", ours);
        std::printf("%-14s the link allows %.2f s: ratio %.3f\n", "", ours.missing_seconds,
                    ours.sharp_after_seconds / ours.missing_seconds);
        EXPECT_LE(ours.sharp_after_seconds, 1.25 * ours.missing_seconds);
    }
}

}  // namespace
}  // namespace tessera::testing
