// Scenes of pattern blocks: their images, and every way in which they can be wrong.
#include <algorithm>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/pattern.pb.h"

#include "server/scene/asset_file.h"
#include "server/scene/image_file.h"
#include "server/scene/pattern_files.h"
#include "server/scene/scene.h"
#include "tests/support/synthetic_asset.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

/// Image (i, j) of a sheet is red i·16 + j, its texels count on in green; alpha is `alpha`.
StraightRgba8Image sheet(std::int32_t side, std::int32_t columns, std::int32_t rows,
                         std::uint8_t alpha = 255) {
    StraightRgba8Image image{side * columns, side * rows, {}};
    for (std::int32_t y = 0; y < image.height; ++y)
        for (std::int32_t x = 0; x < image.width; ++x)
            for (const std::int32_t code :
                 {x / side * 16 + y / side, (y % side * side + x % side) & 255, 77, std::int32_t{alpha}})
                image.bytes.push_back(static_cast<std::uint8_t>(code));
    return image;
}

class PatternScenes : public testing::Test {
  protected:
    void SetUp() override {
        fs::create_directories(scene_);
        write("patterns.png", sheet(16, 2, 2));
        write("leaves.png", sheet(8, 4, 1, 100));
        labels("map.png", 4, 4, 3);
    }

    void write(const char* name, const StraightRgba8Image& image) {
        ASSERT_TRUE(write_rgba_png(scene_ / name, image));
    }
    void labels(const char* name, std::int32_t width, std::int32_t height, std::uint16_t label) {
        ASSERT_TRUE(write_label_png(
            scene_ / name,
            {width, height, std::vector<std::uint16_t>(std::size_t(width) * std::size_t(height), label)}));
    }
    Result<ScenePtr> load(const std::string& json) const {
        std::ofstream{scene_ / "scene.json"} << json;
        return load_scene(scene_);
    }
    /// A pattern of these blocks, beside a grid "cells" of 16 texels and a set "tiles" of four patterns.
    static std::string with_blocks(const std::string& blocks) {
        return R"({"pattern": {"blocks": [
            {"name": "cells", "virtual_tile_map": {"cell_texels": 16}},
            {"name": "tiles", "pattern_set": {"image": "patterns.png", "side_texels": 16}},)" +
               blocks + "]}}";
    }
    static std::string shown(const std::string& index) {
        return R"({"name": "shown", "reference_texture": {"patterns": "tiles", "grid": "cells", "index": )" +
               index + "}}";
    }

    tests::TemporaryFolder folder_;
    const fs::path scene_ = folder_.path / "scene";
};

TEST_F(PatternScenes, ASheetOfPatternsCoversThePlane) {
    const auto scene =
        load(with_blocks(R"({"name": "pick", "virtual_indirection_map": {"grid": "cells", "count": 4}},)" +
                         shown(R"({"block": "pick"})")));
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_EQ((*scene)->texture->kind(), "pattern");
    EXPECT_EQ((*scene)->slices, 1);
    EXPECT_EQ((*scene)->same_slice(-3), 0);
    Rgba8Image texels;
    ASSERT_TRUE((*scene)->texture->evaluate(TexelRegion{0, 0, 0, 64, 16}, {}, texels));
    for (std::int32_t x = 0; x < 64; ++x) {
        EXPECT_THAT(texels.row(3)[4 * x], testing::AnyOf(0, 1, 16, 17));
        EXPECT_EQ(texels.row(3)[4 * x + 1], 3 * 16 + x % 16)
            << "the whole pattern, upright, at its cell's corner";
    }
}

TEST_F(PatternScenes, CheckNamesEveryBlockWithItsKindRateAndFate) {
    const auto scene = load(with_blocks(
        R"({"name": "pick", "virtual_indirection_map": {"grid": "cells", "count": 4}},
           {"name": "unused", "virtual_random_map": {"grid": "cells"}},)" +
        shown(R"({"block": "pick"})")));
    ASSERT_TRUE(scene) << scene.error().detail;
    const std::string& list = (*scene)->block_list;
    EXPECT_EQ(std::count(list.begin(), list.end(), '\n'), 5) << list;
    EXPECT_THAT(list, HasSubstr("tiles   pattern_set              scene"));
    EXPECT_THAT(list, HasSubstr("pick    virtual_indirection_map  cell"));
    EXPECT_THAT(list, HasSubstr("shown   reference_texture        texel"));
    EXPECT_THAT(list, testing::ContainsRegex("unused  virtual_random_map       - +dropped"));
}

