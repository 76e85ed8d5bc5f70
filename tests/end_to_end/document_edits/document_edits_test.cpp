// Edits of maps, parameters, animations, targets and the clock over a real socket: what pages do, and what is
// there after the server was killed.
#include <signal.h>

#include "tests/end_to_end/edits/edited_scenes.h"
#include "tests/unit/server/edits/edited_pattern.h"

namespace tessera {
namespace {

using namespace test;

class DocumentEdits : public testing::Test {
  protected:
    void SetUp() override { files_.load("moving"); }
    Program serve() const {
        return Program{{"serve", "--scenes", files_.folder().string(), "--listen", "127.0.0.1:0", "--edits",
                        edits_.path.string()}};
    }
    static std::optional<Reply> send(RawClient& client, const proto::Edit& edit) {
        if (!client.send(post("meadow", write_brief_json(edit)))) return std::nullopt;
        return client.receive();
    }
    /// Pages near and far, at a step that shows every animation.
    static std::vector<Reply> pages(RawClient& client) {
        std::vector<Reply> replies;
        for (const std::string page : {"6/0/0", "6/3/3", "6/11/11", "6/40/40", "4/0/0", "0/0/0"})
            replies.push_back(*client.get("/scenes/meadow/" + page + ".png?step=77"));
        return replies;
    }

