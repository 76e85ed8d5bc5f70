// The journal on a disk that fails: whatever it does, an edit that was accepted is there once, in order, and
// one that was refused is not.
#include <future>
#include <map>
#include <thread>

#include "tests/unit/server/journal/engines.h"
#include "tests/unit/server/journal/faulty_disk.h"

namespace tessera::tests {
namespace {

using namespace std::chrono_literals;

class JournalOnAFailingDisk : public testing::Test {
  protected:
    Result<std::unique_ptr<Journal>> open() {
        JournalOptions options = scene_options();
        options.vfs = FaultyDisk::name();
        SilentProgress progress;
        return open_journal(folder_.path / "journal", std::move(options), progress);
    }
    /// Appends until it is accepted; what came before that.
    static std::vector<AppendOutcome> insist(Journal& journal, const Append& edit) {
        std::vector<AppendOutcome> before;
        for (int i = 0; i < 200; ++i) {
            const AppendOutcome outcome = append_and_wait(journal, edit);
            if (std::holds_alternative<Accepted>(outcome)) return before;
            before.push_back(outcome);
            std::this_thread::sleep_for(20ms);
        }
        ADD_FAILURE() << "the journal does not recover: " << journal.status().trouble;
        return before;
    }
    static std::vector<EditId> ids(Journal& journal) {
        std::vector<EditId> all;
        for_each_edit(journal, 1, journal.status().head, [&](const Edit& edit) {
            all.push_back(edit.id);
            return true;
        });
        return all;
    }

