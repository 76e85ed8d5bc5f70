#include "server/history/edit_log.h"

#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "proto/log.pb.h"

#include "server/history/past_journal.h"
#include "server/journal/journal_wait.h"
#include "server/journal/open_journal.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

/// Removals of sprites 1, 2, …, one a second from 1970 on; older than the newest `revisions` are forgotten.
class EditLog : public testing::Test {
  protected:
    void append(std::uint64_t count) {
        for (std::uint64_t i = 0; i < count; ++i) {
            proto::Edit edit;
            edit.set_author("ada");
            edit.add_changes()->mutable_remove_sprite()->set_id(++revision_);
            const auto outcome = append_and_wait(
                *journal_, {random_edit_id(), edit.SerializeAsString(), revision_ - 1, std::nullopt});
            ASSERT_TRUE(std::holds_alternative<Accepted>(outcome));
        }
    }
    std::vector<std::string> lines(const LogOptions& options, std::uint64_t* older = nullptr) {
        char* text = nullptr;
        std::size_t bytes = 0;
        std::FILE* const out = open_memstream(&text, &bytes);
        SilentProgress progress;
        const auto left_out = write_log(*journal_, options, out, progress);
        std::fclose(out);
        EXPECT_TRUE(left_out);
        if (older != nullptr && left_out) *older = *left_out;
        std::istringstream in{std::string{text, bytes}};
        std::free(text);
        std::vector<std::string> lines;
        for (std::string line; std::getline(in, line);) lines.push_back(line);
        return lines;
    }

    std::uint64_t revision_ = 0;
    std::unique_ptr<Journal> journal_ = [this] {
        JournalOptions options;
        options.horizon.revisions = 10;
        options.clock = [this] {
            return JournalTime{std::chrono::seconds{static_cast<std::int64_t>(revision_)}};
        };
        return memory_journal(std::move(options));
    }();
};

TEST_F(EditLog, ListsWhatIsAskedForTheOldestFirst) {
    EXPECT_TRUE(lines({}).empty());
    append(5);
    EXPECT_EQ(lines({}).size(), 5u);
    EXPECT_EQ(lines({}).front(), "1  1970-01-01 00:00:01.000  ada  removes sprite 1");
    std::uint64_t older = 0;
    const auto newest = lines({.limit = 2}, &older);
    ASSERT_EQ(newest.size(), 2u);
    EXPECT_EQ(older, 3u);
    EXPECT_EQ(newest.front().substr(0, 3), "4  ");
    const auto middle = lines({.from = 2, .limit = 2});
    ASSERT_EQ(middle.size(), 2u);
    EXPECT_EQ(middle.front().substr(0, 3), "2  ");
    EXPECT_EQ(lines({.from = 2, .limit = 0}).size(), 4u);
    EXPECT_TRUE(lines({.from = 6}).empty());
}

TEST_F(EditLog, IsAMessageALineInJson) {
    append(2);
    const auto line = lines({.json = true}).at(1);
    proto::LoggedEdit edit;
    ASSERT_TRUE(read_json(line, "line", edit)) << line;
    EXPECT_EQ(edit.revision(), 2u);
    EXPECT_EQ(edit.time(), "1970-01-01T00:00:02.000Z");
    EXPECT_EQ(edit.author(), "ada");
    ASSERT_EQ(edit.changes_size(), 1);
    EXPECT_EQ(edit.changes(0).remove_sprite().id(), 2u);
    EXPECT_TRUE(edit_id_from(edit.id()));
}

TEST_F(EditLog, BeyondTheHorizonIsRefusedByName) {
    append(20);
    ASSERT_TRUE(keep_snapshot_and_wait(*journal_, {20, "state"}));
    append(10);
    ASSERT_TRUE(keep_snapshot_and_wait(*journal_, {30, "state"}));
    append(10);
    // Forgotten where nobody waits, behind the last snapshot but one
    for (int i = 0; i < 500 && journal_->status().oldest == 1; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
    const Revision oldest = journal_->status().oldest;
    ASSERT_GT(oldest, 1u);
    SilentProgress progress;
    const auto refused = write_log(*journal_, {.from = 1}, stdout, progress);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().detail.find("horizon"), std::string::npos);
    EXPECT_EQ(lines({.limit = 0}).size(), 40 - oldest + 1);

    // The state of then can be told from the snapshot on, and no earlier
    EXPECT_TRUE(check_remembered(*journal_, 40));
    EXPECT_TRUE(check_remembered(*journal_, 25));
    EXPECT_NE(check_remembered(*journal_, 3).error().detail.find("horizon"), std::string::npos);
    EXPECT_NE(check_remembered(*journal_, 41).error().detail.find("revision 40"), std::string::npos);
}

}  // namespace
}  // namespace tessera
