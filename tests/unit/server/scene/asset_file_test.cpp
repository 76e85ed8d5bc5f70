#include "server/scene/asset_file.h"

#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include "proto/asset.pb.h"

#include "server/scene/image_file.h"
#include "shared/math/hash.h"
#include "tests/support/synthetic_asset.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

BitMask full(std::int32_t width, std::int32_t height) {
    BitMask mask{width, height};
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x) mask.set(x, y);
    return mask;
}

ExchangeAsset::Content content(ExchangeAsset::Offset at, BitMask shape) {
    return {at, std::move(shape), ExchangeAsset::Standing::chosen, 0};
}

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
        asset.patches.push_back({(p % 4 * 4 + 14) % 16,
                                 (p / 4 * 4 + 14) % 16,
                                 4,
                                 4,
                                 {content({2, 2}, full(4, 4)), content({24, 18}, full(4, 4)),
                                  content({std::max(2, p), 9}, full(4, 4))}});
    return asset;
}

/// Patches of 9×5 and 8×8 on a tile of 16, one in each set, which do not meet, and one over the tile's
/// corner.
ExchangeAsset small_interchange() {
    ExchangeAsset asset = small_asset();
    asset.method = ExchangeMethod::interchange;
    asset.labels.clear();
    asset.patches = {{4, 5, 9, 5, {content({3, 4}, {})}, ExchangeAsset::Set::a},
                     {-2, 4, 4, 8, {content({10, 9}, {})}, ExchangeAsset::Set::b},
                     {13, -3, 8, 8, {content({12, 12}, {})}, ExchangeAsset::Set::none}};
    for (auto& patch : asset.patches) {
        patch.contents[0].shape = BitMask{patch.width, patch.height};
        for (std::int32_t i = 0; i < patch.height; ++i) patch.contents[0].shape.set(i % patch.width, i);
    }
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

    void SetUp() override { ASSERT_TRUE(write_exchange_asset(asset, small_asset(), {})); }

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
        const auto& [x, y, width, height, contents, set] = read.patches[p];
        EXPECT_EQ(std::tuple(x, y, width, height, set),
                  std::tuple(made.patches[p].x, made.patches[p].y, made.patches[p].width,
                             made.patches[p].height, made.patches[p].set));
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
        {[](auto& m) { m.set_method(static_cast<proto::Method>(7)); }, "method: \"content_exchange\""},
        {[](auto& m) { m.clear_patches_info(); }, "patches_info: has 0 patches"},
        {[](auto& m) {
             for (int i = 0; i < 300; ++i)
                 m.mutable_patches_info(0)->add_contents()->CopyFrom(m.patches_info(0).contents(0));
         },
         "patches_info[0].contents: has 303; at most 255"},
        {[](auto& m) {
             while (m.patches_info_size() < 65536) m.add_patches_info()->set_width(1);
         },
         "patches_info: has 65536 patches; from 1 to 65535"},
        {[](auto& m) { m.mutable_patches_info(3)->set_x(-1); }, "patches_info[3].x: is -1; from 0 to 15"},
        {[](auto& m) { m.mutable_patches_info(3)->set_set("a"); },
         "patches_info[3].set: is \"a\"; only interchange has sets"},
        {[](auto& m) { m.mutable_patches_info(3)->mutable_contents(0)->set_standing("banned"); },
         "patches_info[3].contents[0].standing: is \"banned\"; \"pinned\", \"dropped\" or nothing"},
        {[](auto& m) { m.mutable_patches_info(3)->mutable_contents(0)->set_corners("0101"); },
         "patches_info[3].contents[0].corners: is \"0101\"; only tiles of wang have corners"},
        {[](auto& m) { m.set_shapes("../shapes.png"); },
         "shapes: \"../shapes.png\" leaves the asset's folder"},
        {[](auto& m) { m.add_channels()->set_name("gloss"); },
         "channels[0].name: is \"gloss\"; normal, roughness or height"},
        {[](auto& m) {
             m.add_channels()->set_name("height");
             m.mutable_channels(0)->set_exemplar("/etc/passwd");
         },
         "channels[0].exemplar: \"/etc/passwd\" leaves the asset's folder"},
        {[](auto& m) {
             for (int i = 0; i < 2; ++i) {
                 m.add_channels()->set_name("height");
                 m.mutable_channels(i)->set_exemplar("exemplar.png");
                 m.mutable_channels(i)->set_tile("tile.png");
             }
         },
         "channels[1].name: \"height\" is there twice"},
        {[](auto& m) { m.mutable_patches_info(3)->set_x(16); }, "patches_info[3].x: is 16; from 0 to 15"},
        {[](auto& m) { m.mutable_patches_info(3)->set_y(2000000000); }, "patches_info[3].y: is 2000000000"},
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
        ASSERT_TRUE(write_exchange_asset(asset, small_asset(), {}));
        change(row.edit);
        expect_refused(json, row.says);
    }
}

/// The first asset's row is written, changed by `edit`, and refused with these words.
struct Refusal {
    ExchangeAsset made;
    std::function<void(proto::ExchangeAsset&)> edit;
    const char* says;
};

