// What opening a journal says to people: another program's file, a damaged one, a folder that cannot be
// written.
#include <fstream>
#include <thread>

#include <sqlite3.h>
#include <sys/fsuid.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/unit/server/journal/engines.h"

namespace tessera::tests {
namespace {

class OpeningAJournal : public testing::Test {
  protected:
    Result<std::unique_ptr<Journal>> open(JournalOptions options = scene_options()) {
        SilentProgress progress;
        return open_journal(folder_, std::move(options), progress);
    }
    void fill(std::uint64_t edits) {
        const auto journal = open().value();
        std::vector<Append> batch;
        for (std::uint64_t n = 0; n < edits; ++n) batch.push_back(edit(n, std::string(n % 7 * 100, 'x')));
        append_and_wait(*journal, batch);
    }
    void fails(const std::string& words, ErrorCode code = ErrorCode::invalid_input,
               JournalOptions options = scene_options()) {
        const auto journal = open(std::move(options));
        ASSERT_FALSE(journal) << "opened, although: " << words;
        EXPECT_EQ(journal.error().code, code);
        EXPECT_NE(journal.error().detail.find(words), std::string::npos) << journal.error().detail;
        EXPECT_NE(journal.error().detail.find(folder_.string()), std::string::npos) << "names the file";
    }
    void execute(const std::string& sql) {
        sqlite3* database = nullptr;
        ASSERT_EQ(sqlite3_open((folder_ / "journal.db").c_str(), &database), SQLITE_OK);
        EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
            << sqlite3_errmsg(database);
        sqlite3_close(database);
    }
    void damage(const std::filesystem::path& file, std::int64_t at) {
        std::fstream stream{file, std::ios::binary | std::ios::in | std::ios::out};
        stream.seekg(at, at < 0 ? std::ios::end : std::ios::beg);
        const auto place = stream.tellg();
        const int c = stream.get();
        stream.seekp(place);
        stream.put(static_cast<char>(c ^ 0x40));
    }

