#include "client/view/hand/hand_sprite.h"

#include <gtest/gtest.h>

#include "proto/edit.pb.h"

namespace tessera {
namespace {

constexpr std::int64_t far = std::int64_t{1} << 37;

HandSprite sprite_at(std::int64_t x, std::int64_t y) {
    HandSprite sprite;
    sprite.id = 7;
    sprite.side_texels = 16;
    sprite.x = x * sprite_units;
    sprite.y = y * sprite_units;
    return sprite;
}

TEST(HandSprite, MovesByTheSameUnitsAnywhereOnThePlane) {
    const HandSprite moved = changed(sprite_at(far + 3, 5), {.dx = 129, .dy = -1});
    EXPECT_EQ(moved.x, (far + 3) * sprite_units + 129);
    EXPECT_EQ(moved.y, 5 * sprite_units - 1);
}

TEST(HandSprite, AQuarterTurnAboutAPointTurnsPlaceAndSpriteExactly) {
    const HandPoint about{far * sprite_units, far * sprite_units};
    const HandSprite turned = changed(sprite_at(far + 10, far), {.turns = 0.25, .about = about});
    EXPECT_EQ(turned.x, far * sprite_units);
    EXPECT_EQ(turned.y, (far + 10) * sprite_units) << "clockwise: y points down";
    EXPECT_EQ(turned.turn, 16384);
    const HandSprite back = changed(turned, {.turns = -0.25, .about = about});
    EXPECT_TRUE(alike(back, sprite_at(far + 10, far)));
}

TEST(HandSprite, ScalesNoFurtherThanSpritesMay) {
    EXPECT_EQ(changed(sprite_at(0, 0), {.scale = 100}).scale, 4 * sprite_scale_one);
    EXPECT_EQ(changed(sprite_at(0, 0), {.scale = 1e-9}).scale, sprite_scale_one / 64);
}

TEST(HandSprite, WhatIsToldOfAMoveIsWhatDiffers) {
    const HandSprite from = sprite_at(far, 4);
    HandSprite to = from;
    EXPECT_TRUE(changes_between(from, to).empty());
    to.x += 1;
    const auto changes = changes_between(from, to);
    ASSERT_EQ(changes.size(), 1u);
    const proto::SpriteMove& move = changes[0].move_sprite();
    EXPECT_TRUE(move.has_x());
    EXPECT_FALSE(move.has_y() || move.has_scale() || move.has_turn() || move.has_order());
    EXPECT_EQ(move.x(), static_cast<double>(far) + 1.0 / 256) << "a double holds it";
}

TEST(HandSprite, ASpriteWithAWayIsPlacedAnewWithAllOfIt) {
    proto::SpritePlacement placed;
    placed.set_id(3);
    placed.set_x(10);
    placed.set_animation(2);
    placed.set_phase(-4);
    placed.mutable_path()->set_to_x(50);
    placed.mutable_path()->set_steps(20);
    const auto sprite = hand_sprite_of(placed, 4, 16);
    ASSERT_TRUE(sprite) << sprite.error().detail;
    const auto changes = changes_between(*sprite, changed(*sprite, {.dx = 256}));
    ASSERT_EQ(changes.size(), 2u);
    EXPECT_EQ(changes[0].remove_sprite().id(), 3u);
    EXPECT_EQ(changes[1].place_sprite().path().to_x(), 51);
    EXPECT_EQ(changes[1].place_sprite().animation(), 2u) << "kept, though its frames are not known";
    EXPECT_EQ(changes[1].place_sprite().phase(), -4);
}

TEST(HandSprite, APointOfThePlaneComesBackFromUnits) {
    const PlanePoint at{far, -3, 0.5, 0.25};
    EXPECT_EQ(plane_point(hand_point(at)), at);
}

}  // namespace
}  // namespace tessera
