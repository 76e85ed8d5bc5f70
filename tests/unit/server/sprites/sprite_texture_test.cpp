#include "server/sprites/sprite_texture.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "server/texture/constant_texture.h"
#include "shared/math/hash.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

constexpr std::int32_t pattern_side = 16;

/// Three patterns: a disc with a soft edge, a ring, a square full of noise.
PatternImages made_patterns() {
    PatternImages patterns{.side = pattern_side, .count = 3, .slices = 1, .codes = {}};
    for (int pattern = 0; pattern < 3; ++pattern)
        for (int y = 0; y < pattern_side; ++y)
            for (int x = 0; x < pattern_side; ++x) {
                const double r = std::hypot(x - 7.5, y - 7.5);
                const double cover[] = {8 - r, 2 - std::abs(r - 5), 1};
                const std::uint64_t noise = hash(7, 3, x, y);
                patterns.codes.push_back(static_cast<std::uint8_t>(pattern == 2 ? noise : 200));
                patterns.codes.push_back(static_cast<std::uint8_t>(pattern == 2 ? noise >> 8 : x * 16));
                patterns.codes.push_back(static_cast<std::uint8_t>(pattern == 2 ? noise >> 16 : 40));
                patterns.codes.push_back(
                    static_cast<std::uint8_t>(std::clamp(cover[pattern], 0.0, 1.0) * 255));
            }
    return patterns;
}

std::shared_ptr<const Texture> ground() {
    return make_checker_texture(8, {250, 240, 230, 255}, {20, 60, 90, 128});
}

struct Made {
    PositioningMap map;
    std::shared_ptr<const PatternTexture> texture;
};

Sprite sprite_at(SpriteId id, double x, double y, std::int32_t pattern = 2) {
    Sprite sprite;
    sprite.id = id;
    sprite.x = static_cast<std::int64_t>(std::floor(x * sprite_units));
    sprite.y = static_cast<std::int64_t>(std::floor(y * sprite_units));
    sprite.pattern = pattern;
    sprite.side_texels = pattern_side;
    return sprite;
}

/// Sprites in all turns and scales, many over each other, from (x, y) on.
Made crowd(int count, std::int64_t x, std::int64_t y, std::int64_t width) {
    Made made;
    for (int n = 1; n <= count; ++n) {
        const auto part = [&](int stream) {
            return static_cast<double>(hash(11, static_cast<std::uint64_t>(stream), n, 0) >> 40) / 0x1p24;
        };
        Sprite sprite =
            sprite_at(static_cast<SpriteId>(n), static_cast<double>(x) + part(0) * static_cast<double>(width),
                      static_cast<double>(y) + part(1) * static_cast<double>(width), n % 3);
        sprite.turn = static_cast<std::uint16_t>(n % 4 == 0 ? 0 : part(2) * 65536);
        sprite.scale = static_cast<std::uint32_t>((0.3 + part(3) * 2) * sprite_scale_one);
        sprite.order = n % 5;
        EXPECT_FALSE(made.map.place(sprite).has_error());
    }
    made.texture = make_sprite_texture(
        ground(), std::make_shared<SpriteImages>(made_patterns(), std::size_t{64} << 20), made.map);
    return made;
}

LinearImage texels(const Texture& texture, const TexelRegion& region, Evaluation* did = nullptr,
                   Accuracy accuracy = Accuracy::exact) {
    LinearImage out;
    const auto done = texture.evaluate(region, {.accuracy = accuracy}, out);
    EXPECT_TRUE(done);
    if (done && did) *did = *done;
    return out;
}

