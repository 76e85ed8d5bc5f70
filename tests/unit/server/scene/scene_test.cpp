#include "server/scene/scene.h"

#include <fstream>
#include <map>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/scene/asset_file.h"
#include "tests/support/synthetic_asset.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SceneFolders : public testing::Test {
  protected:
    fs::path scene(const std::string& id, const std::string& json) {
        const fs::path folder = folder_.path / id;
        fs::create_directories(folder);
        std::ofstream{folder / "scene.json"} << json;
        return folder;
    }

    tests::TemporaryFolder folder_;
};

TEST_F(SceneFolders, AFolderWithASceneFileIsAScene) {
    const auto loaded =
        load_scene(scene("board", R"({"title": "A board", "extent_log2_pages": 9, "checker": {}})"));
    ASSERT_TRUE(loaded.has_value()) << loaded.error().detail;
    EXPECT_EQ((*loaded)->id, "board");
    EXPECT_EQ((*loaded)->title, "A board");
    EXPECT_EQ((*loaded)->extent.n, 9);
    EXPECT_EQ((*loaded)->texture->kind(), "checker");
    EXPECT_EQ((*loaded)->fingerprint.size(), 16u);
}

TEST_F(SceneFolders, AFolderOfScenesIsToldFromAScene) {
    const fs::path inside = scene("board", R"({"checker": {}})");
    fs::create_directories(folder_.path / "empty");
    EXPECT_EQ(
        load_scene(folder_.path).error().detail,
        folder_.path.string() + ": is a folder of scenes; name one of them, such as " + inside.string());
    EXPECT_EQ(load_scene(folder_.path / "empty").error().detail,
              (folder_.path / "empty").string() + ": holds no scene.json, so it is no scene");
}

TEST_F(SceneFolders, TheExtentIsTwentyUnlessTheSceneSaysOtherwise) {
    EXPECT_EQ((*load_scene(scene("a", R"({"constant": {"color": {"red": 9}}})")))->extent.n, 20);
    EXPECT_EQ((*load_scene(scene("b", R"({"constant": {}, "extent_log2_pages": 30})")))->extent.n, 30);
}

TEST_F(SceneFolders, AnOpeningViewHasDefaultsAndLiesInsideTheExtent) {
    const auto view_of = [&](const std::string& view) {
        return load_scene(scene("a", R"({"constant": {}, "extent_log2_pages": 2, "view": )" + view + "}"));
    };
    EXPECT_EQ((*load_scene(scene("a", R"({"constant": {}})")))->view, std::nullopt);
    EXPECT_EQ((*view_of("{}"))->view, (OpeningView{512, 512, 1}));
    EXPECT_EQ((*view_of(R"({"x": 0, "y": "1023", "level": -2.5})"))->view, (OpeningView{0, 1023, -2.5}));

    const auto problem = [&](const std::string& view) { return view_of(view).error().detail; };
    EXPECT_THAT(problem(R"({"x": 1024})"),
                HasSubstr("scene.json: view.x: is 1024; texels of this scene are 0 to 1023"));
    EXPECT_THAT(problem(R"({"y": -1})"), HasSubstr("view.y: is -1; texels of this scene are 0 to 1023"));
    EXPECT_THAT(problem(R"({"level": 2.5})"),
                HasSubstr("view.level: is 2.5; levels of this scene are -6 to 2"));
    EXPECT_THAT(problem(R"({"level": "NaN"})"), HasSubstr("view.level: is nan"));
    EXPECT_THAT(problem(R"({"zoom": 2})"), HasSubstr("zoom"));
}

TEST_F(SceneFolders, TheFingerprintCoversSceneFileAndAssetsAndNothingElse) {
    const std::string json = R"({"content_exchange": {"asset": "asset"}})";
    std::vector<std::string> prints;
    for (const std::uint64_t seed : {1u, 1u, 2u}) {
        const fs::path folder = scene("scene" + std::to_string(prints.size()), json);
        ASSERT_TRUE(write_exchange_asset(folder / "asset", tests::make_synthetic_asset({.seed = seed}), {}));
        const auto loaded = load_scene(folder);
        ASSERT_TRUE(loaded.has_value()) << loaded.error().detail;
        prints.push_back((*loaded)->fingerprint);
    }
    EXPECT_EQ(prints[0], prints[1]) << "the folder's name and times do not count";
    EXPECT_NE(prints[0], prints[2]) << "another asset, other pages";
    fs::create_directories(folder_.path / "scene0" / ".edits" / "scene0");
    std::ofstream{folder_.path / "scene0" / ".edits" / "scene0" / "journal.db"} << "edits";
    EXPECT_EQ((*load_scene(folder_.path / "scene0"))->fingerprint, prints[0])
        << "its journal is not the scene";
    const fs::path changed = scene("scene0", R"({"content_exchange": {"asset": "asset", "seed": 5}})");
    EXPECT_NE((*load_scene(changed))->fingerprint, prints[0]);
}

