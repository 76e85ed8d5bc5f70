#include "server/history/places.h"

#include <fstream>

#include <gmock/gmock.h>

#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class Places : public testing::Test {
  protected:
    void SetUp() override {
        fs::create_directories(scenes / "wall");
        std::ofstream{scenes / "wall" / "scene.json"} << "{}";
    }
    const tests::TemporaryFolder folder;
    const fs::path scenes = folder.path / "scenes";
};

TEST_F(Places, ASceneIsNamedByItsFolderOrInTheFolderOfScenes) {
    for (const auto& places :
         {find_scene((scenes / "wall").string(), {}, {}), find_scene((scenes / "wall" / "").string(), {}, {}),
          find_scene("wall", scenes, {}), find_scene("wall", scenes / "wall", {})}) {
        ASSERT_TRUE(places);
        EXPECT_EQ(places->id, "wall");
        EXPECT_EQ(places->journal, scenes / ".edits" / "wall");
    }
    EXPECT_EQ(find_scene("wall", scenes, "/elsewhere").value().journal, "/elsewhere/wall");
}

TEST_F(Places, ASceneServedAloneHasItsEditsInside) {
    fs::create_directories(scenes / "wall" / ".edits" / "wall");
    EXPECT_EQ(find_scene("wall", scenes, {}).value().journal, scenes / "wall" / ".edits" / "wall");
    fs::create_directories(scenes / ".edits" / "wall");
    EXPECT_THAT(find_scene("wall", scenes, {}).error().detail, HasSubstr("--edits"));
}

TEST_F(Places, WhatIsNoSceneIsSaidSo) {
    EXPECT_THAT(find_scene("floor", scenes, {}).error().detail, HasSubstr("is no scene"));
    EXPECT_THAT(find_scene("wall", {}, {}).error().detail, HasSubstr("--scenes"));
    EXPECT_THAT(find_scene("floor", scenes / "wall", {}).error().detail, HasSubstr("not floor"));
}

}  // namespace
}  // namespace tessera
