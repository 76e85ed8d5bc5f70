// Seams taken apart, on pictures where the answer is known.
#include <gtest/gtest.h>

#include "painted_texture.h"

#include "server/quality/lab.h"
#include "server/quality/measures.h"
#include "server/quality/own_neighbours.h"

namespace tessera {
namespace {

using test::Codes;
using test::floor_mod;
using test::paint_asset;
using test::PaintedTexture;

Codes grey(int code) {
    const auto c = static_cast<std::uint8_t>(code);
    return {c, c, c};
}

double step_of(int from, int to) { return double(difference(grey(from).data(), grey(to).data())); }

Rgb8Image draw(std::int32_t side, const PaintedTexture::Paint& paint) {
    Rgb8Image out{side, side, {}};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            for (const std::uint8_t code : paint(x, y)) out.bytes.push_back(code);
    return out;
}

/// A tile of 64 texels with one square of 32 in its middle, which shows the tile or the exemplar from (x, y)
/// on.
ExchangeAsset square_in_tile(const PaintedTexture::Paint& tile, const PaintedTexture::Paint& exemplar,
                             ExchangeAsset::Offset at) {
    ExchangeAsset asset;
    asset.tile_side = 64;
    asset.tile = draw(64, tile);
    asset.exemplar = draw(128, exemplar);
    asset.labels.assign(64 * 64, 1);
    asset.patches.resize(2);
    auto& square = asset.patches[0];
    square.x = square.y = 16;
    square.width = square.height = 32;
    BitMask shape{32, 32};
    for (std::int32_t y = 0; y < 32; ++y)
        for (std::int32_t x = 0; x < 32; ++x) {
            shape.set(x, y);
            asset.labels[std::size_t((y + 16) * 64 + x + 16)] = 0;
        }
    square.contents.push_back({at, shape});
    return asset;
}

Seams seams_of(const ExchangeAsset& asset) {
    SilentProgress silent;
    const auto texture = paint_asset(asset);
    auto seams = measure_seams(asset, *texture, *texture, {silent, "measuring"});
    EXPECT_TRUE(seams);
    EXPECT_GT(seams->pairs, 10000U);
    return std::move(*seams);
}

TEST(SeamsTakenApart, AConstantPictureHasNone) {
    const auto flat = [](std::int64_t, std::int64_t) { return grey(90); };
    const Seams seams = seams_of(square_in_tile(flat, flat, {40, 40}));
    EXPECT_EQ(seams.hard.mean, 0);
    EXPECT_EQ(seams.natural.mean, 0);
    EXPECT_EQ(seams.natural_steps, 2 * seams.pairs);
    EXPECT_EQ(seams.excess.mean, 0);
    EXPECT_EQ(seams.new_edges, 0);
    EXPECT_EQ(seams.quiet_ratio.mean, 0);
}

TEST(SeamsTakenApart, ACutThatNobodySeesAlongTheEdgesOfACheckerIsAllPlaceAndNoExcess) {
    const auto checker = [](std::int64_t x, std::int64_t y) {
        return grey((floor_mod(x, 8) < 4) == (floor_mod(y, 8) < 4) ? 100 : 160);
    };
    // The content goes on as the tile does, so that the texture is a checker without a seam
    const Seams seams = seams_of(square_in_tile(checker, checker, {48, 24}));
    EXPECT_NEAR(seams.hard.mean, step_of(100, 160), 0.01);
    EXPECT_NEAR(seams.hard_ratio.mean, 4, 0.15);
    EXPECT_NEAR(seams.natural_ratio.mean, seams.hard_ratio.mean, 1e-9);
    EXPECT_NEAR(seams.excess.mean, 1, 1e-9);
    EXPECT_NEAR(seams.excess.percentile_99, 1, 1e-9);
    EXPECT_EQ(seams.new_edges, 0);
    EXPECT_LT(seams.quiet_ratio.mean, seams.natural_ratio.mean);
}

TEST(SeamsTakenApart, AStepThatNeitherSourceHasIsAllExcess) {
    // Stripes along the rows; from the exemplar's right half on they are lighter by 30
    const auto stripes = [](std::int64_t x, std::int64_t y) {
        return grey((floor_mod(y, 2) == 0 ? 100 : 104) + (x >= 64 ? 30 : 0));
    };
    const Seams seams = seams_of(
        square_in_tile([&](std::int64_t, std::int64_t y) { return stripes(0, y); }, stripes, {80, 48}));
    // A quarter of the pairs at each side: 104|130 above, 134|100 below, and the rows' own steps on the left
    // and right
    const double rows = (step_of(100, 130) + step_of(104, 134)) / 2;
    const double across = step_of(104, 130) + step_of(134, 100);
    EXPECT_NEAR(seams.hard.mean, rows / 2 + across / 4, 0.01);
    const double own = (step_of(100, 104) + step_of(130, 134)) / 2;
    EXPECT_NEAR(seams.natural.mean, own / 2, 0.01) << "none along rows";
    EXPECT_NEAR(seams.excess.mean, seams.hard.mean / seams.natural.mean, 1e-9);
    EXPECT_NEAR(seams.hard_ratio.mean, seams.natural_ratio.mean * seams.excess.mean, 1e-9);
    EXPECT_EQ(seams.new_edges, 1);
}

TEST(SeamsTakenApart, AnEdgeThatOneSourceHasAnywayIsNoNewOne) {
    // The tile is darker in the square, and the content as light as the tile around it: where it ends, so
    // does the tile's edge
    const auto tile = [](std::int64_t x, std::int64_t y) {
        return grey(x >= 16 && x < 48 && y >= 16 && y < 48 ? 60 : 120);
    };
    const auto halves = [](std::int64_t x, std::int64_t) { return grey(x < 64 ? 60 : 120); };
    const Seams dark = seams_of(square_in_tile(tile, halves, {8, 8}));
    EXPECT_NEAR(dark.hard.mean, step_of(60, 120), 0.01);
    EXPECT_NEAR(dark.natural.mean, step_of(60, 120) / 2, 0.01) << "the tile's edge; the content has none";
    EXPECT_NEAR(dark.excess.mean, 2, 1e-6);
    EXPECT_EQ(dark.new_edges, 0);
    const Seams light = seams_of(square_in_tile(tile, halves, {80, 80}));
    EXPECT_EQ(light.hard.mean, 0);
    EXPECT_EQ(light.excess.mean, 0);
    EXPECT_EQ(light.new_edges, 0);
}

TEST(NeighboursOfASource, AreTheTilesAndTheExemplarsOwnAndEndWithThem) {
    const auto place = [](std::int64_t x, std::int64_t y) {
        return Codes{static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 0};
    };
    ExchangeAsset asset = square_in_tile(place, place, {96, 50});
    asset.patches[0].contents.push_back({{20, 30}, asset.patches[0].contents[0].shape});
    asset.patches[0].contents.front().standing = ExchangeAsset::Standing::dropped;
    asset.patches[1].contents.push_back({{0, 0}, BitMask{}});
    const OwnNeighbours own{asset};
    const auto at = [&](std::uint32_t source, std::int64_t x, std::int64_t y, std::int32_t dx,
                        std::int32_t dy, const Codes& shown) {
        const std::uint8_t* codes = own.beside(source, x, y, dx, dy, shown.data());
        return codes == nullptr ? Codes{255, 255, 255} : Codes{codes[0], codes[1], codes[2]};
    };
    const Codes none{255, 255, 255};
    EXPECT_EQ(at(0, -1, 5, 1, 0, place(63, 5)), place(0, 5)) << "the tile repeats";
    EXPECT_EQ(at(0, 70, 63, 0, 1, place(6, 63)), place(6, 0));
    // Dropped contents have no numbers: 1 is the second one
    EXPECT_EQ(at(1, 16 - 64, 17 + 128, -1, 0, place(20, 31)), place(19, 31));
    EXPECT_EQ(at(1, 47, 16, 1, 0, place(51, 30)), place(52, 30)) << "beyond the shape, but in the exemplar";
    EXPECT_EQ(at(1, 47, 16, 1, 0, place(50, 30)), none) << "it shows another texel there";
    EXPECT_EQ(at(1, 50, 16, 1, 0, place(54, 30)), none) << "outside the patch";
    EXPECT_EQ(at(9, 20, 20, 1, 0, place(20, 20)), none) << "no such source";
    asset.patches[0].contents.front().standing = ExchangeAsset::Standing::chosen;
    const OwnNeighbours whole{asset};
    EXPECT_EQ(whole.beside(1, 47, 16, 1, 0, place(127, 50).data()), nullptr) << "the exemplar ends";
    asset.method = ExchangeMethod::wang;
    const OwnNeighbours tiles{asset};
    EXPECT_EQ(tiles.beside(0, 63, 5, 1, 0, place(63, 5).data()), nullptr) << "tiles of wang end";
    EXPECT_NE(tiles.beside(0, 62, 5, 1, 0, place(62, 5).data()), nullptr);
}

}  // namespace
}  // namespace tessera