TEST_F(PatternScenes, ASetIsReadFromASheetOrFromFilesAlike) {
    const StraightRgba8Image whole = sheet(16, 2, 2, 200);
    write("whole.png", whole);
    proto::PatternSet packed, listed;
    packed.set_image("whole.png");
    packed.set_side_texels(16);
    for (int i = 0; i < 4; ++i) {
        StraightRgba8Image part{16, 16, {}};
        for (std::ptrdiff_t y = 0; y < 16; ++y) {
            const auto row = whole.bytes.begin() + ((i / 2 * 16 + y) * 32 + i % 2 * 16) * 4;
            part.bytes.insert(part.bytes.end(), row, row + 64);
        }
        const std::string name = "part" + std::to_string(i) + ".png";
        write(name.c_str(), part);
        listed.add_files(name);
    }
    PatternFiles files{scene_};
    const auto one = files.read_patterns("set", packed), four = files.read_patterns("set", listed);
    ASSERT_TRUE(one && four) << (one ? four : one).error().detail;
    EXPECT_EQ(one->codes, four->codes);
    EXPECT_EQ(one->count, 4);
    EXPECT_EQ(one->image(2, 0)[0], 1) << "row by row: the third is the first of the second row";
    EXPECT_EQ(one->image(1, 0)[3], 200);

    // Two patterns of two slices each: slices follow each other
    packed.set_slices(2);
    const auto volumes = files.read_patterns("set", packed);
    ASSERT_TRUE(volumes) << volumes.error().detail;
    EXPECT_EQ(volumes->count, 2);
    EXPECT_EQ(volumes->image(1, 0)[0], 1);
    EXPECT_EQ(volumes->codes, one->codes);
    packed.set_count(1);
    EXPECT_EQ(files.read_patterns("set", packed)->count, 1);
    // A strip says how large its patterns are
    proto::PatternSet strip;
    strip.set_image("leaves.png");
    EXPECT_EQ(files.read_patterns("set", strip)->count, 4);
}

TEST_F(PatternScenes, MapsAreCodesAndNoColours) {
    LabelImage image{3, 2, {0, 1, 255, 256, 40000, 65535}};
    ASSERT_TRUE(write_label_png(scene_ / "codes.png", image));
    PatternFiles files{scene_};
    const auto map = files.read_map("map", "codes.png");
    ASSERT_TRUE(map) << map.error().detail;
    EXPECT_EQ(map->width, 3);
    std::vector<std::int32_t> values(map->values.size());
    map->values.copy(0, values.size(), values.data());
    EXPECT_THAT(values, testing::ElementsAre(0, 1, 255, 256, 40000, 65535));
    const auto colours = files.read_map("map", "patterns.png");
    EXPECT_THAT(colours.error().detail,
                AllOf(StartsWith("map: "), HasSubstr("patterns.png: is no grey PNG of 8 or 16 bits")));
}

TEST_F(PatternScenes, TheFingerprintCoversEveryImage) {
    const std::string json = with_blocks(
        R"({"name": "stored", "explicit_indirection_map": {"grid": "cells", "image": "map.png"}},)" +
        shown(R"({"block": "stored"})"));
    std::set<std::string> prints;
    const auto add = [&] {
        const auto scene = load(json);
        ASSERT_TRUE(scene) << scene.error().detail;
        prints.insert((*scene)->fingerprint);
    };
    add();
    labels("map.png", 4, 4, 2);
    add();
    write("patterns.png", sheet(16, 2, 2, 254));
    add();
    EXPECT_EQ(prints.size(), 3u);
}

