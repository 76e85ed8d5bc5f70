// Edits over a real socket: what an editor sees, and what is there after the server was killed.
#include <atomic>
#include <chrono>
#include <stop_token>
#include <thread>

#include <signal.h>

#include "tests/end_to_end/edits/edited_scenes.h"

namespace tessera {
namespace {

using namespace test;

class Edits : public EditedScenes {};

const std::string near_page = "/scenes/sprites/6/0/0.png", far_page = "/scenes/sprites/6/9/9.png",
                  coarse_page = "/scenes/sprites/2/0/0.png";

TEST_F(Edits, PagesUnderASpriteChangeAndAllOthersKeepTheirTags) {
    Program program = serve();
    RawClient client{program.port()};
    const Reply before_near = *client.get(near_page), before_far = *client.get(far_page),
                before_coarse = *client.get(coarse_page);
    const proto::EditAnswer placed = answer_in(*send(client, placing(1, 100, 100)));
    EXPECT_EQ(placed.revision(), 1u);
    ASSERT_EQ(placed.dirty_size(), 1);
    EXPECT_EQ(placed.dirty(0).x0(), 92);

    const Reply near = *client.get(near_page), coarse = *client.get(coarse_page);
    EXPECT_NE(near["etag"], before_near["etag"]);
    EXPECT_NE(near.body, before_near.body);
    EXPECT_NE(coarse["etag"], before_coarse["etag"]);
    EXPECT_NE(coarse.body, before_coarse.body);
    const Reply far = *client.get(far_page, "If-None-Match: " + before_far["etag"] + "\r\n");
    EXPECT_EQ(far.status, 304);

    // The inverse brings the texels back, under a revision of its own
    proto::Edit undo = placed.inverse();
    undo.set_id(to_string(random_edit_id()));
    EXPECT_EQ(answer_in(*send(client, undo)).revision(), 2u);
    EXPECT_EQ(client.get(near_page)->body, before_near.body);
    EXPECT_EQ(client.get("/scenes/sprites")->body.find("\"revision\": \"2\"") == std::string::npos, false);
}

TEST_F(Edits, APageIsFoundAtItsOwnRevisionAndGoneAtAnOlderOne) {
    Program program = serve();
    RawClient client{program.port()};
    const Reply description = *client.get("/scenes/sprites");
    const std::size_t at = description.body.find("\"fingerprint\": \"") + 16;
    const std::string fingerprint = description.body.substr(at, 16);
    const auto pinned = [&](int revision, const std::string& page) {
        return "/scenes/sprites/r" + std::to_string(revision) + "-" + fingerprint + page;
    };
    answer_in(*send(client, placing(1, 100, 100)));
    answer_in(*send(client, placing(2, 300, 100)));
    EXPECT_EQ(client.get(pinned(1, "/6/0/0.png"))->status, 200);
    EXPECT_EQ(client.get(pinned(2, "/6/0/0.png"))->status, 308);
    EXPECT_EQ(client.get(pinned(0, "/6/0/0.png"))->status, 410);
    EXPECT_EQ(client.get(pinned(3, "/6/0/0.png"))->status, 404);
    EXPECT_EQ(client.get(pinned(0, "/6/9/9.png"))->status, 200);
}

TEST_F(Edits, WhatIsWrongIsNamedAndTheConnectionGoesOn) {
    Program program = serve();
    RawClient client{program.port()};
    const std::string good = write_brief_json(placing(1, 100, 100));
    const auto status = [&](const std::string& scene, const std::string& body, const std::string& fields,
                            const std::string& words) {
        EXPECT_TRUE(client.send(post(scene, body, fields)));
        const Reply reply = client.receive().value();
        EXPECT_NE(reply.body.find(words), std::string::npos) << reply.body;
        return reply.status;
    };
    EXPECT_EQ(status("sprites", "{}", json_type, "UUID"), 400);
    EXPECT_EQ(status("sprites", "{\"colour\": 3}", json_type, "colour"), 400);
    EXPECT_EQ(status("sprites", "garbage", "Content-Type: application/x-protobuf\r\n", "edit.proto"), 400);
    EXPECT_EQ(status("board", good, json_type, "takes no edits"), 400);
    proto::Edit nowhere = new_edit();
    nowhere.add_changes()->mutable_move_sprite()->set_id(9);
    EXPECT_EQ(status("sprites", write_brief_json(nowhere), json_type, "changes[0].move_sprite"), 400);
    proto::Edit based = placing(1, 1, 1);
    based.set_base_revision(5);
    EXPECT_EQ(status("sprites", write_brief_json(based), json_type, "base_revision"), 409);
    EXPECT_EQ(answer_in(*send(client, placing(1, 100, 100))).revision(), 1u);

    // These are refused before the body is read, which ends the connection
    const auto refused = [&](const std::string& scene, const std::string& body, const std::string& fields) {
        RawClient other{program.port()};
        EXPECT_TRUE(other.send(post(scene, body, fields)));
        return other.receive().value().status;
    };
    EXPECT_EQ(refused("nobody", good, json_type), 404);
    EXPECT_EQ(refused("sprites", good, "Content-Type: application/x-www-form-urlencoded\r\n"), 415);
    EXPECT_EQ(refused("sprites", good, json_type + "Origin: http://evil.example\r\n"), 403);
    EXPECT_EQ(refused("sprites", good, json_type + "Origin: null\r\n"), 403);
    EXPECT_EQ(refused("sprites", good, json_type + "X-Forwarded-For: 10.0.0.1\r\n"), 401);
    EXPECT_EQ(refused("sprites", std::string(300'000, ' '), json_type), 413);
    EXPECT_EQ(client.get("/scenes/sprites/edits")->status, 405);
    // A page of this very server may edit
    proto::Edit second = placing(2, 100, 100);
    EXPECT_TRUE(client.send(
        post("sprites", write_brief_json(second), json_type + "Origin: http://localhost:7070\r\n")));
    EXPECT_EQ(answer_in(client.receive().value()).revision(), 2u);
}

TEST_F(Edits, WhoClosesItsSendingHalfIsAnsweredAllTheSame) {
    Program program = serve({"--edits", (folder.path / ".edits").string()});
    const std::uint16_t port = program.port();
    for (std::uint64_t id = 1; id <= 20; ++id) {
        RawClient client{port};
        ASSERT_TRUE(client.send(post("sprites", write_brief_json(placing(id, 100, 100)))));
        client.close_sending();
        const auto reply = client.receive();
        ASSERT_TRUE(reply);
        EXPECT_EQ(answer_in(*reply).revision(), id);
        EXPECT_TRUE(client.is_closed());
    }
}

/// An edit that is always possible: sprites 1 to 30 are there from the start.
proto::Edit random_move(std::uint64_t n) {
    const auto draw = [&](std::uint64_t what) { return hash(9, what, static_cast<std::int64_t>(n), 0); };
    return moving(1 + draw(1) % 30, static_cast<double>(draw(2) % 65536) / 64,
                  static_cast<double>(draw(3) % 65536) / 64);
}

TEST_F(Edits, EveryEditThatWasAcknowledgedIsThereOnceAfterFiftyKills) {
    proto::Edit all = new_edit();
    for (std::uint64_t id = 1; id <= 30; ++id)
        *all.add_changes() = placing(id, 20.0 * double(id), 50).changes(0);
    std::vector<proto::Edit> acknowledged;
    std::optional<proto::Edit> unanswered = all;
    std::uint64_t drawn = 0, again = 0;
    for (int kill = 0; kill < 50; ++kill) {
        Program program = serve({});
        const std::uint16_t port = program.port();
        ASSERT_NE(port, 0) << program.errors();
        RawClient client{port};
        const auto time = std::chrono::microseconds{hash(8, 8, kill, 0) % 30'000};
        // Most lives take an edit, on however slow a machine
        std::atomic<bool> taken = kill % 5 == 4;
        std::jthread killer{[&](const std::stop_token& over) {
            while (!taken && !over.stop_requested())
                std::this_thread::sleep_for(std::chrono::milliseconds{1});
            std::this_thread::sleep_for(time);
            program.signal(SIGKILL);
        }};
        for (;;) {
            const proto::Edit edit = unanswered ? *unanswered : random_move(++drawn);
            unanswered = edit;
            const auto reply = send(client, edit);
            if (!reply) break;
            const proto::EditAnswer answer = answer_in(*reply);
            ASSERT_EQ(answer.revision(), acknowledged.size() + 1) << "after " << kill << " kills";
            again += answer.again();
            acknowledged.push_back(edit);
            unanswered.reset();
            taken = true;
        }
    }
    RecordProperty("edits", static_cast<int>(acknowledged.size()));
    RecordProperty("retries_of_what_was_in", static_cast<int>(again));
    ASSERT_GT(acknowledged.size(), 39u);

    // A server that was never killed, given the same edits, shows the same pages
    Program lived = serve({});
    RawClient survivor{lived.port()};
    const auto pages = [](RawClient& client) {
        std::string bytes;
        for (const char* page : {"/6/0/0.png", "/6/1/0.png", "/6/3/2.png", "/4/0/0.png", "/2/0/0.png"})
            bytes += client.get("/scenes/sprites" + std::string{page})->body;
        return bytes;
    };
    if (unanswered) {
        answer_in(*send(survivor, *unanswered));
        acknowledged.push_back(*unanswered);
    }
    const std::string survived = pages(survivor);
    Program fresh = serve();
    RawClient client{fresh.port()};
    for (const proto::Edit& edit : acknowledged) answer_in(*send(client, edit));
    EXPECT_EQ(pages(client), survived);
}

}  // namespace
}  // namespace tessera
