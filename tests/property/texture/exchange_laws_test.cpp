#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <thread>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/texture/exchange.h"
#include "server/texture/kernels.h"
#include "server/texture/typed_quadtree.h"
#include "server/texture/unit_choice.h"
#include "shared/math/hash.h"
#include "shared/math/srgb.h"
#include "tests/support/synthetic_asset.h"

namespace tessera {
namespace {

using tests::make_synthetic_asset;

LinearImage linear(const Texture& texture, const TexelRegion& region, Accuracy accuracy = Accuracy::exact) {
    LinearImage image;
    EXPECT_TRUE(texture.evaluate(region, Budget{.accuracy = accuracy}, image).has_value());
    return image;
}

Rgba8Image codes(const Texture& texture, const TexelRegion& region) {
    Rgba8Image image;
    EXPECT_TRUE(texture.evaluate(region, Budget{.accuracy = Accuracy::exact}, image).has_value());
    return image;
}

/// The four texels below each texel, averaged.
TexelRegion below(const TexelRegion& region) {
    return {static_cast<std::uint8_t>(region.level - 1), region.x * 2, region.y * 2, region.width * 2,
            region.height * 2};
}

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

ExchangeAsset make_asset(ExchangeMethod method, const tests::SyntheticAssetOptions& options) {
    switch (method) {
        case ExchangeMethod::interchange:
            return tests::make_synthetic_interchange(options);
        case ExchangeMethod::wang:
            return tests::make_synthetic_wang(options);
        case ExchangeMethod::content_exchange:
            break;
    }
    return make_synthetic_asset(options);
}

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
        {"kolar", interchange, {.patches = 200}, O{.seed = 2, .choice = Choice::kolar}},
        {"wang", wang, {.tile_side = 32, .blend_texels = 0}, O{.seed = 4, .types = 128}},
    };
}

