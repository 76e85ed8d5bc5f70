// Who may edit, over a real socket. What a proxy passes on is from elsewhere, so a test can be, too.
#include <fstream>
#include <sstream>

#include <sys/stat.h>

#include "tests/end_to_end/edits/edited_scenes.h"

namespace tessera {
namespace {

using namespace test;

const std::string from_elsewhere = json_type + "X-Forwarded-For: 10.0.0.1\r\n";

std::string bearing(const std::string& token) {
    return from_elsewhere + "Authorization: Bearer " + token + "\r\n";
}

class AccessToEdits : public EditedScenes {
  protected:
    /// What `tessera token` prints.
    std::string new_token(const std::string& name, const std::string& role, const std::string& day = {}) {
        std::vector<std::string> words{"token", name, "--role", role, "--file", tokens};
        if (!day.empty()) words.insert(words.end(), {"--expires", day});
        Program program{words};
        EXPECT_EQ(program.exit_code(), 0) << program.errors();
        return program.output().substr(0, program.output().find('\n'));
    }
    static Reply answer(const Program& program, std::uint16_t port, const std::string& text) {
        RawClient client{port};
        EXPECT_TRUE(client.send(text));
        const auto reply = client.receive();
        EXPECT_TRUE(reply) << program.errors();
        return reply.value_or(Reply{});
    }

    const std::string tokens = (folder.path / "tokens").string();
};

TEST_F(AccessToEdits, FromElsewhereTakesATokenOfAnEditor) {
    const std::string ada = new_token("ada", "editor"), bob = new_token("bob", "viewer"),
                      old = new_token("eve", "editor", "2999-12-31");
    // No token is made that is over already: this one is by now
    std::stringstream lines;
    lines << std::ifstream{tokens}.rdbuf();
    std::string text = lines.str();
    const std::size_t day = text.find("2999-12-31");
    ASSERT_NE(day, std::string::npos);
    std::ofstream{tokens} << text.replace(day, 10, "2020-01-01");
    EXPECT_EQ(Program({"token", "eve", "--role", "editor", "--expires", "2020-01-01"}).exit_code(), 1);
    struct stat status {};
    ASSERT_EQ(::stat(tokens.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600u);
    Program program = serve({"--keep-no-edits", "--tokens", tokens});
    const std::uint16_t port = program.port();
    const auto reply = [&](const proto::Edit& edit, const std::string& fields) {
        return answer(program, port, post("sprites", write_brief_json(edit), fields));
    };
    for (const std::string& fields : {from_elsewhere, bearing("x"), bearing(ada + "x"), bearing(old),
                                      from_elsewhere + "Authorization: Basic " + ada + "\r\n"}) {
        const Reply refused = reply(placing(1, 100, 100), fields);
        EXPECT_EQ(refused.status, 401) << fields;
        EXPECT_EQ(refused["www-authenticate"], "Bearer realm=\"tessera\"");
    }
    const Reply viewer = reply(placing(1, 100, 100), bearing(bob));
    EXPECT_EQ(viewer.status, 403);
    EXPECT_NE(viewer.body.find("viewer"), std::string::npos);

    EXPECT_EQ(answer_in(reply(placing(1, 100, 100), bearing(ada))).revision(), 1u);
    proto::Edit of_bob = placing(2, 100, 100);
    of_bob.set_author("bob");
    const Reply forged = reply(of_bob, bearing(ada));
    EXPECT_EQ(forged.status, 400);
    EXPECT_NE(forged.body.find("author"), std::string::npos);
    EXPECT_EQ(answer_in(reply(of_bob, json_type)).revision(), 2u);
    // A token does not make a page of another site one of ours
    EXPECT_EQ(reply(placing(3, 1, 1), bearing(ada) + "Origin: http://evil.example\r\n").status, 403);
}

TEST_F(AccessToEdits, AWrongTokenIsRefusedOnThisMachineToo) {
    Program program = serve();
    const std::string edit = write_brief_json(placing(1, 1, 1));
    const Reply refused = answer(program, program.port(),
                                 post("sprites", edit, json_type + "Authorization: Bearer nonsense\r\n"));
    EXPECT_EQ(refused.status, 401);
    EXPECT_NE(refused.body.find("leave it out"), std::string::npos) << refused.body;
    EXPECT_EQ(answer(program, program.port(), post("sprites", edit, json_type)).status, 200);
}

TEST_F(AccessToEdits, WithoutTokensNobodyEditsFromElsewhere) {
    Program program = serve();
    const Reply refused =
        answer(program, program.port(), post("sprites", write_brief_json(placing(1, 1, 1)), from_elsewhere));
    EXPECT_EQ(refused.status, 401);
    EXPECT_NE(refused.body.find("--tokens"), std::string::npos);
}

TEST_F(AccessToEdits, ANameThatIsMadeToLeadHereDoesNotMakeAPageOurs) {
    Program program = serve();
    const std::string body = write_brief_json(placing(1, 1, 1));
    const auto status = [&](const std::string& host, const std::string& origin) {
        return answer(program, program.port(),
                      "POST /scenes/sprites/edits HTTP/1.1\r\nHost: " + host +
                          "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n" + json_type +
                          (origin.empty() ? "" : "Origin: " + origin + "\r\n") + "\r\n" + body)
            .status;
    };
    EXPECT_EQ(status("evil.example:7070", "http://evil.example:7070"), 403);
    EXPECT_EQ(status("127.evil.example", "http://127.evil.example"), 403);
    EXPECT_EQ(status("localhost.evil.example", "http://localhost.evil.example"), 403);
    for (const std::string host : {"localhost", "LocalHost:7070", "127.0.0.1:7070", "[::1]:7070"})
        EXPECT_EQ(status(host, "http://" + host), 200) << host;
    // What is no browser says no origin, and may call this machine what it likes
    EXPECT_EQ(status("wall.example", ""), 200);
}

TEST_F(AccessToEdits, TokensAreReadAgainAtAReload) {
    const std::string ada = new_token("ada", "editor");
    Program program = serve({"--keep-no-edits", "--tokens", tokens});
    const std::uint16_t port = program.port();
    const auto status = [&](const std::string& token) {
        return answer(program, port, post("sprites", "{}", bearing(token))).status;
    };
    EXPECT_EQ(status(ada), 400);  // Past the gate: the edit has no id
    const std::string bob = new_token("bob", "editor");
    EXPECT_EQ(status(bob), 401);
    program.signal(SIGHUP);
    ASSERT_TRUE(program.says("reloaded"));
    EXPECT_EQ(status(bob), 400);

    // A file that cannot be read changes nothing
    write("tokens", std::string{"editor ada\n"});
    program.signal(SIGHUP);
    ASSERT_TRUE(program.says("tokens:1: "));
    EXPECT_EQ(status(ada), 400);

    write("tokens", std::string{"# nobody\n"});
    program.signal(SIGHUP);
    for (int i = 0; i < 500 && status(ada) != 401; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
    EXPECT_EQ(status(ada), 401);
}

TEST_F(AccessToEdits, ATokenFileThatIsWrongStopsTheStart) {
    Program program = serve({"--keep-no-edits", "--tokens", (folder.path / "none").string()});
    EXPECT_EQ(program.exit_code(), 1);
    EXPECT_NE(program.errors().find("--tokens "), std::string::npos);
}

}  // namespace
}  // namespace tessera
