#include "server/scene/asset_file.h"

#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include "proto/asset.pb.h"

#include "server/scene/image_file.h"
#include "shared/math/hash.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A tile of 16 in sixteen patches of 4×4, the first of which starts at (14, 14) and wraps.
ExchangeAsset small_asset() {
    ExchangeAsset asset;
    asset.exemplar = {30, 24, {}};
    for (int i = 0; i < 3 * 30 * 24; ++i)
        asset.exemplar.bytes.push_back(static_cast<std::uint8_t>(hash(1, 1, i, 0)));
    asset.tile = {16, 16, {}};
    for (int i = 0; i < 3 * 16 * 16; ++i)
        asset.tile.bytes.push_back(static_cast<std::uint8_t>(hash(1, 2, i, 0)));
    asset.tile_side = 16;
    asset.blend_texels = 4;
    asset.labels.resize(16 * 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            asset.labels[static_cast<std::size_t>(y * 16 + x)] =
                static_cast<std::uint16_t>((y + 2) % 16 / 4 * 4 + (x + 2) % 16 / 4);
    for (int p = 0; p < 16; ++p)
        asset.patches.push_back(
            {(p % 4 * 4 + 14) % 16, (p / 4 * 4 + 14) % 16, 4, 4, {{2, 2}, {24, 18}, {p, 9}}});
    for (auto& patch : asset.patches) patch.contents[2].at.x = std::max(2, patch.contents[2].at.x);
    return asset;
}

std::string text_of(const fs::path& file) {
    std::ifstream in{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
}

class AssetFile : public testing::Test {
  protected:
    tests::TemporaryFolder folder;
    fs::path asset = folder.path / "asset";
    fs::path json = asset / "asset.json";

    void SetUp() override { ASSERT_TRUE(write_exchange_asset(asset, small_asset(), 5)); }

    void change(const std::function<void(proto::ExchangeAsset&)>& edit) {
        proto::ExchangeAsset message;
        ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(text_of(json), &message).ok());
        edit(message);
        std::string text;
        ASSERT_TRUE(google::protobuf::util::MessageToJsonString(message, &text).ok());
        std::ofstream{json} << text;
    }

    void expect_refused(const fs::path& file, const std::string& says) {
        const auto read = read_exchange_asset(asset);
        ASSERT_FALSE(read) << says;
        EXPECT_THAT(read.error().detail, HasSubstr(file.string() + ": "));
        EXPECT_THAT(read.error().detail, HasSubstr(says));
    }
};

TEST_F(AssetFile, comes_back_as_it_was_written) {
    const ExchangeAsset made = small_asset();
    const auto read = read_exchange_asset(asset);
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_EQ(read->exemplar.bytes, made.exemplar.bytes);
    EXPECT_EQ(read->exemplar.width, 30);
    EXPECT_EQ(read->tile.bytes, made.tile.bytes);
    EXPECT_EQ(read->labels, made.labels);
    EXPECT_EQ(read->tile_side, 16);
    EXPECT_EQ(read->blend_texels, 4);
    ASSERT_EQ(read->patches.size(), made.patches.size());
    for (std::size_t p = 0; p < made.patches.size(); ++p) {
        EXPECT_EQ(read->patches[p].x, made.patches[p].x);
        EXPECT_EQ(read->patches[p].y, made.patches[p].y);
        EXPECT_EQ(read->patches[p].width, made.patches[p].width);
        EXPECT_EQ(read->patches[p].height, made.patches[p].height);
        ASSERT_EQ(read->patches[p].contents.size(), 3u);
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_EQ(read->patches[p].contents[c].at.x, made.patches[p].contents[c].at.x);
            EXPECT_EQ(read->patches[p].contents[c].at.y, made.patches[p].contents[c].at.y);
        }
    }
}

TEST_F(AssetFile, the_same_asset_is_the_same_bytes_in_every_file) {
    ASSERT_TRUE(write_exchange_asset(folder.path / "again", small_asset(), 5));
    for (const char* name : {"asset.json", "exemplar.png", "tile.png", "patches.png"})
        EXPECT_EQ(text_of(asset / name), text_of(folder.path / "again" / name)) << name;
}

