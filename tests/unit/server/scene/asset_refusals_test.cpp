// Assets that do not hold together: each fault is refused, and told with its file and field.
#include <fstream>
#include <functional>

#include "server/scene/image_file.h"
#include "tests/support/synthetic_asset.h"
#include "tests/unit/server/scene/asset_folder.h"

namespace tessera {
namespace {

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
        {[](auto& m) { m.mutable_patches_info(3)->set_group(1); },
         "patches_info[3].group: is 1; only interchange has groups"},
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
        {made, [](auto& m) { m.mutable_patches_info(2)->set_group(257); },
         "patches_info[2].group: is 257; from 1 to 256, or 0"},
        {made, [](auto& m) { m.mutable_patches_info(0)->set_group(1); },
         "patches_info[0].set: is \"a\", but the patch is in group 1; leave one of them out"},
        {made,
         [](auto& m) {
             m.mutable_patches_info(2)->set_group(1);
             m.mutable_patches_info(2)->set_x(128);
         },
         "patches_info[2].x: is 128; from -8 to 127"},
        {made,
         [](auto& m) {
             m.mutable_patches_info(2)->set_group(7);
             m.add_patches_info()->CopyFrom(m.patches_info(2));
             m.mutable_patches_info(3)->set_x(15);  // of a diagonal of texels: the third meets the first
             m.mutable_patches_info(3)->set_y(-1);
         },
         "patches_info[3]: overlaps another patch of group 7 at texel (15, -1); take one of them out"},
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

}  // namespace
}  // namespace tessera