TEST_F(SceneFolders, TheFingerprintNamesTheBytesThatWereCompiledHoweverTheyChange) {
    // Two states of one scene, swapped all the time while it is loaded: whichever is loaded, its pages are
    // its own
    const std::string states[2] = {R"({"constant": {"color": {"red": 10}}})",
                                   R"({"constant": {"color": {"red": 200}}})"};
    std::map<std::string, std::uint8_t> red_of;
    const auto red = [](const Scene& scene) {
        Rgba8Image texel;
        EXPECT_TRUE(scene.texture->evaluate({0, 0, 0, 1, 1}, Budget{}, texel).has_value());
        return texel.bytes[0];
    };
    fs::path folder;
    for (const std::string& state : states) {
        folder = scene("swapped", state);
        const auto loaded = load_scene(folder);
        ASSERT_TRUE(loaded.has_value());
        red_of[(*loaded)->fingerprint] = red(**loaded);
    }
    ASSERT_EQ(red_of.size(), 2u);
    const std::jthread swapper{[&](std::stop_token stop) {
        for (int i = 0; !stop.stop_requested(); ++i) {
            std::ofstream{folder_.path / "next"} << states[i % 2];
            fs::rename(folder_.path / "next", folder / "scene.json");
        }
    }};
    int loads = 0;
    for (int attempt = 0; attempt < 300; ++attempt)
        if (const auto loaded = load_scene(folder)) {
            ++loads;
            ASSERT_TRUE(red_of.contains((*loaded)->fingerprint));
            ASSERT_EQ(red(**loaded), red_of.at((*loaded)->fingerprint));
        }
    EXPECT_GT(loads, 0);
}

TEST_F(SceneFolders, ALinkThatLeadsNowhereIsNoReasonToFall) {
    const fs::path folder = scene("linked", R"({"checker": {}})");
    fs::create_symlink("loop", folder / "loop");
    fs::create_symlink("nowhere", folder / "dangling");
    EXPECT_TRUE(load_scene(folder).has_value());
}

TEST_F(SceneFolders, ASceneIsCalledAsItsEntryAlsoThroughALink) {
    for (const char* place : {"one", "two"}) scene(std::string{place} + "/rock", R"({"checker": {}})");
    fs::create_directories(folder_.path / "scenes");
    fs::create_directory_symlink(folder_.path / "one" / "rock", folder_.path / "scenes" / "a");
    fs::create_directory_symlink(folder_.path / "two" / "rock", folder_.path / "scenes" / "b");
    const auto catalog = load_catalog(folder_.path / "scenes");
    ASSERT_TRUE(catalog.has_value());
    EXPECT_NE(catalog->find("a"), nullptr);
    EXPECT_NE(catalog->find("b"), nullptr);
}

TEST_F(SceneFolders, AnAssetTooLargeForMemoryIsRefusedUnbuilt) {
    // Small on disk: a tile of 1024 in 16 patches whose boxes are half the tile, with 80 contents each
    ExchangeAsset asset = tests::make_synthetic_asset({.tile_side = 1024, .patches = 16, .contents = 2});
    for (auto& patch : asset.patches) {
        patch.width = patch.height = 512;
        patch.contents.assign(80, {{4, 4}, {}, {}, 0});
    }
    const fs::path folder = scene("huge", R"({"content_exchange": {"asset": "asset"}})");
    ASSERT_TRUE(write_exchange_asset(folder / "asset", asset, {}));
    const auto loaded = load_scene(folder);
    ASSERT_FALSE(loaded.has_value());
    EXPECT_THAT(loaded.error().detail, HasSubstr("content_exchange.asset"));
    EXPECT_THAT(loaded.error().detail, HasSubstr("MiB"));
}

