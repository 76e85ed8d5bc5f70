// tessera log and tessera export, beside a server that runs and without one.
#include <filesystem>
#include <memory>
#include <sstream>
#include <thread>

#include <signal.h>

#include "proto/log.pb.h"

#include "tests/end_to_end/edits/edited_scenes.h"

namespace tessera {
namespace {

using namespace test;

struct Said {
    int code = 0;
    std::string out, err;
};

Said run(const std::vector<std::string>& words) {
    Program program{words};
    Said said;
    said.code = program.exit_code();
    said.out = program.output();
    said.err = program.errors();
    return said;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in{text};
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

const std::vector<std::string> pages{"/6/0/0.png", "/6/1/0.png", "/5/0/0.png", "/3/0/0.png", "/0/0/0.png"};

class SceneHistory : public EditedScenes {
  protected:
    std::string scene() const { return (folder.path / "sprites").string(); }
    static std::vector<std::string> bodies(RawClient& client, const std::string& name = "sprites") {
        std::vector<std::string> bodies;
        for (const std::string& page : pages) bodies.push_back(client.get("/scenes/" + name + page)->body);
        return bodies;
    }
};

TEST_F(SceneHistory, IsListedWhileTheServerWritesIt) {
    Program program = serve({});
    const std::uint16_t port = program.port();
    std::atomic<bool> over = false;
    std::atomic<std::uint64_t> acknowledged = 0;
    std::jthread editor{[&] {
        RawClient client{port};
        proto::Edit edit = placing(1, 100, 100);
        edit.set_author("ada \x1b[2J");
        answer_in(*send(client, edit));
        // Long enough for checkpoints to begin the log anew
        while (!over) {
            proto::Edit many = new_edit();
            for (int i = 0; i < 100; ++i) {
                proto::SpriteMove& move = *many.add_changes()->mutable_move_sprite();
                move.set_id(1);
                move.set_x(i);
            }
            acknowledged = answer_in(*send(client, many)).revision();
        }
    }};
    while (acknowledged < 5) std::this_thread::sleep_for(std::chrono::milliseconds{5});
    for (int i = 0; i < 3; ++i) {
        const std::uint64_t before = acknowledged;
        const Said log = run({"log", "sprites", "--scenes", folder.path.string(), "--limit", "0"});
        ASSERT_EQ(log.code, 0) << log.err;
        const auto lines = lines_of(log.out);
        ASSERT_GE(lines.size(), before) << "an edit that was acknowledged is missing";
        ASSERT_LE(lines.size(), acknowledged + 1);
        for (std::size_t line = 0; line < lines.size(); ++line)
            ASSERT_TRUE(lines[line].starts_with(std::to_string(line + 1) + "  ")) << lines[line];
        EXPECT_NE(lines[0].find("ada ?[2J  places sprite 1, pattern 0, at (100, 100)"), std::string::npos);
        EXPECT_NE(lines[1].find("; and 97 changes more"), std::string::npos) << lines[1];
    }
    over = true;
    editor.join();

    const Said json = run({"log", scene(), "--json", "--from", "1", "--limit", "1"});
    proto::LoggedEdit first;
    ASSERT_TRUE(read_json(json.out, "line", first)) << json.out << json.err;
    EXPECT_EQ(first.revision(), 1u);
    EXPECT_EQ(first.changes(0).place_sprite().id(), 1u);
    const Said none = run({"log", (folder.path / "board").string()});
    EXPECT_EQ(none.code, 1);
    EXPECT_NE(none.err.find("no journal"), std::string::npos);
}

TEST_F(SceneHistory, IsUndoneThroughTheServerThatHasTheSceneAndWithoutOne) {
    std::unique_ptr<Program> program{new Program(serve({}))};
    std::optional<RawClient> client{program->port()};
    answer_in(*send(*client, placing(1, 100, 100)));
    answer_in(*send(*client, placing(2, 200, 100)));
    const auto then = bodies(*client);
    for (int i = 0; i < 20; ++i) {
        proto::Edit edit = new_edit();
        proto::SpriteMove& move = *edit.add_changes()->mutable_move_sprite();
        move.set_id(1);
        move.set_x(110 + 5 * i);
        answer_in(*send(*client, edit));
    }
    answer_in(*send(*client, placing(3, 50, 50)));
    const auto now = bodies(*client);
    ASSERT_NE(now, then);

    Said undone = run({"log", scene(), "--undo-to", "2"});
    EXPECT_EQ(undone.code, 1);
    EXPECT_NE(undone.err.find("--server"), std::string::npos) << undone.err;
    const std::string address = "http://127.0.0.1:" + std::to_string(program->port());
    undone = run({"log", scene(), "--undo-to", "99", "--server", address});
    EXPECT_EQ(undone.code, 1);
    EXPECT_NE(undone.err.find("revision 99"), std::string::npos) << undone.err;
    EXPECT_EQ(bodies(*client), now);

    undone = run({"log", scene(), "--undo-to", "2", "--server", address, "--author", "bob"});
    EXPECT_EQ(undone.code, 0) << undone.err;
    EXPECT_NE(undone.err.find("one edit"), std::string::npos) << undone.err;
    EXPECT_NE(undone.err.find("revision 24"), std::string::npos) << undone.err;
    EXPECT_EQ(bodies(*client), then);
    const auto last = lines_of(run({"log", scene(), "--limit", "1"}).out);
    ASSERT_EQ(last.size(), 1u);
    EXPECT_NE(last[0].find("24  "), std::string::npos);
    EXPECT_NE(last[0].find("  bob  removes sprite 3; moves sprite 1 to x 100"), std::string::npos) << last[0];

    // The undo is an edit, and is undone as any other
    client.reset();
    program->signal(SIGTERM);
    EXPECT_EQ(program->exit_code(), 0);
    undone = run({"log", scene(), "--undo-to", "23"});
    EXPECT_EQ(undone.code, 0) << undone.err;
    program.reset(new Program(serve({})));
    client.emplace(program->port());
    EXPECT_EQ(bodies(*client), now);
    EXPECT_EQ(answer_in(*send(*client, placing(9, 1, 1))).revision(), 26u);
}

TEST_F(SceneHistory, IsExportedAsASceneOfItsOwnWithEqualPages) {
    std::unique_ptr<Program> program{new Program(serve({}))};
    std::optional<RawClient> client{program->port()};
    proto::Edit edit = placing(1, 100.25, 100);
    edit.mutable_changes(0)->mutable_place_sprite()->set_turn(0.125);
    edit.mutable_changes(0)->mutable_place_sprite()->set_scale(1.5);
    answer_in(*send(*client, edit));
    const auto then = bodies(*client);
    answer_in(*send(*client, placing(2, 300, 40)));
    answer_in(*send(*client, placing(3, 310, 40)));
    const auto now = bodies(*client);

    const std::string out = (folder.path / "copy").string(), old = (folder.path / "old").string();
    Said said = run({"export", scene(), "-o", out});
    ASSERT_EQ(said.code, 0) << said.err;
    said = run({"export", scene(), "-o", old, "--at", "1"});
    ASSERT_EQ(said.code, 0) << said.err;
    EXPECT_EQ(run({"check", out}).code, 0);
    said = run({"export", scene(), "-o", out});
    EXPECT_EQ(said.code, 1);
    EXPECT_NE(said.err.find("is there already"), std::string::npos) << said.err;
    said = run({"export", scene(), "-o", (folder.path / "none" / "copy").string()});
    EXPECT_EQ(said.code, 1);
    EXPECT_NE(said.err.find("is no folder"), std::string::npos) << said.err;

    client.reset();
    program->signal(SIGTERM);
    program->exit_code();
    program.reset(new Program(serve({})));
    client.emplace(program->port());
    EXPECT_EQ(bodies(*client, "copy"), now);
    EXPECT_EQ(bodies(*client, "old"), then);
    EXPECT_EQ(answer_in(*send(*client, placing(9, 1, 1))).revision(), 4u);

    // No journal, no half of it
    for (const auto& entry : std::filesystem::recursive_directory_iterator{out})
        EXPECT_EQ(entry.path().string().find("journal"), std::string::npos);
    for (const auto& entry : std::filesystem::directory_iterator{folder.path})
        EXPECT_FALSE(entry.path().filename().string().starts_with(".copy")) << entry.path();
}

TEST_F(SceneHistory, IsAsLongAsTheServerIsToldAndWhatIsOlderIsRefusedByName) {
    Program program = serve({"--horizon-revisions", "20"});
    RawClient client{program.port()};
    const proto::Edit first = placing(1, 100, 100);
    ASSERT_EQ(answer_in(*send(client, first)).revision(), 1u);
    proto::Edit last;
    std::uint64_t revision = 1;
    const auto move_on = [&] {
        last = moving(1, 100, static_cast<double>(100 + revision % 50));
        last.set_known_revision(revision);
        ASSERT_EQ(answer_in(*send(client, last)).revision(), ++revision);
    };
    // What is forgotten lies behind a snapshot, and those are written beside
    const auto late = [&] { return *send(client, first); };
    for (int i = 0; i < 400 && late().status == 200; ++i) move_on();
    const Reply refused = late();
    EXPECT_EQ(refused.status, 410) << refused.body;
    EXPECT_NE(refused.body.find("only known for revisions after"), std::string::npos) << refused.body;
    EXPECT_TRUE(answer_in(*send(client, last)).again()) << "a retry inside the horizon";
    EXPECT_EQ(answer_in(*send(client, last)).revision(), revision);

    const Said log = run({"log", scene(), "--limit", "0"});
    ASSERT_EQ(log.code, 0) << log.err;
    EXPECT_FALSE(log.out.starts_with("1  ")) << log.out;
    EXPECT_NE(log.out.find(std::to_string(revision) + "  "), std::string::npos) << log.out;
    program.signal(SIGTERM);
    EXPECT_EQ(program.exit_code(), 0);
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"log", scene(), "--undo-to", "1"},
          {"export", scene(), "--at", "1", "-o", (folder.path / "then").string()}}) {
        const Said said = run(words);
        EXPECT_EQ(said.code, 1);
        EXPECT_NE(said.err.find("horizon"), std::string::npos) << said.err;
    }
}

}  // namespace
}  // namespace tessera
