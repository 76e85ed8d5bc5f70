#include <algorithm>
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/texture/lean.h"
#include "server/texture/material.h"
#include "tests/support/synthetic_asset.h"
#include "tests/support/synthetic_channels.h"

namespace tessera {
namespace {

using namespace tests;

ExchangeAsset asset_of(ExchangeMethod method, std::int32_t blend_texels = 4) {
    switch (method) {
        case ExchangeMethod::interchange:
            return make_synthetic_interchange({.patches = 100, .blend_texels = blend_texels});
        case ExchangeMethod::wang:
            return make_synthetic_wang({});
        case ExchangeMethod::content_exchange:
            break;
    }
    return make_synthetic_asset({.blend_texels = blend_texels});
}

/// A surface: its colour, and the sets beside it.
struct Surface {
    std::shared_ptr<const ExchangeTexture> albedo;
    std::vector<Channels> channels;

    Surface(const ExchangeAsset& asset, const ExchangeOptions& options)
        : albedo{make_exchange_texture(asset, options)}, channels{make_channels(albedo, asset)} {}

    const Texture* find(ChannelSet set) const {
        for (const Channels& one : channels)
            if (one.set == set) return one.texture.get();
        return nullptr;
    }
    const Texture& operator[](ChannelSet set) const { return *find(set); }
};

struct Page {
    LinearImage texels;
    Evaluation evaluation;
    const float* at(std::int32_t x, std::int32_t y) const { return texels.row(y) + 4 * x; }
};

Page page_of(const Texture& texture, const TexelRegion& region) {
    Page page;
    page.evaluation = texture.evaluate(region, Budget{.accuracy = Accuracy::exact}, page.texels).value();
    return page;
}

Rgba8Image codes_of(const Texture& texture, const TexelRegion& region) {
    Rgba8Image image;
    EXPECT_TRUE(texture.evaluate(region, Budget{.accuracy = Accuracy::exact}, image).has_value());
    return image;
}

Slopes slopes_at(const Page& normals, std::int32_t x, std::int32_t y) {
    const float* n = normals.at(x, y);
    const double up = n[2] - 0.5;
    return {(n[0] - 0.5) / up, (n[1] - 0.5) / up};
}

/// A few texels of `level`, and all the texels of level 0 under them.
struct Under {
    TexelRegion coarse, fine;
    std::int32_t side;
    explicit Under(std::uint8_t level) : side{1 << level} {
        const std::int32_t count = std::max(1, 64 >> level);
        coarse = {level, -3, 5, count, count};
        fine = {0, -3 * std::int64_t{side}, 5 * std::int64_t{side}, count * side, count * side};
    }
    template <class Visit>
    void each_texel(const Visit& visit) const {
        for (std::int32_t y = 0; y < coarse.height; ++y)
            for (std::int32_t x = 0; x < coarse.width; ++x) visit(x, y);
    }
    template <class Visit>
    void each_under(std::int32_t x, std::int32_t y, const Visit& visit) const {
        for (std::int32_t j = 0; j < side; ++j)
            for (std::int32_t i = 0; i < side; ++i) visit(x * side + i, y * side + j);
    }
};

constexpr std::uint8_t levels[]{1, 3, 6, 8};

class MaterialLaws : public testing::TestWithParam<ExchangeMethod> {
  protected:
    ExchangeAsset bumpy(std::uint8_t least_roughness = 80, std::uint8_t most_roughness = 150) const {
        ExchangeAsset asset = asset_of(GetParam());
        add_bumps(asset, 50);
        add_grey_noise(asset, "roughness", least_roughness, most_roughness);
        return asset;
    }
    ExchangeOptions options(bool blended) const { return {.seed = 3, .types = 64, .blended = blended}; }
};

TEST_P(MaterialLaws, TheNormalOfATexelIsThatOfTheMeanSlopesUnderIt) {
    const Surface surface{bumpy(), options(true)};
    const Texture& normal = surface[ChannelSet::normal];
    for (const std::uint8_t level : levels) {
        const Under under{level};
        const Page coarse = page_of(normal, under.coarse), fine = page_of(normal, under.fine);
        // Beside the stated bounds only the pages' own floats are between the two
        const double bound = (coarse.evaluation.bound_codes + 2 * fine.evaluation.bound_codes) / 255 + 2e-6;
        under.each_texel([&](std::int32_t x, std::int32_t y) {
            Slopes mean;
            under.each_under(x, y, [&](std::int32_t i, std::int32_t j) {
                const Slopes slopes = slopes_at(fine, i, j);
                mean.x += slopes.x / (under.side * under.side);
                mean.y += slopes.y / (under.side * under.side);
            });
            const double half = 0.5 / std::sqrt(1 + mean.x * mean.x + mean.y * mean.y);
            EXPECT_NEAR(coarse.at(x, y)[0], 0.5 + mean.x * half, bound) << int(level);
            EXPECT_NEAR(coarse.at(x, y)[1], 0.5 + mean.y * half, bound) << int(level);
            EXPECT_NEAR(coarse.at(x, y)[2], 0.5 + half, bound) << int(level);
        });
        EXPECT_LT(bound * 255, 0.05) << int(level);
    }
}

TEST_P(MaterialLaws, RoughnessTakesUpTheVarianceOfTheSlopesUnderATexel) {
    // Without blending a texel of level 0 has one slope and one roughness, so brute force sees all there is
    const Surface surface{bumpy(), options(false)};
    const Texture &normal = surface[ChannelSet::normal], &roughness = surface[ChannelSet::roughness],
                  &moments = surface[ChannelSet::moments];
    for (const std::uint8_t level : levels) {
        const Under under{level};
        const Page coarse = page_of(roughness, under.coarse), fine = page_of(roughness, under.fine),
                   spread = page_of(moments, under.coarse), normals = page_of(normal, under.fine);
        const double bound = coarse.evaluation.bound_codes / 255 + 2e-5;
        const double spread_bound = spread.evaluation.bound_codes / 255 + 2e-5;
        double rougher_by = 0;
        under.each_texel([&](std::int32_t x, std::int32_t y) {
            double alpha2 = 0, roughest = 0, sum_x = 0, sum_y = 0, sum_xx = 0, sum_yy = 0, sum_xy = 0;
            const double count = under.side * under.side;
            under.each_under(x, y, [&](std::int32_t i, std::int32_t j) {
                const Slopes slopes = slopes_at(normals, i, j);
                sum_x += slopes.x / count, sum_y += slopes.y / count;
                sum_xx += slopes.x * slopes.x / count, sum_yy += slopes.y * slopes.y / count;
                sum_xy += slopes.x * slopes.y / count;
                alpha2 += std::pow(double{fine.at(i, j)[0]}, 4) / count;
                roughest = std::max(roughest, double{fine.at(i, j)[0]});
            });
            const double var_x = sum_xx - sum_x * sum_x, var_y = sum_yy - sum_y * sum_y;
            const double cov = sum_xy - sum_x * sum_y;
            EXPECT_NEAR(coarse.at(x, y)[0], std::pow(alpha2 + var_x + var_y, 0.25), bound) << int(level);
            EXPECT_NEAR(spread.at(x, y)[0], std::sqrt(std::max(0.0, var_x)), spread_bound) << int(level);
            EXPECT_NEAR(spread.at(x, y)[1], std::sqrt(std::max(0.0, var_y)), spread_bound) << int(level);
            EXPECT_NEAR(spread.at(x, y)[2], 0.5 + 0.5 * std::copysign(std::sqrt(std::abs(cov)), cov),
                        spread_bound)
                << int(level);
            rougher_by += coarse.at(x, y)[0] - roughest;
        });
        EXPECT_LT(coarse.evaluation.bound_codes, 0.5) << int(level);
        const std::int32_t count = under.coarse.width * under.coarse.height;
        EXPECT_GT(rougher_by / count, level < 3 ? 0.0 : 0.03) << int(level);
    }
}

TEST_P(MaterialLaws, AFlatSurfaceKeepsItsNormalAndRoughnessToTheLastCodeAtEveryLevel) {
    for (const Code3 flat : {Code3{128, 128, 255}, Code3{203, 90, 180}})
        for (const std::uint8_t code : std::initializer_list<std::uint8_t>{0, 37, 255}) {
            ExchangeAsset asset = asset_of(GetParam());
            add_flat_channel(asset, "normal", flat);
            add_flat_channel(asset, "roughness", {code, code, code});
            add_flat_channel(asset, "height", {code, code, code});
            const Surface surface{asset, options(true)};
            const Rgba8Image normal = codes_of(surface[ChannelSet::normal], {0, 0, 0, 1, 1});
            for (const std::uint8_t level : std::initializer_list<std::uint8_t>{0, 1, 4, 6, 7, 20}) {
                const TexelRegion region{level, -40, 17, 64, 16};
                const auto expect = [&](ChannelSet set, Code3 expected) {
                    const Rgba8Image page = codes_of(surface[set], region);
                    for (std::size_t i = 0; i < page.bytes.size(); i += 4)
                        ASSERT_THAT((Code3{page.bytes[i], page.bytes[i + 1], page.bytes[i + 2]}), expected)
                            << name_of(set) << " at level " << int(level);
                };
                expect(ChannelSet::normal, {normal.bytes[0], normal.bytes[1], normal.bytes[2]});
                expect(ChannelSet::roughness, {code, code, code});
                expect(ChannelSet::height, {code, code, code});
                expect(ChannelSet::moments, {0, 0, 128});
            }
        }
}

TEST_P(MaterialLaws, BlendingTwoContentsIsNotRough) {
    const Surface blended{bumpy(100, 100), options(true)};
    const TexelRegion region{0, -300, 77, 200, 200};
    const Rgba8Image rough = codes_of(blended[ChannelSet::roughness], region);
    for (std::size_t i = 0; i < rough.bytes.size(); i += 4) ASSERT_EQ(rough.bytes[i], 100);
}

TEST_P(MaterialLaws, EverySetShowsThePlaceThatTheAlbedoShows) {
    ExchangeAsset asset = bumpy();
    add_copy_of_albedo(asset, "height");
    const Surface surface{asset, options(false)};
    const TexelRegion region{0, 1000003, -777, 200, 150};
    const Rgba8Image albedo = codes_of(*surface.albedo, region),
                     height = codes_of(surface[ChannelSet::height], region);
    for (std::size_t i = 0; i < albedo.bytes.size(); i += 4) ASSERT_EQ(albedo.bytes[i], height.bytes[i]);
    // And far up, where the albedo is a sum over all that was chosen below
    for (const std::uint8_t level : levels) {
        const Under under{level};
        const Page coarse = page_of(surface[ChannelSet::height], under.coarse),
                   fine = page_of(surface[ChannelSet::height], under.fine);
        under.each_texel([&](std::int32_t x, std::int32_t y) {
            double mean = 0;
            under.each_under(x, y, [&](std::int32_t i, std::int32_t j) { mean += double{fine.at(i, j)[0]}; });
            EXPECT_NEAR(coarse.at(x, y)[0], mean / (under.side * under.side), 1e-5) << int(level);
        });
    }
}

TEST_P(MaterialLaws, NumbersAreCodedWithoutTheCurveOfColours) {
    const Surface surface{bumpy(), options(true)};
    for (const Channels& channels : surface.channels) {
        EXPECT_EQ(channels.texture->texel_kind(), TexelKind::data);
        const TexelRegion region{2, 11, -3, 40, 30};
        Rgba8Image coded;
        encode_data(page_of(*channels.texture, region).texels, coded);
        EXPECT_EQ(codes_of(*channels.texture, region), coded) << name_of(channels.set);
    }
    EXPECT_EQ(surface.albedo->texel_kind(), TexelKind::color);
}

INSTANTIATE_TEST_SUITE_P(All, MaterialLaws,
                         testing::Values(ExchangeMethod::content_exchange, ExchangeMethod::interchange,
                                         ExchangeMethod::wang),
                         [](const testing::TestParamInfo<ExchangeMethod>& method) {
                             return std::string{method.param == ExchangeMethod::content_exchange
                                                    ? "content_exchange"
                                                : method.param == ExchangeMethod::interchange ? "interchange"
                                                                                              : "wang"};
                         });

TEST(Material, HasTheSetsThatItsImagesMakePossible) {
    using enum ChannelSet;
    const auto sets_of = [](std::initializer_list<const char*> names) {
        ExchangeAsset asset = asset_of(ExchangeMethod::content_exchange);
        for (const char* name : names) add_flat_channel(asset, name, {128, 128, 255});
        std::vector<ChannelSet> sets;
        for (const Channels& one : Surface{asset, {.types = 64}}.channels) sets.push_back(one.set);
        return std::pair{sets, channel_textures(asset)};
    };
    using Sets = std::vector<ChannelSet>;
    EXPECT_EQ(sets_of({}), (std::pair{Sets{}, std::size_t{0}}));
    EXPECT_EQ(sets_of({"height"}), (std::pair{Sets{height}, std::size_t{1}}));
    EXPECT_EQ(sets_of({"height", "roughness"}), (std::pair{Sets{roughness, height}, std::size_t{1}}));
    EXPECT_EQ(sets_of({"normal"}), (std::pair{Sets{normal, moments}, std::size_t{3}}));
    EXPECT_EQ(sets_of({"roughness", "height", "normal"}),
              (std::pair{Sets{normal, roughness, height, moments}, std::size_t{3}}));
}

TEST(Material, RoughnessWithoutNormalsFiltersTheVarianceThatItStandsFor) {
    ExchangeAsset asset = asset_of(ExchangeMethod::content_exchange, 0);
    add_grey_noise(asset, "roughness", 0, 255);
    const Surface surface{asset, {.types = 64}};
    const Under under{3};
    const Page coarse = page_of(surface[ChannelSet::roughness], under.coarse),
               fine = page_of(surface[ChannelSet::roughness], under.fine);
    under.each_texel([&](std::int32_t x, std::int32_t y) {
        double alpha2 = 0;
        under.each_under(x, y, [&](std::int32_t i, std::int32_t j) {
            alpha2 += std::pow(double{fine.at(i, j)[0]}, 4) / 64;
        });
        EXPECT_NEAR(coarse.at(x, y)[0], std::pow(alpha2, 0.25), 1e-5);
    });
}

TEST(Material, StopsWhenNobodyWaits) {
    ExchangeAsset asset = asset_of(ExchangeMethod::content_exchange);
    add_bumps(asset, 20);
    const Surface surface{asset, {.types = 64}};
    std::stop_source nobody;
    nobody.request_stop();
    LinearImage out;
    const auto stopped =
        surface[ChannelSet::normal].evaluate({0, 0, 0, 8, 8}, Budget{.cancelled = nobody.get_token()}, out);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().code, ErrorCode::cancelled);
}

TEST(Material, GivesTheSameBytesOnEveryMachine) {
    // FNV-1a. Raise evaluator_version (server/scene) when these change.
    ExchangeAsset asset = asset_of(ExchangeMethod::content_exchange);
    add_bumps(asset, 50);
    add_grey_noise(asset, "roughness", 80, 150);
    const Surface surface{asset, {.seed = 2026, .types = 64}};
    std::uint64_t h = 0xcbf29ce484222325u;
    for (const Channels& channels : surface.channels)
        for (const std::uint8_t level : levels)
            for (const std::uint8_t byte : codes_of(*channels.texture, {level, -30, 7, 40, 40}).bytes)
                h = (h ^ byte) * 0x100000001b3u;
    EXPECT_EQ(h, 12641499179813967051u);
}

}  // namespace
}  // namespace tessera
