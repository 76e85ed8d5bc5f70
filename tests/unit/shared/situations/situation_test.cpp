#include "shared/situations/situation.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace tessera {
namespace {

/// Texels between two points, each from its own footprint's origin.
double gap(const Footprint& a, std::size_t corner_a, const Footprint& b, std::size_t corner_b) {
    const double x = static_cast<double>(a.x - b.x) + a.corners[corner_a].x - b.corners[corner_b].x;
    const double y = static_cast<double>(a.y - b.y) + a.corners[corner_a].y - b.corners[corner_b].y;
    return std::hypot(x, y);
}

TEST(Situations, EveryPixelThatSeesASurfaceWholeHasAConvexFootprint) {
    for (const Situation& situation : situations(160, 140)) {
        int measured = 0;
        for (std::int32_t py = 0; py < situation.height; ++py)
            for (std::int32_t px = 0; px < situation.width; ++px)
                if (const auto footprint = footprint_of(situation, px, py)) {
                    ++measured;
                    ASSERT_FALSE(check_footprint(*footprint).has_error())
                        << situation.name << ' ' << px << ' ' << py;
                    ASSERT_GT(area_of(*footprint), 0);
                }
        // Well over a third of each picture shows the texture
        EXPECT_GT(measured * 3, situation.width * situation.height) << situation.name;
    }
}

TEST(Situations, NeighbouringPixelsOfOneSurfaceShareTheirCorners) {
    for (const Situation& situation : situations(160, 140))
        for (std::int32_t py = 0; py < situation.height; ++py)
            for (std::int32_t px = 0; px + 1 < situation.width; ++px) {
                const auto here = footprint_of(situation, px, py), next = footprint_of(situation, px + 1, py);
                if (!here || !next || surface_at(situation, px, py) != surface_at(situation, px + 1, py))
                    continue;
                const double texels_away = std::abs(static_cast<double>(here->x)) + 1000;
                ASSERT_LT(gap(*here, 1, *next, 0), texels_away * 1e-9) << situation.name;
                ASSERT_LT(gap(*here, 2, *next, 3), texels_away * 1e-9) << situation.name;
            }
}

TEST(Situations, TheCorridorShowsItsFourSurfacesAndThePlanesTheirHorizon) {
    const auto all = situations(160, 140);
    ASSERT_EQ(all.size(), 3u);
    std::set<std::size_t> seen;
    for (std::int32_t py = 0; py < 140; ++py)
        for (std::int32_t px = 0; px < 160; ++px)
            if (const auto surface = surface_at(all[2], px, py)) seen.insert(*surface);
    EXPECT_EQ(seen.size(), 4u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_FALSE(surface_at(all[i], 80, 0)) << all[i].name;
        EXPECT_TRUE(surface_at(all[i], 80, 139)) << all[i].name;
    }
}

TEST(Situations, ReachFromMagnifiedTexelsToStronglyStretchedFootprints) {
    for (const Situation& situation : situations(800, 700)) {
        double least = 1e30, greatest_ratio = 0;
        for (std::int32_t py = 0; py < situation.height; py += 7)
            for (std::int32_t px = 0; px < situation.width; px += 7)
                if (const auto footprint = footprint_of(situation, px, py)) {
                    const FootprintAxes axes = axes_of(*footprint);
                    const double major = std::hypot(axes.major.x, axes.major.y);
                    least = std::min(least, area_of(*footprint));
                    greatest_ratio = std::max(greatest_ratio, major * major / area_of(*footprint));
                }
        EXPECT_LT(least, 9) << situation.name;
        EXPECT_GT(greatest_ratio, 30) << situation.name;
    }
}

}  // namespace
}  // namespace tessera
