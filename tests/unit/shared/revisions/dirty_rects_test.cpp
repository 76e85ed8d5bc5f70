#include "shared/revisions/dirty_rects.h"

#include <random>

#include <gtest/gtest.h>

namespace tessera::detail {
namespace {

/// As the tree does where it cannot go to smaller cells.
void add(DirtyRects& rects, const DirtyRect& rect) {
    rects.add(rect);
    while (rects.crowded()) rects.join_two();
}

Revision newest_at(const DirtyRects& rects, std::uint32_t x, std::uint32_t y) {
    Revision newest = 0;
    for (const DirtyRect& rect : rects.rects()) {
        if (rect.contains({x, y, x, y, 0})) newest = std::max(newest, rect.revision);
    }
    return newest;
}

TEST(DirtyRects, WhatLiesUnderANewerOneIsGone) {
    DirtyRects rects;
    rects.add({10, 10, 20, 20, 1});
    rects.add({10, 10, 20, 20, 2});
    EXPECT_EQ(rects.rects(), (std::vector<DirtyRect>{{10, 10, 20, 20, 2}}));
    rects.add({0, 15, 30, 30, 3});
    EXPECT_EQ(rects.rects(), (std::vector<DirtyRect>{{10, 10, 20, 14, 2}, {0, 15, 30, 30, 3}}));
    rects.add({12, 0, 40, 40, 4});
    EXPECT_EQ(rects.rects(),
              (std::vector<DirtyRect>{{10, 10, 11, 14, 2}, {0, 15, 11, 30, 3}, {12, 0, 40, 40, 4}}));
}

TEST(DirtyRects, AnOlderOneUnderANewerOneAddsNothing) {
    DirtyRects rects;
    rects.add({0, 0, 100, 100, 7});
    rects.add({5, 5, 6, 6, 3});
    EXPECT_EQ(rects.rects().size(), 1u);
}

TEST(DirtyRects, AFifthJoinsThoseThatMakeTheLeastAreaNewer) {
    DirtyRects rects;
    add(rects, {0, 0, 9, 9, 1});
    add(rects, {12, 0, 21, 9, 2});  // a narrow gap to the first
    add(rects, {0, 500, 9, 509, 3});
    add(rects, {500, 500, 509, 509, 4});
    add(rects, {500, 0, 509, 9, 5});
    ASSERT_EQ(rects.rects().size(), DirtyRects::max_rects);
    EXPECT_EQ(newest_at(rects, 0, 0), 2u);
    EXPECT_EQ(newest_at(rects, 5, 505), 3u);
    EXPECT_EQ(newest_at(rects, 505, 5), 5u);
}

TEST(DirtyRects, AreAtEveryTexelAtLeastTheNewestThatWasAdded) {
    std::mt19937 random{5};
    for (int round = 0; round < 2000; ++round) {
        DirtyRects rects;
        Revision truth[16][16] = {};
        for (Revision revision = 1; revision <= 8; ++revision) {
            const auto below = [&random](std::uint32_t n) {
                return static_cast<std::uint32_t>(random() % n);
            };
            const std::uint32_t x = below(16), y = below(16);
            const DirtyRect rect{x, y, std::min(15u, x + below(9)), std::min(15u, y + below(9)),
                                 round % 2 == 0 ? revision : Revision{1 + below(8)}};
            add(rects, rect);
            for (std::uint32_t v = rect.y0; v <= rect.y1; ++v) {
                for (std::uint32_t u = rect.x0; u <= rect.x1; ++u)
                    truth[v][u] = std::max(truth[v][u], rect.revision);
            }
            ASSERT_LE(rects.rects().size(), DirtyRects::max_rects);
            for (std::uint32_t v = 0; v < 16; ++v) {
                for (std::uint32_t u = 0; u < 16; ++u) {
                    ASSERT_GE(newest_at(rects, u, v), truth[v][u]);
                    if (revision > 4) continue;  // nothing joined yet
                    ASSERT_EQ(newest_at(rects, u, v), truth[v][u]);
                }
            }
        }
    }
}

TEST(DirtyRects, HoldAWholeCell) {
    constexpr std::uint32_t last = 0xffffffff;
    DirtyRects rects;
    for (std::uint32_t i = 0; i < 6; ++i) add(rects, {i * 1000, 0, i * 1000 + 10, last, i + 1});
    EXPECT_EQ(rects.rects().size(), DirtyRects::max_rects);
    add(rects, {0, 0, last, last, 9});
    EXPECT_EQ(rects.rects(), (std::vector<DirtyRect>{{0, 0, last, last, 9}}));
}

}  // namespace
}  // namespace tessera::detail
