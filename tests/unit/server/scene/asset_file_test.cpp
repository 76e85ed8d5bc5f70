#include "server/scene/asset_file.h"

#include <fstream>

#include "server/scene/image_file.h"
#include "tests/support/synthetic_asset.h"
#include "tests/unit/server/scene/asset_folder.h"

namespace tessera {
namespace {

using testing::HasSubstr;

/// Every texel, number and bit.
void expect_same(const ExchangeAsset& read, const ExchangeAsset& made) {
    EXPECT_EQ(read.method, made.method);
    EXPECT_EQ(read.exemplar.width, made.exemplar.width);
    EXPECT_EQ(read.exemplar.bytes, made.exemplar.bytes);
    EXPECT_EQ(read.tile.bytes, made.tile.bytes);
    EXPECT_EQ(read.labels, made.labels);
    EXPECT_EQ(read.tile_side, made.tile_side);
    EXPECT_EQ(read.blend_texels, made.blend_texels);
    ASSERT_EQ(read.patches.size(), made.patches.size());
    for (std::size_t p = 0; p < made.patches.size(); ++p) {
        SCOPED_TRACE(p);
        const auto& [x, y, width, height, contents, set, group] = read.patches[p];
        EXPECT_EQ(std::tuple(x, y, width, height, set, group),
                  std::tuple(made.patches[p].x, made.patches[p].y, made.patches[p].width,
                             made.patches[p].height, made.patches[p].set, made.patches[p].group));
        ASSERT_EQ(contents.size(), made.patches[p].contents.size());
        for (std::size_t c = 0; c < contents.size(); ++c) {
            EXPECT_EQ(contents[c].at, made.patches[p].contents[c].at);
            EXPECT_EQ(contents[c].shape, made.patches[p].contents[c].shape);
            EXPECT_EQ(contents[c].standing, made.patches[p].contents[c].standing);
            EXPECT_EQ(contents[c].corners, made.patches[p].contents[c].corners);
        }
    }
    ASSERT_EQ(read.channels.size(), made.channels.size());
    for (std::size_t i = 0; i < made.channels.size(); ++i) {
        EXPECT_EQ(read.channels[i].name, made.channels[i].name);
        EXPECT_EQ(read.channels[i].exemplar.bytes, made.channels[i].exemplar.bytes);
        EXPECT_EQ(read.channels[i].tile.bytes, made.channels[i].tile.bytes);
    }
}

TEST_F(AssetFile, comes_back_as_it_was_written_by_every_method) {
    std::vector<ExchangeAsset> assets{small_asset(), small_interchange(), tests::make_synthetic_asset({}),
                                      tests::make_synthetic_interchange({}), tests::make_synthetic_wang({})};
    for (auto& made : assets) {
        made.patches[0].contents[0].standing = ExchangeAsset::Standing::pinned;
        if (made.method != ExchangeMethod::wang)
            made.patches.back().contents[0].standing = ExchangeAsset::Standing::dropped;
        made.channels = {{"height", made.exemplar, made.tile}, {"normal", made.exemplar, made.tile}};
        made.channels[0].exemplar.bytes[7] ^= 1;
        made.channels[1].tile.bytes[9] ^= 1;
        ASSERT_TRUE(write_exchange_asset(asset, made, {}));
        const auto read = read_exchange_asset(asset);
        ASSERT_TRUE(read) << read.error().detail;
        expect_same(*read, made);
    }
}

TEST_F(AssetFile, shapes_need_a_file_only_where_they_leave_something_of_their_patch) {
    EXPECT_FALSE(fs::exists(asset / "shapes.png"));
    ASSERT_TRUE(write_exchange_asset(asset, tests::make_synthetic_wang({}), {}));
    EXPECT_FALSE(fs::exists(asset / "shapes.png"));
    EXPECT_FALSE(fs::exists(asset / "patches.png"));
    ASSERT_TRUE(write_exchange_asset(asset, small_interchange(), {}));
    EXPECT_TRUE(fs::exists(asset / "shapes.png"));
    EXPECT_EQ(text_of(asset / "shapes.png")[24], 1) << "one bit a texel";
}

TEST_F(AssetFile, a_content_without_a_shape_fills_its_patch) {
    // As people write them, and as the version before wrote them
    std::ofstream{json} << R"({"tile_side": 16, "blend_texels": 4, "seed": 1, "prepared_by": "tessera 0.1.0",
        "patches_info": [{"width": 8, "height": 8, "contents": [{"x": 2, "y": 3}]},
                         {"x": 8, "width": 8, "height": 8, "contents": []},
                         {"y": 8, "width": 8, "height": 8, "contents": [{"x": 4, "y": 2}]},
                         {"x": 8, "y": 8, "width": 8, "height": 8}]})";
    LabelImage labels{16, 16, {}};
    for (int i = 0; i < 256; ++i)
        labels.labels.push_back(static_cast<std::uint16_t>(i / 128 * 2 + i % 16 / 8));
    labels.labels[5] = 1;  // x = 5 of the first row: outside the box of patch 1, which starts at 8
    ASSERT_TRUE(write_label_png(asset / "patches.png", labels));
    expect_refused(json, "patches_info[1]: its box does not hold texel (5, 0)");
    labels.labels[5] = 0;
    ASSERT_TRUE(write_label_png(asset / "patches.png", labels));
    const auto read = read_exchange_asset(asset);
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_EQ(read->method, ExchangeMethod::content_exchange);
    EXPECT_EQ(read->patches[0].contents[0].shape, full(8, 8));
    EXPECT_EQ(read->patches[2].contents[0].shape, full(8, 8));
}

