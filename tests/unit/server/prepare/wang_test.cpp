#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/prepare/prepare.h"
#include "server/prepare/wang_tiles.h"
#include "tests/unit/server/prepare/made_photo.h"

namespace tessera {
namespace {

using testing::HasSubstr;

PreparedAsset prepared(const Rgb8Image& photo, std::int32_t side, std::int32_t colors,
                       std::size_t threads = 2) {
    PrepareOptions options;
    options.method = ExchangeMethod::wang;
    options.tile_side = side;
    options.colors = colors;
    options.threads = threads;
    SilentProgress progress;
    auto made = prepare_exchange(photo, options, nullptr, progress);
    EXPECT_TRUE(made) << made.error().detail;
    return made ? std::move(*made) : PreparedAsset{};
}

std::int32_t color_of(std::uint8_t corners, int corner) { return corners >> 2 * corner & 3; }

/// Where each texel of each tile is from, by corners.
struct Tiles {
    explicit Tiles(const PreparedAsset& made) : side{made.asset.tile_side}, made_{made}, at_(256) {
        for (const auto& content : made.asset.patches[0].contents) at_[content.corners] = content.at;
    }
    PhotoPoint source(std::uint8_t corners, std::int32_t x, std::int32_t y) const {
        if (corners == 0) return made_.tile_sources[static_cast<std::size_t>(y * side + x)];
        const auto& at = at_[corners];
        return made_
            .exemplar_sources[static_cast<std::size_t>((at.y + y) * made_.asset.exemplar.width + at.x + x)];
    }
    std::int32_t side;