TEST_F(PatternScenes, AVolumeRepeatsAfterItsSlicesAnd3dCellsNeverDo) {
    const std::string volume =
        R"({"name": "volume", "pattern_set": {"image": "patterns.png", "side_texels": 16, "slices": 2}},)";
    const auto flat_cells = load(with_blocks(
        volume + R"({"name": "shown", "reference_texture": {"patterns": "volume", "grid": "cells"}})"));
    ASSERT_TRUE(flat_cells) << flat_cells.error().detail;
    EXPECT_EQ((*flat_cells)->slices, 2);
    EXPECT_EQ((*flat_cells)->same_slice(-1), 1);
    EXPECT_EQ((*flat_cells)->same_slice(6), 0);
    Rgba8Image first, second;
    ASSERT_TRUE((*flat_cells)->texture->evaluate(TexelRegion{0, 0, 0, 16, 16, 0}, {}, first));
    ASSERT_TRUE((*flat_cells)->texture->evaluate(TexelRegion{0, 0, 0, 16, 16, 1}, {}, second));
    EXPECT_EQ(first.bytes[0], 0);
    EXPECT_EQ(second.bytes[0], 16);

    const auto deep_cells = load(
        with_blocks(volume + R"({"name": "deep", "virtual_tile_map": {"cell_texels": 16, "cell_slices": 2}},
                    {"name": "pick", "virtual_indirection_map": {"grid": "deep", "count": 2}},
                    {"name": "shown", "reference_texture":
                        {"patterns": "volume", "grid": "deep", "index": {"block": "pick"}}})"));
    ASSERT_TRUE(deep_cells) << deep_cells.error().detail;
    EXPECT_EQ((*deep_cells)->slices, 0);
    EXPECT_EQ((*deep_cells)->same_slice(-7), -7);
}

TEST_F(PatternScenes, APreparedPhotographIsAGround) {
    ASSERT_TRUE(write_exchange_asset(scene_ / "asset", tests::make_synthetic_asset({}), {}));
    const std::string over = R"({"name": "ground", "content_exchange": {"asset": "asset"}},
        {"name": "all", "layers": {"textures": ["ground", "shown"]}})";
    const auto scene = load(with_blocks(shown(R"({"integer": 1})") + "," + over));
    ASSERT_TRUE(scene) << scene.error().detail;
    const auto wrong = load(with_blocks(R"({"name": "ground", "wang": {"asset": "asset"}})"));
    ASSERT_FALSE(wrong);
    EXPECT_THAT(wrong.error().detail,
                HasSubstr("scene.json: pattern.blocks[2] \"ground\".wang.asset: \"asset\" was prepared for "
                          "content_exchange; name the field so"));
    const auto outside = load(with_blocks(R"({"name": "ground", "wang": {"asset": "../asset"}})"));
    EXPECT_THAT(outside.error().detail,
                HasSubstr("\"ground\".wang.asset: \"../asset\" leaves the scene's folder"));
}

struct Wrong {
    const char* what;
    std::string blocks;
    std::vector<std::string> says;
};

