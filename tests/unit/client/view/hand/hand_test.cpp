#include "client/view/hand/hand.h"

#include <gtest/gtest.h>

#include "client/view/hand/map_brush.h"
#include "client/view/hand/others_hands.h"
#include "client/view/hand/target_hand.h"

namespace tessera {
namespace {

constexpr std::int64_t far = std::int64_t{1} << 36;

HandPoint texel(double x, double y) {
    return {far * sprite_units + static_cast<std::int64_t>(x * sprite_units),
            far * sprite_units + static_cast<std::int64_t>(y * sprite_units)};
}

/// A hand at texel 2^36 of a scene with two sprites, and a server that answers when it is told to.
class HandAtWork : public ::testing::Test {
  protected:
    HandAtWork()
        : edits{[this](proto::Edit edit) {
                    sent.push_back(std::move(edit));
                    return "edit " + std::to_string(sent.size());
                },
                "Ada"},
          hand{Extent{30}, edits} {
        hand.begin(4, 16);
        look(0);
        hand.book().answer(*hand.book().take_question(), {});
        for (const std::uint64_t id : {1, 2}) {
            proto::Change change;
            proto::SpritePlacement& sprite = *change.mutable_place_sprite();
            sprite.set_id(id);
            sprite.set_x(static_cast<double>(far) + 100 * static_cast<double>(id));
            sprite.set_y(static_cast<double>(far) + 50);
            hand.book().take({change}, id, {});
        }
    }
    void look(int milliseconds) {
        hand.look({.now = ClientTime{milliseconds}, .view = {far, far, far + 400, far + 300}});
    }
    void drag(const HandPoint& from, const HandPoint& to, bool add = false) {
        hand.press(from, add);
        hand.drag(to, true, false);
        hand.release(to, true);
    }
    void answer(std::uint64_t revision, const proto::Edit& inverse = {}) {
        proto::EditAnswer made;
        made.set_revision(revision);
        *made.mutable_inverse() = inverse;
        hand.heard(*edits.hear("edit " + std::to_string(sent.size()), made));
    }
    void refuse() {
        proto::EditRefused refused;
        refused.set_why(proto::EditRefused::conflict);
        refused.set_detail("too late");
        hand.heard(*edits.hear("edit " + std::to_string(sent.size()), refused));
    }

