#include "server/edits/live_scene.h"

#include <atomic>
#include <condition_variable>
#include <thread>

#include <gtest/gtest.h>

#include "server/journal/journal_wait.h"
#include "server/journal/open_journal.h"
#include "tests/support/passing_journal.h"
#include "tests/unit/server/edits/made_scene.h"

namespace tessera {
namespace {

/// The journal of a scene that outlives what writes into it, and whose disk fails when a test says so.
class FailingJournal final : public tests::PassingJournal {
  public:
    enum class Next { works, refuses, commits_but_cannot_tell };

    FailingJournal(std::shared_ptr<Journal> journal, std::function<Next()> next)
        : PassingJournal{std::move(journal)}, next_{std::move(next)} {}

    using Journal::append;
    void append(std::vector<Append> batch, Handler<std::vector<AppendOutcome>> handler) override {
        const std::size_t count = batch.size();
        switch (next_()) {
            case Next::refuses:
                return handler(
                    std::vector<AppendOutcome>(count, Refused{RefusalReason::full, "the disk is full"}));
            case Next::commits_but_cannot_tell:
                return PassingJournal::append(std::move(batch), [handler, count](std::vector<AppendOutcome>) {
                    handler(std::vector<AppendOutcome>(count, Unknown{}));
                });
            case Next::works:
                break;
        }
        PassingJournal::append(std::move(batch), std::move(handler));
    }