TEST_F(SceneFolders, LoadingStopsWhenAskedTo) {
    scene("board", R"({"checker": {}})");
    std::stop_source stop;
    stop.request_stop();
    EXPECT_EQ(load_catalog(folder_.path, stop.get_token()).error().code, ErrorCode::cancelled);
}

TEST_F(SceneFolders, OneBrokenSceneDoesNotStopTheOthers) {
    scene("good", R"({"checker": {}})");
    scene("bad", R"({"checker": {"cell_texels": "wide"}})");
    fs::create_directories(folder_.path / "not-a-scene");
    const auto catalog = load_catalog(folder_.path);
    ASSERT_TRUE(catalog.has_value());
    EXPECT_NE(catalog->find("good"), nullptr);
    EXPECT_EQ(catalog->find("bad"), nullptr);
    ASSERT_EQ(catalog->broken.size(), 1u);
    EXPECT_EQ(catalog->broken[0].id, "bad");
    EXPECT_THAT(catalog->broken[0].message, HasSubstr("cell_texels"));
}

TEST_F(SceneFolders, AFolderThatIsItselfASceneIsACatalogOfOne) {
    const auto catalog = load_catalog(scene("only", R"({"checker": {}})"));
    ASSERT_TRUE(catalog.has_value());
    EXPECT_NE(catalog->find("only"), nullptr);
}

TEST_F(SceneFolders, AFolderThatIsNotThereIsAnError) {
    const auto catalog = load_catalog(folder_.path / "nowhere");
    ASSERT_FALSE(catalog.has_value());
    EXPECT_THAT(catalog.error().detail, HasSubstr("nowhere"));
}

struct Bad {
    const char* json;
    const char* says;  ///< Beside the file's name.
};

class BadScenes : public SceneFolders, public testing::WithParamInterface<Bad> {};

TEST_P(BadScenes, AreRefusedWithFileAndField) {
    const auto loaded = load_scene(scene("bad", GetParam().json));
    ASSERT_FALSE(loaded.has_value());
    EXPECT_EQ(loaded.error().code, ErrorCode::invalid_input);
    EXPECT_THAT(loaded.error().detail, HasSubstr("scene.json"));
    EXPECT_THAT(loaded.error().detail, HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadScenes,
    testing::Values(Bad{"", ""}, Bad{"{", ""}, Bad{"[1, 2]", ""}, Bad{"{}", "no texture"},
                    Bad{R"({"colour": 3})", "colour"}, Bad{R"({"checker": {"size": 3}})", "size"},
                    Bad{R"({"checker": {"cell_texels": -4}})", "cell_texels"},
                    Bad{R"({"checker": {"cell_texels": 2000000}})", "checker.cell_texels"},
                    Bad{R"({"checker": {"first": {"red": 256}}})", "checker.first"},
                    Bad{R"({"constant": {"color": {"red": 1, "alpha": 300}}})", "constant.color"},
                    Bad{R"({"extent_log2_pages": 31, "checker": {}})", "extent_log2_pages"},
                    Bad{R"({"checker": {}, "constant": {}})", ""},
                    Bad{R"({"content_exchange": {}})", "content_exchange.asset"},
                    Bad{R"({"content_exchange": {"asset": "/etc"}})", "content_exchange.asset"},
                    Bad{R"({"content_exchange": {"asset": "../other"}})", "leaves the scene's folder"},
                    Bad{R"({"content_exchange": {"asset": "a", "types": 100}})", "content_exchange.types"},
                    Bad{R"({"content_exchange": {"asset": "a", "choice": "sigma"}})", "choice"},
                    Bad{R"({"content_exchange": {"asset": "a", "choice": "kolar"}})",
                        R"(content_exchange.choice: "typed" or "independent")"},
                    Bad{R"({"interchange": {"asset": "a", "choice": "independent"}})",
                        R"(interchange.choice: "typed" or "kolar")"},
                    Bad{R"({"wang": {"asset": "a", "choice": "kolar"}})", R"(wang.choice: "typed" only)"},
                    Bad{R"({"wang": {"asset": "a", "types": 63}})", "wang.types: is 63; a power of two"},
                    Bad{R"({"interchange": {}})", "interchange.asset: is missing"}));

TEST_F(SceneFolders, EveryMethodIsAFieldOfItsOwn) {
    const std::vector<std::pair<std::string, ExchangeAsset>> methods{
        {"content_exchange", tests::make_synthetic_asset({})},
        {"interchange", tests::make_synthetic_interchange({})},
        {"wang", tests::make_synthetic_wang({})}};
    for (const auto& [field, asset] : methods)
        for (const auto& [other, unused] : methods) {
            const fs::path folder =
                scene("scene", "{\"" + other + R"(": {"asset": "asset", "seed": 3, "types": 64}})");
            ASSERT_TRUE(write_exchange_asset(folder / "asset", asset, {}));
            const auto loaded = load_scene(folder);
            if (field == other) {
                ASSERT_TRUE(loaded.has_value()) << loaded.error().detail;
                EXPECT_EQ((*loaded)->texture->kind(), field);
                EXPECT_TRUE((*loaded)->channels.empty());
            } else {
                ASSERT_FALSE(loaded.has_value());
                EXPECT_THAT(loaded.error().detail,
                            HasSubstr("scene.json: " + other + ".asset: \"asset\" was prepared for " + field +
                                      "; name the field so"));
            }
        }
}

