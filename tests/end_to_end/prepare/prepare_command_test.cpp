// The commands `prepare` and `report` as a person runs them.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include <gmock/gmock.h>

#include "server/scene/asset_file.h"
#include "tests/end_to_end/prepare/prepare_runs.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* small = " --tile 32 --patches 16 --contents 4 --blend 4 -q";

class PrepareCommand : public PrepareRuns {
  protected:
    void SetUp() override { write_photo("photo.png", 120, 100); }

    ExchangeAsset asset(const char* name = "asset") const {
        auto read = read_exchange_asset(folder_ / name);
        EXPECT_TRUE(read) << read.error().detail;
        return read ? std::move(*read) : ExchangeAsset{};
    }

    void expect_refused(const std::string& arguments, const std::string& says) {
        const std::size_t before = entries();
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 1) << arguments;
        EXPECT_THAT(outcome.output, HasSubstr(says)) << arguments;
        EXPECT_EQ(entries(), before) << "left behind by: " << arguments;
    }
};

TEST_F(PrepareCommand, MakesAnAssetThatLoadsAndSaysWhat) {
    const Outcome outcome = run("prepare photo.png -o asset --tile 32 --patches 16 --contents 4 --blend 4");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("tessera prepare: asset: content_exchange, tile of 32 texels"));
    const ExchangeAsset made = asset();
    EXPECT_EQ(made.tile_side, 32);
    EXPECT_EQ(made.blend_texels, 4);
    EXPECT_EQ(read_preparation(folder_ / "asset")->contents, 4);
    EXPECT_EQ(entries(), 2u) << "the photograph and the asset";
}

TEST_F(PrepareCommand, DroppedAndKeptContentsAreWrittenDownWithoutASearch) {
    ASSERT_EQ(run("prepare photo.png -o asset" + std::string{small}).exit_code, 0);
    const Outcome outcome = run("prepare -o asset --drop 3:2,5 --keep 1:1,5:1");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    using enum ExchangeAsset::Standing;
    const ExchangeAsset changed = asset();
    EXPECT_EQ(changed.patches[3].contents[0].standing, chosen);
    EXPECT_EQ(changed.patches[3].contents[1].standing, dropped);
    EXPECT_EQ(changed.patches[1].contents[0].standing, pinned);
    EXPECT_EQ(changed.patches[5].contents[0].standing, pinned);
    for (std::size_t c = 1; c < changed.patches[5].contents.size(); ++c)
        EXPECT_EQ(changed.patches[5].contents[c].standing, dropped);
    EXPECT_THAT(outcome.output, HasSubstr("dropped"));
}

TEST_F(PrepareCommand, NumbersThatAreNoneAreNamed) {
    ASSERT_EQ(run("prepare photo.png -o asset" + std::string{small}).exit_code, 0);
    const std::string before = text_of(folder_ / "asset" / "asset.json");
    expect_refused("prepare -o asset --drop 3:", "--drop 3:: \"3:\" is neither PATCH nor PATCH:CONTENT");
    expect_refused("prepare -o asset --keep 1,,2", "--keep 1,,2: \"\" is neither");
    expect_refused("prepare -o asset --drop=-1", "\"-1\" is neither");
    expect_refused("prepare -o asset --drop 99999999999999999999", "is neither");
    expect_refused("prepare -o asset --drop 9999", "asset/asset.json: has no patch 9999; patches are 0 to");
    expect_refused("prepare -o asset --drop 0:99", "patch 0 has no content 99; it has");
    expect_refused("prepare -o asset --drop 0:0", "content 0 of patch 0 is the tile's own");
    expect_refused("prepare -o nowhere --drop 0", "nowhere/asset.json");
    EXPECT_EQ(text_of(folder_ / "asset" / "asset.json"), before);
}

TEST_F(PrepareCommand, OptionsThatDoNotGoTogetherAreNamed) {
    expect_refused("prepare -o asset", "names no PHOTO");
    expect_refused("prepare -o asset --tile 32 --drop 3", "names no PHOTO");
    expect_refused("prepare photo.png -o asset --drop 3", "leave PHOTO out, or add --continue");
    expect_refused("prepare photo.png -o asset --continue --tile 32", "leave the other options out");
    expect_refused("prepare photo.png -o asset --continue", "asset/asset.json");
    expect_refused("prepare photo.png -o asset --method wang --patch-map map.png", "--patch-map is for");
    expect_refused("prepare photo.png -o asset --report picture.png", "picture.png");
    EXPECT_EQ(run("prepare photo.png").exit_code, 2) << "a wrong command line";
    EXPECT_EQ(run("prepare photo.png -o asset --method quilt").exit_code, 2);
    EXPECT_EQ(run("prepare photo.png -o asset --tile wide").exit_code, 2);
    EXPECT_EQ(run("prepare photo.png -o asset --max-megapixels 0").exit_code, 2);
    EXPECT_EQ(run("prepare --help").exit_code, 0);
}

