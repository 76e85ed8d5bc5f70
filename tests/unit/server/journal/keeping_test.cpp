// What every engine of the journal keeps, for how long, and when it forgets: snapshots, bounds, horizons.
#include <algorithm>
#include <atomic>
#include <thread>

#include "tests/unit/server/journal/conformance.h"

namespace tessera::tests {
namespace {

using namespace std::chrono_literals;

using JournalKeeping = JournalConformance;

TEST_P(JournalKeeping, KeepsTheNewestTwoSnapshots) {
    const auto journal = open();
    for (std::uint64_t n = 0; n < 9; ++n) append_and_wait(*journal, edit(n));
    EXPECT_FALSE(newest_snapshot_and_wait(*journal).value());
    for (const Revision revision : {2u, 5u, 9u})
        ASSERT_TRUE(keep_snapshot_and_wait(*journal, {revision, "state " + std::to_string(revision)}));
    EXPECT_EQ(journal->status().snapshot, 9u);
    EXPECT_EQ(newest_snapshot_and_wait(*journal).value()->bytes, "state 9");
    EXPECT_EQ(newest_snapshot_and_wait(*journal, 8).value()->bytes, "state 5");
    EXPECT_EQ(newest_snapshot_and_wait(*journal, 5).value()->revision, 5u);
    EXPECT_FALSE(newest_snapshot_and_wait(*journal, 4).value());
}

TEST_P(JournalKeeping, RefusesASnapshotThatIsNotNewerOrBeyondTheHead) {
    const auto journal = open();
    append_and_wait(*journal, {edit(1), edit(2), edit(3)});
    EXPECT_FALSE(keep_snapshot_and_wait(*journal, {4, "of tomorrow"}));
    EXPECT_FALSE(keep_snapshot_and_wait(*journal, {0, "of nothing"}));
    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {2, ""}));
    EXPECT_FALSE(keep_snapshot_and_wait(*journal, {2, "again"}));
    EXPECT_FALSE(keep_snapshot_and_wait(*journal, {1, "older"}));
    EXPECT_EQ(newest_snapshot_and_wait(*journal).value()->bytes, "");
}

TEST_P(JournalKeeping, ForgetsNothingThatNoSnapshotButTheLastCovers) {
    JournalOptions options = scene_options();
    options.horizon.revisions = 10;
    const auto journal = open(options);
    std::vector<Append> batch;
    for (std::uint64_t n = 0; n < 100; ++n) batch.push_back(edit(n));
    append_and_wait(*journal, batch);
    append_and_wait(*journal, edit(0));
    EXPECT_EQ(journal->status().oldest, 1u) << "no snapshot";
    EXPECT_TRUE(journal->status().snapshot_due);
    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {60, "sixty"}));
    append_and_wait(*journal, edit(100));
    EXPECT_EQ(journal->status().oldest, 1u) << "one, which might be damaged: the whole history stays";
    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {101, "a hundred and one"}));
    EXPECT_EQ(append_and_wait(*journal, edit(101, "edit", 101)), AppendOutcome{Accepted{102}});
    EXPECT_EQ(journal->status().oldest, 61u);
    EXPECT_EQ(history(*journal, 61, 102).size(), 42u);
}

