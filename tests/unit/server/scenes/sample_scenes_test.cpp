#include "server/scenes/sample_scenes.h"

#include <algorithm>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "server/files/whole_file.h"
#include "server/progress/progress.h"
#include "server/scene/asset_file.h"
#include "server/scene/image_file.h"
#include "server/scene/scene.h"
#include "server/scenes/paint_pebbles.h"
#include "server/scenes/scene_folder.h"
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
    const auto made = make_photo_scene(photo, scenes, {}, progress);
    ASSERT_TRUE(made) << made.error().detail;
    EXPECT_EQ(made->made, Made::written);
    EXPECT_EQ(made->id, "my-garden");
    const auto scene = load_scene(scenes / "my-garden");
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_EQ((*scene)->id, "my-garden");
}

/// Makes the scene, and says "ID written" or "ID kept"; or what went wrong.
std::string outcome(const fs::path& photo, const fs::path& scenes, bool force = false) {
    SilentProgress progress;
    const auto made =
        make_photo_scene(photo, scenes, {.prepare = {}, .limits = {}, .force = force}, progress);
    if (!made) return made.error().detail;
    return made->id + (made->made == Made::kept ? " kept" : " written");
}

void write_text(const fs::path& file, const std::string& text) { std::ofstream{file} << text; }

TEST(PhotoScene, IsCalledWhatItsPhotographIs) {
    const tests::TemporaryFolder temporary;
    const fs::path scenes = temporary.path / "scenes";
    const std::pair<const char*, const char*> called[] = {{"Mein Föto (1).png", "Mein Föto (1)"},
                                                          {"\xff\xfe.png", "photo"},  // bytes, and no text
                                                          {"two\nlines.png", "two-lines"}};
    for (const auto& [file, title] : called) {
        const fs::path photo = temporary.path / file;
        write_photo(photo, 1);
        const std::string id = scene_id_of(photo);
        EXPECT_EQ(outcome(photo, scenes, true), id + " written");
        EXPECT_EQ(load_scene(scenes / id).value()->title, title);
        fs::remove_all(scenes / id);
    }
}

TEST(PhotoScene, EveryPictureOfANameHasItsOwnScene) {
    const tests::TemporaryFolder temporary;
    const fs::path photo = temporary.path / "wall.png", scenes = temporary.path / "scenes";
    write_photo(photo, 1);
    EXPECT_EQ(outcome(photo, scenes), "wall written");
    const std::string first = load_scene(scenes / "wall").value()->fingerprint;
    write_photo(photo, 2);
    EXPECT_EQ(outcome(photo, scenes), "wall-2 written");
    EXPECT_EQ(outcome(photo, scenes), "wall-2 kept");
    EXPECT_EQ(load_scene(scenes / "wall").value()->fingerprint, first);
    EXPECT_EQ(load_scene(scenes / "wall-2").value()->title, "wall-2");
    write_photo(photo, 1);
    EXPECT_EQ(outcome(photo, scenes), "wall kept");
    // Also when the name before it has become free
    fs::remove_all(scenes / "wall");
    write_photo(photo, 2);
    EXPECT_EQ(outcome(photo, scenes), "wall-2 kept");
}

TEST(PhotoScene, KeepsWhatAPersonWroteUnlessForced) {
    const tests::TemporaryFolder temporary;
    const fs::path photo = temporary.path / "wall.png", scenes = temporary.path / "scenes";
    const fs::path file = scenes / "wall" / "scene.json";
    write_photo(photo, 1);
    EXPECT_EQ(outcome(photo, scenes), "wall written");
    const std::string made = load_scene(scenes / "wall").value()->fingerprint;

    write_text(file, R"({"title": "Our wall", "content_exchange": {"asset": "asset", "seed": 9}})");
    EXPECT_EQ(outcome(photo, scenes), "wall kept");
    EXPECT_EQ(load_scene(scenes / "wall").value()->title, "Our wall");
    write_text(file, R"({"titel": "Our wall"})");
    EXPECT_NE(outcome(photo, scenes).find("titel"), std::string::npos);
    EXPECT_NE(outcome(photo, scenes).find("--force"), std::string::npos);
    EXPECT_EQ(read_whole_file(file, 1000).value(), R"({"titel": "Our wall"})");

    EXPECT_EQ(outcome(photo, scenes, true), "wall written");
    EXPECT_EQ(load_scene(scenes / "wall").value()->fingerprint, made);
}

/// Writes the scene's asset again, changed, and as if another version had prepared it.
void make_outdated(const fs::path& asset_folder, const std::function<void(ExchangeAsset&)>& change) {
    auto asset = read_exchange_asset(asset_folder);
    auto made = read_preparation(asset_folder);
    ASSERT_TRUE(asset && made);
    change(*asset);
    made->version = prepare_version - 1;
    ASSERT_TRUE(write_exchange_asset(asset_folder, *asset, *made));
}

