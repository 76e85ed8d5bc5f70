#include "server/quality/measures.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "painted_texture.h"

#include "server/quality/lab.h"

namespace tessera {
namespace {

using test::Codes;
using test::floor_mod;
using test::PaintedTexture;
using testing::AllOf;
using testing::Each;
using testing::Ge;
using testing::Le;

constexpr std::uint64_t seed = 7;

Codes grey(int code) {
    const auto c = static_cast<std::uint8_t>(code);
    return {c, c, c};
}

float lightness_at(int code) { return tessera::lightness_of(grey(code).data()); }

/// White noise of greys 60 to 123.
Codes noise(std::int64_t x, std::int64_t y, std::uint64_t index = 0) {
    return grey(60 + static_cast<int>(hash(seed, stream("noise", index), x, y) % 64));
}

/// An asset of one patch, with an exemplar and a tile that `paint` shows.
ExchangeAsset asset_of(std::int32_t side, const PaintedTexture::Paint& paint) {
    ExchangeAsset asset;
    asset.tile_side = side;
    asset.patches.resize(1);
    const auto image = [&](std::int32_t size) {
        Rgb8Image out{size, size, {}};
        for (std::int32_t y = 0; y < size; ++y)
            for (std::int32_t x = 0; x < size; ++x)
                for (const std::uint8_t code : paint(x, y)) out.bytes.push_back(code);
        return out;
    };
    asset.tile = image(side);
    asset.exemplar = image(2 * side);
    return asset;
}

struct StoppedProgress final : Progress {
    void advance(std::string_view, double) override {}
    void note(const std::string&) override {}
    std::stop_token stop() const override { return source.get_token(); }
    std::stop_source source;
};

struct Measures : testing::Test {
    SilentProgress silent;
    ProgressPart progress{silent, "measuring"};
};

TEST(LabColour, MeetsKnownColours) {
    EXPECT_NEAR(to_lab(grey(255).data()).lightness, 100, 0.01);
    EXPECT_NEAR(to_lab(grey(0).data()).lightness, 0, 0.01);
    const Lab red = to_lab(Codes{255, 0, 0}.data());
    EXPECT_NEAR(red.lightness, 53.24, 0.05);
    EXPECT_NEAR(red.green_red, 80.09, 0.1);
    EXPECT_NEAR(red.blue_yellow, 67.20, 0.1);
}

TEST(HistogramOfValues, KnowsItsPercentilesAndHowFarAnotherLies) {
    Histogram low{0, 100}, high{0, 100};
    for (int i = 0; i < 1000; ++i) {
        low.add(float(i) / 100);
        high.add(float(i) / 100 + 5);
    }
    EXPECT_NEAR(low.mean(), 4.995, 1e-3);
    EXPECT_NEAR(low.percentile(0.99), 9.9, 0.05);
    EXPECT_NEAR(distance(low, high), 5, 0.01);
    EXPECT_EQ(distance(low, low), 0);
}

TEST_F(Measures, SeamsAreStepsBetweenSourcesAgainstTheExemplarsOwn) {
    // Columns of two greys: half of the exemplar's steps are 0, the others one size
    const auto columns = [](std::int64_t x, std::int64_t) { return grey(floor_mod(x, 2) == 0 ? 100 : 110); };
    const ExchangeAsset asset = asset_of(64, columns);
    // Sources change every 16 columns, where the texture steps from 110 to 130 or smoothly to 115
    const auto source = [](std::int64_t x, std::int64_t) {
        return static_cast<std::uint32_t>(floor_mod(x, 32) / 16);
    };
    const PaintedTexture hard{
        [&](std::int64_t x, std::int64_t y) { return floor_mod(x, 16) == 0 ? grey(130) : columns(x, y); },
        source};
    const PaintedTexture blended{
        [&](std::int64_t x, std::int64_t y) { return floor_mod(x, 16) == 0 ? grey(115) : columns(x, y); }};
    const auto seams = measure_seams(asset, hard, blended, progress);
    ASSERT_TRUE(seams);
    const double own = double(lightness_at(110) - lightness_at(100));
    EXPECT_NEAR(seams->exemplar.mean, own / 2, 0.02);
    EXPECT_NEAR(seams->exemplar.percentile_99, own, 0.1);
    EXPECT_NEAR(seams->hard.mean, double(lightness_at(130) - lightness_at(110)), 0.01);
    EXPECT_NEAR(seams->hard_ratio.mean, seams->hard.mean / seams->exemplar.mean, 1e-9);
    EXPECT_NEAR(seams->blended.mean, double(lightness_at(115) - lightness_at(110)), 0.01);
    EXPECT_EQ(seams->pairs, 2048U * 2048U / 16U);
    // Every 16th column's step to the right is a seam, at every occurrence of the tile
    EXPECT_EQ(seams->frequency[15], 1);
    EXPECT_EQ(seams->frequency[14], 0);
    EXPECT_EQ(seams->energy[14], 0);
    EXPECT_NEAR(double(seams->energy[64 * 9 + 31]), seams->hard_ratio.mean, 1e-3);
}

TEST_F(Measures, WangTilesHaveSeamsBetweenTilesOfOneKindToo) {
    ExchangeAsset asset = asset_of(64, [](std::int64_t x, std::int64_t y) { return noise(x, y); });
    asset.method = ExchangeMethod::wang;
    asset.patches[0].width = asset.patches[0].height = 64;
    asset.patches[0].contents.push_back({{32, 32}, {}});
    const PaintedTexture texture{[](std::int64_t x, std::int64_t y) { return noise(x, y); }};
    const auto seams = measure_seams(asset, texture, texture, progress);
    ASSERT_TRUE(seams);
    EXPECT_EQ(seams->pairs, 2U * 2048U * 32U);
    EXPECT_NEAR(seams->hard_ratio.mean, 1, 0.05);
}

TEST_F(Measures, ThePeriodicTileRepeatsAndNoiseDoesNot) {
    const auto tile = [](std::int64_t x, std::int64_t y) {
        return noise(floor_mod(x, 256), floor_mod(y, 256));
    };
    const auto periodic = measure_repetition(PaintedTexture{tile}, 256, progress);
    ASSERT_TRUE(periodic);
    EXPECT_EQ(periodic->levels.size(), 3U);
    EXPECT_EQ(periodic->levels[0].shifts.size(), 24U);
    EXPECT_NEAR(periodic->levels[0].greatest.value, 1, 0.001);
    EXPECT_LT(periodic->levels[0].elsewhere, 0.02);
    const auto free = measure_repetition(
        PaintedTexture{[](std::int64_t x, std::int64_t y) { return noise(x, y); }}, 256, progress);
    ASSERT_TRUE(free);
    EXPECT_LT(free->levels[0].greatest.value, 0.005);
    // The mean of all occurrences is the tile, or nearly flat
    ASSERT_EQ(periodic->mean_side, 256);
    for (const int at : {0, 77, 65535}) {
        const Codes codes = tile(at % 256, at / 256);
        EXPECT_NEAR(periodic->mean_lightness[std::size_t(at)], tessera::lightness_of(codes.data()), 0.1);
        EXPECT_NEAR(free->mean_lightness[std::size_t(at)], lightness_at(91), 3);
    }
}

TEST_F(Measures, HalfTheTilesReplacedRepeatAQuarter) {
    const auto texture = [](std::int64_t x, std::int64_t y) {
        const std::int64_t u = floor_mod(x, 128), v = floor_mod(y, 128);
        const bool replaced = hash(seed, stream("replaced"), (x - u) / 128, (y - v) / 128) % 2 == 0;
        return replaced ? noise(x, y, 1) : noise(u, v);
    };
    const auto repetition = measure_repetition(PaintedTexture{texture}, 128, progress);
    ASSERT_TRUE(repetition);
    EXPECT_NEAR(repetition->levels[0].mean, 0.25, 0.03);
}

TEST_F(Measures, TilesThatAreLargeAreSampledSoThatShiftsStayMultiplesOfThem) {
    const auto texture = [](std::int64_t x, std::int64_t y) {
        return noise(floor_mod(x, 1024), floor_mod(y, 1024));
    };
    const auto repetition = measure_repetition(PaintedTexture{texture}, 1024, progress);
    ASSERT_TRUE(repetition);
    for (const auto& shift : repetition->levels[0].shifts) EXPECT_NEAR(shift.value, 1, 0.001);
    EXPECT_LT(repetition->levels[0].elsewhere, 0.02);
}

TEST_F(Measures, TileShareCountsHowOftenAPlaceShowsTheTileAndHowOftenTheSame) {
    // The corner always shows the tile; all else one of four contents, or the tile, alike
    const auto source = [](std::int64_t x, std::int64_t y) {
        const std::int64_t u = floor_mod(x, 64), v = floor_mod(y, 64);
        if (u < 8 && v < 8) return 0U;
        return uniform_below(hash(seed, stream("source"), (x - u) / 64, (y - v) / 64), 5);
    };
    const auto share = measure_tile_share(PaintedTexture{[](auto, auto) { return grey(0); }, source}, 64,
                                          TileSample::rows, progress);
    ASSERT_TRUE(share);
    EXPECT_EQ(share->cells_a_side, 8);
    EXPECT_EQ(share->occurrences, 64 * 64);
    EXPECT_EQ(share->tile.corner, 1);
    EXPECT_EQ(share->tile.greatest, 1);
    EXPECT_NEAR(double(share->tile.cells[9]), 0.2, 0.03);
    EXPECT_NEAR(share->tile.mean, (63 * double(share->tile.cells[9]) + 1) / 64, 1e-6);
    EXPECT_EQ(share->repeat.corner, 1);
    EXPECT_NEAR(double(share->repeat.cells[9]), 0.2, 0.01);
    EXPECT_GT(share->chance, share->repeat.mean);
    const auto fewer = measure_tile_share(PaintedTexture{[](auto, auto) { return grey(0); }, source}, 64,
                                          TileSample::whole_tiles, progress);
    ASSERT_TRUE(fewer);
    EXPECT_EQ(fewer->occurrences, 16 * 16);
    EXPECT_EQ(fewer->tile.corner, 1);
    EXPECT_NEAR(double(fewer->tile.cells[9]), 0.2, 0.1);
    EXPECT_NEAR(share->beyond_chance, 1.0 / 64, 1e-9);
}

TEST_F(Measures, IndependentDrawsKeepToChance) {
    const auto source = [](std::int64_t x, std::int64_t y) {
        const std::int64_t u = floor_mod(x, 64), v = floor_mod(y, 64);
        const auto cell = static_cast<std::uint64_t>(v / 8 * 8 + u / 8);
        return uniform_below(hash(seed, stream("source", cell), (x - u) / 64, (y - v) / 64), 25);
    };
    const auto share = measure_tile_share(PaintedTexture{[](auto, auto) { return grey(0); }, source}, 64,
                                          TileSample::rows, progress);
    ASSERT_TRUE(share);
    EXPECT_NEAR(share->repeat.mean, 0.04, 0.0005);
    EXPECT_LE(share->beyond_chance, 1.0 / 64);
}

TEST_F(Measures, FidelityIsHowFarColoursMoved) {
    const auto paint = [](std::int64_t x, std::int64_t y) { return noise(x, y); };
    const ExchangeAsset asset = asset_of(512, paint);
    const auto same = measure_fidelity(asset, PaintedTexture{paint}, progress);
    ASSERT_TRUE(same);
    EXPECT_LT(same->texture.lightness, 0.1);
    EXPECT_LT(same->texture.steps, 0.1);
    const auto lighter = measure_fidelity(
        asset, PaintedTexture{[](std::int64_t x, std::int64_t y) { return grey(noise(x, y)[0] + 20); }},
        progress);
    ASSERT_TRUE(lighter);
    EXPECT_NEAR(lighter->texture.lightness, double(lightness_at(111) - lightness_at(91)), 0.3);
    EXPECT_LT(lighter->tile.lightness, 0.1);
}

TEST_F(Measures, AnEndedWaitStopsEveryMeasurement) {
    const auto paint = [](std::int64_t x, std::int64_t y) { return noise(x, y); };
    const PaintedTexture texture{paint};
    const ExchangeAsset asset = asset_of(64, paint);
    StoppedProgress stopped;
    stopped.source.request_stop();
    const ProgressPart part{stopped, "measuring"};
    EXPECT_EQ(measure_seams(asset, texture, texture, part).error().code, ErrorCode::cancelled);
    EXPECT_EQ(measure_repetition(texture, 64, part).error().code, ErrorCode::cancelled);
    EXPECT_EQ(measure_tile_share(texture, 64, TileSample::rows, part).error().code, ErrorCode::cancelled);
    EXPECT_EQ(measure_fidelity(asset, texture, part).error().code, ErrorCode::cancelled);
}

TEST_F(Measures, GatesAreThoseOfTheMethod) {
    const auto paint = [](std::int64_t x, std::int64_t y) { return noise(x, y); };
    ExchangeAsset asset = asset_of(64, paint);
    for (int i = 0; i < 25; ++i) asset.patches[0].contents.push_back({{0, 0}, {}});
    asset.patches[0].contents.back().standing = ExchangeAsset::Standing::dropped;
    Seams seams;
    seams.hard_ratio = {1.15, 1.16};
    Repetition repetition;
    repetition.levels.resize(1);
    repetition.levels[0].greatest.value = 0.08;
    TileShare share;
    share.shifted.value = 0.11;
    const auto exchange = gates_of(asset, seams, repetition, share);
    ASSERT_EQ(exchange.size(), 5U);
    EXPECT_TRUE(exchange[0].passed());
    EXPECT_FALSE(exchange[1].passed());
    EXPECT_NEAR(exchange[4].limit, 1.0 / 24 + 0.03, 1e-9) << "what is dropped does not count";
    EXPECT_FALSE(exchange[4].passed());
    asset.method = ExchangeMethod::interchange;
    const auto interchange = gates_of(asset, seams, repetition, share);
    ASSERT_EQ(interchange.size(), 6U);
    EXPECT_TRUE(interchange[4].passed());
    EXPECT_FALSE(interchange[5].passed()) << "units repeat, if not tiles";
    asset.method = ExchangeMethod::wang;
    EXPECT_EQ(gates_of(asset, seams, repetition, share).size(), 4U);
}

}  // namespace
}  // namespace tessera
