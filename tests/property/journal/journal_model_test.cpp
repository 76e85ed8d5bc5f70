// Random appends, retries, conflicts, questions, snapshots and restarts, each answer held against a model
// that forgets nothing.
#include <cstdlib>
#include <random>
#include <unordered_map>

#include "tests/unit/server/journal/engines.h"

namespace tessera::tests {
namespace {

class JournalModel : public testing::TestWithParam<Engine> {
  protected:
    std::uint64_t below(std::uint64_t count) { return random_() % count; }
    bool one_in(std::uint64_t count) { return below(count) == 0; }
    Revision head() const { return edits_.size(); }
    void open() {
        journal_.reset();
        JournalOptions options = scene_options();
        options.limits.edit_bytes = 1000;
        options.limits.history_edits = 50;
        options.horizon.revisions = 150;
        journal_ = GetParam().open(folder_.path / "journal", options);
    }

    Append random_append() {
        Append append =
            edit(next_id_++, std::string(below(40) * below(25), static_cast<char>('a' + below(26))));
        append.known = one_in(10) ? below(head() + 2) : head();
        if (one_in(5)) append.expected = one_in(3) ? below(head() + 2) : head();
        if (!edits_.empty() && one_in(3)) {
            // Again, mostly of late, mostly the same
            const std::uint64_t back = one_in(3) ? below(head()) : below(std::min<Revision>(head(), 20));
            const Edit& before = edits_[static_cast<std::size_t>(head() - 1 - back)];
            append.id = before.id;
            append.known = before.revision - 1;
            append.bytes = one_in(5) ? before.bytes + "!" : before.bytes;
        } else if (one_in(30)) {
            append.bytes.assign(1001, 'x');
        }
        return append;
    }

    /// What the model says about one outcome; an edit that was accepted goes into it.
    void judge(const Append& append, const AppendOutcome& outcome, Revision forgotten) {
        const auto found = revisions_.find(append.id);
        const Edit* const before =
            found == revisions_.end() ? nullptr : &edits_[static_cast<std::size_t>(found->second - 1)];
        const bool may_be_forgotten = before == nullptr || before->revision <= forgotten;
        if (const auto* accepted = std::get_if<Accepted>(&outcome)) {
            ++accepted_;
            if (before != nullptr) {
                EXPECT_TRUE(accepted->again) << "one edit, twice";
                EXPECT_EQ(accepted->revision, before->revision);
                EXPECT_EQ(append.bytes, before->bytes);
                return;
            }
            EXPECT_FALSE(accepted->again);
            EXPECT_EQ(accepted->revision, head() + 1);
            EXPECT_TRUE(!append.expected || *append.expected == head());
            EXPECT_LE(append.bytes.size(), 1000u);
            edits_.push_back({accepted->revision, append.id, {}, append.bytes});
            revisions_.emplace(append.id, accepted->revision);
        } else if (const auto* conflict = std::get_if<Conflict>(&outcome)) {
            EXPECT_EQ(conflict->head, head());
            EXPECT_TRUE(append.expected && *append.expected != head());
            EXPECT_TRUE(may_be_forgotten) << "a retry is no conflict";
        } else {
            const auto* const refused = std::get_if<Refused>(&outcome);
            ASSERT_NE(refused, nullptr) << "unknown, with nothing wrong";
            ++refused_;
            if (refused->why == RefusalReason::other_content) {
                EXPECT_TRUE(before != nullptr && before->bytes != append.bytes);
            } else if (refused->why == RefusalReason::outside_horizon) {
                EXPECT_TRUE(!append.expected || *append.expected == head());
                EXPECT_TRUE(append.known > head() || (append.known < forgotten && may_be_forgotten));
            } else {
                EXPECT_EQ(refused->why, RefusalReason::too_large) << refused->detail;
                EXPECT_GT(append.bytes.size(), 1000u);
            }
        }
    }