  private:
    std::function<Next()> next_;
};

std::unique_ptr<LiveScene> open(
    std::shared_ptr<Journal> journal,
    std::function<FailingJournal::Next()> next = [] { return FailingJournal::Next::works; }) {
    SilentProgress progress;
    return std::move(LiveScene::open(made_scene(),
                                     std::make_unique<FailingJournal>(std::move(journal), std::move(next)),
                                     progress))
        .value();
}

EditOutcome edit_and_wait(LiveScene& scene, const proto::Edit& edit) {
    std::mutex mutex;
    std::condition_variable told;
    std::optional<EditOutcome> outcome;
    scene.edit(edit, [&](EditOutcome how) {
        const std::lock_guard lock{mutex};
        outcome = std::move(how);
        told.notify_one();
    });
    std::unique_lock lock{mutex};
    told.wait(lock, [&] { return outcome.has_value(); });
    return *outcome;
}

const proto::EditAnswer* accepted(const EditOutcome& outcome) {
    return std::get_if<proto::EditAnswer>(&outcome);
}
const EditRefusal* refused(const EditOutcome& outcome) { return std::get_if<EditRefusal>(&outcome); }

TEST(LiveScene, AnEditIsSeenWhenItIsAnsweredAndItsInverseTakesItBack) {
    const auto live = open(memory_journal({}));
    const auto empty = texels_of(*live->now());
    const auto placed = edit_and_wait(*live, placing(1, 100, 100));
    ASSERT_TRUE(accepted(placed));
    EXPECT_EQ(accepted(placed)->revision(), 1u);
    EXPECT_EQ(live->now()->revision, 1u);
    EXPECT_NE(texels_of(*live->now()), empty);

    proto::Edit undo = accepted(placed)->inverse();
    undo.set_id(to_string(random_edit_id()));
    ASSERT_TRUE(accepted(edit_and_wait(*live, undo)));
    EXPECT_EQ(live->now()->revision, 2u);
    EXPECT_EQ(texels_of(*live->now()), empty);
}

TEST(LiveScene, OnlyPagesUnderAnEditGetItsRevision) {
    const auto live = open(memory_journal({}));
    ASSERT_TRUE(accepted(edit_and_wait(*live, placing(1, 100, 100))));
    ASSERT_TRUE(accepted(edit_and_wait(*live, placing(2, 100'000, 100))));
    ASSERT_TRUE(accepted(edit_and_wait(*live, moving(1, 128, 100))));
    const PageRevisions& revisions = live->now()->page_revisions;
    EXPECT_EQ(revisions.of({0, 0, 0}, 16), 3u);
    EXPECT_EQ(revisions.of({0, 100'000 / 256, 0}, 16), 2u);
    EXPECT_EQ(revisions.of({0, 5, 5}, 16), 0u);
    EXPECT_EQ(revisions.of({10, 0, 0}, 16), 3u);
}

TEST(LiveScene, AMoveToWhereItStandsIsARevisionButOfNoPage) {
    const auto live = open(memory_journal({}));
    ASSERT_TRUE(accepted(edit_and_wait(*live, placing(1, 100, 100))));
    ASSERT_TRUE(accepted(edit_and_wait(*live, moving(1, 100, 100))));
    EXPECT_EQ(live->now()->revision, 2u);
    EXPECT_EQ(live->now()->page_revisions.of({0, 0, 0}, 16), 1u);
}

TEST(LiveScene, ARetryIsTheSameEditAndAnotherEditUnderItsIdIsRefused) {
    const auto live = open(memory_journal({}));
    const proto::Edit place = placing(1, 50, 50), move = moving(1, 60, 50);
    ASSERT_TRUE(accepted(edit_and_wait(*live, place)));
    ASSERT_TRUE(accepted(edit_and_wait(*live, move)));
    // Neither would be possible, or change nothing, a second time
    for (const proto::Edit* edit : {&place, &move, &place}) {
        const auto again = edit_and_wait(*live, *edit);
        ASSERT_TRUE(accepted(again));
        EXPECT_TRUE(accepted(again)->again());
        EXPECT_EQ(accepted(again)->revision(), edit == &place ? 1u : 2u);
    }
    EXPECT_EQ(live->now()->revision, 2u);
    proto::Edit other = placing(9, 50, 50);
    other.set_id(place.id());
    const auto outcome = edit_and_wait(*live, other);
    ASSERT_TRUE(refused(outcome));
    EXPECT_EQ(refused(outcome)->why, EditRefusal::Why::other_content);
    EXPECT_EQ(live->now()->revision, 2u);
    EXPECT_EQ(live->now()->sprites.size(), 1u);
}

TEST(LiveScene, AnEditOfAnotherBaseIsAConflictUnlessItIsIn) {
    const auto live = open(memory_journal({}));
    proto::Edit first = placing(1, 50, 50);
    first.set_base_revision(0);
    ASSERT_TRUE(accepted(edit_and_wait(*live, first)));
    proto::Edit second = placing(2, 50, 50);
    second.set_base_revision(0);
    const auto conflict = edit_and_wait(*live, second);
    ASSERT_TRUE(refused(conflict));
    EXPECT_EQ(refused(conflict)->why, EditRefusal::Why::conflict);
    EXPECT_EQ(refused(conflict)->head, 1u);
    EXPECT_TRUE(accepted(edit_and_wait(*live, first)));
    EXPECT_EQ(live->now()->sprites.size(), 1u);
}

TEST(LiveScene, WhatCannotBeIsRefusedAndChangesNothing) {
    const auto live = open(memory_journal({}));
    const auto wrong = [&](const proto::Edit& edit) {
        const auto outcome = edit_and_wait(*live, edit);
        return refused(outcome) && refused(outcome)->why == EditRefusal::Why::wrong;
    };
    proto::Edit nameless = placing(1, 0, 0);
    nameless.set_id("edit 1");
    EXPECT_TRUE(wrong(nameless));
    proto::Edit nil = placing(1, 0, 0);
    nil.set_id(to_string(EditId{}));
    EXPECT_TRUE(wrong(nil));
    EXPECT_TRUE(wrong(new_edit()));
    EXPECT_TRUE(wrong(moving(1, 0, 0)));
    EXPECT_TRUE(wrong(placing(1, 0, 0, 99)));
    EXPECT_EQ(live->now()->revision, 0u);
}

/// An edit that may or may not be possible, of one of few sprites.
proto::Edit random_edit(std::uint64_t seed, std::int64_t n) {
    const auto draw = [&](std::uint64_t what) { return hash(seed, what, n, 0); };
    const std::uint64_t id = 1 + draw(1) % 40;
    const auto place = [&](std::uint64_t what) { return static_cast<double>(draw(what) % 65536) / 256; };
    switch (draw(2) % 4) {
        case 0:
            return placing(id, place(3), place(4), static_cast<std::uint32_t>(draw(5) % 4));
        case 1:
            return removing(id);
        default:
            return moving(id, place(3), place(4));
    }
}

/// A scene that lived through edits looks like one that starts now from the journal.
void expect_replayed(const LiveScene& lived, const std::shared_ptr<Journal>& journal) {
    const auto replayed = open(journal);
    ASSERT_EQ(replayed->now()->revision, lived.now()->revision);
    EXPECT_EQ(replayed->now()->fingerprint, lived.now()->fingerprint);
    EXPECT_EQ(replayed->now()->sprites.size(), lived.now()->sprites.size());
    for (const std::uint8_t level : std::vector<std::uint8_t>{0, 2, 5})
        EXPECT_EQ(texels_of(*replayed->now(), level), texels_of(*lived.now(), level));
    for (std::uint32_t x = 0; x < 3; ++x)
        for (std::uint8_t level = 0; level < 4; ++level)
            EXPECT_EQ(replayed->now()->page_revisions.of({level, x, 0}, 16),
                      lived.now()->page_revisions.of({level, x, 0}, 16));
}

TEST(LiveScene, EditsOfManyHandsAreInOnceAndAReplayGivesTheSameScene) {
    const std::shared_ptr<Journal> journal = memory_journal({});
    const auto live = open(journal);
    std::atomic<std::uint64_t> in{0};
    {
        std::vector<std::jthread> hands;
        for (std::uint64_t hand = 0; hand < 8; ++hand)
            hands.emplace_back([&, hand] {
                for (std::int64_t n = 0; n < 150; ++n)
                    if (accepted(edit_and_wait(*live, random_edit(hand, n)))) ++in;
            });
    }
    EXPECT_GT(in, 300u);
    EXPECT_EQ(live->now()->revision, in);
    expect_replayed(*live, journal);
}

TEST(LiveScene, AFailingDiskLosesNothingThatWasAcknowledgedAndNothingTwice) {
    const std::shared_ptr<Journal> journal = memory_journal({});
    std::atomic<std::uint64_t> commits{0};
    auto live = open(journal, [&] {
        const std::uint64_t draw = hash(3, 3, static_cast<std::int64_t>(++commits), 0) % 6;
        return draw == 0   ? FailingJournal::Next::refuses
               : draw == 1 ? FailingJournal::Next::commits_but_cannot_tell
                           : FailingJournal::Next::works;
    });
    std::atomic<std::uint64_t> in{0}, unknown{0}, full{0};
    {
        std::vector<std::jthread> hands;
        for (std::uint64_t hand = 0; hand < 4; ++hand)
            hands.emplace_back([&, hand] {
                for (std::int64_t n = 0; n < 150; ++n) {
                    const proto::Edit edit = random_edit(100 + hand, n);
                    for (int attempt = 0; attempt < 50; ++attempt) {
                        const auto outcome = edit_and_wait(*live, edit);
                        if (accepted(outcome)) ++in;
                        const auto* no = refused(outcome);
                        if (!no || no->why == EditRefusal::Why::wrong) break;
                        (no->why == EditRefusal::Why::unknown ? unknown : full)++;
                    }
                }
            });
    }
    EXPECT_GT(unknown, 10u);
    EXPECT_GT(full, 10u);
    EXPECT_EQ(journal->status().head, in);
    EXPECT_EQ(live->now()->revision, in);
    expect_replayed(*live, journal);
}

TEST(LiveScene, AReloadWhileEditsAreBeingCommittedShowsNoneOfThem) {
    // Whether they are in is not known then: a page must not show them under a revision that has none of them
    for (const auto how : {FailingJournal::Next::refuses, FailingJournal::Next::works}) {
        LiveScene* scene = nullptr;
        bool reloads = false;
        std::vector<float> seen;
        std::uint64_t revision = 0;
        proto::LiveState state;
        const auto live = open(memory_journal({}), [&] {
            if (!reloads) return FailingJournal::Next::works;
            scene->rebase(made_scene());
            seen = texels_of(*scene->now());
            revision = scene->now()->revision;
            state = scene->state();
            return how;
        });
        scene = live.get();
        ASSERT_TRUE(accepted(edit_and_wait(*live, placing(1, 100, 100))));
        const auto before = texels_of(*live->now());
        reloads = true;
        const auto outcome = edit_and_wait(*live, moving(1, 128, 100));
        ASSERT_EQ(accepted(outcome) != nullptr, how == FailingJournal::Next::works);
        EXPECT_EQ(seen, before);
        EXPECT_EQ(revision, 1u);
        ASSERT_EQ(state.sprites_size(), 1);
        EXPECT_EQ(state.sprites(0).x(), 100);
        EXPECT_EQ(state.revision(), 1u);
        EXPECT_EQ(texels_of(*live->now()) == before, how == FailingJournal::Next::refuses);
    }
}

TEST(LiveScene, MovesWithTheClockWhileAnySpriteDoes) {
    const auto live = open(memory_journal({}));
    ASSERT_TRUE(accepted(edit_and_wait(*live, placing(1, 50, 50))));
    EXPECT_FALSE(live->now()->animated);
    proto::Edit flying = placing(2, 50, 50);
    auto& path = *flying.mutable_changes(0)->mutable_place_sprite()->mutable_path();
    path.set_to_x(150);
    path.set_to_y(50);
    path.set_steps(100);
    ASSERT_TRUE(accepted(edit_and_wait(*live, flying)));
    EXPECT_TRUE(live->now()->animated);
    // A page under its way changes when it moves, one elsewhere never does
    const auto validity = [&](std::int64_t x) {
        LinearImage out;
        return live->now()
            ->texture->evaluate({.x = x, .width = 64, .height = 64, .step = 40}, {}, out)
            ->validity;
    };
    EXPECT_EQ(validity(64), (Validity{40, 41}));
    EXPECT_TRUE(validity(640).is_static());
    ASSERT_TRUE(accepted(edit_and_wait(*live, removing(2))));
    EXPECT_FALSE(live->now()->animated);
}

TEST(LiveScene, AnotherJournalIsAnotherFingerprintSinceItCountsFrom0Again) {
    EXPECT_NE(open(memory_journal({}))->now()->fingerprint, open(memory_journal({}))->now()->fingerprint);
}

TEST(LiveScene, ListenersHearOfEveryRevisionInOrder) {
    const auto live = open(memory_journal({}));
    std::vector<Revision> heard;
    std::size_t boxes = 0;
    auto listening = live->listen([&](const std::vector<LiveScene::Change>& changes) {
        for (const auto& change : changes) {
            heard.push_back(change.revision);
            boxes += change.dirty.size();
        }
    });
    edit_and_wait(*live, placing(1, 50, 50));
    edit_and_wait(*live, moving(1, 60, 50));
    EXPECT_EQ(heard, (std::vector<Revision>{1, 2}));
    EXPECT_EQ(boxes, 3u);
    listening.reset();
    edit_and_wait(*live, removing(1));
    EXPECT_EQ(heard.size(), 2u);
}

}  // namespace
}  // namespace tessera
