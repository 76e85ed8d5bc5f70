// Scenes of pattern blocks over HTTP: slices of a third dimension, and broken ones beside good ones.
#include <fstream>
#include <set>

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

/// `volume` has four slices, which repeat; `deep` has cells in three dimensions; `flat` has one slice; the
/// others are broken.
class PatternPages : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder = std::make_unique<tests::TemporaryFolder>();
        const std::string grid = R"({"name": "cells", "virtual_tile_map": {"cell_texels": 16}},)";
        const std::string set =
            R"({"name": "set", "pattern_set": {"image": "patterns.png", "side_texels": 16, "slices": 4}},)";
        const std::string shown =
            R"({"name": "shown", "reference_texture": {"patterns": "set", "grid": "cells"}})";
        write("volume", grid + set + shown);
        write("deep", R"({"name": "cells", "virtual_tile_map": {"cell_texels": 16, "cell_slices": 4}},)" +
                          set +
                          R"({"name": "pick", "virtual_indirection_map": {"grid": "cells", "count": 2}},
                             {"name": "shown", "reference_texture": {"patterns": "set", "grid": "cells",
                              "index": {"block": "pick"}}})");
        write("flat", grid +
                          R"({"name": "set", "pattern_set": {"image": "patterns.png", "side_texels": 16}},)" +
                          shown);
        write(
            "round",
            R"({"name": "a", "layers": {"textures": ["b"]}}, {"name": "b", "layers": {"textures": ["a"]}})");
        write("none", R"({"name": "cells", "virtual_tile_map": {}},)" + set + shown);
        write("beyond", grid + set +
                            R"({"name": "shown", "reference_texture": {"patterns": "set", "grid": "cells",
                                "index": {"integer": 9}}})");
        std::string many = R"({"name": "b", "constant": {}})";
        for (int i = 0; i < 10'000; ++i)
            many += R"(,{"name": "b)" + std::to_string(i) + R"(", "constant": {}})";
        write("many", many);
        server = Server::start(test::quick_options()).value();
        server->publish(std::make_shared<Catalog>(load_catalog(folder->path).value()), WebFiles::plain());
    }
    static void TearDownTestSuite() {
        server.reset();
        folder.reset();
    }
    /// Eight images of one colour each: red is 30 times the image's number.
    static void write(const std::string& id, const std::string& blocks) {
        fs::create_directories(folder->path / id);
        StraightRgba8Image image{128, 16, {}};
        for (int i = 0; i < 128 * 16; ++i)
            for (const int code : {i % 128 / 16 * 30, 0, 0, 255})
                image.bytes.push_back(static_cast<std::uint8_t>(code));
        ASSERT_TRUE(write_rgba_png(folder->path / id / "patterns.png", image));
        std::ofstream{folder->path / id / "scene.json"}
            << R"({"extent_log2_pages": 4, "pattern": {"blocks": [)" + blocks + "]}}";
    }
    static int red(const Reply& page) { return static_cast<unsigned char>(page.body.at(0)); }

    static inline std::unique_ptr<tests::TemporaryFolder> folder;
    static inline std::unique_ptr<Server> server;
    RawClient client{server->port()};
};

TEST_F(PatternPages, ASliceIsAPageOfItsOwn) {
    std::set<std::string> tags;
    for (const int slice : {0, 1, 2, 3}) {
        const std::string query = slice == 0 ? "" : "?slice=" + std::to_string(slice);
        const Reply page = client.get("/scenes/volume/4/3/5.rgba" + query).value();
        ASSERT_EQ(page.status, 200u) << page.body;
        EXPECT_EQ(red(page), 30 * slice);
        EXPECT_TRUE(tags.insert(page["etag"]).second);
        const std::string known = "If-None-Match: " + page["etag"] + "\r\n";
        EXPECT_EQ(client.get("/scenes/volume/4/3/5.rgba" + query, known).value().status, 304u);
        EXPECT_EQ(
            client.get("/scenes/volume/4/3/5.rgba?slice=" + std::to_string(slice + 1), known).value().status,
            200u);
    }
}

TEST_F(PatternPages, SlicesThatRepeatAreOnePageWithOneAddress) {
    const std::string base = "/scenes/volume/r0-" + load_scene(folder->path / "volume").value()->fingerprint;
    const Reply second = client.get("/scenes/volume/4/3/5.png?slice=2").value();
    for (const char* same : {"6", "-2", "-1099511627774"}) {
        EXPECT_EQ(client.get("/scenes/volume/4/3/5.png?slice=" + std::string{same}).value()["etag"],
                  second["etag"]);
        const Reply moved = client.get(base + "/4/3/5.png?slice=" + same).value();
        EXPECT_EQ(moved.status, 308u) << same;
        EXPECT_EQ(moved["location"], base + "/4/3/5.png?slice=2");
    }
    const Reply pinned = client.get(base + "/4/3/5.png?slice=2").value();
    EXPECT_EQ(pinned.status, 200u);
    EXPECT_EQ(pinned["cache-control"], "public, max-age=31536000, immutable");
    EXPECT_EQ(client.get(base + "/4/3/5.png?slice=0").value()["location"], base + "/4/3/5.png");
    EXPECT_EQ(client.get(base + "/4/3/5.png?slice=4&gutter=2").value()["location"],
              base + "/4/3/5.png?gutter=2");
    // A flat scene is the same in every slice
    EXPECT_EQ(client.get("/scenes/flat/4/3/5.png?slice=77").value()["etag"],
              client.get("/scenes/flat/4/3/5.png").value()["etag"]);
    for (const char* wrong : {"", "x", "1.5", "01", "-0", "1099511627777"})
        EXPECT_EQ(client.get("/scenes/volume/4/3/5.png?slice=" + std::string{wrong}).value().status, 400u)
            << wrong;
}

TEST_F(PatternPages, CellsInThreeDimensionsNeverRepeat) {
    std::set<std::string> tags;
    for (int slice = -40; slice < 40; slice += 4)
        EXPECT_TRUE(
            tags.insert(client.get("/scenes/deep/4/3/5.png?slice=" + std::to_string(slice)).value()["etag"])
                .second);
    const auto slices_of = [&](const std::string& id) {
        std::string text = client.get("/scenes/" + id).value().body;
        std::erase_if(text, [](char c) { return c == ' ' || c == '\n'; });
        return text;
    };
    EXPECT_THAT(slices_of("deep"), HasSubstr("\"slices\":0"));
    EXPECT_THAT(slices_of("volume"), HasSubstr("\"slices\":4"));
    EXPECT_THAT(slices_of("flat"), HasSubstr("\"slices\":1"));
    EXPECT_THAT(slices_of("flat"), HasSubstr("\"texture\":\"pattern\""));
}

TEST_F(PatternPages, BrokenScenesAreListedAndTheOthersServed) {
    const std::string list = client.get("/scenes").value().body;
    for (const char* problem : {"round/scene.json: pattern", "a -\\u003e b -\\u003e a",
                                "none/scene.json: pattern.blocks[0] \\\"cells\\\".cell_texels: is 0",
                                "beyond/scene.json: pattern.blocks[2] \\\"shown\\\".index",
                                "many/scene.json: pattern.blocks: holds 10001 blocks; at most 4096"})
        EXPECT_THAT(list, HasSubstr(problem));
    EXPECT_EQ(client.get("/scenes/round/4/0/0.png").value().status, 404u);
    EXPECT_EQ(client.get("/scenes/flat/4/0/0.png").value().status, 200u);
}

}  // namespace
}  // namespace tessera
