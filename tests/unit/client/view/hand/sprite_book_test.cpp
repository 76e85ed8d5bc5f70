#include "client/view/hand/sprite_book.h"

#include <gtest/gtest.h>

#include "proto/edit.pb.h"

namespace tessera {
namespace {

proto::Change placed(std::uint64_t id, double x, double y, std::int32_t order = 0) {
    proto::Change change;
    proto::SpritePlacement& sprite = *change.mutable_place_sprite();
    sprite.set_id(id);
    sprite.set_x(x);
    sprite.set_y(y);
    sprite.set_order(order);
    return change;
}

proto::Change moved(std::uint64_t id, double x) {
    proto::Change change;
    change.mutable_move_sprite()->set_id(id);
    change.mutable_move_sprite()->set_x(x);
    return change;
}

SpriteBook book_of(const TexelBox& view) {
    SpriteBook book;
    book.begin(4, 16);
    book.look_at(view);
    return book;
}

TEST(SpriteBook, AsksForMoreThanIsSeenOnceAndAgainWhenTheViewLeavesIt) {
    SpriteBook book = book_of({0, 0, 100, 100});
    const auto question = book.take_question();
    ASSERT_TRUE(question);
    EXPECT_EQ(*question, (TexelBox{-50, -50, 150, 150}));
    EXPECT_FALSE(book.take_question()) << "while an answer is awaited";
    book.answer(*question, {});
    book.look_at({40, 40, 140, 140});
    EXPECT_FALSE(book.take_question());
    book.look_at({60, 60, 160, 160});
    EXPECT_TRUE(book.take_question());
}

TEST(SpriteBook, MakesEditsAgainThatAnOlderListDoesNotHave) {
    SpriteBook book = book_of({0, 0, 100, 100});
    const auto question = book.take_question();
    book.take({placed(1, 20, 20)}, 5, {});
    book.take({moved(1, 40)}, 6, {});
    proto::SpriteList list;
    list.set_revision(5);
    *list.add_sprites() = placed(1, 20, 20).place_sprite();
    book.answer(*question, list);
    ASSERT_NE(book.find(1), nullptr);
    EXPECT_EQ(book.find(1)->x, 40 * sprite_units);
}

TEST(SpriteBook, AsksAgainAfterAnEditThatItCannotFollow) {
    SpriteBook book = book_of({0, 0, 100, 100});
    book.answer(*book.take_question(), {});
    ASSERT_FALSE(book.take_question());
    book.take({moved(9, 30)}, 3, {{20, 20, 40, 40}});
    EXPECT_TRUE(book.take_question()) << "a sprite that it does not know came";
}

TEST(SpriteBook, TakesHoldOfTheUppermostThatHasColourThere) {
    SpriteBook book = book_of({0, 0, 100, 100});
    book.answer(*book.take_question(), {});
    book.take({placed(1, 50, 50, 0), placed(2, 54, 50, 3), placed(3, 50, 50, -1)}, 1, {});
    const HandPoint place{52 * sprite_units, 50 * sprite_units};
    ASSERT_NE(book.at(place, 0.1, 0, {}), nullptr);
    EXPECT_EQ(book.at(place, 0.1, 0, {})->id, 2u);
    // The upper one is transparent on its left half
    const auto covers = [](const HandSprite&, double u, double) { return u > 0.5; };
    EXPECT_EQ(book.at(place, 0.1, 0, covers)->id, 1u);
    EXPECT_EQ(book.at({80 * sprite_units, 50 * sprite_units}, 0.1, 0, {}), nullptr);
    EXPECT_NE(book.at({66 * sprite_units, 50 * sprite_units}, 14, 0, {}), nullptr) << "tiny on screen";
}

TEST(SpriteBook, FramesThoseWhoseMiddlesLieInside) {
    SpriteBook book = book_of({0, 0, 100, 100});
    book.answer(*book.take_question(), {});
    book.take({placed(1, 10, 10), placed(2, 30, 30), placed(3, 31, 60)}, 1, {});
    EXPECT_EQ(book.within({0, 0, 31, 31}, 0), (std::vector<SpriteId>{1, 2}));
}

}  // namespace
}  // namespace tessera
