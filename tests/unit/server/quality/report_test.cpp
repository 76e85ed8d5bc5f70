#include "server/quality/report.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "painted_texture.h"

#include "server/quality/pictures.h"
#include "server/quality/small_text.h"
#include "tests/support/synthetic_asset.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::Not;

namespace fs = std::filesystem;

std::string read(const fs::path& file) {
    std::ifstream in{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
}

/// The page without its pictures' bytes, in which any word may occur.
std::string without_pictures(std::string page) {
    for (auto at = page.find(";base64,"); at != std::string::npos; at = page.find(";base64,", at + 8))
        page.erase(at + 8, page.find(')', at) - at - 8);
    return page;
}

int occurrences(const std::string& text, const std::string& part) {
    int count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
    return count;
}

std::shared_ptr<const test::PaintedTexture> repeated_tile(const ExchangeAsset& asset) {
    return std::make_shared<test::PaintedTexture>([&asset](std::int64_t x, std::int64_t y) {
        const auto side = std::int64_t{asset.tile_side};
        const std::uint8_t* codes =
            asset.tile.bytes.data() + (test::floor_mod(y, side) * side + test::floor_mod(x, side)) * 3;
        return test::Codes{codes[0], codes[1], codes[2]};
    });
}

/// Tells of everything, and can be stopped once a stage has come so far.
struct Watched final : Progress {
    void advance(std::string_view stage, double fraction) override {
        EXPECT_GE(fraction, 0);
        EXPECT_LE(fraction, 1);
        if (stage == last_stage) {
            EXPECT_GE(fraction, last_fraction) << stage;
        }
        last_stage = stage;
        last_fraction = fraction;
        if (stage == stop_in) source.request_stop();
    }
    void note(const std::string&) override {}
    std::stop_token stop() const override { return source.get_token(); }
    std::stop_source source;
    std::string last_stage, stop_in;
    double last_fraction = 0;
};

struct Report : testing::Test {
    tests::TemporaryFolder folder;
    fs::path html = folder.path / "stones.html";
    ExchangeAsset asset = tests::make_synthetic_asset({});
    MeasuredTextures textures = textures_of(asset);
    Watched progress;
};

TEST_F(Report, IsOneFileThatAsksNobodyAndHoldsEveryPartOnce) {
    const auto written = write_report(html, asset, textures, progress);
    ASSERT_TRUE(written) << written.error().detail;
    const std::string whole = read(html), page = without_pictures(whole);
    EXPECT_LT(whole.size(), 15U << 20);
    EXPECT_THAT(page, HasSubstr("<title>stones · Tessera</title>"));
    for (const char* picture : {"tile", "patches", "seams", "share", "repeat", "mean", "preview-0",
                                "preview-3", "preview-6", "repeat-0", "repeat-3", "repeat-6", "sheet-0"}) {
        EXPECT_EQ(occurrences(page, ".shows-" + std::string{picture} + "{background-image:url(data:image/"),
                  1)
            << picture;
        EXPECT_TRUE(
            std::regex_search(page, std::regex{"class=\"[^\"]*shows-" + std::string{picture} + "[ \"]"}))
            << picture;
    }
    // Every address is a picture of its own, or nothing
    const std::regex address{"(url\\(|src=|href=\")(?!data:)"};
    EXPECT_FALSE(std::regex_search(page, address));
    EXPECT_THAT(page, Not(HasSubstr("http")));
    EXPECT_THAT(page, Not(HasSubstr("nan")));
    EXPECT_EQ(occurrences(page, "<tr><th>seams"), 4);
    std::size_t contents = 0;
    for (const auto& patch : asset.patches) contents += patch.contents.size();
    EXPECT_EQ(occurrences(page, "<button class=\"content"), int(contents));
    EXPECT_THAT(page, HasSubstr("<span>0:1 · "));
    EXPECT_EQ(progress.last_stage, "drawing");
    EXPECT_EQ(progress.last_fraction, 1);
}

TEST_F(Report, HasItsFiguresBesideItForProgramsAndIsTheSameOnceMore) {
    ASSERT_TRUE(write_report(html, asset, textures, progress));
    const std::string once = read(html);
    const std::string json = read(folder.path / "stones.json");
    for (const char* key :
         {"\"method\": \"content_exchange\"", "\"tile_side\": 64", "\"gates\": [", "\"hard_ratio\"",
          "\"natural_ratio\"", "\"excess\"", "\"new_edges\"", "\"quiet_ratio\"", "\"repetition\": [",
          "\"tile_share\"", "\"fidelity\"", "\"contents_seam_ratio\""})
        EXPECT_THAT(json, HasSubstr(key));
    EXPECT_EQ(occurrences(json, "{"), occurrences(json, "}"));
    Watched again;
    ASSERT_TRUE(write_report(html, asset, textures, again));
    EXPECT_EQ(once, read(html));
    EXPECT_EQ(std::distance(fs::directory_iterator{folder.path}, fs::directory_iterator{}), 2);
}

TEST_F(Report, LeavesNothingWhenStoppedAtAnyStage) {
    for (const char* stage : {"measuring", "drawing"}) {
        Watched stopped;
        stopped.stop_in = stage;
        const auto written = write_report(html, asset, textures, stopped);
        ASSERT_FALSE(written);
        EXPECT_EQ(written.error().code, ErrorCode::cancelled);
        EXPECT_TRUE(fs::is_empty(folder.path));
    }
}

TEST_F(Report, SaysOfInterchangeHowItComparesWithThePapersOwnChoice) {
    const ExchangeAsset interchange = tests::make_synthetic_interchange({.tile_side = 64});
    const auto tile = repeated_tile(interchange);
    const auto written = write_report(html, interchange, {tile, tile, tile}, progress);
    ASSERT_TRUE(written) << written.error().detail;
    const std::string page = read(html);
    EXPECT_THAT(page, HasSubstr("choice: kolar"));
    EXPECT_THAT(page, HasSubstr("Coverage"));
    EXPECT_THAT(page, HasSubstr("of 6 gates failed")) << "a plain tile repeats";
}

TEST_F(Report, ShowsTheCornersOfWangTiles) {
    const ExchangeAsset wang = tests::make_synthetic_wang({.tile_side = 64});
    const auto tile = repeated_tile(wang);
    const auto written = write_report(html, wang, {tile, tile, nullptr}, progress);
    ASSERT_TRUE(written) << written.error().detail;
    EXPECT_THAT(read(html), HasSubstr(", corners 1000, seam"));
}

TEST_F(Report, WantsANameOfAPageInAFolderThatIsThere) {
    EXPECT_THAT(check_report_target(folder.path / "report.json").error().detail, HasSubstr("ends in .html"));
    EXPECT_THAT(check_report_target(folder.path / "none" / "report.html").error().detail,
                HasSubstr("not a folder"));
    fs::create_directory(folder.path / "folder.html");
    EXPECT_THAT(check_report_target(folder.path / "folder.html").error().detail, HasSubstr("is a folder"));
    EXPECT_TRUE(check_report_target(html));
    EXPECT_EQ(write_report(folder.path / "none" / "report.html", asset, textures, progress).error().code,
              ErrorCode::io_failure);
}

TEST(TileAtALevel, IsItsMeanInLinearLightRepeated) {
    Rgb8Image tile{2, 2, {0, 0, 0, 255, 255, 255, 0, 0, 0, 255, 255, 255}};
    const Rgba8Image fine = tile_at_level(tile, 0, 5);
    EXPECT_EQ(fine.width, 6);
    EXPECT_EQ(fine.row(5)[5 * 4], 255);
    const Rgba8Image coarse = tile_at_level(tile, 1);
    EXPECT_EQ(coarse.width, 1);
    EXPECT_EQ(coarse.bytes[0], 188) << "half the light";
    EXPECT_EQ(tile_at_level(tile, 6).width, 1);
}

TEST(ContentSheetsOfAnAsset, MeasureEachContentByItsSeamToTheTile) {
    ExchangeAsset asset = tests::make_synthetic_asset({.constant_code = 100});
    // One content is lighter than the tile around it: every step of its seam is the same
    const auto& patch = asset.patches[2];
    const auto& lighter = patch.contents[1];
    for (std::int32_t y = 0; y < patch.height; ++y)
        for (std::int32_t x = 0; x < patch.width; ++x)
            for (std::int32_t c = 0; c < 3; ++c)
                asset.exemplar.bytes[std::size_t(
                    ((lighter.at.y + y) * asset.exemplar.width + lighter.at.x + x) * 3 + c)] = 119;
    SilentProgress silent;
    const auto contents = draw_contents(asset, 2.0, {silent, "drawing"});
    ASSERT_TRUE(contents);
    bool seen = false;
    for (const ContentFacts& facts : contents->contents)
        if (facts.patch == 2 && facts.content == 2) {
            seen = true;
            EXPECT_NEAR(facts.seam_ratio, 7.6 / 2, 0.1);
            EXPECT_GT(facts.texels, 0);
        }
    EXPECT_TRUE(seen);
    // Without a shape of its own it fills its patch's part of the patch map
    asset.patches[2].contents[1].shape = {};
    const auto whole = draw_contents(asset, 2.0, {silent, "drawing"});
    ASSERT_TRUE(whole);
    for (const ContentFacts& facts : whole->contents)
        if (facts.patch == 2 && facts.content == 2) {
            EXPECT_EQ(facts.texels, std::count(asset.labels.begin(), asset.labels.end(), 2));
        }
}

TEST(SmallText, DrawsLettersInsideThePictureOnly) {
    Rgba8Image image{8, 8};
    draw_text(image, 1, 0, "I", 1, {255, 0, 0});
    EXPECT_EQ(image.row(0)[3 * 4], 255);
    EXPECT_EQ(image.row(0)[1 * 4], 0);
    EXPECT_EQ(image.row(0)[2 * 4], 255);
    draw_text(image, -3, -3, "Wide: 100 % (far)", 3, {0, 255, 0});
    EXPECT_EQ(text_width("AB", 2), 24);
}

}  // namespace
}  // namespace tessera
