// kill -9 at random moments in a stream of accepted edits: each of them is there, once, where it was
// accepted.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "server/journal/journal_wait.h"
#include "server/journal/open_journal.h"
#include "tests/end_to_end/load/child_process.h"
#include "tests/support/temporary_folder.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

constexpr int kills = 50;

struct Line {
    Revision revision = 0;
    EditId id;
};

std::vector<Line> lines_of(const std::filesystem::path& path) {
    std::ifstream file{path, std::ios::binary};
    std::vector<Line> lines;
    for (Line line; file.read(reinterpret_cast<char*>(&line), sizeof line);) lines.push_back(line);
    return lines;
}

std::string content_of(const EditId& id) {
    return std::string(id.bytes[0] * std::size_t{3}, static_cast<char>(id.bytes[1])) + to_string(id);
}

TEST(JournalKill, EveryAcceptedEditIsThereOnceInOrder) {
    const char* const given = std::getenv("TESSERA_SEED");
    const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed));
    std::mt19937_64 random{seed};
    const tests::TemporaryFolder folder;
    const auto journal_folder = folder.path / "journal", accepted_file = folder.path / "accepted";

    std::map<Revision, EditId> history;  // all that was ever seen or accepted
    std::set<EditId> ids;
    std::size_t accepted = 0, snapshots = 0, forgotten = 0, unanswered = 0;
    for (int kill = 0; kill < kills; ++kill) {
        std::filesystem::remove(accepted_file);
        {
            ChildProcess writer{JOURNAL_WRITER, {journal_folder.string(), accepted_file.string()}};
            // Some kills fall into opening
            if (kill % 10 != 9) {
                ASSERT_EQ(writer.read_line(60s), "ready") << "after kill " << kill;
                // Edits are counted, so that as many are in on a slow disk
                const std::size_t enough = (1 + random() % 16) * sizeof(Line);
                for (int i = 0; i < 20'000 && std::filesystem::file_size(accepted_file) < enough; ++i)
                    std::this_thread::sleep_for(1ms);
            }
            std::this_thread::sleep_for(std::chrono::microseconds{random() % 40'000});
            writer.signal(SIGKILL);
            writer.wait(60s);
        }
        for (const Line& line :
             std::filesystem::exists(accepted_file) ? lines_of(accepted_file) : std::vector<Line>{}) {
            ++accepted;
            const auto [place, fresh] = history.emplace(line.revision, line.id);
            ASSERT_EQ(place->second, line.id) << "revision " << line.revision << " was given twice";
            ids.insert(line.id);
        }

        SilentProgress progress;
        JournalOptions options;
        options.scene = "killed";
        auto journal = open_journal(journal_folder, options, progress);
        ASSERT_TRUE(journal) << journal.error().detail;
        const JournalStatus status = (*journal)->status();
        ASSERT_GE(status.head, history.empty() ? 0 : history.rbegin()->first) << "an accepted edit is gone";
        const auto trouble = for_each_edit(**journal, status.oldest, status.head, [&](const Edit& edit) {
            const auto [place, fresh] = history.emplace(edit.revision, edit.id);
            EXPECT_EQ(place->second, edit.id) << "revision " << edit.revision;
            EXPECT_EQ(edit.bytes, content_of(edit.id)) << "revision " << edit.revision;
            unanswered += fresh;
            ids.insert(edit.id);
            return !testing::Test::HasFailure();
        });
        ASSERT_FALSE(trouble) << "history is not whole after kill " << kill;
        ASSERT_EQ(ids.size(), history.size()) << "an edit is there twice";
        ASSERT_EQ(history.size(), status.head) << "there is a gap";
        ASSERT_FALSE(HasFailure()) << "kill " << kill;

        // What is forgotten is behind a snapshot that is whole
        const auto snapshot = newest_snapshot_and_wait(**journal);
        ASSERT_TRUE(snapshot) << snapshot.error().detail;
        if (*snapshot) {
            ++snapshots;
            EXPECT_EQ((*snapshot)->bytes, std::string(100'000, 'x') + std::to_string((*snapshot)->revision));
        }
        ASSERT_GE(*snapshot ? (*snapshot)->revision + 1 : 1, status.oldest);
        forgotten = status.oldest - 1;
    }
    std::printf(
        "[          ] %d kills: %zu edits accepted, %zu in without an answer, %zu forgotten, 0 lost, 0 "
        "twice\n",
        kills, accepted, unanswered, forgotten);
    EXPECT_GT(accepted, kills * std::size_t{5});
    EXPECT_GT(snapshots, kills / 2u);
    EXPECT_GT(forgotten, 0u);
}

}  // namespace
}  // namespace tessera::test