TEST_F(PrepareCommand, GoesOnFromWhatAPersonSaid) {
    ASSERT_EQ(run("prepare photo.png -o asset" + std::string{small}).exit_code, 0);
    const ExchangeAsset before = asset();
    const Outcome outcome = run("prepare photo.png -o asset -q --continue --drop 2:1 --keep 4:3");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const ExchangeAsset after = asset();
    const auto standing_of = [&](std::size_t patch, const ExchangeAsset::Offset& at) {
        for (const auto& content : after.patches[patch].contents)
            if (content.at == at) return content.standing;
        return ExchangeAsset::Standing::chosen;
    };
    ASSERT_EQ(after.patches.size(), before.patches.size());
    EXPECT_EQ(standing_of(2, before.patches[2].contents[0].at), ExchangeAsset::Standing::dropped);
    EXPECT_EQ(standing_of(4, before.patches[4].contents[2].at), ExchangeAsset::Standing::pinned);
    EXPECT_EQ(read_preparation(folder_ / "asset")->contents, 4) << "prepared as before";

    write_photo("other.png", 120, 100, 8);
    expect_refused("prepare other.png -o asset --continue",
                   "asset: was made of another photograph; name that one; or leave --continue out");
}

TEST_F(PrepareCommand, PatchesToInterchangeAreDroppedAndKeptToo) {
    ASSERT_EQ(
        run("prepare photo.png -o asset --method interchange --tile 64 --patches 16 --blend 2 -q").exit_code,
        0);
    const ExchangeAsset before = asset();
    ASSERT_GE(before.patches.size(), 6u);
    const Outcome outcome = run("prepare photo.png -o asset -q --continue --drop 2 --keep 4");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const ExchangeAsset after = asset();
    std::size_t dropped = 0, kept = 0;
    for (const auto& patch : after.patches) {
        const auto& content = patch.contents[0];
        const auto is = [&](std::size_t earlier) {
            return content.at == before.patches[earlier].contents[0].at &&
                   content.shape == before.patches[earlier].contents[0].shape;
        };
        dropped += is(2) && content.standing == ExchangeAsset::Standing::dropped ? 1 : 0;
        kept += is(4) && content.standing == ExchangeAsset::Standing::pinned ? 1 : 0;
    }
    EXPECT_EQ(dropped, 1u);
    EXPECT_EQ(kept, 1u);
}

TEST_F(PrepareCommand, ATileThatNoOtherReplacesIsNotDropped) {
    ASSERT_EQ(run("prepare photo.png -o asset --method wang --tile 32 --colors 2 -q").exit_code, 0);
    EXPECT_EQ(asset().patches[0].contents.size(), 15u);
    expect_refused("prepare -o asset --drop 0:3", "have no tile that is not dropped; each needs one");
}

TEST_F(PrepareCommand, AlignedImagesAreCutLikeThePhotograph) {
    // The photograph in other colours, so that every texel of it can be foretold
    Rgb8Image inverted = test::made_photo(120, 100);
    for (auto& code : inverted.bytes) code = static_cast<std::uint8_t>(255 - code);
    ASSERT_TRUE(write_rgb_png(folder_ / "inverted.png", inverted));
    const auto expect_aligned = [&](std::size_t channels) {
        const ExchangeAsset made = asset();
        ASSERT_EQ(made.channels.size(), channels);
        for (const auto& channel : made.channels) {
            for (std::size_t i = 0; i < made.tile.bytes.size(); ++i)
                ASSERT_EQ(channel.tile.bytes[i], 255 - made.tile.bytes[i]);
            for (std::size_t i = 0; i < made.exemplar.bytes.size(); ++i)
                ASSERT_EQ(channel.exemplar.bytes[i], 255 - made.exemplar.bytes[i]);
        }
    };
    const std::string images = " --normal inverted.png --height inverted.png";
    ASSERT_EQ(run("prepare photo.png -o asset" + images + small).exit_code, 0);
    EXPECT_EQ(asset().channels[0].name, "normal");
    EXPECT_EQ(asset().channels[1].name, "height");
    expect_aligned(2);
    ASSERT_EQ(run("prepare photo.png -o asset -q --continue").exit_code, 0);
    expect_aligned(2);
    ASSERT_EQ(
        run("prepare photo.png -o asset -q --method interchange --tile 64 --patches 16" + images).exit_code,
        0);
    expect_aligned(2);

    // Wang's tiles are cut out of the photograph, and the images with it
    ASSERT_EQ(run("prepare photo.png -o asset -q --method wang --tile 32" + images).exit_code, 0);
    expect_aligned(2);
    expect_refused("prepare photo.png -o asset --continue",
                   "asset: holds its normal cut into tiles; name the image again");
    ASSERT_EQ(run("prepare photo.png -o asset -q --continue --roughness inverted.png").exit_code, 0);
    expect_aligned(1);

    write_photo("small.png", 60, 50);
    expect_refused("prepare photo.png -o another --roughness small.png" + std::string{small},
                   "photo.png: is 120×100, but --roughness is 60×50; aligned images show the same surface");
}