    void append_some() {
        std::vector<Append> batch;
        for (std::uint64_t i = 0; i < 1 + below(12); ++i) batch.push_back(random_append());
        const auto outcomes = append_and_wait(*journal_, batch);
        ASSERT_EQ(outcomes.size(), batch.size());
        // What is forgotten by now may have been forgotten before
        const Revision forgotten = journal_->status().oldest - 1;
        for (std::size_t i = 0; i < batch.size(); ++i) judge(batch[i], outcomes[i], forgotten);
        EXPECT_EQ(journal_->status().head, head());
    }

    void ask() {
        if (edits_.empty()) return;
        const Edit& edit = edits_[static_cast<std::size_t>(below(head()))];
        const Revision oldest = journal_->status().oldest;
        const auto found = find_and_wait(*journal_, edit.id).value();
        EXPECT_EQ(found.value_or(edit.revision), edit.revision);
        EXPECT_TRUE(found || edit.revision < std::max(oldest, journal_->status().oldest));
        EXPECT_EQ(find_and_wait(*journal_, id_of(next_id_)).value(), std::nullopt);
    }

    void read_history() {
        const Revision from = journal_->status().oldest;
        Revision next = from;
        const auto trouble = for_each_edit(*journal_, from, head(), [&](const Edit& edit) {
            const Edit& expected = edits_[static_cast<std::size_t>(next - 1)];
            EXPECT_EQ(edit.revision, next);
            EXPECT_EQ(edit.id, expected.id);
            EXPECT_EQ(edit.bytes, expected.bytes);
            ++next;
            return !HasFailure();
        });
        if (trouble) {
            // Forgotten since it was asked for
            ASSERT_TRUE(std::holds_alternative<OutsideHorizon>(*trouble));
            EXPECT_GT(journal_->status().oldest, from);
        } else {
            EXPECT_EQ(next, head() + 1);
        }
    }

    void keep() {
        const Revision revision = below(head() + 1);
        const bool newer = revision > (snapshots_.empty() ? 0 : snapshots_.back());
        const std::string state = "state " + std::to_string(revision);
        EXPECT_EQ(static_cast<bool>(keep_snapshot_and_wait(*journal_, {revision, state})), newer);
        if (!newer) return;
        snapshots_.push_back(revision);
        EXPECT_EQ(newest_snapshot_and_wait(*journal_).value()->bytes, state);
        EXPECT_LE(journal_->status().oldest,
                  (snapshots_.size() < 2 ? 0 : snapshots_[snapshots_.size() - 2]) + 1);
    }

    std::mt19937_64 random_;
    TemporaryFolder folder_;
    std::unique_ptr<Journal> journal_;
    std::vector<Edit> edits_;
    std::unordered_map<EditId, Revision> revisions_;
    std::vector<Revision> snapshots_;
    std::uint64_t next_id_ = 1;
    int accepted_ = 0, refused_ = 0;
};

TEST_P(JournalModel, AnswersAsTheModelDoes) {
    const char* const given = std::getenv("TESSERA_SEED");
    const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed));
    random_.seed(seed);
    open();
    const int steps = GetParam().lasts ? 300 : 3000;
    for (int step = 0; step < steps; ++step) {
        const std::uint64_t what = below(20);
        if (what < 12)
            append_some();
        else if (what < 16)
            ask();
        else if (what < 18)
            keep();
        else
            read_history();
        if (GetParam().lasts && one_in(40)) open();
        ASSERT_FALSE(HasFailure()) << "step " << step << " (" << what << "), head " << head();
    }
    read_history();
    EXPECT_GT(accepted_, steps);
    EXPECT_GT(refused_, steps / 10);
    EXPECT_GT(journal_->status().oldest, 100u) << "something was forgotten";
}

INSTANTIATE_TEST_SUITE_P(Engines, JournalModel, testing::Values(memory_engine, sqlite_engine),
                         [](const auto& engine) { return engine.param.name; });

}  // namespace
}  // namespace tessera::tests
