#include "server/prepare/patches.h"

#include <algorithm>
#include <queue>

#include <gtest/gtest.h>

#include "server/prepare/tile.h"
#include "tests/unit/server/prepare/made_photo.h"

namespace tessera {
namespace {

PerceptualImage made_tile(std::int32_t side, std::uint64_t seed = 7) {
    return to_perceptual(test::made_photo(side, side, seed));
}

/// Texels of `label` that can be reached from its first one without leaving it, on the torus.
std::int64_t connected_area(const std::vector<std::uint16_t>& labels, std::int32_t side, std::size_t label) {
    const auto first = std::find(labels.begin(), labels.end(), label);
    if (first == labels.end()) return 0;
    std::vector<bool> seen(labels.size());
    std::queue<std::int32_t> open;
    const auto visit = [&](std::int32_t x, std::int32_t y) {
        const std::int32_t i = (y & (side - 1)) * side + (x & (side - 1));
        if (seen[static_cast<std::size_t>(i)] || labels[static_cast<std::size_t>(i)] != label) return;
        seen[static_cast<std::size_t>(i)] = true;
        open.push(i);
    };
    const auto start = static_cast<std::int32_t>(first - labels.begin());
    visit(start % side, start / side);
    std::int64_t area = 0;
    for (; !open.empty(); ++area) {
        const std::int32_t x = open.front() % side, y = open.front() / side;
        open.pop();
        visit(x - 1, y);
        visit(x + 1, y);
        visit(x, y - 1);
        visit(x, y + 1);
    }
    return area;
}

struct Case {
    std::int32_t side, count;
    std::uint64_t seed;
};

class Patches : public testing::TestWithParam<Case> {};

TEST_P(Patches, cover_the_torus_connected_and_inside_boxes_of_half_its_side) {
    const auto [side, count, seed] = GetParam();
    const Segmentation cover = make_patches(made_tile(side), count, seed);
    ASSERT_EQ(cover.labels.size(), static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    EXPECT_NEAR(static_cast<double>(cover.patches.size()), count, 0.15 * count + 1);
    std::vector<std::int64_t> areas(cover.patches.size());
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const std::size_t label = cover.labels[static_cast<std::size_t>(y * side + x)];
            ASSERT_LT(label, cover.patches.size());
            ++areas[label];
            const auto& box = cover.patches[label];
            ASSERT_LT((x - box.x) & (side - 1), box.width);
            ASSERT_LT((y - box.y) & (side - 1), box.height);
        }
    for (std::size_t p = 0; p < cover.patches.size(); ++p) {
        const auto& box = cover.patches[p];
        EXPECT_LE(box.width, side / 2) << "patch " << p;
        EXPECT_LE(box.height, side / 2) << "patch " << p;
        EXPECT_EQ(connected_area(cover.labels, side, p), areas[p]) << "patch " << p;
        // No slivers: nothing below a sixth of a fair share, and nothing much thinner than its box
        EXPECT_GE(areas[p] * 6, std::int64_t{side} * side / std::ssize(areas)) << "patch " << p;
        EXPECT_GE(areas[p] * 4, std::int64_t{box.width} * box.height) << "patch " << p;
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Patches,
                         testing::Values(Case{16, 16, 1}, Case{32, 16, 2}, Case{64, 16, 3}, Case{128, 24, 4},
                                         Case{128, 64, 5}, Case{256, 64, 6}, Case{256, 300, 7},
                                         Case{512, 1024, 8}));

TEST(PatchesOf, a_flat_tile_are_as_good) {
    const PerceptualImage flat{64, 64, std::vector<PerceptualColor>(64 * 64, {400, 0, 0})};
    const Segmentation cover = make_patches(flat, 16, 1);
    EXPECT_EQ(cover.patches.size(), 16u);
    for (std::size_t p = 0; p < 16; ++p) EXPECT_LE(cover.patches[p].width, 32);
}

TEST(PatchesOf, another_seed_are_others_and_the_same_seed_the_same) {
    const PerceptualImage tile = made_tile(128);
    EXPECT_EQ(make_patches(tile, 64, 1).labels, make_patches(tile, 64, 1).labels);
    EXPECT_NE(make_patches(tile, 64, 1).labels, make_patches(tile, 64, 2).labels);
}

TEST(PatchesOf, a_tile_with_one_busy_spot_do_not_border_inside_it) {
    // A chequered disc in the middle of calm grey: borders keep off it where the grid alone would cut it
    PerceptualImage tile{128, 128, std::vector<PerceptualColor>(128 * 128, {400, 0, 0})};
    for (std::int32_t y = 0; y < 128; ++y)
        for (std::int32_t x = 0; x < 128; ++x)
            if ((x - 68) * (x - 68) + (y - 68) * (y - 68) < 10 * 10 && (x + y) % 2 == 0)
                tile.colors[static_cast<std::size_t>(y * 128 + x)].lightness = 700;
    int whole = 0;
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        const Segmentation cover = make_patches(tile, 16, seed);
        int cut = 0;
        const std::uint16_t centre = cover.labels[68 * 128 + 68];
        for (std::int32_t y = 0; y < 128; ++y)
            for (std::int32_t x = 0; x < 128; ++x)
                if ((x - 68) * (x - 68) + (y - 68) * (y - 68) < 8 * 8 &&
                    cover.labels[static_cast<std::size_t>(y * 128 + x)] != centre)
                    ++cut;
        whole += cut == 0 ? 1 : 0;
    }
    EXPECT_GE(whole, 6) << "of 8 seeds";
}

}  // namespace
}  // namespace tessera