TEST_F(PrepareCommand, APaintedPatchMapIsTaken) {
    // Labels as people paint them: greys far apart
    LabelImage map{32, 32, {}};
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x)
            map.labels.push_back(static_cast<std::uint16_t>(40 * (y / 8) + 10 * (x / 8) + 5));
    ASSERT_TRUE(write_label_png(folder_ / "map.png", map));
    const Outcome outcome = run("prepare photo.png -o asset --patch-map map.png --contents 3 --blend 2 -q");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const ExchangeAsset made = asset();
    EXPECT_EQ(made.tile_side, 32);
    ASSERT_EQ(made.patches.size(), 16u);
    const auto borders = [](const std::vector<std::uint16_t>& labels) {
        std::vector<bool> differ;
        for (std::size_t i = 0; i + 32 < labels.size(); ++i) {
            differ.push_back(labels[i] != labels[i + 1]);
            differ.push_back(labels[i] != labels[i + 32]);
        }
        return differ;
    };
    EXPECT_TRUE(borders(made.labels) == borders(map.labels));
    EXPECT_TRUE(read_preparation(folder_ / "asset")->painted_patch_map);

    expect_refused("prepare photo.png -o b --tile 64 --patch-map map.png",
                   "map.png: is 32×32, but --tile is 64");
    // Label 5 is in two places that do not touch
    map.labels[20 * 32 + 20] = 5;
    ASSERT_TRUE(write_label_png(folder_ / "holes.png", map));
    expect_refused("prepare photo.png -o b --patch-map holes.png", "label 5");
    ASSERT_TRUE(write_label_png(folder_ / "odd.png", {30, 32, std::vector<std::uint16_t>(30 * 32)}));
    expect_refused("prepare photo.png -o b --patch-map odd.png", "odd.png: is 30×32; a patch map is square");
    expect_refused("prepare photo.png -o b --patch-map photo.png",
                   "photo.png: is no grey PNG of 8 or 16 bits");
}

TEST_F(PrepareCommand, AReportStandsBesideItsFigures) {
    ASSERT_EQ(run("prepare photo.png -o asset --report first.html" + std::string{small}).exit_code, 0);
    EXPECT_THAT(text_of(folder_ / "first.html"), HasSubstr("<html"));
    EXPECT_THAT(text_of(folder_ / "first.json"), testing::StartsWith("{"));
    ASSERT_EQ(run("report asset -o second.html -q").exit_code, 0);
    EXPECT_EQ(text_of(folder_ / "first.json"), text_of(folder_ / "second.json"));
    expect_refused("report nowhere -o b.html", "nowhere/asset.json");
    expect_refused("report asset -o picture.png", "picture.png");
}

TEST_F(PrepareCommand, InterruptedItLeavesNothing) {
    write_photo("large.png", 512, 512);
    const std::size_t before = entries();
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        const std::string photo = (folder_ / "large.png").string(), target = (folder_ / "asset").string();
        if (std::freopen(log_.c_str(), "w", stderr) == nullptr) _exit(127);
        execl(TESSERA, TESSERA, "prepare", photo.c_str(), "-o", target.c_str(), nullptr);
        _exit(127);
    }
    // In the middle of its work
    for (int i = 0; i < 600 && text_of(log_).find("tile") == std::string::npos; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{100});
    EXPECT_THAT(text_of(log_), HasSubstr("tessera prepare: tile"));
    ASSERT_EQ(kill(child, SIGINT), 0);
    const auto asked = std::chrono::steady_clock::now();
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status)) << "it stops by itself";
    EXPECT_EQ(WEXITSTATUS(status), 128 + SIGINT);
    EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds{20});
    EXPECT_THAT(text_of(log_), HasSubstr("stopped before the asset was complete"));
    EXPECT_EQ(entries(), before);
}

}  // namespace
}  // namespace tessera