TEST_P(JournalKeeping, RefusesByNameWhatLiesBeyondItsHorizonOfRevisions) {
    JournalOptions options = scene_options();
    options.horizon.revisions = 10;
    const auto journal = open(options);
    std::vector<Append> batch;
    for (std::uint64_t n = 1; n <= 100; ++n) batch.push_back(edit(n, "edit", n - 1));
    append_and_wait(*journal, batch);
    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {99, ""}));
    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {100, ""}));
    append_and_wait(*journal, edit(101, "edit", 100));
    for (int i = 0; i < 1000 && journal->status().oldest != 92; ++i) std::this_thread::sleep_for(5ms);
    ASSERT_EQ(journal->status().oldest, 92u);

    EXPECT_EQ(append_and_wait(*journal, edit(92, "edit", 91)), (AppendOutcome{Accepted{92, true}}));
    EXPECT_EQ(refusal(append_and_wait(*journal, edit(91, "edit", 90))), RefusalReason::outside_horizon)
        << "a late retry";
    EXPECT_EQ(refusal(append_and_wait(*journal, edit(200, "edit", 90))), RefusalReason::outside_horizon);
    EXPECT_EQ(refusal(append_and_wait(*journal, edit(201))), RefusalReason::outside_horizon)
        << "knows no revision";
    EXPECT_EQ(refusal(append_and_wait(*journal, edit(201, "edit", 102))), RefusalReason::outside_horizon)
        << "knows one that is not there yet";
    EXPECT_EQ(append_and_wait(*journal, edit(202, "edit", 91)), AppendOutcome{Accepted{102}});
    Append strict = edit(1);
    strict.expected = 0;
    EXPECT_EQ(append_and_wait(*journal, strict), AppendOutcome{Conflict{102}}) << "a late retry of its kind";
    EXPECT_EQ(find_and_wait(*journal, id_of(1)).value(), std::nullopt);
}

/// Of a journal whose clock shows `hours`, which live longer.
JournalOptions remembering_a_day(const std::atomic<std::int64_t>& hours) {
    JournalOptions options = scene_options();
    options.horizon.age = 24h;
    options.clock = [&hours] { return JournalTime{std::chrono::hours{hours}}; };
    return options;
}

TEST_P(JournalKeeping, ForgetsByAgeAlsoWhenNothingHappens) {
    std::atomic<std::int64_t> hours = 0;
    const auto journal = open(remembering_a_day(hours));
    for (std::uint64_t n = 1; n <= 48; ++n, ++hours) append_and_wait(*journal, edit(n));
    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {47, ""}));
    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {48, ""}));
    // Edit n was accepted at hour n - 1; it is hour 48
    const auto forgets_to = [&journal](Revision oldest) {
        for (int i = 0; i < 1000 && journal->status().oldest != oldest; ++i) std::this_thread::sleep_for(5ms);
        EXPECT_EQ(journal->status().oldest, oldest);
    };
    forgets_to(26);
    hours = 58;
    forgets_to(36);
    hours = 1000;
    forgets_to(48);  // what the older snapshot does not cover stays
    EXPECT_EQ(journal->status().head, 48u);
}

TEST_P(JournalKeeping, AsksForASnapshotOfFewEditsOnceTheyAreOld) {
    std::atomic<std::int64_t> hours = 0;
    const auto journal = open(remembering_a_day(hours));
    Revision head = 0;
    for (; hours < 24; ++hours) {
        EXPECT_FALSE(journal->status().snapshot_due) << hours;
        append_and_wait(*journal, edit(++head));
    }
    append_and_wait(*journal, edit(++head));  // Of hour 24: the first is beyond it
    ASSERT_TRUE(journal->status().snapshot_due);
    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {head, ""}));
    EXPECT_EQ(journal->status().snapshot, head);
    append_and_wait(*journal, edit(++head));
    EXPECT_FALSE(journal->status().snapshot_due) << "what is behind it is new";
    hours = 48;
    append_and_wait(*journal, edit(++head));
    ASSERT_TRUE(journal->status().snapshot_due);
    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {head, ""}));
    // Two snapshots now: all that the older one covers and is old enough is forgotten
    for (int i = 0; i < 1000 && journal->status().oldest != 26; ++i) std::this_thread::sleep_for(5ms);
    EXPECT_EQ(journal->status().oldest, 26u);
}

TEST_P(JournalKeeping, AClockThatGoesBackDoesNotReorderTimes) {
    std::atomic<std::int64_t> now = 1000;
    JournalOptions options = scene_options();
    options.clock = [&now] { return JournalTime{std::chrono::milliseconds{now}}; };
    const auto journal = open(options);
    append_and_wait(*journal, edit(1));
    now = 500;
    append_and_wait(*journal, edit(2));
    const auto edits = history(*journal, 1, 2);
    EXPECT_EQ(edits[1].accepted, edits[0].accepted);
}

