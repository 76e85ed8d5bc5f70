// Edits that are wrong: each is refused by name, and changes nothing.
#include <limits>
#include <memory>

#include "tests/end_to_end/edits/edited_scenes.h"

namespace tessera {
namespace {

using namespace test;

const std::string protobuf_type = "Content-Type: application/x-protobuf\r\n";

class BadEdits : public EditedScenes {
  protected:
    void SetUp() override {
        EditedScenes::SetUp();
        write("narrow/patterns.png", to_png(16, 64, PngColor::rgba, 8, std::vector<std::uint8_t>(4096, 90)));
        write("narrow/scene.json", std::string{R"({"checker": {"cell_texels": 8}, "extent_log2_pages": 6,
            "sprites": {"patterns": {"image": "patterns.png", "side_texels": 16}, "overlap_layers": 2}})"});
        server.reset(new Program(serve()));
        client.emplace(server->port());
    }
    Reply reply(const proto::Edit& edit, const std::string& scene = "sprites") {
        EXPECT_TRUE(client->send(post(scene, edit.SerializeAsString(), protobuf_type)));
        return client->receive().value_or(Reply{});
    }
    void expect_refused(const proto::Edit& edit, int status, const std::string& words,
                        const std::string& scene = "sprites") {
        const Reply refused = reply(edit, scene);
        EXPECT_EQ(refused.status, status) << refused.body;
        EXPECT_NE(refused.body.find(words), std::string::npos) << refused.body;
    }
    /// Of a scene, as its description says.
    std::string revision(const std::string& scene = "sprites") {
        const std::string text = client->get("/scenes/" + scene)->body;
        const std::size_t at = text.find("\"revision\": \"");
        return at == std::string::npos ? "0" : text.substr(at + 13, text.find('"', at + 13) - at - 13);
    }

    std::unique_ptr<Program> server;
    std::optional<RawClient> client;
};

TEST_F(BadEdits, PlacesThatNoSpriteCanBeAtAreNamed) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double inf = std::numeric_limits<double>::infinity();
    for (const double far : {nan, inf, -inf, 1e300, 0x1p40, -0x1p40, 0x1p39, -4000.0}) {
        expect_refused(placing(1, far, 0), 400, "changes[0].place_sprite.x");
        expect_refused(placing(1, 0, far), 400, "changes[0].place_sprite");
    }
    proto::Edit edit = placing(1, 0, 0);
    edit.add_changes()->mutable_move_sprite()->set_id(1);
    edit.mutable_changes(1)->mutable_move_sprite()->set_y(-5000);
    expect_refused(edit, 400, "changes[1].move_sprite.y: is outside of the texture");
    edit = placing(1, 0, 0);
    edit.mutable_changes(0)->mutable_place_sprite()->set_scale(nan);
    expect_refused(edit, 400, "scale");
    edit.mutable_changes(0)->mutable_place_sprite()->set_scale(1);
    edit.mutable_changes(0)->mutable_place_sprite()->set_turn(nan);
    expect_refused(edit, 400, "turn");
    EXPECT_TRUE(
        client->send(post("sprites", R"({"id": ")" + edit.id() +
                                         R"(", "changes": [{"place_sprite": {"id": 1, "x": "NaN"}}]})")));
    EXPECT_EQ(client->receive()->status, 400);
    EXPECT_EQ(revision(), "0");
}

TEST_F(BadEdits, WhatIsNotThereIsNamed) {
    proto::Edit edit = placing(1, 0, 0);
    edit.mutable_changes(0)->mutable_place_sprite()->set_pattern(4);
    expect_refused(edit, 400, "pattern");
    edit = placing(0, 0, 0);
    expect_refused(edit, 400, "id");
    edit = new_edit();
    edit.add_changes()->mutable_remove_sprite()->set_id(7);
    expect_refused(edit, 400, "no sprite 7");
    ASSERT_EQ(reply(placing(1, 10, 10)).status, 200);
    expect_refused(placing(1, 20, 20), 400, "a sprite 1 already");
    // One wrong change among good ones, and none of them is made
    edit = placing(2, 5, 5);
    edit.add_changes()->mutable_remove_sprite()->set_id(1);
    edit.add_changes()->mutable_move_sprite()->set_id(9);
    expect_refused(edit, 400, "changes[2].move_sprite");
    EXPECT_EQ(revision(), "1");
    ASSERT_EQ(reply(placing(2, 10, 10)).status, 200);
}

TEST_F(BadEdits, AFullPlaceIsNamedAndTheOthersStay) {
    ASSERT_EQ(reply(placing(1, 100, 100), "narrow").status, 200);
    ASSERT_EQ(reply(placing(2, 101, 100), "narrow").status, 200);
    const std::string page = "/scenes/narrow/6/0/0.png", before = client->get(page)->body;
    expect_refused(placing(3, 102, 100), 400, "changes[0].place_sprite", "narrow");
    expect_refused(placing(3, 102, 100), 400, "overlap layers", "narrow");
    EXPECT_EQ(client->get(page)->body, before);
    EXPECT_EQ(reply(placing(3, 300, 300), "narrow").status, 200);
}

TEST_F(BadEdits, TooMuchAtOnceIsRefusedBeforeItIsLookedAt) {
    proto::Edit edit = new_edit();
    for (std::uint64_t i = 0; i < 1025; ++i) edit.add_changes()->mutable_remove_sprite()->set_id(i + 1);
    expect_refused(edit, 400, "1024");
    edit = placing(1, 0, 0);
    edit.set_author(std::string(65, 'a'));
    expect_refused(edit, 400, "author");
    edit = new_edit();
    for (std::uint64_t i = 0; i < 1'000'000; ++i) edit.add_changes()->mutable_remove_sprite()->set_id(i + 1);
    RawClient other{server->port()};
    // All of it is taken off the socket, so that whoever sends it comes to read why nobody wants it
    EXPECT_TRUE(other.send(post("sprites", edit.SerializeAsString(), protobuf_type)));
    const auto refused = other.receive();
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->status, 413);
    EXPECT_EQ(revision(), "0");
}

