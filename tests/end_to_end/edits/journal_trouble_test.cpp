// What a running server says and goes on to do where its journals cannot be read or written.
#include <algorithm>
#include <filesystem>
#include <memory>

#include "tests/end_to_end/edits/edited_scenes.h"

namespace tessera {
namespace {

using namespace test;
namespace fs = std::filesystem;

class JournalTrouble : public EditedScenes {
  protected:
    void SetUp() override {
        EditedScenes::SetUp();
        fs::create_directories(edits);
    }
    std::vector<std::string> words() const {
        return {"serve", "--scenes", folder.path.string(), "--listen", "127.0.0.1:0", "--edits", edits};
    }
    Program serve() const { return Program{words()}; }
    /// A server for which the folder of edits is a disk of its own, mounted with `options`; none where mounts
    /// are not to be had.
    std::unique_ptr<Program> serve_on_disk(const std::string& options) const {
        if (::system("unshare --map-root-user --mount mount -t tmpfs tmpfs /tmp 2>/dev/null") != 0)
            return nullptr;
        std::vector<std::string> arguments{
            "--map-root-user",
            "--mount",
            "sh",
            "-c",
            "mount -t tmpfs -o " + options + " tmpfs '" + edits + "' && exec \"$0\" \"$@\"",
            TESSERA_PROGRAM};
        for (const std::string& word : words()) arguments.push_back(word);
        return std::make_unique<Program>(arguments, "", "/usr/bin/unshare");
    }
    /// Sprites 1 to 3, and the server stopped.
    void fill() const {
        Program program = serve();
        RawClient client{program.port()};
        for (std::uint64_t id = 1; id <= 3; ++id) answer_in(*send(client, placing(id, 40, 40)));
        client.close();
        program.signal(SIGTERM);
        EXPECT_EQ(program.exit_code(), 0);
    }
    /// The log says why and where, and nobody else hears where.
    void expect_told(Program& program, const Reply& refused, const std::string& why) const {
        EXPECT_EQ(refused.status, 503) << refused.body;
        EXPECT_EQ(refused["etag"], "");
        EXPECT_NE(refused.body.find("journal"), std::string::npos) << refused.body;
        EXPECT_EQ(refused.body.find(folder.path.string()), std::string::npos) << "says where its files are";
        EXPECT_TRUE(program.says(why)) << program.errors();
        EXPECT_NE(program.errors().find(edits), std::string::npos) << program.errors();
    }
    /// Nobody ever edited it here: the scene is served as its files are, and edits are refused.
    void expect_no_edits(Program& program, const std::string& why) const {
        RawClient client{program.port()};
        EXPECT_EQ(client.get("/scenes/sprites/6/0/0.png")->status, 200);
        EXPECT_EQ(client.get("/healthz")->status, 200);
        expect_told(program, *send(client, placing(9, 1, 1)), why);
    }
    /// Edits that were acknowledged cannot be read: no page is shown without them, and the fix is named.
    void expect_not_shown(Program& program, const std::string& why) const {
        const auto reply_to = [&](const std::string& target) {
            return RawClient{program.port()}.get(target).value();  // What is refused may be the last
        };
        for (const char* target :
             {"/scenes/sprites/6/0/0.png", "/scenes/sprites", "/scenes/sprites/sprites"}) {
            const Reply refused = reply_to(target);
            expect_told(program, refused, why);
            EXPECT_NE(refused.body.find(why), std::string::npos) << refused.body;
        }
        RawClient client{program.port()};
        expect_told(program, send(client, placing(9, 1, 1)).value(), why);
        EXPECT_EQ(reply_to("/scenes/board/6/0/0.png").status, 200) << "another scene";
        const std::string list = reply_to("/scenes").body;
        EXPECT_NE(list.find(why), std::string::npos) << list;
        EXPECT_EQ(reply_to("/healthz").status, 200);
    }
    /// Writes one byte of the journal's file, and gives what was there.
    char set_byte(std::int64_t at, char to) const {
        std::fstream file{database, std::ios::binary | std::ios::in | std::ios::out};
        file.seekg(at);
        const auto was = static_cast<char>(file.get());
        file.seekp(at);
        file.put(to);
        return was;
    }