  private:
    const PreparedAsset& made_;
    std::vector<ExchangeAsset::Offset> at_;
};

TEST(Wang, texels_on_both_sides_of_an_edge_depend_on_its_two_colours_only) {
    for (const std::int32_t colors : {2, 3}) {
        const PreparedAsset made = prepared(test::made_photo(140, 120), 32, colors);
        const Tiles tiles{made};
        std::vector<std::uint8_t> all{0};
        for (const auto& content : made.asset.patches[0].contents) all.push_back(content.corners);
        ASSERT_EQ(std::ssize(all), colors * colors * colors * colors);
        // Two tiles that may share an edge show on their sides of it what any other two do
        for (const std::uint8_t a : all)
            for (const std::uint8_t b : all)
                for (std::int32_t along = 0; along < 32; ++along)
                    for (std::int32_t deep = 0; deep < WangFrames::locked; ++deep) {
                        if (color_of(a, 0) == color_of(b, 0) && color_of(a, 1) == color_of(b, 1)) {
                            ASSERT_EQ(tiles.source(a, along, deep), tiles.source(b, along, deep));
                        }
                        if (color_of(a, 2) == color_of(b, 2) && color_of(a, 3) == color_of(b, 3)) {
                            ASSERT_EQ(tiles.source(a, along, 31 - deep), tiles.source(b, along, 31 - deep));
                        }
                        if (color_of(a, 0) == color_of(b, 0) && color_of(a, 2) == color_of(b, 2)) {
                            ASSERT_EQ(tiles.source(a, deep, along), tiles.source(b, deep, along));
                        }
                        if (color_of(a, 1) == color_of(b, 1) && color_of(a, 3) == color_of(b, 3)) {
                            ASSERT_EQ(tiles.source(a, 31 - deep, along), tiles.source(b, 31 - deep, along));
                        }
                    }
    }
}

TEST(Wang, tiles_that_share_an_edge_continue_each_other_as_the_photograph_does) {
    const PreparedAsset made = prepared(test::made_photo(140, 120), 32, 2);
    const Tiles tiles{made};
    int pairs = 0;
    for (int a = 0; a < 256; ++a)
        for (int b = 0; b < 256; ++b) {
            const auto left = static_cast<std::uint8_t>(a), right = static_cast<std::uint8_t>(b);
            if (((a | b) & 0b10101010) != 0) continue;  // two colours
            const bool beside =
                color_of(left, 1) == color_of(right, 0) && color_of(left, 3) == color_of(right, 2);
            const bool below =
                color_of(left, 2) == color_of(right, 0) && color_of(left, 3) == color_of(right, 1);
            for (std::int32_t along = 0; along < 32; ++along) {
                if (beside) {
                    const PhotoPoint from = tiles.source(left, 31, along), to = tiles.source(right, 0, along);
                    // A cut may cross the edge, where strip and sample change over; elsewhere the photograph
                    // goes on
                    if (along < 6 || along >= 26) {
                        EXPECT_EQ(to, (PhotoPoint{from.x + 1, from.y}));
                    }
                    pairs += to == PhotoPoint{from.x + 1, from.y};
                }
                if (below) {
                    const PhotoPoint from = tiles.source(left, along, 31), to = tiles.source(right, along, 0);
                    if (along < 6 || along >= 26) {
                        EXPECT_EQ(to, (PhotoPoint{from.x, from.y + 1}));
                    }
                    pairs += to == PhotoPoint{from.x, from.y + 1};
                }
            }
        }
    EXPECT_GT(pairs, 128 * 32 * 3 / 4) << "of 128 pairs of tiles, 32 texels each";
}

TEST(Wang, the_atlas_holds_every_tile_once_and_nothing_but_the_photographs_texels) {
    const Rgb8Image photo = test::made_photo(140, 120);
    const PreparedAsset made = prepared(photo, 32, 3);
    const ExchangeAsset& asset = made.asset;
    EXPECT_EQ(asset.blend_texels, 0);
    EXPECT_EQ(asset.exemplar.width, 9 * 32);
    ASSERT_EQ(asset.patches.size(), 1u);
    std::vector<bool> used(81), corners(256);
    for (const auto& content : asset.patches[0].contents) {
        EXPECT_EQ(content.at.x % 32, 0);
        EXPECT_EQ(content.at.y % 32, 0);
        const auto box = static_cast<std::size_t>(content.at.y / 32 * 9 + content.at.x / 32);
        EXPECT_FALSE(used[box]) << "boxes do not overlap";
        EXPECT_FALSE(corners[content.corners]);
        used[box] = corners[content.corners] = true;
    }
    for (std::size_t i = 0; i < made.exemplar_sources.size(); ++i) {
        const PhotoPoint from = made.exemplar_sources[i];
        const std::size_t at = 3 * (std::size_t(from.y) * std::size_t(photo.width) + std::size_t(from.x));
        for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(asset.exemplar.bytes[3 * i + c], photo.bytes[at + c]);
    }
}

TEST(Wang, one_thread_and_three_make_the_same_tiles) {
    const Rgb8Image photo = test::made_photo(140, 120);
    EXPECT_EQ(prepared(photo, 64, 2, 1).asset.exemplar.bytes, prepared(photo, 64, 2, 3).asset.exemplar.bytes);
}

TEST(Wang, refuses_options_out_of_range_by_name_and_manages_the_least_photograph) {
    SilentProgress progress;
    const auto says = [&](std::int32_t tile, std::int32_t colors, std::int32_t photo) {
        PrepareOptions options;
        options.method = ExchangeMethod::wang;
        options.tile_side = tile;
        options.colors = colors;
        const auto made = prepare_exchange(test::made_photo(photo, photo), options, nullptr, progress);
        return made ? std::string{"made"} : made.error().detail;
    };
    EXPECT_THAT(says(8, 2, 100), HasSubstr("--tile is 8; from 16 to 4096"));
    EXPECT_THAT(says(100, 2, 100), HasSubstr("a power of two"));
    EXPECT_THAT(says(64, 5, 100), HasSubstr("--colors is 5; from 2 to 4"));
    EXPECT_THAT(says(16, 2, 19), HasSubstr("too small for a tile"));
    EXPECT_EQ(says(0, 0, 20), "made");
}

}  // namespace
}  // namespace tessera
