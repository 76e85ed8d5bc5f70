#include "client/view/hand/edit_history.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using Way = EditHistory::Way;

/// An answer whose inverse removes this sprite.
proto::EditAnswer answer(std::uint64_t id) {
    proto::EditAnswer made;
    made.mutable_inverse()->add_changes()->mutable_remove_sprite()->set_id(id);
    return made;
}

TEST(EditHistory, UndoesTheLastFirstAndDoesAgainWhatWasUndone) {
    EditHistory history;
    history.made(Way::doing, answer(1));
    history.made(Way::doing, answer(2));
    const auto undo = history.take(Way::undoing);
    ASSERT_TRUE(undo);
    EXPECT_EQ(undo->front().remove_sprite().id(), 2u);
    EXPECT_FALSE(history.take(Way::undoing)) << "one at a time";
    history.made(Way::undoing, answer(22));
    const auto redo = history.take(Way::redoing);
    ASSERT_TRUE(redo);
    EXPECT_EQ(redo->front().remove_sprite().id(), 22u);
    history.made(Way::redoing, answer(2));
    EXPECT_FALSE(history.can_redo());
    EXPECT_TRUE(history.can_undo());
}

TEST(EditHistory, ANewEditEndsWhatCouldBeDoneAgain) {
    EditHistory history;
    history.made(Way::doing, answer(1));
    history.take(Way::undoing);
    history.made(Way::undoing, answer(11));
    EXPECT_TRUE(history.can_redo());
    history.made(Way::doing, answer(3));
    EXPECT_FALSE(history.can_redo());
}

TEST(EditHistory, EditsOfOneStrokeAreUndoneTogetherTheLastFirst) {
    EditHistory history;
    history.made(Way::doing, answer(1));
    history.made(Way::doing, answer(2), true);
    const auto undo = history.take(Way::undoing);
    ASSERT_TRUE(undo);
    ASSERT_EQ(undo->size(), 2u);
    EXPECT_EQ((*undo)[0].remove_sprite().id(), 2u);
    EXPECT_EQ((*undo)[1].remove_sprite().id(), 1u);
    EXPECT_FALSE(history.can_undo());
}

TEST(EditHistory, WhatTheServerRefusesToUndoIsGone) {
    EditHistory history;
    history.made(Way::doing, answer(1));
    history.made(Way::doing, answer(2));
    history.take(Way::undoing);
    history.refused();
    const auto next = history.take(Way::undoing);
    ASSERT_TRUE(next);
    EXPECT_EQ(next->front().remove_sprite().id(), 1u);
}

TEST(EditHistory, RemembersSoManyAndNoMore) {
    EditHistory history;
    for (std::uint64_t i = 1; i <= EditHistory::most + 50; ++i) history.made(Way::doing, answer(i));
    std::size_t undone = 0;
    while (history.take(Way::undoing)) {
        history.made(Way::undoing, answer(1));
        ++undone;
    }
    EXPECT_EQ(undone, EditHistory::most);
}

}  // namespace
}  // namespace tessera