TEST_P(JournalKeeping, IsFullWithoutASnapshotAndGoesOnAfterOne) {
    JournalOptions options = scene_options();
    options.horizon.bytes = 100'000;
    const auto journal = open(options);
    std::uint64_t n = 0;
    AppendOutcome outcome = Accepted{};
    while (std::holds_alternative<Accepted>(outcome)) {
        std::vector<Append> batch;
        for (int i = 0; i < 7; ++i) batch.push_back(edit(++n, std::string(872, 'x')));
        outcome = append_and_wait(*journal, batch).back();
    }
    EXPECT_EQ(refusal(outcome), RefusalReason::full);
    EXPECT_EQ(journal->status().head, 100u);
    EXPECT_TRUE(journal->status().snapshot_due);
    EXPECT_EQ(append_and_wait(*journal, edit(1, std::string(872, 'x'))), (AppendOutcome{Accepted{1, true}}))
        << "a retry needs no room";
    EXPECT_EQ(history(*journal, 1, 100).size(), 100u) << "reading goes on";

    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {100, "all of it"}));
    for (int i = 0; i < 1000 && journal->status().bytes > 95'000; ++i) std::this_thread::sleep_for(5ms);
    EXPECT_EQ(append_and_wait(*journal, edit(n, std::string(872, 'x'), 100)), AppendOutcome{Accepted{101}});
}

TEST_P(JournalKeeping, StaysInItsBoundsWhereSnapshotsAreTakenWhenTheyAreDue) {
    JournalOptions options = scene_options();
    options.horizon.bytes = 200'000;
    const auto journal = open(options);
    std::uint64_t most = 0;
    for (std::uint64_t n = 1; n <= 3000; n += 20) {
        std::vector<Append> batch;
        for (std::uint64_t i = n; i < n + 20; ++i)
            batch.push_back(edit(i, std::string(i * 37 % 900, 'x'), n - 1));
        const auto outcomes = append_and_wait(*journal, batch);
        for (std::uint64_t i = 0; i < 20; ++i) ASSERT_EQ(outcomes[i], AppendOutcome{Accepted{n + i}});
        const JournalStatus status = journal->status();
        most = std::max(most, status.bytes);
        if (!status.snapshot_due) continue;
        ASSERT_TRUE(keep_snapshot_and_wait(*journal, {status.head, "state"}));
    }
    EXPECT_LE(most, 200'000u);
    EXPECT_GT(journal->status().oldest, 2000u);
}

TEST_P(JournalKeeping, RemembersItsHorizonAfterOpeningItAgain) {
    if (!GetParam().lasts) return;
    JournalOptions options = scene_options();
    options.horizon.revisions = 5;
    {
        const auto journal = open(options);
        std::vector<Append> batch;
        for (std::uint64_t n = 1; n <= 50; ++n) batch.push_back(edit(n));
        append_and_wait(*journal, batch);
        ASSERT_TRUE(keep_snapshot_and_wait(*journal, {49, ""}));
        ASSERT_TRUE(keep_snapshot_and_wait(*journal, {50, ""}));
        append_and_wait(*journal, edit(51, "edit", 50));
        EXPECT_EQ(journal->status().oldest, 47u);
    }
    const auto journal = open();
    EXPECT_EQ(journal->status().oldest, 47u);
    EXPECT_EQ(refusal(append_and_wait(*journal, edit(3))), RefusalReason::outside_horizon);
    EXPECT_EQ(append_and_wait(*journal, edit(52, "edit", 46)), AppendOutcome{Accepted{52}});
}

INSTANTIATE_TEST_SUITE_P(Engines, JournalKeeping, testing::Values(memory_engine, sqlite_engine),
                         [](const auto& engine) { return engine.param.name; });

}  // namespace
}  // namespace tessera::tests