TEST_F(BadEdits, WhatThisServerDoesNotKnowIsRefusedRatherThanForgotten) {
    proto::Edit edit = placing(1, 0, 0);
    std::string bytes = edit.SerializeAsString();
    bytes += std::string{"\xa0\x06\x01", 3};  // field 100, a number
    EXPECT_TRUE(client->send(post("sprites", bytes, protobuf_type)));
    Reply refused = client->receive().value();
    EXPECT_EQ(refused.status, 400);
    EXPECT_NE(refused.body.find("does not know"), std::string::npos);
    EXPECT_TRUE(client->send(post("sprites", R"({"colour": 3})")));
    refused = client->receive().value();
    EXPECT_EQ(refused.status, 400);
    EXPECT_NE(refused.body.find("colour"), std::string::npos);
    edit = new_edit();
    edit.add_changes();
    expect_refused(edit, 400, "changes[0]");
    expect_refused(new_edit(), 400, "changes: is empty");
    EXPECT_EQ(revision(), "0");
}

TEST_F(BadEdits, AnIdStandsForOneEditOfOneScene) {
    const proto::Edit edit = placing(1, 10, 10);
    ASSERT_EQ(reply(edit).status, 200);
    proto::Edit other = placing(2, 10, 10);
    other.set_id(edit.id());
    expect_refused(other, 409, "");
    proto::EditAnswer again;
    ASSERT_TRUE(again.ParseFromString(reply(edit).body));
    EXPECT_TRUE(again.again());
    EXPECT_EQ(again.revision(), 1u);
    EXPECT_EQ(revision(), "1");
    // Each scene has a journal of its own
    ASSERT_EQ(reply(edit, "narrow").status, 200);
    EXPECT_EQ(revision("narrow"), "1");
    expect_refused(edit, 400, "takes no edits", "board");
}

}  // namespace
}  // namespace tessera