TEST_F(AssetFile, what_interchange_does_not_hold_is_named) {
    const ExchangeAsset made = small_interchange();
    ExchangeAsset overlapping = made;  // on the tile to the left of patch 0's, and over its texel (4, 5)
    overlapping.patches[1] = {20, 5, 1, 1, {content({10, 9}, full(1, 1))}, ExchangeAsset::Set::b};
    const std::vector<Refusal> rows{
        {made, [](auto& m) { m.mutable_patches_info(0)->set_x(-9); },
         "patches_info[0].x: is -9; from -8 to 23"},
        {made, [](auto& m) { m.mutable_patches_info(0)->set_x(24); },
         "patches_info[0].x: is 24; from -8 to 23"},
        {made, [](auto& m) { m.mutable_patches_info(0)->set_width(33); },
         "patches_info[0].width: is 33; from 1 to 32"},
        {made, [](auto& m) { m.mutable_patches_info(0)->set_set("c"); },
         "patches_info[0].set: is \"c\"; \"a\", \"b\" or nothing"},
        {made, [](auto& m) { m.mutable_patches_info(2)->set_set("a"); },
         "patches_info[2]: is in a set, and its texel (13, -3) leaves the tile's rhombus; take it out of its "
         "set"},
        {made, [](auto& m) { m.mutable_patches_info(1)->mutable_contents(0)->set_shape_y(90); },
         "patches_info[1].contents[0].shape_y: is 90; from 0 to"},
        {made, [](auto& m) { m.mutable_patches_info(1)->clear_contents(); },
         "patches_info[1].contents: has 0; exactly one"},
        {made, [](auto& m) { m.set_patches("patches.png"); },
         "patches: only content_exchange has a patch map"},
        {overlapping, [](auto&) {}, "patches_info[1]: is in set b and overlaps patches_info[0] of set a"},
    };
    for (const Refusal& row : rows) {
        ASSERT_TRUE(write_exchange_asset(asset, row.made, {}));
        change(row.edit);
        expect_refused(json, row.says);
    }
}

TEST_F(AssetFile, what_wang_does_not_hold_is_named) {
    const ExchangeAsset made = tests::make_synthetic_wang({});
    const std::vector<Refusal> rows{
        {made, [](auto& m) { m.mutable_patches_info(0)->mutable_contents()->DeleteSubrange(4, 1); },
         "patches_info[0].contents: of 2 colours, the corners"},
        {made, [](auto& m) { m.mutable_patches_info(0)->mutable_contents(4)->set_standing("dropped"); },
         "have no tile that is not dropped; each needs one"},
        {made, [](auto& m) { m.mutable_patches_info(0)->mutable_contents(4)->set_corners("012"); },
         "patches_info[0].contents[4].corners: is \"012\"; four digits 0 to 3"},
        {made, [](auto& m) { m.mutable_patches_info(0)->mutable_contents(4)->set_corners("0124"); },
         "four digits 0 to 3"},
        {made, [](auto& m) { m.add_patches_info(); }, "patches_info: has 2 patches; one, the square tile"},
        {made, [](auto& m) { m.mutable_patches_info(0)->set_width(60); },
         "patches_info[0].width: is 60; from 64 to 64"},
        {made, [](auto& m) { m.mutable_patches_info(0)->set_x(1); }, "patches_info[0].x: is 1; from 0 to 0"},
    };
    for (const Refusal& row : rows) {
        ASSERT_TRUE(write_exchange_asset(asset, row.made, {}));
        change(row.edit);
        expect_refused(json, row.says);
    }
    ExchangeAsset with_a_hole = made;
    with_a_hole.patches[0].contents[3].shape = BitMask{made.tile_side, made.tile_side};
    with_a_hole.patches[0].contents[3].shape.set(5, 5);
    ASSERT_TRUE(write_exchange_asset(asset, with_a_hole, {}));
    expect_refused(asset / "shapes.png", "the shape of patches_info[0].contents[3] of asset.json has holes");
}

TEST_F(AssetFile, a_shape_that_leaves_its_part_of_the_patch_map_is_named) {
    ExchangeAsset made = tests::make_synthetic_asset({});
    auto& patch = made.patches[2];
    patch.contents[1].shape = full(patch.width, patch.height);
    ASSERT_TRUE(write_exchange_asset(asset, made, {}));
    expect_refused(
        asset / "shapes.png",
        "the shape of patches_info[2].contents[1] of asset.json leaves the patch's part of patches.png");
}

TEST_F(AssetFile, an_aligned_image_of_another_size_is_named) {
    ExchangeAsset made = small_asset();
    made.channels = {{"height", made.tile, made.tile}};
    ASSERT_TRUE(write_exchange_asset(asset, made, {}));
    expect_refused(asset / "height.png", "is 16×16, but exemplar.png, which it belongs to, is 30×24");
    made.channels = {{"height", made.exemplar, made.exemplar}};
    ASSERT_TRUE(write_exchange_asset(asset, made, {}));
    expect_refused(asset / "height-tile.png", "is 30×24, but tile.png, which it belongs to, is 16");
}

TEST_F(AssetFile, boxes_that_would_take_all_memory_are_refused_before_their_shapes_are_made) {
    ASSERT_TRUE(write_exchange_asset(asset, tests::make_synthetic_asset({.tile_side = 256}), {}));
    change([](auto& m) {
        m.clear_shapes();
        m.clear_patches_info();
        for (int p = 0; p < 150; ++p) {
            auto& patch = *m.add_patches_info();
            patch.set_width(128);
            patch.set_height(128);
            for (int c = 0; c < 255; ++c) {
                auto& listed = *patch.add_contents();
                listed.set_x(9);
                listed.set_y(9);
            }
        }
    });
    expect_refused(json, "patches_info: the boxes of all contents cover 597 Mtexels; at most 512");
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
    ASSERT_TRUE(write_exchange_asset(asset, small_asset(), {}));
    ASSERT_TRUE(write_label_png(asset / "patches.png", {8, 16, std::vector<std::uint16_t>(8 * 16)}));
    expect_refused(asset / "patches.png", "is 8×16, but tile_side in asset.json is 16");
    ASSERT_TRUE(write_exchange_asset(asset, small_asset(), {}));
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
