#include "shared/sprites/positioning_map.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "shared/math/hash.h"

namespace tessera {
namespace {

/// The n-th number of a sequence that is the same everywhere.
std::uint64_t draw(std::uint64_t n) { return mix(n * 0x9e3779b97f4a7c15u + 1); }

Sprite sprite_at(SpriteId id, std::int64_t x, std::int64_t y, std::uint16_t side) {
    Sprite sprite;
    sprite.id = id;
    sprite.x = x;
    sprite.y = y;
    sprite.side_texels = side;
    return sprite;
}

/// Sprites of all sizes, some turned, some moving; `spread` texels around the origin.
Sprite any_sprite(SpriteId id, std::int64_t spread) {
    const auto within = [&](std::uint64_t n) {
        return static_cast<std::int64_t>(draw(n) % static_cast<std::uint64_t>(2 * spread * sprite_units)) -
               spread * sprite_units;
    };
    Sprite sprite = sprite_at(id, within(id * 8), within(id * 8 + 1),
                              static_cast<std::uint16_t>(std::uint16_t{1} << draw(id * 8 + 2) % 8));
    sprite.turn = static_cast<std::uint16_t>(draw(id * 8 + 3) % 3 * 11000);
    sprite.order = static_cast<std::int32_t>(draw(id * 8 + 4) % 3);
    if (draw(id * 8 + 5) % 4 == 0) {
        SpriteLife life;
        life.moves = true;
        life.path = {within(id * 8 + 6), within(id * 8 + 7), 0, 100, SpritePath::Then::reverse};
        sprite.life = std::make_shared<const SpriteLife>(life);
    }
    return sprite;
}

std::vector<SpriteId> ids_of(const std::vector<Sprite>& sprites) {
    std::vector<SpriteId> ids;
    for (const Sprite& sprite : sprites) ids.push_back(sprite.id);
    return ids;
}

TEST(PositioningMap, FindsWhatAListOfAllSpritesFindsInTheOrderOfDrawing) {
    for (const std::int64_t spread : {std::int64_t{300}, std::int64_t{100'000}, std::int64_t{1} << 38}) {
        PositioningMap map;
        std::map<SpriteId, Sprite> model;
        for (std::uint64_t n = 0; n < 3000; ++n) {
            const SpriteId id = 1 + draw(n + 77) % 800;
            if (const auto old = model.find(id); old != model.end()) {
                ASSERT_TRUE(map.remove(old->second));
                ASSERT_FALSE(map.remove(old->second));
                model.erase(old);
            } else if (const Sprite sprite = any_sprite(id, spread); !map.place(sprite).has_error()) {
                model.emplace(id, sprite);
            }
            ASSERT_EQ(map.size(), model.size());
            if (n % 10 != 0) continue;
            const std::int64_t side = std::int64_t{1} << draw(n * 3) % 20;
            const Sprite around = any_sprite(n + 10'000, spread);
            const TexelBox box{around.x / sprite_units, around.y / sprite_units,
                               around.x / sprite_units + side, around.y / sprite_units + side};
            const auto step = static_cast<std::int64_t>(draw(n * 5) % 200);
            std::vector<Sprite> all, now;
            for (const auto& [key, sprite] : model) {
                if (box_of(sprite).meets(box)) all.push_back(sprite);
                if (box_at(sprite, step).meets(box)) now.push_back(sprite);
            }
            std::sort(all.begin(), all.end(), drawn_before);
            std::sort(now.begin(), now.end(), drawn_before);
            ASSERT_EQ(ids_of(map.meeting(box)), ids_of(all));
            ASSERT_EQ(ids_of(map.meeting_at(box, step)), ids_of(now));
            ASSERT_EQ(map.any_meets(box), !all.empty());
        }
        for (const auto& [id, sprite] : model) ASSERT_TRUE(map.remove(sprite));
        EXPECT_EQ(map.size(), 0u);
        EXPECT_EQ(map.memory_bytes(), PositioningMap{}.memory_bytes());
    }
}

TEST(PositioningMap, ACopyKeepsWhatItWasACopyOf) {
    PositioningMap map;
    for (SpriteId id = 1; id <= 500; ++id) ASSERT_FALSE(map.place(any_sprite(id, 100'000)).has_error());
    const TexelBox everywhere{-(std::int64_t{1} << 40), -(std::int64_t{1} << 40), std::int64_t{1} << 40,
                              std::int64_t{1} << 40};
    const PositioningMap before = map;
    const auto ids = ids_of(before.meeting(everywhere));
    for (SpriteId id = 1; id <= 500; id += 2) ASSERT_TRUE(map.remove(any_sprite(id, 100'000)));
    for (SpriteId id = 501; id <= 900; ++id) ASSERT_FALSE(map.place(any_sprite(id, 100'000)).has_error());
    EXPECT_EQ(ids_of(before.meeting(everywhere)), ids);
    EXPECT_EQ(before.size(), 500u);
    EXPECT_EQ(map.size(), 650u);
    EXPECT_EQ(map.meeting(everywhere).size(), 650u);
}

TEST(PositioningMap, RefusesOneTooManyInACellAndKeepsTheOthers) {
    PositioningMap map{4};
    for (SpriteId id = 1; id <= 4; ++id) ASSERT_FALSE(map.place(sprite_at(id, 2560, 2560, 16)).has_error());
    const auto full = map.place(sprite_at(5, 2560, 2560, 16));
    ASSERT_TRUE(full.has_error());
    EXPECT_NE(full.error().detail.find("overlap layers"), std::string::npos) << full.error().detail;
    EXPECT_EQ(map.size(), 4u);
    // One that only leans into the full cell is refused too; other grids and other cells have room
    EXPECT_TRUE(map.place(sprite_at(6, 2560 - 16 * sprite_units, 2560, 16)).has_error());
    EXPECT_FALSE(map.place(sprite_at(7, 2560, 2560, 64)).has_error());
    EXPECT_FALSE(map.place(sprite_at(8, 2560 + 64 * sprite_units, 2560, 16)).has_error());
}

TEST(PositioningMap, TakesLessThanTwoHundredBytesForASpriteHoweverTheyAreScattered) {
    PositioningMap map;
    constexpr SpriteId count = 200'000;
    for (SpriteId id = 1; id <= count; ++id) {
        const auto place = [&](std::uint64_t n) {
            return static_cast<std::int64_t>(draw(n) >> 18) - (std::int64_t{1} << 45);
        };
        ASSERT_FALSE(map.place(sprite_at(id, place(2 * id), place(2 * id + 1), 32)).has_error());
    }
    // What malloc adds to each of a node's at most three pieces is below 16 bytes each
    const std::size_t bytes = map.memory_bytes() / count + 48;
    RecordProperty("bytes_for_a_sprite", static_cast<int>(bytes));
    EXPECT_LT(bytes, 200u);
}

}  // namespace
}  // namespace tessera
