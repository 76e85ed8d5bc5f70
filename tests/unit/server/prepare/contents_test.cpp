#include "server/prepare/contents.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "server/prepare/border_band.h"
#include "server/prepare/candidate_search.h"
#include "tests/unit/server/prepare/made_photo.h"

namespace tessera {
namespace {

/// A photograph whose tile is cut from its left, and a patch of the tile that occurs once more, on the right.
struct Fixture {
    Rgb8Image photo = test::made_photo(300, 120);
    PerceptualImage colors;
    PeriodicTile tile;
    PerceptualImage tile_colors;
    Segmentation segmentation;

    Fixture() {
        for (std::int32_t y = 0; y < 64; ++y)
            for (std::int32_t x = 0; x < 64; ++x)
                for (std::int32_t c = 0; c < 3; ++c) {
                    const auto at = [&](std::int32_t px, std::int32_t py) {
                        return static_cast<std::size_t>(3 * (py * 300 + px) + c);
                    };
                    photo.bytes[at(203 + x, 41 + y)] = photo.bytes[at(x, y)];
                }
        colors = to_perceptual(photo);
        tile.side = 64;
        for (std::int32_t y = 0; y < 64; ++y)
            for (std::int32_t x = 0; x < 64; ++x) tile.sources.push_back({x, y});
        tile_colors = to_perceptual(cut_out(photo, tile));
        segmentation = make_patches(tile_colors, 16, 1);
    }
};

TEST(Candidates, a_place_that_shows_the_same_is_found_to_the_texel) {
    const Fixture made;
    SilentProgress progress;
    const auto found =
        find_candidates(made.colors, made.tile_colors, made.tile, made.segmentation, {8, 4, 2}, progress);
    std::size_t inner = 0;
    for (std::size_t p = 0; p < found.size(); ++p) {
        const auto& box = made.segmentation.patches[p];
        // Only patches whose surroundings are inside the copied square
        if (box.x < 9 || box.y < 9 || box.x + box.width > 55 || box.y + box.height > 55) continue;
        ++inner;
        ASSERT_FALSE(found[p].empty());
        EXPECT_EQ(found[p].front().cost, 0u) << "patch " << p;
        EXPECT_EQ(found[p].front().at, (ExchangeAsset::Offset{203 + box.x, 41 + box.y})) << "patch " << p;
    }
    EXPECT_GE(inner, 1u);
}

TEST(Contents, lie_inside_the_photograph_apart_from_each_other_and_from_the_tiles_own_place) {
    const Fixture made;
    SilentProgress progress;
    const auto found =
        find_contents(made.colors, made.tile_colors, made.tile, made.segmentation, {12, 6, 2}, progress);
    for (std::size_t p = 0; p < found.size(); ++p) {
        const auto& box = made.segmentation.patches[p];
        ASSERT_EQ(found[p].size(), 12u) << "patch " << p;
        for (std::size_t i = 0; i < found[p].size(); ++i) {
            const auto at = found[p][i].at;
            EXPECT_GE(at.x, 3);
            EXPECT_GE(at.y, 3);
            EXPECT_LE(at.x + box.width + 3, 300);
            EXPECT_LE(at.y + box.height + 3, 120);
            const bool wraps = box.x + box.width > 64 || box.y + box.height > 64;
            EXPECT_TRUE(wraps || lie_apart(at, {box.x, box.y}, 4)) << "patch " << p << " shows itself";
            for (std::size_t j = 0; j < i; ++j)
                EXPECT_TRUE(lie_apart(at, found[p][j].at, 4)) << "patch " << p;
            // The shape keeps to the patch, and shows something of its own
            std::int32_t area = 0;
            for (std::int32_t y = 0; y < box.height; ++y)
                for (std::int32_t x = 0; x < box.width; ++x) {
                    if (!found[p][i].shape.at(x, y)) continue;
                    ++area;
                    const std::int32_t texel = (box.y + y) % 64 * 64 + (box.x + x) % 64;
                    ASSERT_EQ(made.segmentation.labels[static_cast<std::size_t>(texel)], p);
                }
            EXPECT_GT(area, box.width * box.height / 8) << "patch " << p;
        }
    }
}

TEST(Contents, together_show_most_of_the_photograph) {
    const Fixture made;
    SilentProgress progress;
    const auto found =
        find_contents(made.colors, made.tile_colors, made.tile, made.segmentation, {24, 4, 2}, progress);
    std::set<std::pair<std::int32_t, std::int32_t>> shown;
    for (std::size_t p = 0; p < found.size(); ++p)
        for (const ShapedContent& content : found[p])
            for (std::int32_t y = content.at.y; y < content.at.y + made.segmentation.patches[p].height; ++y)
                for (std::int32_t x = content.at.x; x < content.at.x + made.segmentation.patches[p].width;
                     ++x)
                    shown.emplace(x, y);
    EXPECT_GT(shown.size(), 300u * 120u * 7 / 10);
}

TEST(BorderBand, lies_on_both_sides_of_the_border_and_nowhere_else) {
    // One patch of 8×6 at (60, 3) of a tile of 64: it wraps
    const PerceptualImage tile{64, 64, std::vector<PerceptualColor>(64 * 64, {100, 0, 0})};
    Segmentation segmentation{std::vector<std::uint16_t>(64 * 64, 0), {{}, {60, 3, 8, 6, {}}}};
    for (std::int32_t y = 3; y < 9; ++y)
        for (std::int32_t x = 60; x < 68; ++x)
            segmentation.labels[static_cast<std::size_t>(y * 64 + x % 64)] = 1;
    const BorderBand band = make_border_band(tile, segmentation, 1, 2, 1);
    EXPECT_EQ(band.margin, 2);
    EXPECT_EQ(band.width, 12);
    EXPECT_EQ(band.height, 10);
    // All of 12×10 but the inner 4×2
    EXPECT_EQ(band.texels.size(), 12u * 10 - 4 * 2);
    const Span span = span_of(100, band.width, band);
    EXPECT_EQ(span.first, 2);
    EXPECT_EQ(span.last, 90);
}

TEST(BorderBand, all_places_at_once_agree_with_one_place_at_a_time) {
    const PerceptualImage tile = to_perceptual(test::made_photo(64, 64));
    const PerceptualImage photo = reduced(to_perceptual(test::made_photo(120, 90, 3)), 2);
    const Segmentation segmentation = make_patches(tile, 16, 1);
    const BorderBand band = make_border_band(tile, segmentation, 5, 4, 2);
    const auto all = all_differences(band, photo);
    const Span across = span_of(120, band.width, band), down = span_of(90, band.height, band);
    std::size_t i = 0;
    for (std::int32_t y = down.first; y <= down.last; y += 2)
        for (std::int32_t x = across.first; x <= across.last; x += 2, ++i) {
            const double mean = static_cast<double>(mean_difference(band, photo, x, y));
            ASSERT_NEAR(16.0 * all.at(i) / static_cast<double>(band.texels.size()), mean, 17.0)
                << x << ", " << y;
        }
    EXPECT_EQ(i, all.size());
}

TEST(Liveliness, flat_places_cost_twofold_and_average_ones_what_they_cost) {
    // Left half flat, right half chequered
    PerceptualImage photo{64, 32, std::vector<PerceptualColor>(64 * 32, {400, 0, 0})};
    for (std::int32_t y = 0; y < 32; ++y)
        for (std::int32_t x = 32; x < 64; ++x)
            photo.colors[static_cast<std::size_t>(y * 64 + x)].lightness = (x + y) % 2 == 0 ? 300 : 500;
    const Liveliness liveliness{photo};
    EXPECT_EQ(liveliness.weigh(1000, {2, 2}, 16, 16), 2000u);
    EXPECT_NEAR(static_cast<double>(liveliness.weigh(1000, {24, 2}, 16, 16)), 1000, 60);
    EXPECT_LT(liveliness.weigh(1000, {40, 2}, 16, 16), 700u);
}

}  // namespace
}  // namespace tessera
