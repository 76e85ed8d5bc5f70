#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <thread>

#include "shared/math/srgb.h"
#include "tests/property/texture/exchange_pages.h"

namespace tessera {
namespace {

using tests::below;
using tests::codes;
using tests::linear;
using tests::make_asset;
using tests::make_synthetic_asset;

struct Difference {
    double worst = 0;
    double mean = 0;  ///< Signed: a bias.
};

/// In codes of linear light.
Difference against_children(const Texture& texture, const TexelRegion& region) {
    const LinearImage page = linear(texture, region), children = linear(texture, below(region));
    Difference difference;
    for (std::int32_t y = 0; y < region.height; ++y)
        for (std::int32_t x = 0; x < region.width; ++x)
            for (std::int32_t c = 0; c < 4; ++c) {
                const double reduced =
                    0.25 * (double{children.row(2 * y)[8 * x + c]} + children.row(2 * y)[8 * x + 4 + c] +
                            children.row(2 * y + 1)[8 * x + c] + children.row(2 * y + 1)[8 * x + 4 + c]);
                const double d = (page.row(y)[4 * x + c] - reduced) / code_in_linear;
                difference.worst = std::max(difference.worst, std::abs(d));
                difference.mean += d / (4.0 * region.width * region.height);
            }
    return difference;
}

/// The same on what is sent: 8-bit codes, children decoded, averaged in linear light and encoded again.
double encoded_against_children(const Texture& texture, const TexelRegion& region) {
    const Rgba8Image page = codes(texture, region), children = codes(texture, below(region));
    double worst = 0;
    for (std::int32_t y = 0; y < region.height; ++y)
        for (std::int32_t x = 0; x < region.width; ++x)
            for (std::int32_t c = 0; c < 3; ++c) {
                const auto step = [&](std::int32_t dx, std::int32_t dy) {
                    return double{from_srgb(children.row(2 * y + dy)[8 * x + 4 * dx + c])};
                };
                const double mean = 0.25 * (step(0, 0) + step(1, 0) + step(0, 1) + step(1, 1));
                // As a real-valued code, so that the rounding counted is the children's and the page's
                const std::uint8_t code = page.row(y)[4 * x + c];
                double real_code = 0;
                for (int k = 0; k < 255; ++k)
                    if (mean >= from_srgb(static_cast<std::uint8_t>(k)))
                        real_code = k + std::min(1.0, (mean - from_srgb(static_cast<std::uint8_t>(k))) /
                                                          (from_srgb(static_cast<std::uint8_t>(k + 1)) -
                                                           from_srgb(static_cast<std::uint8_t>(k))));
                worst = std::max(worst, std::abs(code - real_code));
            }
    return worst;
}

/// Where an evaluator might go wrong: at the origin, across it, and far out, also beyond the largest extent.
std::vector<std::pair<std::int64_t, std::int64_t>> places(std::uint8_t level) {
    const std::int64_t far = std::int64_t{1} << (38 - level);
    return {
        {0, 0}, {-13, -7}, {1234567 >> level, 7654321 >> level}, {far - 9, far / 2 - 11}, {-far, far + 5}};
}

struct Case {
    std::string name;
    ExchangeMethod method = ExchangeMethod::content_exchange;
    tests::SyntheticAssetOptions asset;
    ExchangeOptions options;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class ExchangeLaws : public testing::TestWithParam<Case> {
  protected:
    const ExchangeAsset asset_ = make_asset(GetParam().method, GetParam().asset);
    const std::shared_ptr<const Texture> texture_ = make_exchange_texture(asset_, GetParam().options);
};

TEST_P(ExchangeLaws, APageIsTheReductionOfItsChildren) {
    const bool typed = GetParam().options.choice == Choice::typed;
    const int tile_level = static_cast<int>(std::log2(asset_.tile_side));
    // Independent choices are exact as far as they are enumerated
    const bool kolar = GetParam().options.choice == Choice::kolar;
    const int top = typed ? 30 : kolar ? tile_level + 2 : tile_level + 3;
    for (std::uint8_t level = 1; level <= top; ++level)
        for (const auto& [x, y] : places(level)) {
            SCOPED_TRACE(testing::Message() << "level " << int{level} << " at " << x << ", " << y);
            const std::int32_t side = level > tile_level && !typed ? 8 : 40;
            const Difference difference = against_children(*texture_, {level, x, y, side, side - 3});
            EXPECT_LT(difference.worst, 0.02);
            EXPECT_LT(std::abs(difference.mean), 0.02);
            EXPECT_LT(encoded_against_children(*texture_, {level, x, y, 8, 8}), 1.1);
        }
}

TEST_P(ExchangeLaws, AnyWindowOnALevelShowsTheSameTexels) {
    for (const std::uint8_t level : std::initializer_list<std::uint8_t>{0, 1, 3, 5, 6, 7, 8, 12}) {
        if (GetParam().options.choice != Choice::typed && level > 8) continue;
        const TexelRegion whole{level, -37, 21, 90, 70}, window{level, -5, 40, 33, 29};
        const Rgba8Image a = codes(*texture_, whole), b = codes(*texture_, window);
        for (std::int32_t y = 0; y < window.height; ++y)
            ASSERT_TRUE(std::equal(
                b.row(y), b.row(y) + window.width * 4,
                a.row(y + static_cast<std::int32_t>(window.y - whole.y)) + (window.x - whole.x) * 4))
                << "level " << int{level} << " row " << y;
    }
}

TEST_P(ExchangeLaws, ATexelAloneIsThatOfItsPage) {
    for (const std::int64_t origin : {std::int64_t{0}, std::int64_t{-64}, (std::int64_t{1} << 37) - 50}) {
        const TexelRegion whole{0, origin - 31, origin + 5, 100, 90};
        const Rgba8Image page = codes(*texture_, whole);
        for (std::int32_t y = 0; y < whole.height; ++y)
            for (std::int32_t x = y % 3; x < whole.width; x += 3)
                ASSERT_TRUE(std::equal(page.row(y) + 4 * x, page.row(y) + 4 * x + 4,
                                       codes(*texture_, {0, whole.x + x, whole.y + y, 1, 1}).row(0)))
                    << x << ", " << y;
    }
}

TEST_P(ExchangeLaws, ManyThreadsGiveTheBytesOfOne) {
    const TexelRegion region{2, 100, -900, 128, 128};
    const Rgba8Image alone = codes(*texture_, region);
    std::vector<Rgba8Image> images(8);
    {
        std::vector<std::jthread> threads;
        for (Rgba8Image& image : images)
            threads.emplace_back([&] { (void)texture_->evaluate(region, Budget{}, image); });
    }
    for (const Rgba8Image& image : images) EXPECT_EQ(image, alone);
}

TEST_P(ExchangeLaws, TakesNoMoreMemoryThanForetold) {
    const std::size_t foretold = exchange_bytes(asset_, GetParam().options);
    EXPECT_LE(texture_->memory_bytes(), foretold);
    EXPECT_GT(texture_->memory_bytes(), foretold / 40) << "a bound that refuses what would fit";
}

TEST_P(ExchangeLaws, CodesAreTheEncodedLinearTexels) {
    for (const std::uint8_t level : std::initializer_list<std::uint8_t>{0, 2, 6}) {
        const TexelRegion region{level, 7, 9, 64, 64};
        const Rgba8Image sent = codes(*texture_, region);
        Rgba8Image encoded;
        encode(linear(*texture_, region), encoded);
        for (std::size_t i = 0; i < sent.bytes.size(); ++i)
            ASSERT_NEAR(sent.bytes[i], encoded.bytes[i], 1) << i;
        const auto different = [&] {
            std::size_t count = 0;
            for (std::size_t i = 0; i < sent.bytes.size(); ++i) count += sent.bytes[i] != encoded.bytes[i];
            return count;
        }();
        EXPECT_LT(different, sent.bytes.size() / 500);
    }
}

TEST_P(ExchangeLaws, AConstantExemplarStaysConstantToTheLastBit) {
    for (const int code : {1, 93, 200, 255}) {
        auto made = GetParam().asset;
        made.constant_code = code;
        const auto texture = make_exchange_texture(make_asset(GetParam().method, made), GetParam().options);
        const float expected = linear(*texture, {0, 0, 0, 1, 1}).values[0];
        EXPECT_EQ(expected, from_srgb(static_cast<std::uint8_t>(code)));
        for (std::uint8_t level = 0; level <= 30; ++level)
            for (const auto& [x, y] : places(level)) {
                const TexelRegion region{level, x, y, 24, 24};
                const LinearImage values = linear(*texture, region, Accuracy::high);
                for (std::size_t i = 0; i < values.values.size(); ++i)
                    ASSERT_EQ(values.values[i], i % 4 == 3 ? 1.0F : expected) << "level " << int{level};
                const Rgba8Image sent = codes(*texture, {level, x, y, 5, 5});
                for (std::size_t i = 0; i < sent.bytes.size(); ++i)
                    ASSERT_EQ(sent.bytes[i], i % 4 == 3 ? 255 : code) << "level " << int{level};
            }
    }
}

std::vector<Case> cases() {
    using O = ExchangeOptions;
    constexpr auto content_exchange = ExchangeMethod::content_exchange;
    constexpr auto interchange = ExchangeMethod::interchange;
    constexpr auto wang = ExchangeMethod::wang;
    return {
        {"typed", content_exchange, {}, O{.seed = 3}},
        {"typed_unblended", content_exchange, {}, O{.seed = 3, .blended = false}},
        {"typed_many_patches",
         content_exchange,
         {.tile_side = 128, .patches = 100, .contents = 3, .blend_texels = 6},
         O{.types = 256}},
        {"typed_small_tile",
         content_exchange,
         {.tile_side = 16, .patches = 4, .blend_texels = 2},
         O{.seed = 9, .types = 64}},
        {"independent", content_exchange, {}, O{.seed = 5, .choice = Choice::independent}},
        {"independent_unblended",
         content_exchange,
         {},
         O{.seed = 5, .choice = Choice::independent, .blended = false}},
        {"interchange", interchange, {.patches = 300}, O{.seed = 3, .types = 256}},
        {"interchange_unblended", interchange, {.patches = 200}, O{.types = 128, .blended = false}},
        {"interchange_small_tile",
         interchange,
         {.tile_side = 16, .patches = 60, .blend_texels = 2},
         O{.types = 64}},
        {"interchange_groups", interchange, {.patches = 100, .groups = 24}, O{.seed = 3, .types = 128}},
        {"kolar", interchange, {.patches = 200}, O{.seed = 2, .choice = Choice::kolar}},
        {"wang", wang, {.tile_side = 32, .blend_texels = 0}, O{.seed = 4, .types = 128}},
    };
}

INSTANTIATE_TEST_SUITE_P(All, ExchangeLaws, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

TEST(Exchange, ATexelFarUpIsWithinTheBoundOfTheExpectation) {
    const ExchangeAsset asset = make_synthetic_asset({});
    const auto texture = make_exchange_texture(asset, {.seed = 4, .choice = Choice::independent});
    LinearImage expected, enumerated;
    for (const std::uint8_t level : std::initializer_list<std::uint8_t>{7, 8, 9}) {  // 2, 4, 8 tiles a side
        const TexelRegion region{level, -20, 8, 32, 32};
        const auto guess = texture->evaluate(region, Budget{.accuracy = Accuracy::fast}, expected);
        const auto truth = texture->evaluate(region, Budget{.accuracy = Accuracy::exact}, enumerated);
        ASSERT_EQ(guess->method, "expectation");
        ASSERT_EQ(truth->method, "enumeration");
        double worst = 0;
        for (std::size_t i = 0; i < expected.values.size(); ++i)
            worst =
                std::max(worst, std::abs(double{expected.values[i]} - enumerated.values[i]) / code_in_linear);
        EXPECT_LE(worst, guess->bound_codes);
        EXPECT_GT(worst, guess->bound_codes / 40) << "a bound that says nothing";
    }
    const auto far = texture->evaluate({24, 0, 0, 4, 4}, Budget{}, expected);
    EXPECT_LT(far->bound_codes, 0.01);
}

TEST(Exchange, WithIndependentChoicesAPageIsTheReductionOfItsChildrenWithinTheStatedBounds) {
    // Also where the children are enumerated and the page is expected, and where both are expected
    const auto texture =
        make_exchange_texture(make_synthetic_asset({}), {.seed = 4, .choice = Choice::independent});
    std::set<std::string> methods;
    for (const Accuracy accuracy : accuracies)
        for (std::uint8_t level = 1; level <= 16; ++level) {
            const TexelRegion region{level, -5, 9, 16, 16};
            LinearImage page, children;
            const auto above = texture->evaluate(region, Budget{.accuracy = accuracy}, page);
            const auto under = texture->evaluate(below(region), Budget{.accuracy = accuracy}, children);
            ASSERT_TRUE(above && under);
            methods.insert(std::string{under->method} + " under " + std::string{above->method});
            for (std::int32_t y = 0; y < 16; ++y)
                for (std::int32_t x = 0; x < 64; ++x) {
                    const std::int32_t left = x / 4 * 8 + x % 4;
                    const float mean =
                        0.25F * (children.row(2 * y)[left] + children.row(2 * y)[left + 4] +
                                 children.row(2 * y + 1)[left] + children.row(2 * y + 1)[left + 4]);
                    ASSERT_LE(std::abs(page.row(y)[x] - mean) / code_in_linear,
                              above->bound_codes + under->bound_codes + 0.001)
                        << "level " << int{level};
                }
        }
    EXPECT_TRUE(methods.contains("enumeration under expectation"));
    EXPECT_TRUE(methods.contains("expectation under expectation"));
}

TEST(Exchange, NoPageOfIndependentChoicesIsBeyondReach) {
    // Enumeration costs tiles × patches: where that is too much, the expectation answers, whatever was asked
    const auto texture = make_exchange_texture(
        make_synthetic_asset({.tile_side = 64, .patches = 1024, .contents = 2, .blend_texels = 2}),
        {.choice = Choice::independent});
    for (std::uint8_t level = 6; level <= 30; ++level)
        for (const Accuracy accuracy : accuracies) {
            LinearImage page;
            const auto evaluation =
                texture->evaluate({level, 0, 0, 64, 64}, Budget{.accuracy = accuracy}, page);
            ASSERT_TRUE(evaluation.has_value());
            EXPECT_LE(evaluation->work, 64u * 64 * 8192) << "level " << int{level};
        }
}

TEST(Exchange, StopsWhenNobodyWaitsOrTimeIsUp) {
    const auto texture = make_exchange_texture(make_synthetic_asset({}), {});
    std::stop_source source;
    source.request_stop();
    LinearImage image;
    EXPECT_EQ(texture->evaluate({0, 0, 0, 8, 8}, Budget{.cancelled = source.get_token()}, image).error().code,
              ErrorCode::cancelled);
    EXPECT_EQ(texture->evaluate({9, 0, 0, 8, 8}, Budget{.deadline = std::chrono::steady_clock::now()}, image)
                  .error()
                  .code,
              ErrorCode::timed_out);
}

}  // namespace
}  // namespace tessera