TEST_F(PatternScenes, WhatIsWrongIsNamedByFileBlockAndField) {
    write("odd.png", sheet(12, 2, 1));
    write("one.png", sheet(16, 1, 1));
    ASSERT_TRUE(write_rgba_png(folder_.path / "outside.png", sheet(16, 1, 1)));
    fs::create_symlink(folder_.path / "outside.png", scene_ / "link.png");
    std::ofstream{scene_ / "cut.png", std::ios::binary} << "\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
    labels("nine.png", 4, 4, 9);
    const std::string pick = R"({"name": "pick", "virtual_indirection_map": {"grid": "cells", "count": 4}},)";
    const auto map = [](const std::string& fields) {
        return R"({"name": "stored", "explicit_indirection_map": {"grid": "cells", )" + fields + "}}," +
               shown(R"({"block": "stored"})");
    };
    const auto set = [](const std::string& fields) {
        return R"({"name": "set", "pattern_set": {)" + fields +
               R"(}}, {"name": "shown", "reference_texture": {"patterns": "set", "grid": "cells"}})";
    };
    const auto transform = [](const std::string& fields) {
        return R"({"name": "set", "pattern_set": {"image": "leaves.png"}},
                  {"name": "turned", "tile_transform": {"grid": "cells", )" +
               fields + R"(}},
                  {"name": "shown", "reference_texture": {"patterns": "set", "grid": "cells", "transform": "turned"}})";
    };
    const std::string combination = R"({"corners": [0, 0, 0, 0], "patterns": {"entries": [{"pattern": 0}]}})";
    const std::vector<Wrong> wrongs{
        {"a map of the wrong size",
         map(R"("values": [0, 1, 2], "width": 2)"),
         {R"(blocks[2] "stored")", "values"}},
        {"a map without a width", map(R"("values": [0, 1])"), {R"("stored")", "width"}},
        {"an empty map", map(R"("width": 2)"), {R"("stored")"}},
        {"an index beyond the set, in a map", map(R"("values": [0, 4], "width": 2)"), {"4", "shown"}},
        {"an index beyond the set, in an image", map(R"("image": "nine.png")"), {"9", "shown"}},
        {"an index beyond the set, constant",
         shown(R"({"integer": 4})"),
         {R"(blocks[2] "shown")", "index", "4"}},
        {"an index below blank", shown(R"({"integer": -2})"), {R"("shown")", "-2"}},
        {"a probability of 0 everywhere",
         pick + R"({"name": "p", "probability_map": {"index": {"block": "pick"}, "material":
            {"entries": [{"pattern": 0, "weight": 0}]}}},)" +
             shown(R"({"block": "p"})"),
         {R"(blocks[3] "p".material)", "weight"}},
        {"a transition set with missing combinations",
         pick + R"({"name": "t", "transition_tiles": {"families": 2, "material": {"integer": 0},
            "index": {"block": "pick"}, "combinations": [)" +
             combination + "]}}," + shown(R"({"block": "t"})"),
         {R"("t".combinations)", "combinations"}},
        {"a block that goes round",
         R"({"name": "a", "layers": {"textures": ["b"]}}, {"name": "b", "layers": {"textures": ["a"]}})",
         {"a -> b -> a"}},
        {"a dangling name", shown(R"({"block": "nobody"})"), {R"("shown")", "index", "nobody"}},
        {"a block of another type", shown(R"({"block": "tiles"})"), {R"("shown")", "index", "tiles"}},
        {"two blocks of one name", pick + pick + shown("{}"), {R"("pick")"}},
        {"a 0-sized grid",
         R"({"name": "none", "virtual_tile_map": {}}, {"name": "shown", "reference_texture":
            {"patterns": "tiles", "grid": "none"}})",
         {R"("none".cell_texels)", "is 0"}},
        {"a scale of 0", transform(R"("scale": {"number": 0})"), {R"("turned".scale)"}},
        {"a scale of NaN", transform(R"("scale": {"number": "NaN"})"), {R"("turned".scale)"}},
        {"an endless scale", transform(R"("scale": {"number": "Infinity"})"), {R"("turned".scale)"}},
        {"a scale that does not fit",
         transform(R"("scale": {"number": 4})"),
         {R"("shown".transform)", "The largest scale that fits is 2"}},
        {"a truncated sheet",
         set(R"("image": "cut.png")"),
         {R"("set".pattern_set.image: )", "cut.png: is a broken"}},
        {"a missing sheet",
         set(R"("image": "none.png")"),
         {R"("set".pattern_set.image: )", "there is no such file"}},
        {"a sheet of no whole patterns",
         set(R"("image": "odd.png", "side_texels": 16)"),
         {R"("set".pattern_set.image: "odd.png", which is 24×12, holds no whole number of patterns of 16)"}},
        {"a sheet that says no side",
         set(R"("image": "odd.png")"),
         {R"("set".pattern_set.side_texels: is unset)"}},
        {"a side that is no power of two",
         set(R"("image": "odd.png", "side_texels": 12)"),
         {R"("set".pattern_set.side_texels: is 12)"}},
        {"a side beyond the limit",
         set(R"("image": "odd.png", "side_texels": 2048)"),
         {"side_texels: is 2048"}},
        {"more patterns than there are",
         set(R"("image": "leaves.png", "count": 5)"),
         {R"("set".pattern_set.count: is 5, but "leaves.png", which is 32×8, has room for 4 images)"}},
        {"more slices than there are",
         set(R"("image": "leaves.png", "slices": 5)"),
         {R"("set".pattern_set.slices: is 5, but)"}},
        {"no images", set(""), {R"("set".pattern_set)"}},
        {"both kinds of images",
         set(R"("image": "leaves.png", "files": ["leaves.png"])"),
         {R"("set".pattern_set)"}},
        {"a file that is not square",
         set(R"("files": ["leaves.png"])"),
         {R"(.files[0]: "leaves.png" is 32×8; a pattern is a)"}},
        {"files of two sizes",
         set(R"("files": ["one.png", "patterns.png"], "side_texels": 16)"),
         {R"(.files[1]: "patterns.png" is 32×32; the patterns of this set are 16×16)"}},
        {"files that fill no volume",
         set(R"("files": ["a", "b", "c"], "slices": 2)"),
         {"files, which are no multiple"}},
        {"a path that leaves the folder",
         set(R"("image": "../outside.png")"),
         {R"("set".pattern_set.image: "../outside.png" leaves the scene's folder)"}},
        {"an absolute path", set(R"("image": "/etc/passwd")"), {R"(leaves the scene's folder)"}},
        {"a link that leaves the folder",
         set(R"("image": "link.png")"),
         {R"("link.png" leaves the scene's folder)"}},
        {"a name with a NUL", set(R"("image": "leaves.png\u0000")"), {R"(leaves the scene's folder)"}},
        {"a map that leaves the folder",
         map(R"("image": "../outside.png")"),
         {R"("stored")", "image", "leaves the scene's folder"}},
        {"no file but a folder", set(R"("image": ".")"), {R"("set".pattern_set.image: )", "is not a file"}},
    };
    for (const Wrong& wrong : wrongs) {
        const auto scene = load(with_blocks(wrong.blocks));
        ASSERT_FALSE(scene) << wrong.what;
        EXPECT_THAT(scene.error().detail, StartsWith((scene_ / "scene.json").string() + ": ")) << wrong.what;
        for (const std::string& word : wrong.says)
            EXPECT_THAT(scene.error().detail, HasSubstr(word)) << wrong.what;
    }
}

