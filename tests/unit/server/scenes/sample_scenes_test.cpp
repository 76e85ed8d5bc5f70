#include "server/scenes/sample_scenes.h"

#include <fstream>

#include <gtest/gtest.h>

#include "server/progress/progress.h"
#include "server/scene/image_file.h"
#include "server/scene/scene.h"
#include "server/scenes/paint_pebbles.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

void write_photo(const fs::path& file, std::uint64_t seed) {
    const auto written = write_rgb_png(file, paint_pebbles(128, seed));
    ASSERT_TRUE(written) << written.error().detail;
}

TEST(Samples, AreFoundByName) {
    for (const Sample& sample : all_samples()) EXPECT_EQ(find_sample(sample.name)->title, sample.title);
    EXPECT_NE(find_sample("pebbles"), nullptr);
    EXPECT_EQ(find_sample("pebble"), nullptr);
}

TEST(Samples, PatternsLoadAndAreKeptTheSecondTime) {
    const tests::TemporaryFolder temporary;
    SilentProgress progress;
    for (const char* name : {"constant", "checker"}) {
        const Sample& sample = *find_sample(name);
        EXPECT_EQ(make_sample(sample, temporary.path, "", false, progress).value(), Made::written);
        EXPECT_EQ(make_sample(sample, temporary.path, "", false, progress).value(), Made::kept);
        EXPECT_EQ(make_sample(sample, temporary.path, "", true, progress).value(), Made::written);
        const auto scene = load_scene(temporary.path / name);
        ASSERT_TRUE(scene) << scene.error().detail;
        EXPECT_EQ((*scene)->title, sample.title);
    }
}

TEST(Samples, ABrokenFolderIsMadeAgain) {
    const tests::TemporaryFolder temporary;
    SilentProgress progress;
    fs::create_directory(temporary.path / "checker");
    std::ofstream{temporary.path / "checker" / "scene.json"} << "{";
    EXPECT_EQ(make_sample(*find_sample("checker"), temporary.path, "", false, progress).value(),
              Made::written);
    EXPECT_TRUE(load_scene(temporary.path / "checker"));
}

TEST(Samples, ASampleWithoutItsPhotographNamesTheFile) {
    const tests::TemporaryFolder temporary;
    SilentProgress progress;
    const auto made =
        make_sample(*find_sample("coffee"), temporary.path, temporary.path / "photos", false, progress);
    ASSERT_FALSE(made);
    EXPECT_NE(made.error().detail.find("coffee.jpg"), std::string::npos);
}

TEST(PhotoScene, ShowsThePhotographUnderItsName) {
    const tests::TemporaryFolder temporary;
    SilentProgress progress;
    const fs::path photo = temporary.path / "my garden.png", scenes = temporary.path / "scenes";
    write_photo(photo, 1);
    const auto made = make_photo_scene(photo, scenes, false, progress);
    ASSERT_TRUE(made) << made.error().detail;
    EXPECT_EQ(*made, Made::written);
    const auto scene = load_scene(scenes / "my-garden");
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_EQ((*scene)->id, "my-garden");
}

TEST(PhotoScene, IsKeptForTheSamePictureAndMadeAgainForAnother) {
    const tests::TemporaryFolder temporary;
    SilentProgress progress;
    const fs::path photo = temporary.path / "a.png", scenes = temporary.path / "scenes";
    write_photo(photo, 1);
    EXPECT_EQ(make_photo_scene(photo, scenes, false, progress).value(), Made::written);
    const std::string before = load_scene(scenes / "a").value()->fingerprint;
    EXPECT_EQ(make_photo_scene(photo, scenes, false, progress).value(), Made::kept);
    EXPECT_EQ(make_photo_scene(photo, scenes, true, progress).value(), Made::written);
    EXPECT_EQ(load_scene(scenes / "a").value()->fingerprint, before);
    write_photo(photo, 2);
    EXPECT_EQ(make_photo_scene(photo, scenes, false, progress).value(), Made::written);
    EXPECT_NE(load_scene(scenes / "a").value()->fingerprint, before);
}

TEST(PhotoScene, AFileThatIsNoImageIsAnErrorThatNamesIt) {
    const tests::TemporaryFolder temporary;
    SilentProgress progress;
    const fs::path photo = temporary.path / "notes.jpg";
    std::ofstream{photo} << "these are not the texels you are looking for";
    const auto made = make_photo_scene(photo, temporary.path / "scenes", false, progress);
    ASSERT_FALSE(made);
    EXPECT_NE(made.error().detail.find("notes.jpg"), std::string::npos);
    EXPECT_FALSE(fs::exists(temporary.path / "scenes" / "notes"));
}

}  // namespace
}  // namespace tessera
