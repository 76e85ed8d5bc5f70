// People with tessera-edit on a live scene.
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/stream.pb.h"

#include "shared/wire/json.h"
#include "tests/end_to_end/live_edit/edit_program.h"
#include "tests/end_to_end/live_edit/live_scene.h"

namespace tessera {
namespace {

using test::EditProgram;
using test::LiveScene;
using test::Program;
using testing::HasSubstr;

std::string url_of(std::uint16_t port) { return "http://127.0.0.1:" + std::to_string(port); }

proto::ServerMessage message_in(const std::string& line) {
    proto::ServerMessage message;
    const auto read = read_json(line, "a line of tessera-edit", message);
    EXPECT_TRUE(read) << (read ? "" : read.error().detail) << "\n" << line;
    return message;
}

struct Said {
    int exit_code;
    std::string output, errors;
};

Said say(const std::string& url, std::vector<std::string> words) {
    words.insert(words.begin(), {url, "sprites"});
    EditProgram program{std::move(words)};
    program.close_input();
    Said said{0, program.rest(), program.errors()};
    said.exit_code = program.exit_code();
    return said;
}

TEST(LiveEdit, WhoWatchesSeesWhatTheOtherDoes) {
    const LiveScene scene;
    Program server{scene.arguments()};
    const std::uint16_t port = server.port();
    ASSERT_NE(port, 0) << server.errors();
    const std::string url = url_of(port);
    EditProgram watcher{{url, "sprites", "--name", "Grace", "watch", "--edits", "3"}};
    EXPECT_NE(watcher.line_with("\"hello\""), "");

    const Said placed = say(url, {"--name", "Ada", "place", "100", "50", "--id", "7", "--pattern", "2"});
    EXPECT_EQ(placed.exit_code, 0) << placed.errors;
    EXPECT_EQ(placed.output, "revision 1: place sprite 7 at (100, 50)\n");
    const Said moved = say(url, {"--json", "--name", "Ada", "move", "7", "300", "60.5"});
    EXPECT_EQ(moved.exit_code, 0) << moved.errors;
    const proto::ServerMessage answer = message_in(moved.output);
    EXPECT_EQ(answer.edit_done().answer().revision(), 2u);
    ASSERT_EQ(answer.edit_done().answer().inverse().changes_size(), 1);
    EXPECT_EQ(answer.edit_done().answer().inverse().changes(0).move_sprite().x(), 100);
    std::ofstream{scene.file("done.jsonl")} << moved.output;
    const Said undone = say(url, {"undo", scene.file("done.jsonl").string()});
    EXPECT_EQ(undone.exit_code, 0) << undone.errors;
    EXPECT_THAT(undone.output, HasSubstr("revision 3: move sprite 7"));

    std::set<std::uint64_t> revisions;
    bool has_stale = false;
    for (std::string line = watcher.line(); !line.empty(); line = watcher.line()) {
        const proto::ServerMessage told = message_in(line);
        has_stale = has_stale || told.invalidation().stale_size() > 0;
        if (!told.has_edit_done()) continue;
        revisions.insert(told.edit_done().answer().revision());
        ASSERT_EQ(told.edit_done().changes_size(), 1);
        if (told.edit_done().answer().revision() == 1) {
            EXPECT_EQ(told.edit_done().author(), "Ada");
            EXPECT_EQ(told.edit_done().changes(0).place_sprite().id(), 7u);
        }
    }
    EXPECT_EQ(watcher.exit_code(), 0);
    EXPECT_EQ(revisions, (std::set<std::uint64_t>{1, 2, 3}));
    EXPECT_TRUE(has_stale);
}

TEST(LiveEdit, SaysWhatIsWrong) {
    const LiveScene scene;
    Program server{scene.arguments()};
    const std::uint16_t port = server.port();
    ASSERT_NE(port, 0) << server.errors();
    const std::string url = url_of(port);
    const Said nobody = say(url, {"move", "9", "1", "1"});
    EXPECT_EQ(nobody.exit_code, 3);
    EXPECT_THAT(nobody.errors, HasSubstr("move sprite 9 to (1, 1): wrong: "));
    EXPECT_EQ(say(url, {"place", "1", "1", "--id", "1"}).exit_code, 0);
    const Said conflict = say(url, {"--base", "0", "move", "1", "5", "5"});
    EXPECT_EQ(conflict.exit_code, 3);
    EXPECT_THAT(conflict.errors, HasSubstr("conflict"));
    EXPECT_EQ(say(url, {"move", "1", "5"}).exit_code, 2);
    EXPECT_EQ(say(url, {"apply", "no-such-file.json"}).exit_code, 2);
    EditProgram nowhere{{url, "nowhere", "remove", "1"}};
    EXPECT_EQ(nowhere.exit_code(), 1);
    EditProgram help{{"--help"}};
    EXPECT_THAT(help.rest(), HasSubstr("Examples:"));
    server.signal(SIGTERM);
    EXPECT_EQ(server.exit_code(), 0);
    const Said gone = say(url, {"remove", "1"});
    EXPECT_EQ(gone.exit_code, 1);
    EXPECT_THAT(gone.errors, HasSubstr("is the server running there?"));
}

TEST(LiveEdit, EveryLineIsInOnceThoughTheServerIsKilledInBetween) {
    const LiveScene scene;
    auto server = std::make_unique<Program>(scene.arguments());
    const std::uint16_t port = server->port();
    ASSERT_NE(port, 0) << server->errors();
    const std::string url = url_of(port);
    EditProgram watcher{{url, "sprites", "watch"}};
    EXPECT_NE(watcher.line_with("\"hello\""), "");
    EditProgram lines{{url, "sprites", "--patience", "60", "lines"}};
    constexpr int most = 300;
    std::signal(SIGPIPE, SIG_IGN);  // a program that has ended is seen by its output
    std::jthread writer{[&] {
        EXPECT_TRUE(lines.write_line(R"({"changes": [{"place_sprite": {"id": 1, "x": 0, "y": 0}}]})"));
        for (int i = 1; i < most; ++i) {
            EXPECT_TRUE(lines.write_line(R"({"changes": [{"move_sprite": {"id": 1, "x": )" +
                                         std::to_string(i) + R"(, "y": 20}}]})"));
            std::this_thread::sleep_for(std::chrono::milliseconds{3});
        }
        lines.close_input();
    }};
    std::vector<std::uint64_t> revisions;
    std::set<std::string> ids;
    for (int i = 0; i < most; ++i) {
        const proto::ServerMessage told = message_in(lines.line());
        ASSERT_TRUE(told.has_edit_done()) << told.DebugString();
        revisions.push_back(told.edit_done().answer().revision());
        ids.insert(told.edit_done().id());
        if (i == most / 4 || i == most / 2) {
            server->signal(SIGKILL);
            server.reset();
            server = std::make_unique<Program>(scene.arguments(port));
            ASSERT_EQ(server->port(), port) << server->errors();
        }
    }
    writer.join();
    EXPECT_EQ(lines.exit_code(), 0);
    EXPECT_EQ(ids.size(), std::size_t{most});
    for (std::size_t i = 0; i < revisions.size(); ++i)
        EXPECT_EQ(revisions[i], i + 1) << "in order, each once";

    const Said moved = say(url, {"--json", "move", "1", "9", "9"});
    const proto::EditAnswer last = message_in(moved.output).edit_done().answer();
    EXPECT_EQ(last.revision(), std::uint64_t{most} + 1);
    ASSERT_EQ(last.inverse().changes_size(), 1);
    EXPECT_EQ(last.inverse().changes(0).move_sprite().x(), most - 1) << "the last line is the last edit";
    // Who watched was told that the stream went on where it was
    EXPECT_NE(watcher.line_with("\"goodbye\""), "");
    const std::string hello = watcher.line_with("\"hello\"");
    EXPECT_THAT(hello, HasSubstr("\"resumed\":true"));
    EXPECT_NE(watcher.line_with("\"revision\":\"" + std::to_string(most + 1) + "\""), "");
    watcher.signal(SIGINT);
    EXPECT_EQ(watcher.exit_code(), 130);
}

}  // namespace
}  // namespace tessera