    FaultyDisk disk_;
    TemporaryFolder folder_;
};

TEST_F(JournalOnAFailingDisk, ASyncThatFailsOnceIsResolvedBeforeTheAnswer) {
    const auto journal = open().value();
    // Of the log's head: the edit is not in, and never will be
    disk_.fail(1, 0, false, FaultyDisk::Kind::sync);
    EXPECT_EQ(std::get<Refused>(append_and_wait(*journal, edit(0))).why, RefusalReason::unavailable);
    EXPECT_EQ(find_and_wait(*journal, id_of(0)).value(), std::nullopt);
    insist(*journal, edit(1));
    // Of the commit itself, whether it says so wrongly or not: the log holds it when it is read back
    for (const bool done : {false, true}) {
        insist(*journal, edit(10 + done));
        const Revision head = journal->status().head;
        disk_.fail(1, 0, done, FaultyDisk::Kind::sync);
        EXPECT_EQ(append_and_wait(*journal, edit(20 + done)), AppendOutcome{Accepted{head + 1}});
        EXPECT_EQ(find_and_wait(*journal, id_of(20 + done)).value(), std::optional<Revision>{head + 1});
        EXPECT_EQ(journal->status().trouble, "");
    }
    EXPECT_EQ(ids(*journal), (std::vector<EditId>{id_of(1), id_of(10), id_of(20), id_of(11), id_of(21)}));
}

TEST_F(JournalOnAFailingDisk, AnOutcomeThatCannotBeReadBackIsUnknownAndResolvedByItsId) {
    const auto journal = open().value();
    ASSERT_EQ(append_and_wait(*journal, edit(0)), AppendOutcome{Accepted{1}});
    disk_.fail(1, 1'000'000, true, FaultyDisk::Kind::sync);  // the commit, and every sync after it
    EXPECT_EQ(append_and_wait(*journal, edit(1)), AppendOutcome{Unknown{}});
    EXPECT_NE(journal->status().trouble, "");
    EXPECT_EQ(std::get<Refused>(append_and_wait(*journal, edit(2))).why, RefusalReason::unavailable);
    EXPECT_FALSE(find_and_wait(*journal, id_of(1))) << "no answer is better than a wrong one";
    disk_.heal();
    insist(*journal, edit(1));
    EXPECT_EQ(append_and_wait(*journal, edit(1)), (AppendOutcome{Accepted{2, true}}));
    EXPECT_EQ(journal->status().trouble, "");
    insist(*journal, edit(2));
    EXPECT_EQ(ids(*journal), (std::vector<EditId>{id_of(0), id_of(1), id_of(2)}));
}

TEST_F(JournalOnAFailingDisk, WhoFollowsHearsOfAnEditThatTurnedOutToBeIn) {
    const auto journal = open().value();
    std::promise<History> heard;
    const auto ticket = journal->follow(1, [&](History history) { heard.set_value(std::move(history)); });
    disk_.fail(1, 4, true, FaultyDisk::Kind::sync);
    append_and_wait(*journal, edit(0));
    insist(*journal, edit(0));
    const History history = heard.get_future().get();
    EXPECT_EQ(std::get<std::vector<Edit>>(history).front().id, id_of(0));
}

TEST_F(JournalOnAFailingDisk, AFullDiskRefusesEditsAndRecoversWhenThereIsRoom) {
    auto journal = open().value();
    std::uint64_t n = 0;
    for (; n < 5; ++n) ASSERT_EQ(append_and_wait(*journal, edit(n)), AppendOutcome{Accepted{n + 1}});
    disk_.set_room(0);  // nothing may grow
    AppendOutcome outcome = Accepted{};
    for (; n < 2000; ++n) {
        outcome = append_and_wait(*journal, edit(n, std::string(3000, 'x')));
        if (!std::holds_alternative<Accepted>(outcome)) break;
    }
    ASSERT_TRUE(std::holds_alternative<Refused>(outcome)) << outcome.index();
    EXPECT_EQ(std::get<Refused>(outcome).why, RefusalReason::full);
    EXPECT_NE(std::get<Refused>(outcome).detail.find("full"), std::string::npos);
    EXPECT_NE(journal->status().trouble, "");
    // Reading and retries go on
    EXPECT_EQ(append_and_wait(*journal, edit(2)), (AppendOutcome{Accepted{3, true}}));
    EXPECT_EQ(ids(*journal).size(), n);
    EXPECT_EQ(find_and_wait(*journal, id_of(n)).value(), std::nullopt) << "what was refused is not in";
    std::this_thread::sleep_for(150ms);
    EXPECT_EQ(std::get<Refused>(append_and_wait(*journal, edit(n + 1, std::string(3000, 'x')))).why,
              RefusalReason::full);

    disk_.set_room({});
    insist(*journal, edit(n, std::string(3000, 'x')));
    EXPECT_EQ(journal->status().trouble, "");
    const auto lived = ids(*journal);
    journal.reset();
    EXPECT_EQ(ids(*open().value()), lived);
    EXPECT_EQ(lived.size(), n + 1);
}

TEST_F(JournalOnAFailingDisk, OpeningOnAFullDiskSaysSo) {
    disk_.set_room(0);
    const auto journal = open();
    ASSERT_FALSE(journal);
    EXPECT_EQ(journal.error().code, ErrorCode::io_failure);
    EXPECT_NE(journal.error().detail.find("full"), std::string::npos) << journal.error().detail;
    disk_.set_room({});
    EXPECT_TRUE(open());
}

/// What a session did, and what has to be there afterwards.
struct Story {
    std::map<std::uint64_t, Revision> accepted;  ///< Edit -> revision.
    std::map<std::uint64_t, bool> refused;       ///< By its last answer.