TEST(SpriteTexture, OnWholeTexelsAPatternIsSeenTexelForTexel) {
    PositioningMap map;
    ASSERT_FALSE(map.place(sprite_at(1, 108, -92)).has_error());
    const PatternImages patterns = made_patterns();
    const auto texture =
        make_sprite_texture(ground(), std::make_shared<SpriteImages>(patterns, 1 << 20), map);
    const LinearImage shown =
        texels(*texture, {.level = 0, .x = 100, .y = -100, .width = pattern_side, .height = pattern_side});
    const std::uint8_t* codes = patterns.image(2, 0);
    for (std::size_t i = 0; i < shown.values.size(); ++i)
        ASSERT_EQ(shown.values[i], i % 4 == 3 ? 1.0F : static_cast<float>(srgb_to_steps[codes[i]] / 65535.0))
            << i;
}

TEST(SpriteTexture, TransparentMarginsChangeNothingAndAreNotKept) {
    // The ring alone, and with as much of nothing around it as makes 128 texels a side; and nothing
    const PatternImages all = made_patterns();
    constexpr std::int32_t wide_side = 128, margin = (wide_side - pattern_side) / 2;
    PatternImages narrow{.side = pattern_side, .count = 1, .slices = 1, .codes = {}};
    narrow.codes.assign(all.image(1, 0), all.image(2, 0));
    PatternImages wide{.side = wide_side, .count = 2, .slices = 1, .codes = {}};
    wide.codes.resize(std::size_t{2} * wide_side * wide_side * 4);
    for (std::int32_t y = 0; y < pattern_side; ++y)
        std::copy_n(narrow.codes.begin() + y * pattern_side * 4, pattern_side * 4,
                    wide.codes.begin() + ((margin + y) * wide_side + margin) * 4);
    const SpriteImages narrow_images{narrow, 1 << 24}, wide_images{wide, 1 << 24};
    for (int n = 0; n < 100; ++n) {
        Sprite sprite = sprite_at(1, n * 0.37 - 20, n * -0.61, 0);
        sprite.turn = static_cast<std::uint16_t>(n % 4 == 0 ? n * 4096 : n * 641);
        sprite.scale = static_cast<std::uint32_t>((0.05 + 0.039 * n) * sprite_scale_one);
        const SpriteImage one = narrow_images.of(sprite, 0, 0);
        sprite.side_texels = wide_side;
        const SpriteImage other = wide_images.of(sprite, 0, 0);
        ASSERT_LT(other.image->width(), 1.5 * pattern_side * sprite.scale / sprite_scale_one + 8) << n;
        const auto step = [](const SpriteImage& image, std::int64_t x, std::int64_t y) {
            const std::int64_t i = x - image.left, j = y - image.top;
            if (i < 0 || j < 0 || i >= image.image->width() || j >= image.image->height())
                return SummedArea::Sums{};
            const auto u = static_cast<std::int32_t>(i), v = static_cast<std::int32_t>(j);
            return image.image->sum(u, v, u + 1, v + 1);
        };
        for (std::int64_t y = one.top - 4; y < one.top + one.image->height() + 4; ++y)
            for (std::int64_t x = one.left - 4; x < one.left + one.image->width() + 4; ++x)
                for (std::size_t c = 0; c < 4; ++c)
                    ASSERT_NEAR(static_cast<double>(step(one, x, y)[c]),
                                static_cast<double>(step(other, x, y)[c]), 1)
                        << n << ": " << x << ", " << y;
        sprite.pattern = 1;
        EXPECT_EQ(wide_images.of(sprite, 0, 0).image->width(), 1);
    }
}