    TemporaryFolder temporary_;
    const std::filesystem::path folder_ = temporary_.path / "scenes" / "garden" / "journal";
};

TEST_F(OpeningAJournal, MakesTheFolder) {
    ASSERT_TRUE(open());
    EXPECT_TRUE(std::filesystem::is_regular_file(folder_ / "journal.db"));
}

TEST_F(OpeningAJournal, KeepsItsPromisesInTheFile) {
    fill(3);
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open((folder_ / "journal.db").c_str(), &database), SQLITE_OK);
    const auto ask = [&](const char* sql) {
        std::string answer;
        sqlite3_exec(
            database, sql,
            [](void* to, int, char** row, char**) {
                *static_cast<std::string*>(to) = row[0] == nullptr ? "null" : row[0];
                return 0;
            },
            &answer, nullptr);
        return answer;
    };
    EXPECT_EQ(ask("PRAGMA journal_mode"), "wal");
    EXPECT_EQ(ask("PRAGMA user_version"), "2");
    EXPECT_EQ(ask("SELECT count(*) FROM pragma_table_list WHERE name IN ('edit', 'journal') AND strict = 1"),
              "2");
    EXPECT_NE(
        sqlite3_exec(database, "INSERT INTO edit SELECT 99, id, accepted, bytes, checksum FROM edit LIMIT 1",
                     nullptr, nullptr, nullptr),
        SQLITE_OK)
        << "ids are unique";
    sqlite3_close(database);
}

TEST_F(OpeningAJournal, BringsAnOldOneUpToDate) {
    std::filesystem::create_directories(folder_);
    std::ifstream file{JOURNAL_OF_VERSION_1};
    execute(std::string{std::istreambuf_iterator<char>{file}, {}});
    for (const Revision head : {Revision{3}, Revision{4}}) {
        const auto journal = open();
        ASSERT_TRUE(journal) << journal.error().detail;
        ASSERT_EQ((*journal)->status().head, head);
        EXPECT_EQ(to_string((*journal)->status().lineage), "00112233-4455-6677-8899-aabbccddeeff");
        std::vector<Edit> edits;
        ASSERT_FALSE(for_each_edit(**journal, 1, head, [&](const Edit& edit) {
            edits.push_back(edit);
            return true;
        }));
        ASSERT_EQ(edits.size(), head);
        EXPECT_EQ(edits[0].bytes, "the first edit");
        EXPECT_EQ(to_string(edits[1].id), "20212223-2425-2627-2829-2a2b2c2d2e2f");
        EXPECT_EQ(edits[2].accepted.time_since_epoch().count(), 1'760'000'002'000);
        for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(edits[i].step, 0);
        if (head == 4) {
            EXPECT_EQ(edits[3].step, 77);
            break;
        }
        Append next = edit(9, "with a step");
        next.step = 77;
        append_and_wait(**journal, {next});
    }
}

TEST_F(OpeningAJournal, RefusesANewerVersion) {
    fill(3);
    execute("PRAGMA user_version=3");
    fails("version 3");
}

TEST_F(OpeningAJournal, RefusesAnotherScenes) {
    fill(3);
    JournalOptions options;
    options.scene = "desert";
    fails("the journal of scene garden", ErrorCode::invalid_input, options);
}

TEST_F(OpeningAJournal, RefusesAnotherProgramsDatabase) {
    std::filesystem::create_directories(folder_);
    execute("CREATE TABLE bookmark (url TEXT)");
    fails("another program");
}

TEST_F(OpeningAJournal, RefusesAFileThatIsNoDatabase) {
    std::filesystem::create_directories(folder_);
    std::ofstream{folder_ / "journal.db"} << "Dear diary, " << std::string(5000, 'z');
    fails("is not a journal");
}

TEST_F(OpeningAJournal, RefusesAFolderInPlaceOfTheFileAndAFileInPlaceOfTheFolder) {
    std::filesystem::create_directories(folder_ / "journal.db");
    fails("cannot be opened", ErrorCode::io_failure);
    std::filesystem::remove_all(folder_);
    std::ofstream{folder_} << "a file";
    fails("", ErrorCode::io_failure);
}

TEST_F(OpeningAJournal, GoesOnAfterAnEmptyFile) {
    std::filesystem::create_directories(folder_);
    std::ofstream{folder_ / "journal.db"}.flush();
    fill(2);
    EXPECT_EQ(open().value()->status().head, 2u);
}

TEST_F(OpeningAJournal, GoesOnAfterAKillBeforeItsTablesWereMade) {
    std::filesystem::create_directories(folder_);
    execute("PRAGMA auto_vacuum=INCREMENTAL; PRAGMA journal_mode=WAL");
    fill(2);
    EXPECT_EQ(open().value()->status().head, 2u);
}

TEST_F(OpeningAJournal, NoticesADamagedByteUnlessNothingUsesIt) {
    fill(200);
    const auto file = folder_ / "journal.db";
    const auto size = static_cast<std::int64_t>(std::filesystem::file_size(file));
    const auto whole = temporary_.path / "whole";
    std::filesystem::copy_file(file, whole);
    int noticed = 0, harmless = 0;
    for (std::int64_t at = 40; at < size; at += size / 150) {
        std::filesystem::copy_file(whole, file, std::filesystem::copy_options::overwrite_existing);
        damage(file, at);
        SilentProgress progress;
        const auto journal = open();
        if (!journal) {
            EXPECT_NE(journal.error().detail.find("journal.db"), std::string::npos);
            ++noticed;
            continue;
        }
        // A byte that nothing uses: then everything is there
        std::uint64_t next = 0;
        const auto trouble = for_each_edit(**journal, 1, 200, [&](const Edit& edit) {
            EXPECT_EQ(edit.id, id_of(next));
            EXPECT_EQ(edit.bytes, std::string(next % 7 * 100, 'x'));
            ++next;
            return true;
        });
        EXPECT_FALSE(trouble);
        EXPECT_EQ(next, 200u) << "byte " << at;
        ++harmless;
    }
    EXPECT_GT(noticed, harmless) << noticed << " noticed, " << harmless << " harmless";
}

TEST_F(OpeningAJournal, NoticesAMissingEditAndOneThatWasChanged) {
    fill(20);
    execute("UPDATE edit SET bytes = x'00' WHERE revision = 7");
    fails("edit 7 is damaged");
    execute("DELETE FROM edit WHERE revision = 7");
    fails("edit 7 is missing");
}

TEST_F(OpeningAJournal, NoticesAFileThatWasCutOff) {
    fill(500);
    std::filesystem::resize_file(folder_ / "journal.db",
                                 std::filesystem::file_size(folder_ / "journal.db") / 2);
    fails("damaged");
}

TEST_F(OpeningAJournal, RefusesAFolderThatCannotBeWritten) {
    std::filesystem::create_directories(folder_);
    const auto as_nobody = [&](const auto& what) {
        std::jthread{[&] {
            if (::getuid() == 0) ::setfsuid(65534);  // of this thread alone; root may write anywhere
            what();
        }}.join();
    };
    ::chmod(temporary_.path.c_str(), 0755);
    ::chmod(folder_.c_str(), 0555);
    as_nobody([&] { fails("writable", ErrorCode::io_failure); });
    ::chmod(folder_.c_str(), 0755);
    fill(2);
    ::chmod((folder_ / "journal.db").c_str(), 0444);
    ::chmod(folder_.c_str(), 0555);
    as_nobody([&] { fails("writable", ErrorCode::io_failure); });
    ::chmod(folder_.c_str(), 0755);
}

TEST_F(OpeningAJournal, RefusesWhatAnotherProcessHasOpen) {
    fill(2);
    int to_child[2], to_parent[2];
    ASSERT_EQ(::pipe(to_child), 0);
    ASSERT_EQ(::pipe(to_parent), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        const bool opened = static_cast<bool>(open());
        char c = 'x';
        {
            SilentProgress progress;
            const auto held = open_journal(folder_, scene_options(), progress);
            c = held && opened ? 'y' : 'n';
            if (::write(to_parent[1], &c, 1) != 1 || ::read(to_child[0], &c, 1) != 1) ::_exit(1);
        }
        ::_exit(0);
    }
    char answer = 0;
    ASSERT_EQ(::read(to_parent[0], &answer, 1), 1);
    EXPECT_EQ(answer, 'y');
    fails("another process", ErrorCode::io_failure);
    ASSERT_EQ(::write(to_child[1], "x", 1), 1);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    EXPECT_EQ(open().value()->status().head, 2u);
    for (const int file : {to_child[0], to_child[1], to_parent[0], to_parent[1]}) ::close(file);
}

TEST_F(OpeningAJournal, RefusesASecondTimeInOneProcess) {
    const auto journal = open().value();
    fails("another process", ErrorCode::io_failure);
}

/// Notes what it is told; stops when it has been told often enough.
class Told final : public Progress {
  public:
    explicit Told(int calls) : calls_{calls} {}
    void advance(std::string_view stage, double fraction) override {
        EXPECT_EQ(stage, "checking the journal");
        EXPECT_GE(fraction, last);
        EXPECT_LE(fraction, 1);
        last = fraction;
        if (--calls_ == 0) source_.request_stop();
    }
    void note(const std::string&) override {}
    std::stop_token stop() const override { return source_.get_token(); }
    double last = 0;

