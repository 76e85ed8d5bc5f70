#include <gtest/gtest.h>

#include "server/stream/edit_news.h"
#include "server/stream/presence_board.h"

namespace tessera {
namespace {

EditNewsPtr news(Revision revision, std::size_t bytes = 10) {
    auto made = std::make_shared<EditNews>();
    made->revision = revision;
    made->message.assign(bytes, 'x');
    return made;
}

TEST(EditNewsRing, TellsEachEditInOrderToWhoKeepsUp) {
    EditNewsRing ring;
    for (Revision revision = 5; revision < 10; ++revision) ring.add(news(revision));
    Revision told = 6;
    for (Revision expected = 7; expected < 10; ++expected) {
        const auto next = ring.after(told);
        ASSERT_TRUE(next.news);
        EXPECT_EQ(next.missed_to, 0u);
        EXPECT_EQ(told = next.news->revision, expected);
    }
    EXPECT_FALSE(ring.after(told).news);
}

TEST(EditNewsRing, SaysWhatWasMissedToWhoDoesNot) {
    EditNewsRing ring{4, 1000};
    for (Revision revision = 1; revision <= 10; ++revision) ring.add(news(revision));
    const auto next = ring.after(2);
    EXPECT_EQ(next.missed_to, 6u);
    ASSERT_TRUE(next.news);
    EXPECT_EQ(next.news->revision, 7u);
    // Bytes are a limit, too
    ring.add(news(11, 999));
    EXPECT_EQ(ring.after(2).missed_to, 10u);
    ring.skip(20);
    EXPECT_EQ(ring.after(11).missed_to, 20u);
    EXPECT_EQ(ring.after(20).missed_to, 0u);
}

TEST(PresenceBoard, TellsTheLastWordOfEachAndNotWhatWasBetween) {
    PresenceBoard board;
    for (int i = 0; i < 100; ++i) board.set(1, "one at " + std::to_string(i));
    board.set(2, "two");
    const auto news = board.after(0, 2);
    ASSERT_EQ(news.people.size(), 1u);
    EXPECT_EQ(*news.people[0], "one at 99");
    EXPECT_TRUE(board.after(news.version, 3).people.empty());
    board.set(1, "one at 99");
    EXPECT_EQ(board.version(), news.version) << "the same word again is no news";
}

TEST(PresenceBoard, TellsWhoHasLeft) {
    PresenceBoard board;
    board.set(1, "one");
    board.set(2, "two");
    const auto before = board.after(0, 9).version;
    board.leave(1);
    board.leave(7);  // who never was here
    const auto news = board.after(before, 9);
    EXPECT_EQ(news.left, std::vector<PresenceBoard::Session>{1});
    EXPECT_TRUE(news.people.empty());
    EXPECT_TRUE(board.after(0, 9).left.empty()) << "a new reader has heard of nobody";
}

TEST(PresenceBoard, GivesACrowdInParts) {
    PresenceBoard board;
    for (std::uint64_t session = 1; session <= 1000; ++session) board.set(session, std::to_string(session));
    board.leave(999);
    PresenceBoard::Version read = 0;
    std::size_t people = 0;
    for (bool more = true; more;) {
        const auto news = board.after(read, 5, 100);
        ASSERT_LE(news.people.size(), 100u);
        people += news.people.size();
        read = news.version;
        more = news.more;
    }
    EXPECT_EQ(people, 998u);
    EXPECT_EQ(read, board.version());
}

TEST(PresenceBoard, SaysWhenMoreHaveLeftThanItRemembers) {
    PresenceBoard board;
    board.set(1, "one");
    const auto read = board.after(0, 9).version;
    for (std::uint64_t session = 2; session < 6000; ++session) {
        board.set(session, "somebody");
        board.leave(session);
    }
    EXPECT_TRUE(board.after(read, 9).lost);
    EXPECT_FALSE(board.after(0, 9).lost);
}

}  // namespace
}  // namespace tessera
