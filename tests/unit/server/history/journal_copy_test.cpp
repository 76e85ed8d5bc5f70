#include "server/history/journal_copy.h"

#include <fstream>

#include <gmock/gmock.h>

#include "server/journal/journal_wait.h"
#include "server/journal/open_journal.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

using testing::HasSubstr;

std::unique_ptr<Journal> open(const std::filesystem::path& folder) {
    JournalOptions options;
    options.scene = "wall";
    SilentProgress progress;
    return open_journal(folder, std::move(options), progress).value();
}

void append(Journal& journal, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i)
        ASSERT_TRUE(std::holds_alternative<Accepted>(
            append_and_wait(journal, {random_edit_id(), std::string(3000, 'x'), 0, std::nullopt})));
}

// That it is right while a server writes is shown where there are two processes: tests/end_to_end/edits
TEST(JournalCopy, HoldsAllThatWasAcceptedWhetherItIsInTheLogOrNot) {
    const tests::TemporaryFolder folder;
    SilentProgress progress;
    auto journal = open(folder.path);
    append(*journal, 300);
    ASSERT_TRUE(keep_snapshot_and_wait(*journal, {200, "state"}));
    for (int round = 0; round < 2; ++round) {
        const auto copy = JournalCopy::take(folder.path, "wall", progress);
        ASSERT_TRUE(copy) << copy.error().detail;
        const JournalStatus status = copy->journal().status();
        EXPECT_EQ(status.head, 300u);
        const auto snapshot = newest_snapshot_and_wait(copy->journal());
        ASSERT_TRUE(snapshot && *snapshot);
        EXPECT_EQ((*snapshot)->bytes, "state");
        Revision seen = 0;
        EXPECT_FALSE(for_each_edit(copy->journal(), 1, 300, [&](const Edit& edit) {
            return edit.revision == ++seen && edit.bytes.size() == 3000;
        }));
        EXPECT_EQ(seen, 300u);
        journal.reset();  // The second copy is of a journal that nobody has open
    }
}

TEST(JournalCopy, LeavesNothingBehindAndTheJournalAsItWas) {
    const tests::TemporaryFolder folder, temporary;
    SilentProgress progress;
    append(*open(folder.path), 3);
    const auto files = [](const std::filesystem::path& path) {
        std::map<std::string, std::filesystem::file_time_type> found;
        for (const auto& entry : std::filesystem::directory_iterator{path})
            found[entry.path().filename()] = entry.last_write_time();
        return found;
    };
    const auto before = files(folder.path);
    ::setenv("TMPDIR", temporary.path.c_str(), 1);
    {
        const auto copy = JournalCopy::take(folder.path, "wall", progress);
        ASSERT_TRUE(copy);
        EXPECT_EQ(files(temporary.path).size(), 1u);
    }
    EXPECT_FALSE(JournalCopy::take(folder.path, "floor", progress));
    ::unsetenv("TMPDIR");
    EXPECT_TRUE(files(temporary.path).empty());
    EXPECT_EQ(files(folder.path), before);
}

TEST(JournalCopy, AWrongFileIsNamedWhereItIs) {
    const tests::TemporaryFolder folder;
    SilentProgress progress;
    EXPECT_THAT(JournalCopy::take(folder.path, "wall", progress).error().detail,
                HasSubstr("holds no journal"));
    std::ofstream{folder.path / "journal.db"} << std::string(5000, '?');
    const auto copy = JournalCopy::take(folder.path, "wall", progress);
    ASSERT_FALSE(copy);
    EXPECT_THAT(copy.error().detail, HasSubstr((folder.path / "journal.db").string()));
}

}  // namespace
}  // namespace tessera