    std::vector<proto::Edit> sent;
    HandEdits edits;
    Hand hand;
};

TEST_F(HandAtWork, ADragIsOneEditThatIsDrawnUntilThePagesShowIt) {
    hand.press(texel(101, 51), false);
    EXPECT_EQ(hand.selected(), std::vector<SpriteId>{1});
    EXPECT_EQ(hand.carries().holds().at(0).lifted, std::vector<std::uint64_t>{1})
        << "lifted from the press on";
    hand.drag(texel(111, 56), true, false);
    ASSERT_EQ(hand.held().size(), 1u);
    EXPECT_EQ(hand.held()[0].middle, (PlanePoint{far + 110, far + 55}));
    EXPECT_TRUE(sent.empty());
    EXPECT_FALSE(hand.carries().holds().at(0).waits);

    hand.release(texel(111, 56), true);
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_EQ(sent[0].changes(0).move_sprite().x(), static_cast<double>(far) + 110);
    EXPECT_EQ(sent[0].author(), "Ada");
    EXPECT_TRUE(hand.carries().holds().at(0).waits);
    EXPECT_EQ(hand.carries().holds().at(0).revision, 0u);
    answer(3);
    EXPECT_EQ(hand.carries().holds().at(0).revision, 3u);
    EXPECT_EQ(hand.book().find(1)->x, (far + 110) * sprite_units);
    EXPECT_EQ(hand.held().size(), 1u) << "the pages do not show it yet";
    const std::uint32_t hold = hand.held()[0].hold;
    hand.ended(std::vector{hold});
    EXPECT_TRUE(hand.held().empty());
}

TEST_F(HandAtWork, WhatTheServerRefusesIsWhereItWas) {
    drag(texel(101, 51), texel(150, 80));
    refuse();
    EXPECT_TRUE(hand.held().empty());
    EXPECT_TRUE(hand.carries().holds().empty());
    EXPECT_EQ(hand.selection().at(0).x, (far + 100) * sprite_units);
    EXPECT_NE(hand.take_message().find("too late"), std::string::npos);
}

TEST_F(HandAtWork, PagesThatNeverComeAreNotWaitedForForEver) {
    drag(texel(101, 51), texel(150, 80));
    answer(3);
    look(4000);
    EXPECT_FALSE(hand.held().empty());
    look(5001);
    EXPECT_TRUE(hand.held().empty());
}

TEST_F(HandAtWork, EscapeLeavesAllAsItWas) {
    hand.press(texel(101, 51), false);
    hand.drag(texel(150, 51), true, false);
    EXPECT_TRUE(hand.cancel());
    hand.release(texel(150, 51), true);
    EXPECT_TRUE(sent.empty());
    EXPECT_TRUE(hand.held().empty());
}

TEST_F(HandAtWork, ClicksSelectAndWithShiftAddAndTakeAway) {
    const auto click = [&](double x, bool add) {
        hand.press(texel(x, 50), add);
        hand.release(texel(x, 50), false);
    };
    click(100, false);
    EXPECT_EQ(hand.selected(), (std::vector<SpriteId>{1}));
    click(200, true);
    EXPECT_EQ(hand.selected(), (std::vector<SpriteId>{1, 2}));
    click(100, true);
    EXPECT_EQ(hand.selected(), (std::vector<SpriteId>{2}));
    click(300, false);
    EXPECT_TRUE(hand.selected().empty()) << "beside all";
    EXPECT_TRUE(sent.empty());
}

TEST_F(HandAtWork, AFrameSelectsSeveralAndTheyMoveAsOneEdit) {
    drag(texel(50, 20), texel(250, 80), true);
    EXPECT_EQ(hand.selected(), (std::vector<SpriteId>{1, 2}));
    drag(texel(101, 50), texel(101, 60));
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_EQ(sent[0].changes_size(), 2);
}

TEST_F(HandAtWork, HandlesScaleAndTurnAboutTheMiddle) {
    hand.select({1});
    const SelectionFrame frame = *hand.frame();
    const auto handle = [&](const HandOffset& offset, double by) {
        return HandPoint{frame.middle.x + static_cast<std::int64_t>(offset.x * by * sprite_units),
                         frame.middle.y + static_cast<std::int64_t>(offset.y * by * sprite_units)};
    };
    drag(handle(frame.corners[2], 1), handle(frame.corners[2], 2));
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_NEAR(sent[0].changes(0).move_sprite().scale(), 2, 0.01);
    EXPECT_FALSE(sent[0].changes(0).move_sprite().has_x());
    refuse();
    hand.press(handle(frame.knob, 1), false);
    hand.drag({frame.middle.x + 100 * sprite_units, frame.middle.y}, true, true);
    hand.release({frame.middle.x + 100 * sprite_units, frame.middle.y}, true);
    ASSERT_EQ(sent.size(), 2u);
    EXPECT_EQ(sent[1].changes(0).move_sprite().turn(), 0.25) << "from above to the right";
}

TEST_F(HandAtWork, PlacesWhatIsChosenAndNothingOutsideTheTexture) {
    hand.choose(2);
    hand.hover(texel(10, 20));
    EXPECT_EQ(hand.held().size(), 1u) << "what a click would place";
    EXPECT_FALSE(hand.press(texel(10, 20), false)) << "a drag moves the camera";
    hand.release(texel(10, 20), false);
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_EQ(sent[0].changes(0).place_sprite().pattern(), 2u);
    EXPECT_EQ(sent[0].changes(0).place_sprite().y(), static_cast<double>(far) + 20);
    hand.press({-5, 0}, false);
    hand.release({-5, 0}, false);
    EXPECT_EQ(sent.size(), 1u);
    EXPECT_FALSE(hand.take_message().empty());
}

TEST_F(HandAtWork, RemovesDuplicatesAndRaises) {
    hand.select({1, 2});
    hand.duplicate();
    ASSERT_EQ(sent.back().changes_size(), 2);
    const std::uint64_t copy = sent.back().changes(0).place_sprite().id();
    EXPECT_GT(copy, 2u);
    EXPECT_EQ(hand.selection().size(), 2u) << "the copies, before the server has them";
    answer(3);
    hand.select({1});
    hand.raise(true);
    EXPECT_EQ(sent.back().changes(0).move_sprite().order(), 1);
    answer(4);
    hand.remove();
    EXPECT_EQ(sent.back().changes(0).remove_sprite().id(), 1u);
    EXPECT_FALSE(hand.now(1)) << "gone at once";
    refuse();
    EXPECT_TRUE(hand.now(1)) << "and back where the server refuses it";
}

TEST_F(HandAtWork, UndoIsTheServersInverseAndIsSeenAtOnce) {
    drag(texel(101, 51), texel(111, 51));
    proto::Edit inverse;
    inverse.add_changes()->mutable_move_sprite()->set_id(1);
    inverse.mutable_changes(0)->mutable_move_sprite()->set_x(static_cast<double>(far) + 100);
    answer(3, inverse);
    hand.ended(std::vector{hand.held()[0].hold});
    EXPECT_TRUE(hand.go(HandEdits::Way::undoing));
    EXPECT_EQ(sent.back().changes(0).move_sprite().x(), static_cast<double>(far) + 100);
    ASSERT_EQ(hand.held().size(), 1u);
    EXPECT_EQ(hand.held()[0].middle.x, far + 100);
    EXPECT_TRUE(hand.go(HandEdits::Way::undoing)) << "waits for the one under way";
    EXPECT_EQ(sent.size(), 2u);
    answer(4);
    look(100);
    EXPECT_EQ(sent.size(), 2u) << "there is no more to undo";
    EXPECT_FALSE(hand.go(HandEdits::Way::undoing));
    EXPECT_EQ(hand.book().find(1)->x, (far + 100) * sprite_units);
}

/// An inverse that puts a sprite back to where it was.
proto::Edit back_to(std::uint64_t id, double x) {
    proto::Edit inverse;
    inverse.add_changes()->mutable_move_sprite()->set_id(id);
    inverse.mutable_changes(0)->mutable_move_sprite()->set_x(static_cast<double>(far) + x);
    return inverse;
}

TEST_F(HandAtWork, WhatIsUndoneWhileAnEditIsUnderWayIsThatEditAndNotTheOneBefore) {
    drag(texel(201, 51), texel(211, 51));
    answer(3, back_to(2, 200));
    drag(texel(101, 51), texel(111, 51));
    EXPECT_TRUE(hand.go(HandEdits::Way::undoing)) << "no answer has come: the connection may be lost";
    look(100);
    EXPECT_EQ(sent.size(), 2u);
    answer(4, back_to(1, 100));
    look(200);
    ASSERT_EQ(sent.size(), 3u);
    EXPECT_EQ(sent[2].changes(0).move_sprite().id(), 1u);

    answer(5, back_to(1, 110));
    drag(texel(101, 51), texel(121, 51));
    EXPECT_TRUE(hand.go(HandEdits::Way::undoing));
    refuse();
    look(300);
    EXPECT_EQ(sent.size(), 4u) << "what was not made is not undone, nor what was before it";
}

TEST_F(HandAtWork, WhatLiesOverADraggedSpriteIsDrawnOverIt) {
    const auto place = [&](std::uint64_t id, double x, std::int32_t order) {
        proto::Change change;
        proto::SpritePlacement& sprite = *change.mutable_place_sprite();
        sprite.set_id(id);
        sprite.set_x(static_cast<double>(far) + x);
        sprite.set_y(static_cast<double>(far) + 50);
        sprite.set_order(order);
        sprite.set_pattern(static_cast<std::uint32_t>(id) % 4);
        hand.book().take({change}, 10 + id, {});
    };
    place(5, 140, -1);  // below
    place(6, 145, 1);   // above
    place(7, 155, 2);   // above that one alone
    place(3, 175, 3);   // above, but elsewhere
    hand.press(texel(101, 51), false);
    hand.drag(texel(135, 51), true, false);
    const std::vector<HeldSprite> held = hand.held();
    ASSERT_EQ(held.size(), 3u);
    EXPECT_EQ(held[0].middle.x, far + 134);
    EXPECT_NE(held[0].hold, 0u);
    EXPECT_EQ(held[1].middle.x, far + 145);
    EXPECT_EQ(held[2].middle.x, far + 155);
    EXPECT_EQ(held[2].hold, 0u) << "the pages show it, too";
    hand.cancel();
    EXPECT_TRUE(hand.held().empty());
}

TEST_F(HandAtWork, ABrushKnowsTheBorderOfItsMap) {
    proto::EditableGrid grid;
    grid.set_x(100);
    grid.set_y(-50);
    grid.set_width(4);
    grid.set_height(2);
    grid.set_entry_texels(16);
    EXPECT_EQ(MapBrush(grid, edits).border(), (TexelBox{100, -50, 164, -18}));
    const auto paints = [&](std::int64_t x, std::int64_t y) {
        MapBrush brush{grid, edits};
        brush.radius_texels = 1;
        return !brush.entries_at({x * sprite_units, y * sprite_units}).empty();
    };
    EXPECT_TRUE(paints(101, -49));
    EXPECT_FALSE(paints(98, -49));
    grid.set_corners(true);
    EXPECT_EQ(MapBrush(grid, edits).border(), (TexelBox{92, -58, 156, -26}));
    EXPECT_TRUE(paints(93, -57));
    EXPECT_FALSE(paints(158, -40));
    grid.set_repeats(true);
    EXPECT_FALSE(MapBrush(grid, edits).border());
    EXPECT_TRUE(paints(-1000, 5000));
}

TEST_F(HandAtWork, ASpriteThatIsTakenUpAgainBeforeItsPagesCameIsDrawnOnce) {
    drag(texel(101, 51), texel(121, 51));
    answer(3);
    drag(texel(121, 51), texel(141, 51));
    EXPECT_EQ(hand.carries().holds().size(), 2u);
    ASSERT_EQ(hand.held().size(), 1u);
    EXPECT_EQ(hand.held()[0].middle.x, far + 140);
}

TEST_F(HandAtWork, AStrokeOfTheBrushHasOneEditUnderWayAndPaintsEachEntryOnce) {
    proto::EditableGrid grid;
    grid.set_block("fields");
    grid.set_entry_texels(64);
    grid.set_width(32);
    grid.set_height(32);
    grid.set_most(3);
    MapBrush brush{grid, edits};
    brush.value = 2;
    brush.radius_texels = 100;
    brush.press({640 * sprite_units, 640 * sprite_units});
    brush.advance();
    ASSERT_EQ(sent.size(), 1u);
    const proto::MapPaint first = sent[0].changes(0).paint_map();
    EXPECT_EQ(first.value(), 2);
    EXPECT_EQ(first.x(), 9);
    EXPECT_EQ(first.width(), 2u);
    brush.drag({900 * sprite_units, 640 * sprite_units});
    brush.advance();
    EXPECT_EQ(sent.size(), 1u) << "one is under way";
    answer(3);
    brush.advance();
    ASSERT_EQ(sent.size(), 2u);
    EXPECT_GE(sent[1].changes(0).paint_map().x(), 9);
    std::size_t painted = 0;
    for (const proto::Edit& edit : sent)
        for (const char bits : edit.changes(0).paint_map().mask())
            painted += static_cast<std::size_t>(__builtin_popcount(static_cast<unsigned char>(bits)));
    // A band of 100 texels above and below, from 640 to 900
    EXPECT_GE(painted, 12u);
    EXPECT_LE(painted, 24u);
}

TEST_F(HandAtWork, ADraggedTargetSendsTheLatestPlaceOnceTheLastIsIn) {
    TargetHand targets{edits};
    proto::Target target;
    target.set_id(5);
    target.set_x(100);
    target.set_y(100);
    target.add_legs()->set_x(300);
    google::protobuf::RepeatedPtrField<proto::Target> all;
    *all.Add() = target;
    targets.set(all);
    const HandPoint at{100 * sprite_units, 100 * sprite_units};
    ASSERT_EQ(targets.at(at, 10), 5u);
    targets.press(5, at);
    for (const int x : {110, 120, 130}) {
        targets.drag({x * sprite_units, at.y});
        targets.advance();
    }
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_EQ(sent[0].changes(0).set_target().x(), 110);
    EXPECT_EQ(sent[0].changes(0).set_target().legs(0).x(), 310) << "its way goes with it";
    answer(3);
    targets.advance();
    ASSERT_EQ(sent.size(), 2u);
    EXPECT_EQ(sent[1].changes(0).set_target().x(), 130);
}

TEST(OthersHands, WhatSomebodyPutsDownIsDrawnUntilThePagesShowItThere) {
    OthersHands others;
    HandSprite there;
    there.id = 4;
    there.side_texels = 16;
    HandSprite held = there;
    held.x = 100 * sprite_units;
    others.hold(9, held, &there);
    ASSERT_EQ(others.held(0).size(), 1u);
    ASSERT_EQ(others.holds().size(), 1u);
    EXPECT_EQ(others.holds()[0].lifted, std::vector<std::uint64_t>{4});
    EXPECT_FALSE(others.holds()[0].waits);
    others.let_go(9, ClientTime{100});
    EXPECT_TRUE(others.holds()[0].waits);
    proto::EditDone done;
    done.set_session(9);
    done.add_changes()->mutable_move_sprite()->set_id(4);
    done.mutable_answer()->set_revision(7);
    others.heard(done, ClientTime{120});
    others.tidy(ClientTime{2000});
    ASSERT_EQ(others.held(0).size(), 1u);
    EXPECT_EQ(others.holds()[0].revision, 7u);
    others.ended(std::vector{others.holds()[0].id});
    EXPECT_TRUE(others.held(0).empty());
}

TEST(OthersHands, WhatSomebodyLetsGoWithoutAnEditIsWhereItWas) {
    OthersHands others;
    HandSprite held;
    held.id = 4;
    held.side_texels = 16;
    others.hold(9, held, nullptr);
    others.let_go(9, ClientTime{100});
    others.tidy(ClientTime{800});
    EXPECT_EQ(others.held(0).size(), 1u);
    others.tidy(ClientTime{901});
    EXPECT_TRUE(others.held(0).empty());
    EXPECT_TRUE(others.holds().empty());
}

}  // namespace
}  // namespace tessera