    const std::string edits = (folder.path / ".edits").string();
    const fs::path database = fs::path{edits} / "sprites" / "journal.db";
    static constexpr std::int64_t version_at = 63;  ///< The last byte of SQLite's user_version.
};

TEST_F(JournalTrouble, OfANewerVersionIsNamedAndNothingIsLost) {
    fill();
    std::string page;
    {
        Program program = serve();
        page = RawClient{program.port()}.get("/scenes/sprites/6/0/0.png")->body;
        program.signal(SIGTERM);
        EXPECT_EQ(program.exit_code(), 0);
    }
    const char version = set_byte(version_at, 77);
    Program program = serve();
    expect_not_shown(program, "version 77");
    EXPECT_EQ(set_byte(version_at, version), 77) << "it was not touched";
    // Helped while the server runs
    program.signal(SIGHUP);
    ASSERT_TRUE(program.says("reloaded"));
    RawClient client{program.port()};
    EXPECT_TRUE(client.get("/scenes/sprites/6/0/0.png")->body == page);
    EXPECT_EQ(answer_in(*send(client, placing(4, 1, 1))).revision(), 4u);
}

TEST_F(JournalTrouble, OfDamageIsNamed) {
    fill();
    // Where all of a page is bytes that are used
    const auto size = static_cast<std::int64_t>(fs::file_size(database));
    std::fstream file{database, std::ios::binary | std::ios::in | std::ios::out};
    file.seekp(4096);
    for (std::int64_t i = 4096; i < size; ++i) file.put('\x5a');
    file.close();
    Program program = serve();
    expect_not_shown(program, "damaged");
}

TEST_F(JournalTrouble, OfTwoServersOnOneFolderIsNamed) {
    fill();
    Program first = serve();
    EXPECT_EQ(RawClient{first.port()}.get("/scenes/sprites/6/0/0.png")->status, 200);
    Program second = serve();
    expect_not_shown(second, "another process");
}

TEST_F(JournalTrouble, OfAFolderThatCannotBeWrittenIsNamed) {
    const auto program = serve_on_disk("ro,size=2m");
    if (!program) GTEST_SKIP() << "NOT TESTED: no disk can be mounted here";
    expect_no_edits(*program, "ead-only");
}

TEST_F(JournalTrouble, OfAFullDiskRefusesEditsServesPagesAndEndsWhenThereIsRoom) {
    const auto program = serve_on_disk("size=2m");
    if (!program) GTEST_SKIP() << "NOT TESTED: no disk can be mounted here";
    RawClient client{program->port()};
    ASSERT_EQ(answer_in(*send(client, placing(1, 40, 40))).revision(), 1u);
    // As the server sees the disk: what is left of it is taken
    const std::string ballast = "/proc/" + std::to_string(program->process()) + "/root" + edits + "/ballast";
    std::ofstream{ballast} << std::string(4 << 20, 'b');
    ASSERT_GT(fs::file_size(ballast), 0u);

    std::uint64_t head = 1;
    std::optional<Reply> refused;
    proto::Edit edit;
    for (int i = 0; i < 400 && !refused; ++i) {
        edit = new_edit();
        edit.set_author(std::string(60, 'a'));
        for (int change = 0; change < 100; ++change) {
            proto::SpriteMove& move = *edit.add_changes()->mutable_move_sprite();
            move.set_id(1);
            move.set_x(40 + i % 7);
        }
        const auto reply = send(client, edit);
        ASSERT_TRUE(reply) << program->errors();
        if (reply->status == 200)
            ASSERT_EQ(answer_in(*reply).revision(), ++head);
        else
            refused = reply;
    }
    ASSERT_TRUE(refused) << "the disk is not full";
    EXPECT_EQ(refused->status, 503) << refused->body;
    EXPECT_NE(refused->body.find("full"), std::string::npos) << refused->body;
    EXPECT_EQ(refused->body.find(edits), std::string::npos) << "says where its files are";

    // Pages, what is known of the scene, and retries of edits that are in go on
    for (const char* page : {"/scenes/sprites/6/0/0.png", "/scenes/sprites/6/5/5.png", "/scenes", "/healthz"})
        EXPECT_EQ(client.get(page)->status, 200) << page;
    EXPECT_NE(client.get("/metrics")->body.find("tessera_journal_trouble{scene=\"sprites\"} 1"),
              std::string::npos);
    const std::string full = client.get("/scenes/sprites/6/0/0.png")->body;
    EXPECT_EQ(send(client, placing(2, 60, 40))->status, 503) << "still";
    EXPECT_TRUE(client.get("/scenes/sprites/6/0/0.png")->body == full) << "what was refused is not seen";

    fs::remove(ballast);
    std::optional<Reply> taken;
    for (int tries = 0; tries < 100 && (!taken || taken->status == 503); ++tries) {
        std::this_thread::sleep_for(std::chrono::milliseconds{50});
        taken = send(client, edit);
    }
    EXPECT_EQ(answer_in(*taken).revision(), head + 1) << "the edit that was refused, under its id";
    EXPECT_EQ(answer_in(*send(client, placing(2, 60, 40))).revision(), head + 2);
    EXPECT_NE(client.get("/metrics")->body.find("tessera_journal_trouble{scene=\"sprites\"} 0"),
              std::string::npos);
}

}  // namespace
}  // namespace tessera
