#include "server/http/descriptions.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "proto/page.pb.h"

#include "shared/wire/json.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

class Descriptions : public testing::Test {
  protected:
    ScenePtr scene(const std::string& id, const std::string& text) {
        std::filesystem::create_directories(folder_.path / id);
        std::ofstream{folder_.path / id / "scene.json"} << text;
        return load_scene(folder_.path / id).value();
    }
    proto::TileJson tiles(const std::string& text) {
        proto::TileJson message;
        EXPECT_TRUE(read_json(describe_tiles(*scene("a", text), "http://here"), "here", message));
        return message;
    }

    tests::TemporaryFolder folder_;
};

TEST_F(Descriptions, TellTheOpeningViewInTexelsAndAsACenterOfTheSquareWorld) {
    const proto::TileJson seen =
        tiles(R"({"constant": {}, "extent_log2_pages": 4, "view": {"x": 1024, "y": 3072, "level": 1.6}})");
    EXPECT_EQ(seen.tessera().view().x(), 1024);
    EXPECT_EQ(seen.tessera().view().y(), 3072);
    EXPECT_EQ(seen.tessera().view().level(), 1.6);
    ASSERT_EQ(seen.center_size(), 3);
    EXPECT_EQ(seen.center(0), -90);
    EXPECT_NEAR(seen.center(1), -66.51326044311186, 1e-9);  // three quarters down
    EXPECT_EQ(seen.center(2), 2);
}

TEST_F(Descriptions, SendAVisitorToTheMiddleWhereTheSceneSaysNothing) {
    const proto::TileJson seen = tiles(R"({"constant": {}, "extent_log2_pages": 4})");
    EXPECT_FALSE(seen.tessera().has_view());
    EXPECT_THAT(seen.center(), testing::ElementsAre(0, 0, 3));
}

TEST_F(Descriptions, KeepTheCenterOfACloseOrAFarViewAmongTheZoomsThereAre) {
    for (const auto& [level, zoom] : {std::pair{"-6", 4}, {"-0.4", 4}, {"0.4", 4}, {"4", 0}}) {
        const proto::TileJson seen = tiles(R"({"constant": {}, "extent_log2_pages": 4, "view": {"level": )" +
                                           std::string{level} + "}}");
        EXPECT_EQ(seen.center(2), zoom) << level;
    }
}

TEST_F(Descriptions, ListTheOpeningViewOfASceneThatNamesOne) {
    Catalog catalog;
    catalog.scenes.emplace("near",
                           scene("near", R"({"constant": {}, "view": {"x": 7, "y": 9, "level": 0}})"));
    catalog.scenes.emplace("plain", scene("plain", R"({"constant": {}})"));
    proto::SceneList list;
    ASSERT_TRUE(read_json(describe_scenes(catalog), "here", list));
    EXPECT_EQ(list.scenes(0).view().x(), 7);
    EXPECT_FALSE(list.scenes(1).has_view());
}

}  // namespace
}  // namespace tessera
