#include "shared/sprites/sprite.h"

#include <array>
#include <functional>

#include <gtest/gtest.h>

namespace tessera {
namespace {

Sprite at_texel(std::int64_t x, std::int64_t y, std::uint16_t side = 16) {
    Sprite sprite;
    sprite.id = 1;
    sprite.x = x * sprite_units;
    sprite.y = y * sprite_units;
    sprite.side_texels = side;
    return sprite;
}

Sprite with(Sprite sprite, const std::function<void(SpriteLife&)>& change) {
    SpriteLife life = sprite.life ? *sprite.life : SpriteLife{};
    change(life);
    sprite.life = std::make_shared<const SpriteLife>(life);
    return sprite;
}

Sprite moving(Sprite sprite, std::int64_t to_x, std::int64_t to_y, std::int64_t first, std::int64_t steps,
              SpritePath::Then then) {
    return with(std::move(sprite), [&](SpriteLife& life) {
        life.moves = true;
        life.path = {to_x, to_y, first, steps, then};
    });
}

TEST(Sprite, UnturnedColoursExactlyItsSideAndTurnedAtMostItsDiagonal) {
    EXPECT_EQ(box_of(at_texel(100, -50)), (TexelBox{92, -58, 108, -42}));
    Sprite sprite = at_texel(100, -50);
    sprite.turn = 16384;
    EXPECT_EQ(box_of(sprite), (TexelBox{92, -58, 108, -42}));
    sprite.turn = 8192;  // 16·√2 = 22.6 texels wide
    EXPECT_EQ(box_of(sprite), (TexelBox{88, -62, 112, -38}));
    sprite.turn = 0;
    sprite.scale = sprite_scale_one / 2;
    EXPECT_EQ(box_of(sprite), (TexelBox{96, -54, 104, -46}));
    sprite.x += 1;
    EXPECT_EQ(box_of(sprite), (TexelBox{96, -54, 105, -46}));
}

TEST(Sprite, GoesAlongItsPathAndThenRestsRepeatsOrReverses) {
    const auto at = [](SpritePath::Then then, std::int64_t step) {
        return position_at(moving(at_texel(0, 0), 1000, -500, 10, 100, then), step);
    };
    using enum SpritePath::Then;
    for (const auto then : {rest, repeat, reverse}) {
        EXPECT_EQ(at(then, -5), (SpritePosition{0, 0}));
        EXPECT_EQ(at(then, 10), (SpritePosition{0, 0}));
        EXPECT_EQ(at(then, 11), (SpritePosition{10, -5}));
        EXPECT_EQ(at(then, 60), (SpritePosition{500, -250}));
    }
    EXPECT_EQ(at(rest, 110), (SpritePosition{1000, -500}));
    EXPECT_EQ(at(rest, 1'000'000'000'000'000), (SpritePosition{1000, -500}));
    EXPECT_EQ(at(repeat, 110), (SpritePosition{0, 0}));
    EXPECT_EQ(at(reverse, 110), (SpritePosition{1000, -500}));
    EXPECT_EQ(at(reverse, 120), (SpritePosition{900, -450}));
    EXPECT_EQ(at(reverse, 210), (SpritePosition{0, 0}));
}

TEST(Sprite, TellsInWhichStepsItStaysAsItIs) {
    // Against stepping, on paths fast and slow, long and short, standing and leaving
    const auto life_and_death = [](Sprite sprite) {
        return with(std::move(sprite), [](SpriteLife& life) {
            life.first_step = -3;
            life.end_step = 77;
        });
    };
    for (const auto then : {SpritePath::Then::rest, SpritePath::Then::repeat, SpritePath::Then::reverse})
        for (const std::int64_t steps : {1, 2, 7, 30})
            for (const std::int64_t x : {0, 1, -3, 100, -3001})
                for (const std::int64_t y : {0, 2, -40})
                    for (const bool mortal : {false, true}) {
                        Sprite sprite = moving(at_texel(0, 0), x, y, 5, steps, then);
                        if (mortal) sprite = life_and_death(sprite);
                        for (Step step = -10; step < 90; ++step) {
                            const Validity stay = stay_of(sprite, step);
                            ASSERT_TRUE(stay.holds(step));
                            const auto alike = [&](Step other) {
                                return there_at(sprite, other) == there_at(sprite, step) &&
                                       (!there_at(sprite, step) ||
                                        position_at(sprite, other) == position_at(sprite, step));
                            };
                            for (Step s = std::max<Step>(stay.from, -200);
                                 s < std::min<Step>(stay.until, 200); ++s)
                                ASSERT_TRUE(alike(s)) << s << " around " << step;
                            ASSERT_TRUE(stay.until == never || !alike(stay.until))
                                << stay.until << " after " << step;
                            ASSERT_TRUE(stay.from == always || !alike(stay.from - 1))
                                << stay.from << " before " << step;
                        }
                    }
}

TEST(Sprite, KeepsCountOverStepsAndWaysAsLongAsNumbersGo) {
    const std::int64_t far = (std::int64_t{1} << 39) * sprite_units;
    Sprite sprite = moving(at_texel(0, 0), -far, far, 0, 2147483647, SpritePath::Then::reverse);
    sprite.x = far;
    sprite.y = -far;
    ASSERT_FALSE(check_sprite(sprite).has_error());
    EXPECT_EQ(position_at(sprite, 2147483647), (SpritePosition{-far, far}));
    for (const std::int64_t step :
         {std::int64_t{-1'000'000'000'000'000}, std::int64_t{1'000'000'000'000'000}, never - 1, always + 1}) {
        const SpritePosition here = position_at(sprite, step);
        EXPECT_TRUE(box_of(sprite).meets(box_at(sprite, step)));
        const Validity stay = stay_of(sprite, step);
        EXPECT_TRUE(stay.holds(step));
        if (stay.until != never) {
            EXPECT_NE(position_at(sprite, stay.until), here);
        }
    }
}

TEST(Sprite, IsRefusedByFieldAndRange) {
    const auto refused = [](const Sprite& sprite, const char* field) {
        const auto checked = check_sprite(sprite);
        return checked.has_error() && checked.error().detail.starts_with(field);
    };
    Sprite sprite = at_texel(0, 0);
    EXPECT_FALSE(check_sprite(sprite).has_error());
    sprite.id = 0;
    EXPECT_TRUE(refused(sprite, "id"));
    sprite = at_texel((std::int64_t{1} << 39) + 1, 0);
    EXPECT_TRUE(refused(sprite, "x"));
    sprite = at_texel(0, 0, 2000);
    EXPECT_TRUE(refused(sprite, "side_texels"));
    sprite = at_texel(0, 0);
    sprite.scale = 0;
    EXPECT_TRUE(refused(sprite, "scale"));
    EXPECT_TRUE(refused(moving(at_texel(0, 0), 0, 0, 0, 0, SpritePath::Then::rest), "path.steps"));
    EXPECT_TRUE(
        refused(with(at_texel(0, 0), [](SpriteLife& life) { life.end_step = life.first_step; }), "end_step"));
}

TEST(Sprite, ShowsTheFramesOfItsAnimationAgainAndAgain) {
    const auto frames = std::make_shared<const SpriteFrames>(
        SpriteFrames{{7, 8, 9}, TimeLine{std::array<std::uint32_t, 3>{4, 1, 2}}});
    const Sprite sprite = with(at_texel(0, 0), [&](SpriteLife& life) {
        life.frames = frames;
        life.phase = 3;
        life.end_step = 100;
    });
    // 7 steps a round; at step 0 the fourth of the first frame
    const std::array<std::int32_t, 7> shown{7, 8, 9, 9, 7, 7, 7};
    for (Step step = -40; step < 100; ++step)
        ASSERT_EQ(pattern_at(sprite, step), shown[static_cast<std::size_t>((step % 7 + 7) % 7)]) << step;
    for (Step step = -40; step < 98; ++step) {
        const Validity stay = stay_of(sprite, step);
        ASSERT_TRUE(stay.holds(step));
        for (Step at = stay.from; at < stay.until; ++at)
            ASSERT_EQ(pattern_at(sprite, at), pattern_at(sprite, step));
        ASSERT_NE(pattern_at(sprite, stay.from - 1), pattern_at(sprite, step));
        ASSERT_TRUE(stay.until == 100 || pattern_at(sprite, stay.until) != pattern_at(sprite, step));
    }
    EXPECT_FALSE(same_sprite(sprite, at_texel(0, 0)));
}

}  // namespace
}  // namespace tessera