    EditedPattern files_;
    tests::TemporaryFolder edits_;
};

TEST_F(DocumentEdits, OfEachKindChangePagesAndSurviveAKill) {
    std::vector<Reply> last;
    std::vector<proto::Edit> inverses;
    std::vector<Reply> before;
    {
        Program program = serve();
        RawClient client{program.port()};
        before = pages(client);
        for (const Reply& reply : before) ASSERT_EQ(reply.status, 200) << reply.body;

        proto::Edit edit = new_edit();
        proto::MapPaint& paint = *edit.add_changes()->mutable_paint_map();
        paint.set_block("areas");
        paint.set_width(2);
        paint.set_height(2);
        paint.set_values(std::string{"\1\0\1\0\1\0\0\0", 8});
        proto::EditAnswer answer = answer_in(*send(client, edit));
        EXPECT_EQ(answer.revision(), 1u);
        EXPECT_EQ(answer.dirty_size(), 1);
        inverses.push_back(answer.inverse());
        std::vector<Reply> now = pages(client);
        EXPECT_NE(now[0]["etag"], before[0]["etag"]);
        EXPECT_TRUE(now[0].body != before[0].body);
        EXPECT_EQ(now[3]["etag"], before[3]["etag"]) << "far from it";

        edit = new_edit();
        proto::Target& target = *edit.add_changes()->mutable_set_target();
        target.set_id(1);
        target.set_x(10300);
        target.set_y(10300);
        answer = answer_in(*send(client, edit));
        inverses.push_back(answer.inverse());
        std::vector<Reply> then = std::exchange(now, pages(client));
        EXPECT_NE(now[2]["etag"], then[2]["etag"]) << "where it was";
        EXPECT_TRUE(now[2].body != then[2].body);
        EXPECT_TRUE(now[3].body != then[3].body);
        EXPECT_EQ(now[0]["etag"], then[0]["etag"]);

        edit = new_edit();
        proto::ParameterChange& parameter = *edit.add_changes()->mutable_set_parameter();
        parameter.set_block("which");
        parameter.set_field("count");
        parameter.mutable_value()->set_integer(5);
        answer = answer_in(*send(client, edit));
        inverses.push_back(answer.inverse());
        then = std::exchange(now, pages(client));
        EXPECT_TRUE(now[3].body != then[3].body);

        edit = new_edit();
        proto::AnimationChange& animation = *edit.add_changes()->mutable_change_animation();
        animation.set_block("blink");
        animation.set_step(20);
        animation.set_density(0);
        answer = answer_in(*send(client, edit));
        ASSERT_EQ(answer.effects_size(), 1);
        EXPECT_EQ(answer.effects(0).step(), 20);
        then = std::exchange(now, pages(client));
        EXPECT_TRUE(now[3].body != then[3].body);

        edit = new_edit();
        proto::ClockChange& clock = *edit.add_changes()->mutable_set_clock();
        clock.set_playing(false);
        clock.set_step(500);
        answer = answer_in(*send(client, edit));
        EXPECT_EQ(answer.dirty_size(), 0);
        last = pages(client);
        EXPECT_EQ(last[0]["etag"], now[0]["etag"]) << "no page depends on the clock";

        edit = new_edit();
        proto::ParameterChange& impossible = *edit.add_changes()->mutable_set_parameter();
        impossible.set_block("which");
        impossible.set_field("count");
        impossible.mutable_value()->set_integer(0);
        const Reply refused = *send(client, edit);
        EXPECT_EQ(refused.status, 400);
        EXPECT_NE(refused.body.find("from 1 to 65536"), std::string::npos) << refused.body;
        program.signal(SIGKILL);
    }
    Program program = serve();
    RawClient client{program.port()};
    const std::vector<Reply> again = pages(client);
    for (std::size_t i = 0; i < again.size(); ++i) {
        EXPECT_EQ(again[i]["etag"], last[i]["etag"]);
        EXPECT_TRUE(again[i].body == last[i].body);
    }
    for (auto inverse = inverses.rbegin(); inverse != inverses.rend(); ++inverse) {
        inverse->set_id(to_string(random_edit_id()));
        answer_in(*send(client, *inverse));
    }
    proto::Edit edit = new_edit();
    proto::AnimationChange& animation = *edit.add_changes()->mutable_change_animation();
    animation.set_block("blink");
    animation.set_step(20);
    animation.set_density(1);
    answer_in(*send(client, edit));
}

TEST_F(DocumentEdits, ReloadsInTheMiddleLoseNothing) {
    std::vector<Reply> lived;
    {
        Program program = serve();
        RawClient client{program.port()};
        for (int i = 0; i < 12; ++i) {
            proto::Edit edit = new_edit();
            if (i % 3 == 0) {
                proto::ParameterChange& parameter = *edit.add_changes()->mutable_set_parameter();
                parameter.set_block("which");
                parameter.set_field("count");
                parameter.mutable_value()->set_integer(3 + i);
            } else {
                proto::MapPaint& paint = *edit.add_changes()->mutable_paint_map();
                paint.set_block("areas");
                paint.set_x(i);
                paint.set_width(2);
                paint.set_height(2);
                paint.set_value(1);
            }
            // The file changes too: blocks stay as edits left them
            if (i == 5) files_.load("moving", false);
            if (i == 8) files_.load("moving");
            if (i % 2 == 1) program.signal(SIGHUP);
            EXPECT_EQ(answer_in(*send(client, edit)).revision(), static_cast<std::uint64_t>(i) + 1);
        }
        EXPECT_TRUE(program.says("reloaded: 1 scenes")) << program.errors();
        program.signal(SIGHUP);
        proto::Edit last = new_edit();
        proto::AnimationChange& animation = *last.add_changes()->mutable_change_animation();
        animation.set_block("blink");
        animation.set_step(40);
        animation.set_density(2);
        EXPECT_EQ(answer_in(*send(client, last)).revision(), 13u);
        // More reloads than were asked for before: the last word is of files as they are now
        for (int i = 0; i < 8; ++i) {
            program.forget();
            program.signal(SIGHUP);
            ASSERT_TRUE(program.says("reloaded: 1 scenes"));
        }
        lived = pages(client);
        for (const Reply& reply : lived) ASSERT_EQ(reply.status, 200) << reply.body;
        client.close();
        program.signal(SIGTERM);
        EXPECT_EQ(program.exit_code(), 0) << program.errors();
    }
    Program program = serve();
    RawClient client{program.port()};
    const std::vector<Reply> again = pages(client);
    for (std::size_t i = 0; i < again.size(); ++i) {
        EXPECT_EQ(again[i]["etag"], lived[i]["etag"]);
        EXPECT_TRUE(again[i].body == lived[i].body);
    }
}

TEST_F(DocumentEdits, WhatMayBeChangedIsToldAsItIsNow) {
    Program program = serve();
    RawClient client{program.port()};
    const auto told = [&] { return client.get("/scenes/meadow/editables")->body; };
    const auto has = [](const std::string& text, const std::string& words) {
        return text.find(words) != std::string::npos;
    };
    const std::string before = told();
    EXPECT_TRUE(has(before, "\"revision\": \"0\"") || !has(before, "revision")) << before;
    EXPECT_TRUE(has(before, "\"block\": \"areas\"")) << before;
    EXPECT_TRUE(has(before, "\"block\": \"blink\"")) << before;

    proto::Edit edit = new_edit();
    proto::Target& target = *edit.add_changes()->mutable_set_target();
    target.set_id(1);
    target.set_x(10300);
    target.set_y(10301);
    proto::AnimationChange& animation = *edit.add_changes()->mutable_change_animation();
    animation.set_block("blink");
    animation.set_density(0.25);
    answer_in(*send(client, edit));
    const std::string after = told();
    for (const char* words : {"\"revision\": \"1\"", "10300", "10301", "0.25"})
        EXPECT_TRUE(has(after, words)) << words << " in " << after;
    EXPECT_EQ(client.get("/scenes/nowhere/editables")->status, 404);
}

}  // namespace
}  // namespace tessera