TEST_F(SceneFolders, TheChoiceOfTheMethodsOwnPaperIsThereToCompare) {
    const fs::path folder = scene("kolar", R"({"interchange": {"asset": "asset", "choice": "kolar"}})");
    ExchangeAsset asset = tests::make_synthetic_interchange({.patches = 60});
    ASSERT_TRUE(write_exchange_asset(folder / "asset", asset, {}));
    const auto loaded = load_scene(folder);
    ASSERT_TRUE(loaded.has_value()) << loaded.error().detail;
    for (auto& patch : asset.patches) patch.set = ExchangeAsset::Set::none;
    ASSERT_TRUE(write_exchange_asset(folder / "asset", asset, {}));
    EXPECT_THAT(load_scene(folder).error().detail,
                HasSubstr("interchange.choice: \"kolar\" needs patches of both sets"));
}

TEST_F(SceneFolders, AlignedImagesBecomeChannelSets) {
    ExchangeAsset asset = tests::make_synthetic_asset({});
    asset.channels = {{"height", asset.exemplar, asset.tile}, {"normal", asset.exemplar, asset.tile}};
    const fs::path folder = scene("surface", R"({"content_exchange": {"asset": "asset", "types": 64}})");
    ASSERT_TRUE(write_exchange_asset(folder / "asset", asset, {}));
    const auto loaded = load_scene(folder);
    ASSERT_TRUE(loaded.has_value()) << loaded.error().detail;
    EXPECT_EQ((*loaded)->channel_names(), "albedo, normal, height, moments");
    EXPECT_NE((*loaded)->texture_of(ChannelSet::height), nullptr);
    EXPECT_EQ((*loaded)->texture_of(ChannelSet::roughness), nullptr);
}

TEST_F(SceneFolders, ALinkThatLeavesTheFolderIsRefused) {
    const fs::path folder = scene("linked", R"({"content_exchange": {"asset": "asset"}})");
    fs::create_directories(folder_.path / "elsewhere");
    fs::create_directory_symlink(folder_.path / "elsewhere", folder / "asset");
    const auto loaded = load_scene(folder);
    ASSERT_FALSE(loaded.has_value());
    EXPECT_THAT(loaded.error().detail, HasSubstr("leaves the scene's folder"));
}

TEST_F(SceneFolders, AnAssetThatIsNotThereIsNamed) {
    const auto loaded = load_scene(scene("bare", R"({"content_exchange": {"asset": "asset"}})"));
    ASSERT_FALSE(loaded.has_value());
    EXPECT_THAT(loaded.error().detail, HasSubstr("asset.json"));
}

TEST_F(SceneFolders, AHugeSceneFileIsRefusedUnread) {
    const fs::path folder = scene("huge", std::string((8 << 20) + 1, ' '));
    const auto loaded = load_scene(folder);
    ASSERT_FALSE(loaded.has_value());
    EXPECT_THAT(loaded.error().detail, HasSubstr("larger than 8 MiB"));
}

}  // namespace
}  // namespace tessera