  private:
    int calls_;
    std::stop_source source_;
};

TEST_F(OpeningAJournal, SaysHowFarItIsAndCanBeStopped) {
    for (std::uint64_t n = 0; n < 12'000; n += 4000) {
        const auto journal = open().value();
        std::vector<Append> batch;
        for (std::uint64_t i = n; i < n + 4000; ++i) batch.push_back(edit(i));
        append_and_wait(*journal, batch);
    }
    Told all{1000};
    ASSERT_TRUE(open_journal(folder_, scene_options(), all));
    EXPECT_EQ(all.last, 1);
    Told some{3};
    const auto stopped = open_journal(folder_, scene_options(), some);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().code, ErrorCode::cancelled);
}

TEST_F(OpeningAJournal, GivesRoomBackThatItNoLongerNeeds) {
    const auto file_bytes = [&] { return std::filesystem::file_size(folder_ / "journal.db"); };
    {
        const auto journal = open().value();
        for (std::uint64_t n = 0; n < 8000; n += 2000) {
            std::vector<Append> batch;
            for (std::uint64_t i = n; i < n + 2000; ++i) batch.push_back(edit(i, std::string(2000, 'x')));
            append_and_wait(*journal, batch);
        }
        ASSERT_TRUE(keep_snapshot_and_wait(*journal, {7999, ""}));
        ASSERT_TRUE(keep_snapshot_and_wait(*journal, {8000, ""}));
    }
    EXPECT_GT(file_bytes(), 16'000'000u);
    {
        JournalOptions options = scene_options();
        options.horizon.revisions = 10;
        auto journal = open(options).value();
        for (int i = 0; i < 2000 && journal->status().oldest != 7991; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds{5});
        EXPECT_EQ(journal->status().oldest, 7991u);
        std::this_thread::sleep_for(std::chrono::seconds{1});  // what is idle tidies up
    }
    EXPECT_LT(file_bytes(), 8'000'000u);
    EXPECT_EQ(open().value()->status().head, 8000u);
}

TEST_F(OpeningAJournal, ADamagedSnapshotGivesWayToTheOneBefore) {
    fill(20);
    {
        const auto journal = open().value();
        ASSERT_TRUE(keep_snapshot_and_wait(*journal, {10, std::string(2'500'000, 'a')}));
        ASSERT_TRUE(keep_snapshot_and_wait(*journal, {20, std::string(2'500'000, 'b')}));
    }
    std::ofstream{folder_ / "unfinished-snapshot"} << "of a kill";
    damage(folder_ / "snapshot-20", -1000);
    {
        const auto journal = open().value();
        EXPECT_FALSE(std::filesystem::exists(folder_ / "unfinished-snapshot"));
        EXPECT_EQ(newest_snapshot_and_wait(*journal).value()->bytes, std::string(2'500'000, 'a'));
    }
    std::filesystem::resize_file(folder_ / "snapshot-10", 30);
    {
        const auto journal = open().value();
        const auto none = newest_snapshot_and_wait(*journal);
        ASSERT_FALSE(none);
        EXPECT_EQ(none.error().code, ErrorCode::invalid_input);
        EXPECT_NE(none.error().detail.find("snapshot-20"), std::string::npos) << none.error().detail;
    }
    for (int at = 0; at < 56; at += 3) {
        damage(folder_ / "snapshot-20", at);
        EXPECT_FALSE(newest_snapshot_and_wait(*open().value()));
    }
}

TEST_F(OpeningAJournal, RefusesASnapshotOfTheFuture) {
    fill(5);
    std::ofstream{folder_ / "snapshot-6"} << "?";
    fails("snapshot-6");
}

}  // namespace
}  // namespace tessera::tests