INSTANTIATE_TEST_SUITE_P(All, ExchangeLaws, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

/// DESIGN section 2's sum, one texel at a time and from the asset alone: the readable reference. I = tile + Σ
/// over the patches of the shape's share of the window around the texel, rounded down to a 32768th, times
/// (content − tile).
std::array<double, 3> reference_texel(const ExchangeAsset& asset, const TypedQuadtree& tree,
                                      const Variants& variants, std::int64_t x, std::int64_t y,
                                      std::int32_t radius) {
    const std::int64_t side = asset.tile_side;
    const auto floor_mod = [&](std::int64_t a) { return ((a % side) + side) % side; };
    const auto texel = [](const Rgb8Image& image, std::int64_t u, std::int64_t v, std::size_t c) {
        return srgb_to_steps[image.bytes[static_cast<std::size_t>(v * image.width + u) * 3 + c]] / 65535.0;
    };
    std::array<double, 3> sum{};
    for (std::size_t c = 0; c < 3; ++c) sum[c] = texel(asset.tile, floor_mod(x), floor_mod(y), c);
    std::uint32_t first_shape = 0;
    for (const auto& patch : asset.patches) {
        // The occurrence of the patch that covers (x, y): its grown origin lies in [x − width, x]
        const std::int64_t in_x = floor_mod(x - patch.x + radius), in_y = floor_mod(y - patch.y + radius);
        const auto tile_of = [&](std::int64_t a) { return (a - floor_mod(a)) / side; };
        const std::int64_t tile_x = tile_of(x - in_x), tile_y = tile_of(y - in_y);
        const std::uint16_t type = tree.types_of(0, tile_x, tile_y, 1, 1).at(tile_x, tile_y);
        for (const Shown& shown : variants.of(type)) {
            if (shown.shape < first_shape || shown.shape >= first_shape + patch.contents.size()) continue;
            const auto& content = patch.contents[shown.shape - first_shape];
            std::int64_t count = 0;
            for (std::int64_t v = in_y - 2 * radius; v <= in_y; ++v)
                for (std::int64_t u = in_x - 2 * radius; u <= in_x; ++u)
                    if (u >= 0 && v >= 0 && u < patch.width && v < patch.height)
                        count += content.shape.at(static_cast<std::int32_t>(u), static_cast<std::int32_t>(v));
            const double weight = double(count * 32768 / ((2 * radius + 1) * (2 * radius + 1))) / 32768;
            if (weight == 0) continue;
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += weight * (texel(asset.exemplar, content.at.x - radius + in_x,
                                          content.at.y - radius + in_y, c) -
                                    texel(asset.tile, floor_mod(x), floor_mod(y), c));
        }
        first_shape += static_cast<std::uint32_t>(patch.contents.size());
    }
    return sum;
}

TEST(Exchange, AgreesWithTheReadableReferenceAtLevel0) {
    const ExchangeAsset asset = make_synthetic_asset({});
    const ExchangeOptions options{.seed = 77, .types = 4096};
    const auto texture = make_exchange_texture(asset, options);
    const TypedQuadtree tree{options.seed, options.types};
    const std::int32_t radius = asset.blend_texels / 2;
    const Variants variants = content_variants(Shapes{asset, radius}, options.seed, options.types);
    const TexelRegion region{0, -70, 1000, 140, 100};
    const LinearImage page = linear(*texture, region);
    for (std::int32_t y = 0; y < region.height; ++y)
        for (std::int32_t x = 0; x < region.width; ++x) {
            const auto expected = reference_texel(asset, tree, variants, region.x + x, region.y + y, radius);
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(page.row(y)[4 * x + std::int32_t(c)], expected[c], 0.01 * code_in_linear)
                    << x << ", " << y;
        }
}

TEST(Exchange, AgreesWithPaintingOneShapeAfterAnotherWhereItDoesNotBlend) {
    // Whatever the method: sources() says which content a texel shows, and the page shows that content's
    // texel
    for (const ExchangeMethod method :
         {ExchangeMethod::content_exchange, ExchangeMethod::interchange, ExchangeMethod::wang})
        for (const Choice choice : {Choice::typed, Choice::kolar}) {
            if (choice == Choice::kolar && method != ExchangeMethod::interchange) continue;
            const ExchangeAsset asset = make_asset(method, {.patches = 100});
            const auto texture =
                make_exchange_texture(asset, {.choice = choice, .types = 64, .blended = false});
            const TexelRegion region{0, -200, 77, 300, 200};
            const auto sources = texture->sources(region);
            ASSERT_TRUE(sources.has_value());
            const Rgba8Image page = codes(*texture, region);
            std::vector<std::pair<std::size_t, std::size_t>> of_source;
            for (std::size_t p = 0; p < asset.patches.size(); ++p)
                for (std::size_t c = 0; c < asset.patches[p].contents.size(); ++c)
                    of_source.emplace_back(p, c);
            std::size_t exchanged = 0;
            for (std::int32_t y = 0; y < region.height; ++y)
                for (std::int32_t x = 0; x < region.width; ++x) {
                    const std::int64_t wrap = asset.tile_side - 1;
                    const std::uint32_t source = (*sources)[std::size_t(y * region.width + x)];
                    const Rgb8Image& image = source == 0 ? asset.tile : asset.exemplar;
                    std::int64_t u = (region.x + x) & wrap, v = (region.y + y) & wrap;
                    if (source > 0) {
                        const auto& patch = asset.patches[of_source[source - 1].first];
                        const auto& content = patch.contents[of_source[source - 1].second];
                        // Where in its box the texel lies: boxes are no wider than two tiles
                        std::int64_t in_x = (region.x + x - patch.x) & wrap,
                                     in_y = (region.y + y - patch.y) & wrap;
                        ASSERT_LT(patch.width, asset.tile_side + 1);
                        ASSERT_TRUE(content.shape.at(static_cast<std::int32_t>(in_x),
                                                     static_cast<std::int32_t>(in_y)));
                        u = content.at.x + in_x;
                        v = content.at.y + in_y;
                        ++exchanged;
                    }
                    for (std::int32_t c = 0; c < 3; ++c)
                        ASSERT_EQ(page.row(y)[x * 4 + c],
                                  image.bytes[std::size_t((v * image.width + u) * 3 + c)]);
                }
            EXPECT_GT(exchanged, sources->size() / (choice == Choice::kolar ? 10 : 3));
        }
}

TEST(Exchange, ShowsOnlyColoursOfTheExemplarWhereItDoesNotBlend) {
    const ExchangeAsset asset = make_synthetic_asset({});
    const auto texture = make_exchange_texture(asset, {.blended = false});
    std::set<std::tuple<int, int, int>> colours;
    for (const Rgb8Image* image : {&asset.exemplar, &asset.tile})
        for (std::size_t i = 0; i < image->bytes.size(); i += 3)
            colours.emplace(image->bytes[i], image->bytes[i + 1], image->bytes[i + 2]);
    const Rgba8Image page = codes(*texture, {0, -300, 500, 256, 256});
    for (std::size_t i = 0; i < page.bytes.size(); i += 4)
        ASSERT_TRUE(colours.contains({page.bytes[i], page.bytes[i + 1], page.bytes[i + 2]}));
}

TEST(Exchange, NeverRepeatsItsChoiceOfContentsWithAPeriod) {
    const std::uint32_t types = 4096;
    const TypedQuadtree tree{1, types};
    const std::int32_t side = 256;
    const TypeGrid grid = tree.types_of(0, -side / 2, -side / 2, 2 * side, 2 * side);
    // For every displacement of up to 128 tiles: how many of 4096 tiles have the type of the one so far away
    int total = 0, displacements = 0;
    for (std::int64_t dy = 0; dy <= 128; ++dy)
        for (std::int64_t dx = dy == 0 ? 1 : -64; dx <= 64; ++dx) {
            int equal = 0;
            for (std::int64_t y = 0; y < 64; ++y)
                for (std::int64_t x = 0; x < 64; ++x) equal += grid.at(x, y) == grid.at(x + dx, y + dy);
            // One is expected, a period would give 4096. Two equal nodes of height h give 4^h: up to 4 is
            // common.
            ASSERT_LT(equal, 1024) << dx << ", " << dy;
            total += equal;
            ++displacements;
        }
    EXPECT_NEAR(double(total) / displacements, 1.0, 0.1);
}

/// The content that each type shows of a patch: 0 its own.
std::vector<std::uint32_t> contents_by_type(const Variants& variants, const Shapes& shapes,
                                            std::size_t patch) {
    std::vector<std::uint32_t> contents;
    for (std::uint32_t type = 0; type < variants.types(); ++type) {
        contents.push_back(0);
        for (const Shown& shown : variants.of(type))
            if (shapes[shown.shape].patch == patch) contents.back() = shapes[shown.shape].content + 1;
    }
    return contents;
}

TEST(Exchange, UsesEveryContentEquallyOften) {
    const ExchangeAsset asset = make_synthetic_asset({.contents = 6});
    const Shapes shapes{asset, 2};
    const Variants variants = content_variants(shapes, 5, 4096);
    for (std::size_t p = 0; p < asset.patches.size(); ++p) {
        std::vector<int> counts(6);
        for (const std::uint32_t content : contents_by_type(variants, shapes, p)) ++counts[content];
        EXPECT_LE(
            *std::max_element(counts.begin(), counts.end()) - *std::min_element(counts.begin(), counts.end()),
            1);
    }
}

TEST(Exchange, PatchesOfATileChooseIndependently) {
    // The flaw of the authors' own library: one draw for all patches of a tile
    const ExchangeAsset asset = make_synthetic_asset({.contents = 6});
    const Shapes shapes{asset, 2};
    const Variants variants = content_variants(shapes, 5, 4096);
    const auto first = contents_by_type(variants, shapes, 0), second = contents_by_type(variants, shapes, 1);
    int equal = 0;
    for (std::size_t type = 0; type < first.size(); ++type) equal += first[type] == second[type];
    EXPECT_NEAR(equal, 4096 / 6, 120);  // five standard deviations
}

TEST(Exchange, ADroppedContentIsNeverShown) {
    ExchangeAsset asset = make_synthetic_asset({});
    for (auto& patch : asset.patches) patch.contents[1].standing = ExchangeAsset::Standing::dropped;
    const Shapes shapes{asset, 2};
    EXPECT_EQ(shapes.size(), asset.patches.size() * 3);
    for (std::size_t s = 0; s < shapes.size(); ++s) EXPECT_NE(shapes[s].content, 1u);
}

TEST(Exchange, NoTwoPatchesOfAnyUnitsOverlapWhateverTheirTypes) {
    // Typed: every type beside and above every other would be too many to try, so each texel that any type
    // may take is marked, and units are laid side by side
    const ExchangeAsset asset = tests::make_synthetic_interchange({.patches = 300, .blend_texels = 0});
    const Shapes shapes{asset, 0};
    const Variants variants = packed_variants(asset, shapes, 7, 128);
    const std::int32_t unit = variants.unit_tiles * asset.tile_side;
    std::vector<bool> ever(std::size_t(2 * unit) * std::size_t(2 * unit));
    std::size_t covered = 0;
    for (std::uint32_t type = 0; type < variants.types(); ++type) {
        std::vector<bool> taken(ever.size());
        for (const Shown& shown : variants.of(type)) {
            const Shapes::Shape& shape = shapes[shown.shape];
            for (std::int32_t y = 0; y < shape.height; ++y)
                for (const Shapes::Segment& segment : shapes.row(shape, y))
                    for (std::int32_t x = segment.begin; x < segment.end; ++x) {
                        const auto at = std::size_t(shown.tile_y * asset.tile_side + shape.y + y) *
                                            std::size_t(2 * unit) +
                                        std::size_t(shown.tile_x * asset.tile_side + shape.x + x);
                        ASSERT_FALSE(taken[at]) << "type " << type;
                        taken[at] = true;
                        ever[at] = true;
                        ++covered;
                    }
        }
    }
    for (std::int32_t y = 0; y < unit; ++y)
        for (std::int32_t x = 0; x < unit; ++x) {
            const auto at = [&](std::int32_t u, std::int32_t v) {
                return ever[std::size_t(v) * std::size_t(2 * unit) + std::size_t(u)] ? 1 : 0;
            };
            ASSERT_LE(at(x, y) + at(x + unit, y) + at(x, y + unit) + at(x + unit, y + unit), 1)
                << x << ", " << y;
        }
    EXPECT_GT(covered, std::size_t(unit) * std::size_t(unit) * variants.types() / 2) << "packed too loosely";
}

TEST(Exchange, TilesOfAWangUnitAgreeOnTheColoursOfTheirCorners) {
    const ExchangeAsset asset = tests::make_synthetic_wang({.tile_side = 16});
    const Shapes shapes{asset, 0};
    const Variants variants = wang_variants(asset, shapes, 3, 256);
    const std::int32_t side = variants.unit_tiles;
    std::set<std::vector<int>> outlines;
    for (std::uint32_t type = 0; type < variants.types(); ++type) {
        std::vector<int> corners(std::size_t(side * side) * 4);  // the tile itself: all zero
        for (const Shown& shown : variants.of(type))
            for (int corner = 0; corner < 4; ++corner)
                corners[std::size_t(shown.tile_y * side + shown.tile_x) * 4 + std::size_t(corner)] =
                    asset.patches[0].contents[shapes[shown.shape].content].corners >> 2 * corner & 3;
        const auto at = [&](std::int32_t x, std::int32_t y, int corner) {
            return corners[std::size_t((y % side) * side + x % side) * 4 + std::size_t(corner)];
        };
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x) {
                ASSERT_EQ(at(x, y, 1), at(x + 1, y, 0));  // also round the unit: neighbours share its outline
                ASSERT_EQ(at(x, y, 2), at(x, y + 1, 0));
                ASSERT_EQ(at(x, y, 3), at(x + 1, y + 1, 0));
            }
        std::vector<int> outline;
        for (std::int32_t i = 0; i < side; ++i) {
            outline.push_back(at(i, 0, 0));
            outline.push_back(at(0, i, 0));
        }
        outlines.insert(outline);
    }
    EXPECT_EQ(outlines.size(), 1u);
}

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

