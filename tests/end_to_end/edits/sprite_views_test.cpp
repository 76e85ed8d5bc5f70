// What an editor draws with: the sprites of a box, the patterns alone, and pages without the sprites in the
// hand.
#include "tests/end_to_end/edits/edited_scenes.h"

namespace tessera {
namespace {

using namespace test;

class SpriteViews : public EditedScenes {
  protected:
    void SetUp() override {
        EditedScenes::SetUp();
        server.emplace(serve());
        client.emplace(server->port());
    }
    void make(const proto::Edit& edit) {
        ASSERT_TRUE(client->send(
            post("sprites", edit.SerializeAsString(), "Content-Type: application/x-protobuf\r\n")));
        ASSERT_EQ(client->receive().value_or(Reply{}).status, 200);
    }
    Reply get(const std::string& path) { return client->get("/scenes/" + path).value_or(Reply{}); }

    std::optional<Program> server;
    std::optional<RawClient> client;
};

TEST_F(SpriteViews, ABoxListsTheSpritesThatMeetItAndNoOthers) {
    make(placing(7, 100, 100));
    make(placing(8, 3000, 100));
    const Reply list = get("sprites/sprites?x0=0&y0=0&x1=512&y1=512");
    EXPECT_EQ(list.status, 200);
    EXPECT_NE(list.body.find("\"revision\": \"2\""), std::string::npos) << list.body;
    EXPECT_NE(list.body.find("\"id\": \"7\""), std::string::npos) << list.body;
    EXPECT_EQ(list.body.find("\"id\": \"8\""), std::string::npos) << list.body;
    for (const char* wrong :
         {"", "?x0=0", "?x0=0&y0=0&x1=0&y1=9", "?x0=0&x0=0&y0=0&x1=9&y1=9", "?x0=a&y0=0&x1=9&y1=9",
          "?x0=0&y0=0&x1=9&y1=9&z=1", "?x0=0&y0=0&x1=9999999999999999999&y1=9"})
        EXPECT_EQ(get("sprites/sprites" + std::string{wrong}).status, 400) << wrong;
    EXPECT_EQ(get("board/sprites?x0=0&y0=0&x1=9&y1=9").status, 404);
}

TEST_F(SpriteViews, APageWithoutASpriteIsThePageBeforeItWasPlaced) {
    const std::string page = "sprites/6/0/0.png";
    const std::string bare = get(page).body;
    make(placing(7, 100, 100));
    const std::string placed = get(page).body;
    EXPECT_NE(placed, bare);
    EXPECT_EQ(get("sprites/without-7/6/0/0.png").body, bare);
    EXPECT_EQ(get("sprites/without-7,9/6/0/0.png").body, bare);
    EXPECT_EQ(get("sprites/without-9/6/0/0.png").body, placed);
    EXPECT_EQ(get(page).body, placed) << "the page itself stays what it is";
    for (const char* wrong : {"without-", "without-x", "without-7,", "without--7"})
        EXPECT_EQ(get("sprites/" + std::string{wrong} + "/6/0/0.png").status, 400) << wrong;
    EXPECT_EQ(get("sprites/without-7/6/64/0.png").status, 404);
}

TEST_F(SpriteViews, APatternIsAPictureAndThereAreNoMore) {
    const Reply first = get("sprites/patterns/0.png");
    EXPECT_EQ(first.status, 200);
    EXPECT_EQ(first.body.substr(1, 3), "PNG");
    EXPECT_NE(get("sprites/patterns/1.png").body, first.body);
    EXPECT_EQ(get("sprites/patterns/4.png").status, 404);
    EXPECT_EQ(get("sprites/patterns/-1.png").status, 404);
    EXPECT_EQ(get("sprites/patterns/0.jpg").status, 404);
    EXPECT_EQ(get("board/patterns/0.png").status, 404);
}

}  // namespace
}  // namespace tessera