TEST_F(PatternScenes, ASheetThatWouldExhaustMemoryIsRefusedUnread) {
    ASSERT_TRUE(write_rgb_png(scene_ / "huge.png", {1, 1, {1, 2, 3}}));
    std::string png = [&] {
        std::ifstream in{scene_ / "huge.png", std::ios::binary};
        return std::string{std::istreambuf_iterator<char>{in}, {}};
    }();
    png.replace(16, 8, std::string{"\0\0\x40\0\0\0\x40\0", 8});  // 16384², with a checksum that is wrong then
    std::ofstream{scene_ / "huge.png", std::ios::binary} << png;
    EXPECT_FALSE(load(with_blocks(
        R"({"name": "set", "pattern_set": {"image": "huge.png"}},
           {"name": "shown", "reference_texture": {"patterns": "set", "grid": "cells"}})")));

    // Each is small enough; together they are too much
    proto::PatternSet set;
    set.set_image("patterns.png");
    set.set_side_texels(16);
    PatternFiles files{scene_, 3 * 4 * 16 + 4 * 32 * 32 - 1};
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(files.read_map("map", "map.png")) << i;
    const auto one_more = files.read_patterns("set", set);
    ASSERT_FALSE(one_more);
    EXPECT_THAT(one_more.error().detail, StartsWith("set.image: "));
    EXPECT_THAT(one_more.error().detail, EndsWith("or name fewer images in the scene"));
}

TEST_F(PatternScenes, TenThousandBlocksAreRefusedAndALongChainToo) {
    std::string many, chain;
    for (int i = 0; i < 10'000; ++i) many += R"({"name": "b)" + std::to_string(i) + R"(", "constant": {}},)";
    many.pop_back();
    const auto refused = load(with_blocks(many));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().detail,
                HasSubstr("scene.json: pattern.blocks: holds 10002 blocks; at most 4096"));

    chain = R"({"name": "b0", "constant": {"red": 10}})";
    for (int i = 1; i < 4000; ++i)
        chain += R"(,{"name": "b)" + std::to_string(i) + R"(", "layers": {"textures": ["b)" +
                 std::to_string(i - 1) + "\"]}}";
    const auto long_one = load(with_blocks(chain));
    ASSERT_FALSE(long_one);
    EXPECT_THAT(long_one.error().detail,
                HasSubstr("pattern.blocks[1026] \"b1024\".textures: show 1025 textures"));
}

TEST_F(PatternScenes, JsonThatIsTooDeepIsRefusedAndALargeMapIsNot) {
    std::string deep = R"({"pattern": )";
    for (int i = 0; i < 100'000; ++i) deep += R"({"blocks": [)";
    const auto nested = load(deep);
    ASSERT_FALSE(nested);
    EXPECT_THAT(nested.error().detail, HasSubstr("scene.json"));

    std::string values = "0";
    for (int i = 1; i < 1024 * 1024; ++i) values += i % 3 == 0 ? ",1" : ",2";
    const auto large = load(with_blocks(
        R"({"name": "stored", "explicit_indirection_map": {"grid": "cells", "width": 1024, "values": [)" +
        values + "]}}," + shown(R"({"block": "stored"})")));
    ASSERT_TRUE(large) << large.error().detail;
}

TEST_F(PatternScenes, OneBrokenSceneDoesNotStopTheOthers) {
    ASSERT_TRUE(load(with_blocks(shown("{}"))));
    fs::copy(scene_, folder_.path / "broken", fs::copy_options::recursive);
    fs::remove(folder_.path / "broken" / "patterns.png");
    const auto catalog = load_catalog(folder_.path);
    ASSERT_TRUE(catalog);
    EXPECT_EQ(catalog->scenes.size(), 1u);
    ASSERT_EQ(catalog->broken.size(), 1u);
    EXPECT_EQ(catalog->broken[0].id, "broken");
    EXPECT_THAT(catalog->broken[0].message,
                AllOf(HasSubstr("broken/scene.json: pattern.blocks[1] \"tiles\".pattern_set.image: "),
                      HasSubstr("patterns.png: there is no such file")));
}

}  // namespace
}  // namespace tessera