TEST(PhotoScene, IsPreparedAgainWhenThePreparationHasChanged) {
    const tests::TemporaryFolder temporary;
    const fs::path photo = temporary.path / "wall.png", scenes = temporary.path / "scenes";
    const fs::path asset = scenes / "wall" / "asset";
    write_photo(photo, 1);
    EXPECT_EQ(outcome(photo, scenes), "wall written");
    const std::string made = load_scene(scenes / "wall").value()->fingerprint;
    make_outdated(asset, [](ExchangeAsset& old) { old.patches[0].contents.resize(1); });
    EXPECT_EQ(outcome(photo, scenes), "wall written");
    EXPECT_EQ(outcome(photo, scenes), "wall kept");
    EXPECT_EQ(load_scene(scenes / "wall").value()->fingerprint, made)
        << "all is as if it had been made today";

    // What a person said and wrote stays
    write_text(scenes / "wall" / "scene.json",
               R"({"title": "Our wall", "content_exchange": {"asset": "asset"}})");
    make_outdated(asset, [](ExchangeAsset& old) {
        old.patches[1].contents[0].standing = ExchangeAsset::Standing::dropped;
        old.patches[2].contents[0].standing = ExchangeAsset::Standing::pinned;
    });
    const auto before = read_exchange_asset(asset);
    EXPECT_EQ(outcome(photo, scenes), "wall written");
    EXPECT_EQ(load_scene(scenes / "wall").value()->title, "Our wall");
    const auto after = read_exchange_asset(asset);
    ASSERT_TRUE(before && after);
    const auto has = [&](std::size_t patch, ExchangeAsset::Standing standing) {
        const auto& wanted = before->patches[patch].contents[0];
        return std::ranges::any_of(after->patches[patch].contents, [&](const auto& content) {
            return content.at == wanted.at && content.standing == standing;
        });
    };
    EXPECT_TRUE(has(1, ExchangeAsset::Standing::dropped));
    EXPECT_TRUE(has(2, ExchangeAsset::Standing::pinned));
}

TEST(PhotoScene, EveryMethodHasASceneOfItsOwn) {
    const tests::TemporaryFolder temporary;
    SilentProgress progress;
    const fs::path photo = temporary.path / "wall.png", scenes = temporary.path / "scenes";
    write_photo(photo, 1);
    for (const ExchangeMethod method :
         {ExchangeMethod::content_exchange, ExchangeMethod::interchange, ExchangeMethod::wang}) {
        PhotoSceneOptions options;
        options.prepare.method = method;
        options.prepare.tile_side = 64;
        options.prepare.patches = 16;
        const std::string name{method_name(method)};
        for (const Made expected : {Made::written, Made::kept}) {
            const auto made = make_photo_scene(photo, scenes, options, progress);
            ASSERT_TRUE(made) << made.error().detail;
            EXPECT_EQ(made->id, method == ExchangeMethod::content_exchange ? "wall" : "wall-" + name);
            EXPECT_EQ(made->made, expected);
        }
        const auto scene = load_scene(scenes / scene_id_of(photo, method));
        ASSERT_TRUE(scene) << scene.error().detail;
        EXPECT_EQ((*scene)->texture->kind(), name);
    }
}

TEST(PhotoScene, LeavesOtherFoldersAndTheNamesOfSamplesAlone) {
    const tests::TemporaryFolder temporary;
    const fs::path scenes = temporary.path / "scenes";
    fs::create_directories(scenes / "letters");
    write_text(scenes / "letters" / "dear.txt", "kept");
    write_photo(temporary.path / "letters.png", 1);
    EXPECT_EQ(outcome(temporary.path / "letters.png", scenes, true), "letters-2 written");
    EXPECT_TRUE(fs::exists(scenes / "letters" / "dear.txt"));
    write_photo(temporary.path / "leaf.png", 1);
    EXPECT_EQ(outcome(temporary.path / "leaf.png", scenes), "leaf-2 written");
}

TEST(Samples, AScenesOwnerMayChangeItAlsoWhereItIsAPhotographs) {
    const tests::TemporaryFolder temporary;
    SilentProgress progress;
    fs::create_directory(temporary.path / "coffee");
    write_text(temporary.path / "coffee" / "scene.json", R"({"title": "Mine", "checker": {}})");
    const auto made = make_sample(*find_sample("coffee"), temporary.path, "no photographs", false, progress);
    ASSERT_TRUE(made) << made.error().detail;
    EXPECT_EQ(*made, Made::kept);
    EXPECT_EQ(load_scene(temporary.path / "coffee").value()->title, "Mine");
}

TEST(PhotoScene, AFileThatIsNoImageIsAnErrorThatNamesIt) {
    const tests::TemporaryFolder temporary;
    SilentProgress progress;
    const fs::path photo = temporary.path / "notes.jpg";
    std::ofstream{photo} << "these are not the texels you are looking for";
    const auto made = make_photo_scene(photo, temporary.path / "scenes", {}, progress);
    ASSERT_FALSE(made);
    EXPECT_NE(made.error().detail.find("notes.jpg"), std::string::npos);
    EXPECT_FALSE(fs::exists(temporary.path / "scenes" / "notes"));
}

}  // namespace
}  // namespace tessera