TEST(SpriteTexture, EveryLevelIsTheBoxReductionOfLevel0) {
    for (const std::int64_t at : {std::int64_t{0}, std::int64_t{-3000}, (std::int64_t{1} << 37) - 256}) {
        const Made made = crowd(60, at, at, 256);
        constexpr std::int32_t side = 512;
        const TexelRegion all{
            .level = 0, .x = (at - 128) & ~255, .y = (at - 128) & ~255, .width = side, .height = side};
        const LinearImage fine = texels(*made.texture, all);
        for (std::uint8_t level = 1; level <= 8; ++level) {
            const std::int32_t block = 1 << level;
            Evaluation did;
            const LinearImage coarse = texels(*made.texture,
                                              {.level = level,
                                               .x = all.x >> level,
                                               .y = all.y >> level,
                                               .width = side >> level,
                                               .height = side >> level},
                                              &did);
            ASSERT_LT(did.bound_codes, 0.02);
            for (std::int32_t y = 0; y < coarse.height; ++y)
                for (std::int32_t x = 0; x < coarse.width; ++x)
                    for (std::int32_t c = 0; c < 4; ++c) {
                        double sum = 0;
                        for (std::int32_t v = 0; v < block; ++v)
                            for (std::int32_t u = 0; u < block; ++u)
                                sum += double{fine.row(y * block + v)[(x * block + u) * 4 + c]};
                        ASSERT_NEAR(coarse.row(y)[x * 4 + c], sum / block / block, 1e-6)
                            << "level " << int{level};
                    }
        }
    }
}

TEST(SpriteTexture, APageThatMeetsNoSpriteIsTheGroundsOwn) {
    const Made made = crowd(20, 0, 0, 100);
    const TexelRegion elsewhere{.level = 3, .x = 400, .y = 0, .width = 64, .height = 64};
    Evaluation did;
    EXPECT_EQ(texels(*made.texture, elsewhere, &did).values, texels(*ground(), elsewhere).values);
    EXPECT_NE(did.method, "sprites");
    Rgba8Image shown, own;
    ASSERT_TRUE(made.texture->evaluate(elsewhere, {}, shown));
    ASSERT_TRUE(ground()->evaluate(elsewhere, {}, own));
    EXPECT_EQ(shown, own);
}

TEST(SpriteTexture, ATexelIsTheSameWhateverRegionItIsAskedIn) {
    const Made made = crowd(80, -200, -200, 400);
    for (const std::uint8_t level : std::vector<std::uint8_t>{0, 1, 3, 5}) {
        const TexelRegion whole{.level = level,
                                .x = -256 >> level,
                                .y = -256 >> level,
                                .width = 512 >> level,
                                .height = 512 >> level};
        const LinearImage all = texels(*made.texture, whole);
        const TexelRegion part{.level = level,
                               .x = whole.x + whole.width / 3,
                               .y = whole.y + whole.height / 5,
                               .width = whole.width / 2,
                               .height = whole.height / 2};
        const LinearImage some = texels(*made.texture, part);
        for (std::int32_t y = 0; y < part.height; ++y)
            ASSERT_TRUE(std::equal(some.row(y), some.row(y) + part.width * 4,
                                   all.row(y + whole.height / 5) + whole.width / 3 * 4))
                << "level " << int{level};
    }
}

TEST(SpriteTexture, TooManyForTheBudgetAreLaidOverTheMeanWithinTheBound) {
    const Made made = crowd(1500, 0, 0, 6000);
    for (const std::uint8_t level : std::vector<std::uint8_t>{7, 9, 12}) {
        const TexelRegion region{
            .level = level, .x = 0, .y = 0, .width = 8192 >> level, .height = 8192 >> level};
        Evaluation exact, fast;
        const LinearImage truth = texels(*made.texture, region, &exact);
        const LinearImage guess = texels(*made.texture, region, &fast, Accuracy::fast);
        ASSERT_LT(exact.bound_codes, 0.02);
        ASSERT_GT(fast.bound_codes, 0.02) << "the budget was enough: nothing was tried";
        double worst = 0;
        for (std::size_t i = 0; i < truth.values.size(); ++i)
            worst = std::max(worst, std::abs(double{truth.values[i]} - double{guess.values[i]}));
        RecordProperty("worst_codes_at_level_" + std::to_string(level), std::to_string(worst * 255));
        RecordProperty("bound_codes_at_level_" + std::to_string(level), std::to_string(fast.bound_codes));
        EXPECT_LE(worst * 255, fast.bound_codes + exact.bound_codes);
    }
}

}  // namespace
}  // namespace tessera