TEST(ExchangeGolden, EveryInstructionSetGivesTheSameBytes) {
    // FNV-1a over one page of each way to evaluate. Raise evaluator_version (server/scene/scene.cpp) when
    // these change.
    const ExchangeAsset asset =
        make_synthetic_asset({.tile_side = 128, .patches = 30, .contents = 7, .blend_texels = 8});
    const auto typed = make_exchange_texture(asset, {.seed = 2026});
    const auto independent = make_exchange_texture(asset, {.seed = 2026, .choice = Choice::independent});
    const ExchangeAsset patches = tests::make_synthetic_interchange({.patches = 200});
    const auto interchange = make_exchange_texture(patches, {.seed = 2026, .types = 64});
    const auto kolar = make_exchange_texture(patches, {.seed = 2026, .choice = Choice::kolar});
    const auto wang = make_exchange_texture(tests::make_synthetic_wang({}), {.seed = 2026, .types = 64});
    const auto hash_of = [&](const Texture& texture, std::uint8_t level, std::int32_t side) {
        const Rgba8Image page = codes(texture, {level, -300, 77, side, side});
        std::uint64_t h = 0xcbf29ce484222325u;
        for (const std::uint8_t byte : page.bytes) h = (h ^ byte) * 0x100000001b3u;
        return h;
    };
    if (const char* asked = std::getenv("TESSERA_KERNELS")) {
        const KernelList list = available_kernels();
        const bool available = std::any_of(list.items, list.items + list.count,
                                           [&](const Kernels* k) { return std::string{k->name} == asked; });
        EXPECT_EQ(available, std::string{kernels().name} == asked);
        if (!available)
            std::cout << "This processor lacks " << asked << "; tested " << kernels().name << " instead\n";
    }
    const auto expect = [&](const Texture& texture, std::int32_t side,
                            const std::map<int, std::uint64_t>& golden) {
        for (const auto& [level, expected] : golden)
            EXPECT_EQ(hash_of(texture, static_cast<std::uint8_t>(level), side), expected)
                << texture.kind() << ", level " << level;
    };
    expect(*typed, 264,
           {{0, 17560310496679043940u},
            {1, 3053456330696986945u},
            {3, 14341894892491646556u},
            {5, 16147777811767766030u},
            {7, 1183169205514748749u},
            {15, 5834916224373319461u}});
    expect(*independent, 64,
           {{0, 15342631789067391047u},
            {4, 10738616608029685732u},
            {7, 15720084498647707819u},
            {8, 13734359368375779633u},
            {20, 3871475367914185509u}});
    expect(*interchange, 264,
           {{0, 3357954405446415724u},
            {2, 16105001816997495996u},
            {5, 12420483317608146460u},
            {8, 16359884047706111190u},
            {20, 11517562437440240293u}});
    expect(*kolar, 64,
           {{0, 9991239574444758533u},
            {3, 2554564605730996358u},
            {7, 970311202921875993u},
            {20, 15578437444352647973u}});
    expect(*wang, 264, {{0, 17581993318018745531u}, {4, 8418642413948361472u}, {9, 284458875325107527u}});
}

}  // namespace
}  // namespace tessera
