// What every engine of the journal has to do. A new engine is one more line at the end.
#include <algorithm>
#include <atomic>
#include <future>
#include <mutex>
#include <set>
#include <thread>

#include "tests/unit/server/journal/engines.h"

namespace tessera::tests {
namespace {

using namespace std::chrono_literals;

class JournalConformance : public testing::TestWithParam<Engine> {
  protected:
    std::unique_ptr<Journal> open(JournalOptions options = scene_options()) {
        return GetParam().open(temporary_.path / "journal", std::move(options));
    }
    static std::vector<Edit> history(Journal& journal, Revision from, Revision through) {
        std::vector<Edit> edits;
        const auto trouble = for_each_edit(journal, from, through, [&](const Edit& edit) {
            edits.push_back(edit);
            return true;
        });
        EXPECT_FALSE(trouble) << "no history from " << from;
        return edits;
    }
    static RefusalReason refusal(const AppendOutcome& outcome) {
        const auto* const refused = std::get_if<Refused>(&outcome);
        EXPECT_NE(refused, nullptr) << "not refused";
        if (refused == nullptr) return RefusalReason::unavailable;
        EXPECT_FALSE(refused->detail.empty());
        return refused->why;
    }

    TemporaryFolder temporary_;
};

TEST_P(JournalConformance, CountsRevisionsFromOneWithoutGaps) {
    const auto journal = open();
    EXPECT_EQ(journal->status().head, 0u);
    EXPECT_EQ(journal->status().oldest, 1u);
    for (Revision revision = 1; revision <= 20; ++revision)
        EXPECT_EQ(append_and_wait(*journal, edit(revision)), AppendOutcome{Accepted{revision}});
    EXPECT_EQ(journal->status().head, 20u);
}

TEST_P(JournalConformance, KeepsEveryByteOfAnEdit) {
    const auto journal = open();
    std::vector<std::string> all{"", std::string(1, '\0'), std::string(40'000, 'x'), "\xff\xfe\n\"'"};
    for (int c = 0; c < 256; ++c) all.back() += static_cast<char>(c);
    for (std::size_t i = 0; i < all.size(); ++i) append_and_wait(*journal, edit(i, all[i]));
    const auto edits = history(*journal, 1, all.size());
    ASSERT_EQ(edits.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(edits[i].bytes, all[i]);
        EXPECT_EQ(edits[i].id, id_of(i));
        EXPECT_EQ(edits[i].revision, i + 1);
    }
}

TEST_P(JournalConformance, ARetryIsNotASecondEdit) {
    const auto journal = open();
    EXPECT_EQ(append_and_wait(*journal, edit(7, "a")), (AppendOutcome{Accepted{1, false}}));
    append_and_wait(*journal, edit(8, "b"));
    EXPECT_EQ(append_and_wait(*journal, edit(7, "a")), (AppendOutcome{Accepted{1, true}}));
    EXPECT_EQ(journal->status().head, 2u);
}

TEST_P(JournalConformance, ARetryIsTakenAsSuchWhateverItExpected) {
    const auto journal = open();
    Append strict = edit(1);
    strict.expected = 0;
    EXPECT_EQ(append_and_wait(*journal, strict), (AppendOutcome{Accepted{1, false}}));
    append_and_wait(*journal, edit(2));
    EXPECT_EQ(append_and_wait(*journal, strict), (AppendOutcome{Accepted{1, true}}));
}

TEST_P(JournalConformance, RefusesAnIdWithOtherContent) {
    const auto journal = open();
    append_and_wait(*journal, edit(7, "a"));
    EXPECT_EQ(refusal(append_and_wait(*journal, edit(7, "b"))), RefusalReason::other_content);
    EXPECT_EQ(refusal(append_and_wait(*journal, edit(7, ""))), RefusalReason::other_content);
    EXPECT_EQ(journal->status().head, 1u);
}

TEST_P(JournalConformance, AnEditThatExpectsAnotherHeadIsAConflictAndNamesTheHead) {
    const auto journal = open();
    append_and_wait(*journal, edit(1));
    append_and_wait(*journal, edit(2));
    for (const Revision wrong : {0u, 1u, 3u, 1000u}) {
        Append strict = edit(3);
        strict.expected = wrong;
        EXPECT_EQ(append_and_wait(*journal, strict), AppendOutcome{Conflict{2}});
    }
    Append right = edit(3);
    right.expected = 2;
    EXPECT_EQ(append_and_wait(*journal, right), AppendOutcome{Accepted{3}});
}

TEST_P(JournalConformance, OfManyThatExpectTheSameHeadOneWins) {
    const auto journal = open();
    std::vector<std::future<AppendOutcome>> outcomes;
    for (std::uint64_t n = 0; n < 16; ++n) {
        outcomes.push_back(std::async(std::launch::async, [&journal, n] {
            Append strict = edit(n);
            strict.expected = 0;
            return append_and_wait(*journal, strict);
        }));
    }
    int won = 0;
    for (auto& outcome : outcomes) {
        const AppendOutcome what = outcome.get();
        if (what == AppendOutcome{Accepted{1}})
            ++won;
        else
            EXPECT_EQ(what, AppendOutcome{Conflict{1}});
    }
    EXPECT_EQ(won, 1);
}

TEST_P(JournalConformance, ABatchIsDecidedInItsOrder) {
    const auto journal = open();
    Append follows = edit(2, "b");
    follows.expected = 1;
    Append late = edit(3, "c");
    late.expected = 1;
    const auto outcomes = append_and_wait(
        *journal, {edit(1, "a"), follows, edit(1, "a"), edit(2, "other"), late, edit(4, "d")});
    ASSERT_EQ(outcomes.size(), 6u);
    EXPECT_EQ(outcomes[0], (AppendOutcome{Accepted{1, false}}));
    EXPECT_EQ(outcomes[1], (AppendOutcome{Accepted{2, false}}));
    EXPECT_EQ(outcomes[2], (AppendOutcome{Accepted{1, true}}));
    EXPECT_EQ(refusal(outcomes[3]), RefusalReason::other_content);
    EXPECT_EQ(outcomes[4], AppendOutcome{Conflict{2}});
    EXPECT_EQ(outcomes[5], (AppendOutcome{Accepted{3, false}}));
}

TEST_P(JournalConformance, AnEmptyBatchHasNoOutcomes) {
    const auto journal = open();
    EXPECT_TRUE(append_and_wait(*journal, std::vector<Append>{}).empty());
}

TEST_P(JournalConformance, RefusesWhatIsTooLargeAndTakesTheRest) {
    JournalOptions options = scene_options();
    options.limits.edit_bytes = 100;
    options.limits.batch_edits = 3;
    const auto journal = open(options);
    const auto outcomes =
        append_and_wait(*journal, {edit(1), edit(2, std::string(101, 'x')), edit(3, std::string(100, 'x'))});
    EXPECT_EQ(outcomes[0], AppendOutcome{Accepted{1}});
    EXPECT_EQ(refusal(outcomes[1]), RefusalReason::too_large);
    EXPECT_EQ(outcomes[2], AppendOutcome{Accepted{2}});
    for (const auto& outcome : append_and_wait(*journal, {edit(5), edit(6), edit(7), edit(8)}))
        EXPECT_EQ(refusal(outcome), RefusalReason::too_large);
    EXPECT_EQ(journal->status().head, 2u);
}

TEST_P(JournalConformance, RefusesWhatItCannotQueueAtOnce) {
    JournalOptions options = scene_options();
    options.limits.queued_edits = 4;
    const auto journal = open(options);
    // A handler holds up the journal's thread: what comes meanwhile queues
    std::promise<void> held, release;
    journal->append(edit(0), [&](const AppendOutcome&) {
        held.set_value();
        release.get_future().wait();
    });
    held.get_future().wait();
    std::atomic<int> accepted = 0, overloaded = 0;
    std::promise<void> all;
    for (std::uint64_t n = 1; n <= 10; ++n) {
        journal->append(edit(n), [&](const AppendOutcome& outcome) {
            if (std::holds_alternative<Accepted>(outcome))
                ++accepted;
            else if (std::get<Refused>(outcome).why == RefusalReason::overloaded)
                ++overloaded;
            if (accepted + overloaded == 10) all.set_value();
        });
    }
    EXPECT_EQ(overloaded, 6) << "refused before append() returned";
    release.set_value();
    all.get_future().wait();
    EXPECT_EQ(accepted, 4);
    EXPECT_EQ(append_and_wait(*journal, edit(99)), AppendOutcome{Accepted{6}}) << "and takes edits again";
}

TEST_P(JournalConformance, FindsWhatIsInAndNothingElse) {
    const auto journal = open();
    append_and_wait(*journal, edit(1));
    append_and_wait(*journal, edit(2));
    EXPECT_EQ(find_and_wait(*journal, id_of(2)).value(), std::optional<Revision>{2});
    EXPECT_EQ(find_and_wait(*journal, id_of(3)).value(), std::nullopt);
}

TEST_P(JournalConformance, WhoFollowsGetsEveryEditOnceInOrder) {
    JournalOptions options = scene_options();
    options.limits.history_edits = 7;
    const auto journal = open(options);
    for (std::uint64_t n = 0; n < 50; ++n) append_and_wait(*journal, edit(n, std::to_string(n)));
    std::jthread writer{[&journal] {
        for (std::uint64_t n = 50; n < 300; n += 5) {
            std::vector<Append> batch;
            for (std::uint64_t i = n; i < n + 5; ++i) batch.push_back(edit(i, std::to_string(i)));
            append_and_wait(*journal, std::move(batch));
        }
    }};
    const auto edits = history(*journal, 1, 300);
    ASSERT_EQ(edits.size(), 300u);
    for (std::size_t i = 0; i < edits.size(); ++i) {
        ASSERT_EQ(edits[i].revision, i + 1);
        ASSERT_EQ(edits[i].bytes, std::to_string(i));
        ASSERT_GE(edits[i].accepted, edits[i == 0 ? 0 : i - 1].accepted);
    }
}

TEST_P(JournalConformance, AnswersToFollowKeepToTheirSize) {
    JournalOptions options = scene_options();
    options.limits.history_bytes = 1000;
    const auto journal = open(options);
    std::vector<Append> batch;
    for (std::uint64_t n = 0; n < 10; ++n) batch.push_back(edit(n, std::string(n == 4 ? 5000 : 400, 'x')));
    append_and_wait(*journal, batch);
    std::vector<std::size_t> counts;
    for (Revision from = 1; from <= 10;) {
        std::promise<History> answer;
        const auto ticket =
            journal->follow(from, [&](History history) { answer.set_value(std::move(history)); });
        const History history = answer.get_future().get();
        counts.push_back(std::get<std::vector<Edit>>(history).size());
        from += counts.back();
    }
    EXPECT_EQ(counts, (std::vector<std::size_t>{2, 2, 1, 2, 2, 1}));
}

TEST_P(JournalConformance, WhoFollowsHearsOfAnEditBeforeItsAnswer) {
    const auto journal = open();
    std::mutex mutex;
    std::vector<std::string> order;
    std::promise<void> answered;
    const auto ticket = journal->follow(1, [&](const History&) {
        const std::lock_guard lock{mutex};
        order.emplace_back("followed");
    });
    find_and_wait(*journal, id_of(0)).value();  // The question before is looked at by now
    journal->append(edit(1), [&](const AppendOutcome&) {
        const std::lock_guard lock{mutex};
        order.emplace_back("answered");
        answered.set_value();
    });
    answered.get_future().wait();
    const std::lock_guard lock{mutex};
    EXPECT_EQ(order, (std::vector<std::string>{"followed", "answered"}));
}

TEST_P(JournalConformance, ATicketGivenUpIsNotAnswered) {
    const auto journal = open();
    std::atomic<int> called = 0;
    auto given_up = journal->follow(1, [&](const History&) { ++called; });
    const auto kept = journal->follow(1, [&](const History&) { called += 100; });
    find_and_wait(*journal, id_of(0)).value();
    given_up.reset();
    append_and_wait(*journal, edit(1));
    EXPECT_EQ(called, 100);
}

TEST_P(JournalConformance, WhoFollowsWhereNoHistoryIsIsToldWhereItIs) {
    const auto journal = open();
    append_and_wait(*journal, {edit(1), edit(2)});
    for (const Revision wrong : {Revision{0}, Revision{4}, ~Revision{0}}) {
        std::promise<History> answer;
        const auto ticket =
            journal->follow(wrong, [&](History history) { answer.set_value(std::move(history)); });
        const History history = answer.get_future().get();
        ASSERT_TRUE(std::holds_alternative<OutsideHorizon>(history)) << wrong;
        EXPECT_EQ(std::get<OutsideHorizon>(history).oldest, 1u);
        EXPECT_EQ(std::get<OutsideHorizon>(history).head, 2u);
    }
}

TEST_P(JournalConformance, ClosingCommitsWhatWasAppendedAndAnswersEverybody) {
    std::atomic<int> accepted = 0, told_of_the_end = 0;
    auto journal = open();
    const auto waits = journal->follow(501, [&](const History& history) {
        if (std::holds_alternative<OutsideHorizon>(history))
            ++told_of_the_end;  // looked at before there were 500
        if (std::holds_alternative<Refused>(history)) ++told_of_the_end;
    });
    for (std::uint64_t n = 0; n < 500; ++n) {
        journal->append(edit(n), [&](const AppendOutcome& outcome) {
            if (std::holds_alternative<Accepted>(outcome)) ++accepted;
        });
    }
    journal.reset();
    EXPECT_EQ(accepted, 500);
    EXPECT_EQ(told_of_the_end, 1);
}

TEST_P(JournalConformance, KeepsTheNewestTwoSnapshots) {
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

TEST_P(JournalConformance, RefusesASnapshotThatIsNotNewerOrBeyondTheHead) {
    const auto journal = open();
    append_and_wait(*journal, {edit(1), edit(2), edit(3)});
    EXPECT_FALSE(keep_snapshot_and_wait(*journal, {4, "of tomorrow"}));
    EXPECT_FALSE(keep_snapshot_and_wait(*journal, {0, "of nothing"}));
    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {2, ""}));
    EXPECT_FALSE(keep_snapshot_and_wait(*journal, {2, "again"}));
    EXPECT_FALSE(keep_snapshot_and_wait(*journal, {1, "older"}));
    EXPECT_EQ(newest_snapshot_and_wait(*journal).value()->bytes, "");
}

TEST_P(JournalConformance, ForgetsNothingThatNoSnapshotButTheLastCovers) {
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

TEST_P(JournalConformance, RefusesByNameWhatLiesBeyondItsHorizonOfRevisions) {
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

TEST_P(JournalConformance, ForgetsByAgeAlsoWhenNothingHappens) {
    std::atomic<std::int64_t> hours = 0;
    JournalOptions options = scene_options();
    options.horizon.age = 24h;
    options.clock = [&hours] { return JournalTime{std::chrono::hours{hours}}; };
    const auto journal = open(options);
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

TEST_P(JournalConformance, AClockThatGoesBackDoesNotReorderTimes) {
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

TEST_P(JournalConformance, IsFullWithoutASnapshotAndGoesOnAfterOne) {
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

TEST_P(JournalConformance, StaysInItsBoundsWhereSnapshotsAreTakenWhenTheyAreDue) {
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

TEST_P(JournalConformance, IsTheSameAfterOpeningItAgain) {
    if (!GetParam().lasts) return;  // Nothing to be the same: this engine is as old as the process
    std::vector<Edit> before;
    EditId lineage;
    {
        const auto journal = open();
        std::vector<Append> batch;
        for (std::uint64_t n = 0; n < 30; ++n) batch.push_back(edit(n, std::to_string(n)));
        append_and_wait(*journal, batch);
        ASSERT_TRUE(keep_snapshot_and_wait(*journal, {20, "twenty"}));
        before = history(*journal, 1, 30);
        lineage = journal->status().lineage;
    }
    const auto journal = open();
    EXPECT_EQ(history(*journal, 1, 30), before);
    EXPECT_EQ(journal->status().lineage, lineage);
    EXPECT_EQ(journal->status().snapshot, 20u);
    EXPECT_EQ(newest_snapshot_and_wait(*journal).value()->bytes, "twenty");
    EXPECT_EQ(append_and_wait(*journal, edit(4, "4")), (AppendOutcome{Accepted{5, true}}));
    EXPECT_EQ(refusal(append_and_wait(*journal, edit(4, "5"))), RefusalReason::other_content);
    EXPECT_EQ(append_and_wait(*journal, edit(30)), AppendOutcome{Accepted{31}});
}

TEST_P(JournalConformance, RemembersItsHorizonAfterOpeningItAgain) {
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

TEST_P(JournalConformance, ManyThreadsAtOnceLoseNothing) {
    const auto journal = open();
    constexpr std::uint64_t threads = 8, each = 100;
    std::mutex mutex;
    std::set<Revision> revisions;
    {
        std::vector<std::jthread> all;
        for (std::uint64_t t = 0; t < threads; ++t) {
            all.emplace_back([&, t] {
                for (std::uint64_t n = 0; n < each; ++n) {
                    const AppendOutcome outcome = append_and_wait(*journal, edit(t * each + n));
                    const std::lock_guard lock{mutex};
                    revisions.insert(std::get<Accepted>(outcome).revision);
                }
            });
        }
    }
    EXPECT_EQ(revisions.size(), threads * each);
    EXPECT_EQ(*revisions.rbegin(), threads * each);
}

INSTANTIATE_TEST_SUITE_P(Engines, JournalConformance, testing::Values(memory_engine, sqlite_engine),
                         [](const auto& engine) { return engine.param.name; });

}  // namespace
}  // namespace tessera::tests