TEST_F(AssetFile, fields_that_do_not_fit_are_named) {
    struct Row {
        std::function<void(proto::ExchangeAsset&)> edit;
        const char* says;
    };
    const std::vector<Row> rows{
        {[](auto& m) { m.set_tile_side(0); }, "tile_side: is 0; a power of two from 16 to 4096"},
        {[](auto& m) { m.set_tile_side(24); }, "tile_side: is 24; a power of two"},
        {[](auto& m) { m.set_tile_side(8192); }, "tile_side: is 8192; a power of two"},
        {[](auto& m) { m.set_blend_texels(3); }, "blend_texels: is 3; even"},
        {[](auto& m) { m.set_blend_texels(10); }, "blend_texels: is 10; even, from 0 to 8"},
        {[](auto& m) { m.clear_patches_info(); }, "patches_info: has 0 patches"},
        {[](auto& m) { m.mutable_patches_info(3)->set_x(16); }, "patches_info[3].x: is 16; from 0 to 15"},
        {[](auto& m) { m.mutable_patches_info(3)->set_y(4000000000u); }, "patches_info[3].y: is 4000000000"},
        {[](auto& m) { m.mutable_patches_info(0)->set_width(9); },
         "patches_info[0].width: is 9; from 1 to 8"},
        {[](auto& m) { m.mutable_patches_info(0)->set_height(0); },
         "patches_info[0].height: is 0; from 1 to 8"},
        {[](auto& m) { m.mutable_patches_info(5)->set_width(3); },
         "patches_info[5]: its box does not hold texel"},
        {[](auto& m) { m.mutable_patches_info(5)->set_y(3); },
         "patches_info[5]: its box does not hold texel"},
        {[](auto& m) { m.mutable_patches_info(2)->mutable_contents(1)->set_x(25); },
         "patches_info[2].contents[1].x: is 25; from 2 to 24"},
        {[](auto& m) { m.mutable_patches_info(2)->mutable_contents(1)->set_y(1); },
         "patches_info[2].contents[1].y: is 1; from 2 to 18"},
        {[](auto& m) { m.set_tile("../tile.png"); }, "tile: \"../tile.png\" leaves the asset's folder"},
        {[](auto& m) { m.set_exemplar("/etc/passwd"); },
         "exemplar: \"/etc/passwd\" leaves the asset's folder"},
        {[](auto& m) { m.set_patches("."); }, "patches: \".\" leaves the asset's folder"},
        {[](auto& m) { m.add_patches_info()->CopyFrom(m.patches_info(0)); },
         "patches_info[16]: no texel of patches.png has this label"},
    };
    for (const Row& row : rows) {
        ASSERT_TRUE(write_exchange_asset(asset, small_asset(), 5));
        change(row.edit);
        expect_refused(json, row.says);
    }
}

TEST_F(AssetFile, a_label_without_a_patch_is_named_with_its_texel) {
    change([](auto& message) { message.mutable_patches_info()->RemoveLast(); });
    expect_refused(asset / "patches.png", "texel (10, 10): label 15, but patches_info has only 15 patches");
}

TEST_F(AssetFile, an_unknown_field_is_named) {
    const std::string text = text_of(json);
    std::ofstream{json} << "{\"tile_sid\": 16," << text.substr(text.find('{') + 1);
    expect_refused(json, "tile_sid");
}

TEST_F(AssetFile, json_that_is_none_or_too_much_is_refused) {
    std::ofstream{json} << "{\"tile_side\": ";
    expect_refused(json, "");
    fs::resize_file(json, (std::uintmax_t{1} << 26) + 1);
    expect_refused(json, "at most 67108864");
    fs::remove(json);
    expect_refused(json, "`tessera prepare PHOTO -o");
}

TEST_F(AssetFile, images_of_the_wrong_size_are_named) {
    Rgb8Image tile{16, 8, std::vector<std::uint8_t>(3 * 16 * 8)};
    ASSERT_TRUE(write_rgb_png(asset / "tile.png", tile));
    expect_refused(asset / "tile.png", "is 16×8, but tile_side in asset.json is 16");
    ASSERT_TRUE(write_exchange_asset(asset, small_asset(), 5));
    ASSERT_TRUE(write_label_png(asset / "patches.png", {8, 16, std::vector<std::uint16_t>(8 * 16)}));
    expect_refused(asset / "patches.png", "is 8×16, but tile_side in asset.json is 16");
    ASSERT_TRUE(write_exchange_asset(asset, small_asset(), 5));
    ASSERT_TRUE(write_rgb_png(asset / "exemplar.png", tile));
    expect_refused(json, "contents[1].x: is 24; from 2 to 10");
}

TEST_F(AssetFile, a_missing_image_is_named) {
    fs::remove(asset / "exemplar.png");
    expect_refused(asset / "exemplar.png", "there is no such file");
}

TEST_F(AssetFile, a_link_out_of_the_folder_is_refused) {
    fs::rename(asset / "tile.png", folder.path / "elsewhere.png");
    fs::create_symlink(folder.path / "elsewhere.png", asset / "tile.png");
    expect_refused(json, "tile: \"tile.png\" leaves the asset's folder");
}

TEST_F(AssetFile, writing_replaces_an_asset_whole_and_leaves_nothing_beside_it) {
    ExchangeAsset other = small_asset();
    other.tile.bytes[0] ^= 1;
    ASSERT_TRUE(write_exchange_asset(asset.string() + "/", other, 6));
    const auto read = read_exchange_asset(asset);
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_EQ(read->tile.bytes, other.tile.bytes);
    EXPECT_EQ(std::distance(fs::directory_iterator{folder.path}, {}), 1);
}

TEST_F(AssetFile, writing_replaces_nothing_but_an_asset) {
    const auto expect_kept = [&](const fs::path& target, const char* says) {
        const auto written = write_exchange_asset(target, small_asset(), 1);
        ASSERT_FALSE(written) << target;
        EXPECT_THAT(written.error().detail, HasSubstr(says));
    };
    std::ofstream{asset / "diary.txt"} << "dear";
    expect_kept(asset, "holds diary.txt, which is no part of an asset");
    EXPECT_TRUE(fs::exists(asset / "diary.txt"));
    fs::create_directory(folder.path / "pictures");
    ASSERT_TRUE(write_rgb_png(folder.path / "pictures" / "tile.png", {1, 1, {1, 2, 3}}));
    expect_kept(folder.path / "pictures", "holds no asset.json");
    EXPECT_TRUE(fs::exists(folder.path / "pictures" / "tile.png"));
    std::ofstream{folder.path / "file"} << "x";
    expect_kept(folder.path / "file", "is not a folder");
    expect_kept(folder.path / "none" / "asset", "is not a folder; make it first");
    fs::create_directory_symlink(asset, folder.path / "link");
    expect_kept(folder.path / "link", "is not a folder");
}

}  // namespace
}  // namespace tessera
