#include "server/scenes/scene_folder.h"

#include <fstream>

#include <gtest/gtest.h>

#include "proto/scene.pb.h"

#include "server/files/whole_file.h"
#include "server/scene/scene.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

proto::Scene constant_scene(std::uint32_t red) {
    proto::Scene scene;
    scene.set_title("One colour");
    scene.mutable_constant()->mutable_color()->set_red(red);
    return scene;
}

TEST(SceneIdOf, KeepsAPlainNameAsItIs) {
    EXPECT_EQ(scene_id_of("/photos/IMG_2041.JPG"), "IMG_2041");
    EXPECT_EQ(scene_id_of("brick-wall.v2.png"), "brick-wall.v2");
}

TEST(SceneIdOf, ReplacesWhatAnIdMayNotHold) {
    EXPECT_EQ(scene_id_of("my garden (2).jpeg"), "my-garden-2");
    EXPECT_EQ(scene_id_of("Fußboden.jpg"), "Fu-boden");
    EXPECT_EQ(scene_id_of("/a/..hidden.jpg"), "hidden");
    EXPECT_EQ(scene_id_of("a%2f<b>.png"), "a-2f-b");
}

TEST(SceneIdOf, IsNeverEmptyAndNeverLong) {
    EXPECT_EQ(scene_id_of("写真.jpg"), "photo");
    EXPECT_EQ(scene_id_of(""), "photo");
    EXPECT_EQ(scene_id_of(std::string(300, 'x') + ".jpg"), std::string(64, 'x'));
}

TEST(NumberedId, IsAPlainIdForTheFirstAndNeverLong) {
    EXPECT_EQ(numbered_id("wall", 1), "wall");
    EXPECT_EQ(numbered_id("wall", 2), "wall-2");
    EXPECT_EQ(numbered_id(std::string(64, 'x'), 10), std::string(61, 'x') + "-10");
}

TEST(SceneFolder, WritesASceneThatLoads) {
    const tests::TemporaryFolder temporary;
    ASSERT_TRUE(write_scene_folder(temporary.path / "plain", constant_scene(7), nullptr));
    const auto scene = load_scene(temporary.path / "plain");
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_EQ((*scene)->id, "plain");
    EXPECT_EQ((*scene)->title, "One colour");
    EXPECT_TRUE(holds_valid_scene(temporary.path / "plain"));
}

TEST(SceneFolder, ReplacesASceneAndLeavesNothingElseBehind) {
    const tests::TemporaryFolder temporary;
    ASSERT_TRUE(write_scene_folder(temporary.path / "plain", constant_scene(7), nullptr));
    const std::string before = (*load_scene(temporary.path / "plain"))->fingerprint;
    ASSERT_TRUE(write_scene_folder(temporary.path / "plain", constant_scene(8), nullptr));
    EXPECT_NE((*load_scene(temporary.path / "plain"))->fingerprint, before);
    EXPECT_EQ(std::distance(fs::directory_iterator{temporary.path}, fs::directory_iterator{}), 1);
}

TEST(SceneFolder, LeavesAnotherOnesUnfinishedFolderAlone) {
    const tests::TemporaryFolder temporary;
    fs::create_directory(temporary.path / ".plain.unfinished");
    ASSERT_TRUE(write_scene_folder(temporary.path / "plain", constant_scene(7), nullptr));
    EXPECT_TRUE(fs::exists(temporary.path / ".plain.unfinished"));
    const auto catalog = load_catalog(temporary.path);
    ASSERT_TRUE(catalog) << catalog.error().detail;
    EXPECT_EQ(catalog->scenes.size(), 1U);
    EXPECT_TRUE(catalog->broken.empty());
}

TEST(SceneFolder, TheSceneFileSaysOnlyWhatIsSet) {
    const tests::TemporaryFolder temporary;
    ASSERT_TRUE(write_scene_folder(temporary.path / "plain", constant_scene(7), nullptr));
    const std::string text = read_whole_file(temporary.path / "plain" / "scene.json", 1000).value();
    EXPECT_NE(text.find("title"), std::string::npos);
    EXPECT_EQ(text.find("extent_log2_pages"), std::string::npos) << text;
    EXPECT_EQ(text.find("attribution"), std::string::npos) << text;
}

TEST(SceneFolder, RefusesToReplaceAFolderThatIsNoScene) {
    const tests::TemporaryFolder temporary;
    fs::create_directory(temporary.path / "letters");
    std::ofstream{temporary.path / "letters" / "dear.txt"} << "kept";
    const auto written = write_scene_folder(temporary.path / "letters", constant_scene(7), nullptr);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::invalid_input);
    EXPECT_TRUE(fs::exists(temporary.path / "letters" / "dear.txt"));
}

TEST(SceneFolder, SaysWhereItCouldNotWrite) {
    const tests::TemporaryFolder temporary;
    std::ofstream{temporary.path / "file"} << "not a folder";
    const auto written = write_scene_folder(temporary.path / "file" / "scene", constant_scene(7), nullptr);
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().detail.find("file"), std::string::npos);
}

TEST(SceneFolder, ABrokenSceneIsNotValid) {
    const tests::TemporaryFolder temporary;
    EXPECT_FALSE(holds_valid_scene(temporary.path / "absent"));
    std::ofstream{temporary.path / "scene.json"} << "{\"constant\": 3}";
    EXPECT_FALSE(holds_valid_scene(temporary.path));
}

}  // namespace
}  // namespace tessera
