#include "server/prepare/tile.h"

#include <gtest/gtest.h>

#include "tests/unit/server/prepare/made_photo.h"

namespace tessera {
namespace {

/// Mean difference of neighbours on the torus: of those that are no neighbours in the photograph (the seams).
struct Seams {
    double mean = 0;
    std::size_t texels = 0;
};

Seams seams_of(const PerceptualImage& photo, const std::vector<PhotoPoint>& sources, std::int32_t side) {
    Seams seams;
    const auto at = [&](std::int32_t x, std::int32_t y) {
        return sources[static_cast<std::size_t>((y % side) * side + x % side)];
    };
    const auto compare = [&](PhotoPoint here, PhotoPoint there, std::int32_t dx, std::int32_t dy) {
        if (there.x == here.x + dx && there.y == here.y + dy) return;
        seams.mean += difference(photo.at(here.x, here.y), photo.at(there.x, there.y));
        ++seams.texels;
    };
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            compare(at(x, y), at(x + 1, y), 1, 0);
            compare(at(x, y), at(x, y + 1), 0, 1);
        }
    if (seams.texels > 0) seams.mean /= static_cast<double>(seams.texels);
    return seams;
}

/// What a crop of the photograph, repeated without any care, would be.
std::vector<PhotoPoint> crop(PhotoPoint corner, std::int32_t side) {
    std::vector<PhotoPoint> sources;
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) sources.push_back({corner.x + x, corner.y + y});
    return sources;
}

TEST(Tile, seams_show_far_less_than_the_edges_of_a_plain_crop) {
    const PerceptualImage photo = to_perceptual(test::made_photo(256, 220));
    SilentProgress progress;
    const PeriodicTile tile = make_tile(photo, 128, 2, progress);
    const Seams cut = seams_of(photo, tile.sources, 128);
    const Seams naive = seams_of(photo, crop(tile.sources[64 * 128 + 64], 64), 64);
    ASSERT_GT(cut.texels, 200u) << "a tile without seams was not cut out of this photograph";
    EXPECT_LT(cut.mean, 0.5 * naive.mean) << "cut " << cut.mean << ", crop " << naive.mean;
}

TEST(Tile, every_texel_is_the_photographs_own_at_a_place_that_is_whole_sides_away) {
    const PerceptualImage photo = to_perceptual(test::made_photo(100, 130));
    SilentProgress progress;
    const PeriodicTile tile = make_tile(photo, 64, 1, progress);
    ASSERT_EQ(tile.sources.size(), 64u * 64u);
    // All of them are one translation, up to a side to the right and a side down
    const PhotoPoint last = tile.sources.back();
    const std::int32_t left = last.x - 63, top = last.y - 63;
    for (std::int32_t y = 0; y < 64; ++y)
        for (std::int32_t x = 0; x < 64; ++x) {
            const PhotoPoint source = tile.sources[static_cast<std::size_t>(y * 64 + x)];
            ASSERT_TRUE(source.x >= 0 && source.y >= 0 && source.x < 100 && source.y < 130);
            ASSERT_TRUE(source.x - x == left || source.x - x == left + 64) << x << ", " << y;
            ASSERT_TRUE(source.y - y == top || source.y - y == top + 64) << x << ", " << y;
        }
}

TEST(Tile, holds_the_photographs_bytes_unaltered) {
    const Rgb8Image photo = test::made_photo(90, 90);
    SilentProgress progress;
    const PeriodicTile tile = make_tile(to_perceptual(photo), 64, 2, progress);
    const Rgb8Image image = cut_out(photo, tile);
    ASSERT_EQ(image.bytes.size(), 3u * 64 * 64);
    for (std::size_t i = 0; i < tile.sources.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_EQ(
                image.bytes[3 * i + c],
                photo.bytes[3 * static_cast<std::size_t>(tile.sources[i].y * 90 + tile.sources[i].x) + c]);
}

TEST(Tile, a_photograph_that_repeats_by_itself_is_cut_without_any_difference) {
    // Period 32 both ways, and larger than tile and overlap
    const Rgb8Image once = test::made_photo(32, 32);
    Rgb8Image photo{80, 80, {}};
    for (std::int32_t y = 0; y < 80; ++y)
        for (std::int32_t x = 0; x < 80; ++x)
            for (std::int32_t c = 0; c < 3; ++c)
                photo.bytes.push_back(once.bytes[static_cast<std::size_t>(3 * ((y % 32) * 32 + x % 32) + c)]);
    SilentProgress progress;
    EXPECT_EQ(make_tile(to_perceptual(photo), 64, 1, progress).seam_cost, 0u);
}

TEST(Tile, is_the_same_for_any_number_of_threads) {
    const PerceptualImage photo = to_perceptual(test::made_photo(160, 140));
    SilentProgress progress;
    EXPECT_EQ(make_tile(photo, 64, 1, progress).sources, make_tile(photo, 64, 4, progress).sources);
}

}  // namespace
}  // namespace tessera
