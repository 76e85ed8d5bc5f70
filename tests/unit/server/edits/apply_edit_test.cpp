#include "server/edits/apply_edit.h"

#include <gtest/gtest.h>

#include "tests/unit/server/edits/made_scene.h"

namespace tessera {
namespace {

constexpr SpritePatterns patterns{4, 16};

std::string book_text(const SpriteBook& book) {
    std::string text;
    for (const Sprite& sprite : book.map().meeting({-10'000, -10'000, 10'000, 10'000})) {
        proto::SpritePlacement message;
        write_sprite(sprite, message);
        text += message.ShortDebugString() + '\n';
    }
    return text;
}

TEST(ApplyEdit, TheInverseRestoresWhatWasThere) {
    SpriteBook book;
    ASSERT_TRUE(apply_edit(placing(1, 100.5, 60, 3), patterns, book));
    ASSERT_TRUE(apply_edit(placing(2, 90, 70), patterns, book));
    const std::string before = book_text(book);

    proto::Edit edit = new_edit();
    proto::SpriteMove& move = *edit.add_changes()->mutable_move_sprite();
    move.set_id(1);
    move.set_x(7);
    move.set_turn(0.3);
    move.set_scale(2);
    move.set_order(-4);
    move.set_pattern(2);
    edit.add_changes()->mutable_remove_sprite()->set_id(2);
    edit.MergeFrom([] {
        proto::Edit more;
        *more.mutable_changes() = placing(2, -5, -6, 1).changes();
        return more;
    }());
    const auto applied = apply_edit(edit, patterns, book);
    ASSERT_TRUE(applied) << applied.error().detail;
    EXPECT_NE(book_text(book), before);
    EXPECT_EQ(applied->dirty.size(), 4u);
    ASSERT_TRUE(apply_edit(applied->inverse, patterns, book));
    EXPECT_EQ(book_text(book), before);
}

TEST(ApplyEdit, MakesAllChangesOrNone) {
    SpriteBook book;
    ASSERT_TRUE(apply_edit(placing(1, 10, 10), patterns, book));
    const std::string before = book_text(book);
    proto::Edit edit = placing(2, 50, 50);
    *edit.add_changes() = moving(1, 90, 90).changes(0);
    *edit.add_changes() = removing(77).changes(0);
    const auto applied = apply_edit(edit, patterns, book);
    ASSERT_FALSE(applied);
    EXPECT_TRUE(applied.error().detail.starts_with("changes[2].remove_sprite: there is no sprite 77"))
        << applied.error().detail;
    EXPECT_EQ(book_text(book), before);
}

TEST(ApplyEdit, NamesWhatIsWrong) {
    SpriteBook book;
    ASSERT_TRUE(apply_edit(placing(1, 10, 10), patterns, book));
    const auto says = [&](const proto::Edit& edit, const std::string& text) {
        const auto applied = apply_edit(edit, patterns, book);
        return !applied && applied.error().detail.find(text) != std::string::npos;
    };
    EXPECT_TRUE(says(placing(1, 0, 0), "already"));
    EXPECT_TRUE(says(placing(0, 0, 0), "id"));
    EXPECT_TRUE(says(placing(2, 0, 0, 4), "pattern: is 4; the set has 4"));
    EXPECT_TRUE(says(placing(2, 1e300, 0), "x, y"));
    EXPECT_TRUE(says(placing(2, 0, std::numeric_limits<double>::quiet_NaN()), "x, y"));
    EXPECT_TRUE(says(moving(2, 0, 0), "there is no sprite 2"));
    EXPECT_TRUE(says(moving(1, 1e13, 0), "x, y"));
    proto::Edit nothing = new_edit();
    nothing.add_changes();
    EXPECT_TRUE(says(nothing, "says nothing"));
}

TEST(ApplyEdit, AMoveToWhereItStandsDirtiesNoPage) {
    SpriteBook book;
    ASSERT_TRUE(apply_edit(placing(1, 10, 10), patterns, book));
    const std::string before = book_text(book);
    const auto applied = apply_edit(moving(1, 10, 10), patterns, book);
    ASSERT_TRUE(applied);
    EXPECT_TRUE(applied->dirty.empty());
    EXPECT_EQ(applied->inverse.changes_size(), 1);
    EXPECT_EQ(book_text(book), before);
    EXPECT_FALSE(apply_edit(moving(1, 10, 10.5), patterns, book)->dirty.empty());
}

TEST(CheckMoves, RefusesThatWhichSetsNothing) {
    proto::Edit edit = placing(1, 10, 10);
    edit.add_changes()->mutable_move_sprite()->set_id(1);
    const auto checked = check_moves(edit, {10});
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().detail.find("changes[1].move_sprite: sets nothing"), 0u)
        << checked.error().detail;
    edit.mutable_changes(1)->mutable_move_sprite()->set_turn(0);
    EXPECT_TRUE(check_moves(edit, {10}));
}

TEST(CanonicalEdit, IsTheMeaningAlone) {
    proto::Edit edit = placing(1, 10, 10);
    const auto bytes = canonical_edit(edit);
    ASSERT_TRUE(bytes);
    edit.set_id("another");
    edit.set_known_revision(7);
    edit.set_base_revision(7);
    EXPECT_EQ(*canonical_edit(edit), *bytes);
    edit.mutable_changes(0)->mutable_place_sprite()->set_x(11);
    EXPECT_NE(*canonical_edit(edit), *bytes);
}

TEST(CanonicalEdit, RefusesTooMuchAndWhatItDoesNotKnow) {
    EXPECT_FALSE(canonical_edit(new_edit()));
    proto::Edit many = new_edit();
    for (int i = 0; i <= max_changes; ++i) many.add_changes();
    EXPECT_FALSE(canonical_edit(many));
    proto::Edit author = placing(1, 0, 0);
    author.set_author(std::string(65, 'a'));
    EXPECT_FALSE(canonical_edit(author));
    proto::Edit newer = placing(1, 0, 0);
    auto& place = *newer.mutable_changes(0)->mutable_place_sprite();
    place.GetReflection()->MutableUnknownFields(&place)->AddVarint(99, 1);
    EXPECT_FALSE(canonical_edit(newer));
}

}  // namespace
}  // namespace tessera
