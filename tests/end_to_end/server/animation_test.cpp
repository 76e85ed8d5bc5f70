// Scenes that move over HTTP: a page is the same, with the same entity tag, for every step of its interval.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/scene/image_file.h"
#include "tests/end_to_end/server/running_server.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using test::RawClient;
using test::Reply;
using testing::HasSubstr;

/// `blinking`: all cells together, ten steps of black and then one of each of two greys. `still`: no motion.
class AnimatedPages : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder = std::make_unique<tests::TemporaryFolder>();
        const std::string index = R"(, "index": {"block": "lit"})";
        write(
            "blinking",
            R"({"name": "frames", "animation_sequence": {"frames": [{"pattern": 0}, {"pattern": 1}, {"pattern": 2}]}},
            {"name": "lit", "animation_map": {"sequence": "frames", "rest": {"integer": 9}}},)",
            index, R"("clock": {"steps_per_second": 4, "loop_steps": 120},)");
        write("still", "", "", "");
        server = Server::start(test::quick_options()).value();
        server->publish(std::make_shared<Catalog>(load_catalog(folder->path).value()), WebFiles::plain());
    }
    static void TearDownTestSuite() {
        server.reset();
        folder.reset();
    }
    static void write(const std::string& id, const std::string& blocks, const std::string& index,
                      const std::string& more) {
        fs::create_directories(folder->path / id);
        StraightRgba8Image image{48, 16, {}};
        for (int i = 0; i < 48 * 16; ++i)
            for (const int code : {i % 48 / 16 * 100, 0, 0, 255})
                image.bytes.push_back(static_cast<std::uint8_t>(code));
        ASSERT_TRUE(write_rgba_png(folder->path / id / "patterns.png", image));
        std::ofstream{folder->path / id / "scene.json"}
            << "{" << more << R"("extent_log2_pages": 4, "pattern": {"blocks": [)"
            << R"({"name": "cells", "virtual_tile_map": {"cell_texels": 16}},
                  {"name": "set", "pattern_set": {"image": "patterns.png", "side_texels": 16}},)"
            << blocks << R"({"name": "shown", "reference_texture": {"patterns": "set", "grid": "cells")"
            << index << "}}]}}";
    }
    static int red(const Reply& page) { return static_cast<unsigned char>(page.body.at(0)); }

    static inline std::unique_ptr<tests::TemporaryFolder> folder;
    static inline std::unique_ptr<Server> server;
    RawClient client{server->port()};
};

TEST_F(AnimatedPages, AreTheSameForEveryStepOfTheirInterval) {
    const Reply first = client.get("/scenes/blinking/4/3/5.rgba?step=3").value();
    ASSERT_EQ(first.status, 200u);
    EXPECT_EQ(red(first), 0);
    EXPECT_EQ(first["tessera-valid-from"], "0");
    EXPECT_EQ(first["tessera-valid-until"], "10");
    for (const int step : {0, 1, 5, 9}) {
        const std::string query = step == 0 ? "" : "?step=" + std::to_string(step);
        const Reply same = client.get("/scenes/blinking/4/3/5.rgba" + query).value();
        EXPECT_EQ(same["etag"], first["etag"]);
        EXPECT_EQ(same.body, first.body);
        EXPECT_THAT(same["server-timing"], HasSubstr("hit"));
        EXPECT_EQ(
            client.get("/scenes/blinking/4/3/5.rgba" + query, "If-None-Match: " + first["etag"] + "\r\n")
                .value()
                .status,
            304u);
    }
    const Reply next = client.get("/scenes/blinking/4/3/5.rgba?step=10").value();
    EXPECT_EQ(red(next), 100);
    EXPECT_NE(next["etag"], first["etag"]);
    EXPECT_EQ(next["tessera-valid-until"], "11");
    EXPECT_EQ(red(client.get("/scenes/blinking/4/3/5.rgba?step=11").value()), 200);
    EXPECT_EQ(red(client.get("/scenes/blinking/4/3/5.rgba?step=1000000000000000").value()),
              1'000'000'000'000'000 % 12 == 10   ? 100
              : 1'000'000'000'000'000 % 12 == 11 ? 200
                                                 : 0);
    EXPECT_EQ(red(client.get("/scenes/blinking/4/3/5.rgba?step=-1").value()), 200);
}

TEST_F(AnimatedPages, AreRevalidatedBeforeTheirIntervalIsKnown) {
    const Reply page = client.get("/scenes/blinking/4/7/7.rgba?step=2").value();
    // Another server, which has not evaluated the page yet
    auto other = Server::start(test::quick_options()).value();
    other->publish(std::make_shared<Catalog>(load_catalog(folder->path).value()), WebFiles::plain());
    RawClient again{other->port()};
    EXPECT_EQ(again.get("/scenes/blinking/4/7/7.rgba?step=8", "If-None-Match: " + page["etag"] + "\r\n")
                  .value()
                  .status,
              304u);
    EXPECT_EQ(again.get("/scenes/blinking/4/7/7.rgba?step=10", "If-None-Match: " + page["etag"] + "\r\n")
                  .value()
                  .status,
              200u);
}

TEST_F(AnimatedPages, OfAStillSceneHaveNoSteps) {
    const Reply page = client.get("/scenes/still/4/3/5.png").value();
    const Reply other = client.get("/scenes/still/4/3/5.png?step=77").value();
    EXPECT_EQ(page["etag"], other["etag"]);
    EXPECT_EQ(page["tessera-valid-from"], "always");
    EXPECT_EQ(page["tessera-valid-until"], "never");
    EXPECT_EQ(client.get("/scenes/still/4/3/5.png?step=1.5").value().status, 400u);
}

TEST_F(AnimatedPages, AreToldOfInTileJson) {
    const std::string moving = client.get("/scenes/blinking").value().body,
                      still = client.get("/scenes/still").value().body;
    EXPECT_THAT(moving, HasSubstr("\"animated\": true"));
    EXPECT_THAT(moving, HasSubstr("\"steps_per_second\": 4"));
    EXPECT_THAT(moving, HasSubstr("\"loop_steps\": \"120\""));
    EXPECT_THAT(still, HasSubstr("\"animated\": false"));
}

}  // namespace
}  // namespace tessera
