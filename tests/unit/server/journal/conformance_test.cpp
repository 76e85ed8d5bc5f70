// What every engine of the journal has to do. A new engine is one more line at the end, here and in
// keeping_test.cpp.
#include "tests/unit/server/journal/conformance.h"

#include <atomic>
#include <future>
#include <mutex>
#include <set>
#include <thread>

namespace tessera::tests {
namespace {

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