    void note(std::uint64_t n, const AppendOutcome& outcome) {
        if (const auto* in = std::get_if<Accepted>(&outcome)) {
            const auto [place, fresh] = accepted.emplace(n, in->revision);
            EXPECT_EQ(place->second, in->revision) << "one edit, two revisions";
            refused.erase(n);
        } else if (const auto* why = std::get_if<Refused>(&outcome);
                   why != nullptr && why->why != RefusalReason::unavailable) {
            EXPECT_EQ(accepted.count(n), 0u) << "accepted, then refused";
            refused[n] = true;
        } else {
            refused.erase(n);
        }
    }
    /// Revisions are gapless, every id is there once, accepted ones where they were accepted.
    void holds_in(const std::vector<EditId>& ids) const {
        std::map<EditId, Revision> there;
        for (std::size_t i = 0; i < ids.size(); ++i)
            EXPECT_TRUE(there.emplace(ids[i], i + 1).second) << "twice: revision " << i + 1;
        for (const auto& [n, revision] : accepted) {
            const auto found = there.find(id_of(n));
            ASSERT_NE(found, there.end()) << "edit " << n << ", accepted as " << revision << ", is lost";
            EXPECT_EQ(found->second, revision);
        }
        for (const auto& [n, yes] : refused)
            EXPECT_EQ(there.count(id_of(n)), 0u) << "edit " << n << " was refused";
    }
};

/// Some edits, some in batches, some sent again.
void session(Journal& journal, Story& story, std::uint64_t& next) {
    for (int i = 0; i < 6; ++i) {
        std::vector<Append> batch;
        std::vector<std::uint64_t> numbers;
        for (std::uint64_t k = 0; k < 1 + next % 3; ++k) numbers.push_back(next++);
        if (next > 4) numbers.push_back(next - 4);
        for (const std::uint64_t n : numbers) batch.push_back(edit(n, std::string(n % 5 * 700, 'x')));
        const auto outcomes = append_and_wait(journal, batch);
        for (std::size_t k = 0; k < numbers.size(); ++k) story.note(numbers[k], outcomes[k]);
    }
}

TEST_F(JournalOnAFailingDisk, EveryOperationOfASessionMayFailInTurn) {
    int failed = 0;
    for (const bool done : {false, true}) {
        for (const std::uint64_t more : {0u, 3u}) {
            bool ended = false;
            for (std::uint64_t number = 1; !ended; ++number) {
                std::filesystem::remove_all(folder_.path / "journal");
                Story story;
                std::uint64_t next = 0;
                {
                    auto journal = open();
                    ASSERT_TRUE(journal);
                    disk_.fail(number, more, done);
                    const std::uint64_t before = disk_.operations();
                    session(**journal, story, next);
                    ended = disk_.operations() - before < number;
                }
                disk_.heal();
                const auto journal = open();
                ASSERT_TRUE(journal) << journal.error().detail;
                const auto there = ids(**journal);
                story.holds_in(there);
                ASSERT_FALSE(HasFailure())
                    << "operation " << number << " failed, " << more << " more, done: " << done;
                failed += !ended;
            }
        }
    }
    std::printf("[          ] %d operations failed in turn\n", failed);
    EXPECT_GT(failed, 100);
}

TEST_F(JournalOnAFailingDisk, EveryOperationOfOpeningMayFailInTurn) {
    Story story;
    std::uint64_t next = 0;
    session(*open().value(), story, next);
    std::uint64_t number = 1;
    for (bool failed = true; failed; ++number) {
        disk_.fail(number);
        const std::uint64_t before = disk_.operations();
        const auto journal = open();
        failed = disk_.operations() - before >= number;
        disk_.heal();
        if (!journal) {
            EXPECT_NE(journal.error().detail.find("journal.db"), std::string::npos) << journal.error().detail;
        }
    }
    EXPECT_GT(number, 3u);
    story.holds_in(ids(*open().value()));
}

TEST_F(JournalOnAFailingDisk, AnEditWhoseSyncFailedAndThatIsAcceptedAllTheSameSurvivesAPowerCut) {
    for (std::uint64_t round = 0; round < 20; ++round) {
        Story story;
        std::uint64_t next = 0;
        {
            const auto journal = open().value();
            session(*journal, story, next);
            // The kernel drops what the sync was for, and says so once; the file still seems to hold it
            disk_.fail(1, 0, false, FaultyDisk::Kind::sync);
            session(*journal, story, next);
            disk_.lose_power(1);
        }
        disk_.power_comes_back(round);
        const auto journal = open();
        ASSERT_TRUE(journal) << journal.error().detail;
        story.holds_in(ids(**journal));
        EXPECT_EQ(story.accepted.size(), next);
        ASSERT_FALSE(HasFailure()) << "round " << round;
        std::filesystem::remove_all(folder_.path / "journal");
    }
}

TEST_F(JournalOnAFailingDisk, AcceptedEditsSurviveAPowerCutAtEveryOperation) {
    Story story;
    std::uint64_t next = 0, accepted = 0;
    open().value();
    for (std::uint64_t number = 1; number <= 120; ++number) {
        if (number % 40 == 0) {
            accepted += story.accepted.size();
            std::filesystem::remove_all(folder_.path / "journal");
            story = {};
            next = 0;
            open().value();
        }
        {
            disk_.lose_power(number % 40 + 1);
            auto journal = open();
            if (journal) session(**journal, story, next);
        }
        disk_.power_comes_back(number);
        const auto journal = open();
        ASSERT_TRUE(journal) << journal.error().detail;
        story.refused.clear();  // an answer that the power cut: not to be believed
        story.holds_in(ids(**journal));
        ASSERT_FALSE(HasFailure()) << "cut " << number;
    }
    EXPECT_GT(accepted, 100u);
}

}  // namespace
}  // namespace tessera::tests