TEST_F(AssetFile, a_shape_that_is_left_out_follows_the_patch_map) {
    ExchangeAsset made = tests::make_synthetic_asset({});
    for (auto& patch : made.patches)
        for (auto& content : patch.contents) content.shape = {};
    ASSERT_TRUE(write_exchange_asset(asset, made, {}));
    const auto read = read_exchange_asset(asset);
    ASSERT_TRUE(read) << read.error().detail;
    for (std::size_t p = 0; p < read->patches.size(); ++p)
        for (const auto& content : read->patches[p].contents)
            EXPECT_EQ(content.shape, tests::region_of_patch(*read, p)) << p;
}

TEST_F(AssetFile, how_it_was_made_is_recorded) {
    const Preparation made{.method = ExchangeMethod::interchange,
                           .version = 7,
                           .photo = "0123456789abcdef",
                           .seed = 5,
                           .tile_side = 64,
                           .patches = 300,
                           .contents = 0,
                           .colors = 3,
                           .blend_texels = 0,
                           .painted_patch_map = true};
    ASSERT_TRUE(write_exchange_asset(asset, small_interchange(), made));
    const auto read = read_preparation(asset);
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_EQ(read->method, made.method);
    EXPECT_EQ(read->version, 7u);
    EXPECT_EQ(read->photo, made.photo);
    EXPECT_EQ(read->seed, 5u);
    EXPECT_EQ(read->tile_side, 64);
    EXPECT_EQ(read->patches, 300);
    EXPECT_EQ(read->colors, 3);
    EXPECT_EQ(read->blend_texels, 0);
    EXPECT_TRUE(read->painted_patch_map);
    ASSERT_TRUE(write_exchange_asset(asset, small_asset(), {}));
    EXPECT_EQ(read_preparation(asset)->blend_texels, -1) << "left to the method";
    EXPECT_EQ(read_preparation(asset)->version, 0u);
}

TEST_F(AssetFile, the_same_asset_is_the_same_bytes_in_every_file) {
    Preparation recorded;
    recorded.seed = 5;
    for (const fs::path& target : {asset, folder.path / "again"})
        ASSERT_TRUE(write_exchange_asset(target, tests::make_synthetic_asset({}), recorded));
    for (const char* name : {"asset.json", "exemplar.png", "tile.png", "patches.png", "shapes.png"})
        EXPECT_EQ(text_of(asset / name), text_of(folder.path / "again" / name)) << name;
}

TEST_F(AssetFile, standings_are_changed_in_place_and_nothing_else) {
    change([](auto& m) { m.set_tile("mine.png"); });
    fs::rename(asset / "tile.png", asset / "mine.png");
    using enum ExchangeAsset::Standing;
    ASSERT_TRUE(change_standings(asset, {{3, 2, dropped}, {5, std::nullopt, dropped}, {5, 1, pinned}}));
    const auto read = read_exchange_asset(asset);
    ASSERT_TRUE(read) << read.error().detail;
    for (std::size_t p = 0; p < 16; ++p)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto expected = p == 3 && c == 1 ? dropped : p == 5 ? (c == 0 ? pinned : dropped) : chosen;
            EXPECT_EQ(read->patches[p].contents[c].standing, expected) << p << ":" << c + 1;
        }
    EXPECT_THAT(text_of(json), HasSubstr("mine.png"));
    EXPECT_EQ(std::distance(fs::directory_iterator{asset}, {}), 4) << "nothing is left behind";
}

TEST_F(AssetFile, standings_of_what_is_not_there_change_nothing) {
    const auto expect_unchanged = [&](const std::vector<StandingChange>& changes, const char* says) {
        const std::string before = text_of(json);
        const auto changed = change_standings(asset, changes);
        ASSERT_FALSE(changed);
        EXPECT_EQ(changed.error().code, ErrorCode::invalid_input);
        EXPECT_THAT(changed.error().detail, HasSubstr(json.string()));
        EXPECT_THAT(changed.error().detail, HasSubstr(says));
        EXPECT_EQ(text_of(json), before);
    };
    using enum ExchangeAsset::Standing;
    expect_unchanged({{1, 1, dropped}, {16, 1, dropped}}, "has no patch 16; patches are 0 to 15");
    expect_unchanged({{1, 4, dropped}}, "patch 1 has no content 4; it has 3, counted from 1");
    expect_unchanged({{1, 0, dropped}}, "content 0 of patch 1 is the tile's own");
    ASSERT_TRUE(write_exchange_asset(asset, tests::make_synthetic_wang({}), {}));
    expect_unchanged({{0, 7, dropped}}, "have no tile that is not dropped; each needs one");
}

TEST_F(AssetFile, writing_replaces_an_asset_whole_and_leaves_nothing_beside_it) {
    ExchangeAsset other = small_asset();
    other.tile.bytes[0] ^= 1;
    ASSERT_TRUE(write_exchange_asset(asset.string() + "/", other, {}));
    const auto read = read_exchange_asset(asset);
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_EQ(read->tile.bytes, other.tile.bytes);
    EXPECT_EQ(std::distance(fs::directory_iterator{folder.path}, {}), 1);
}

TEST_F(AssetFile, writing_replaces_nothing_but_an_asset) {
    const auto expect_kept = [&](const fs::path& target, const char* says) {
        const auto written = write_exchange_asset(target, small_asset(), {});
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
