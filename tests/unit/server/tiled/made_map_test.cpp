// Maps made here, whose texels are known.
#include "tests/unit/server/tiled/layer_text.h"
#include "tests/unit/server/tiled/map_folder.h"

namespace tessera {
namespace {

using test::joined;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using MadeMap = test::MapFolder;
using Texel = std::array<int, 4>;

std::string map_of(const std::string& tilesets, const std::string& layers, int width, int height,
                   int tile = 8) {
    return R"(<?xml version="1.0" encoding="UTF-8"?>
<map version="1.10" orientation="orthogonal" width=")" +
           std::to_string(width) + R"(" height=")" + std::to_string(height) + R"(" tilewidth=")" +
           std::to_string(tile) + R"(" tileheight=")" + std::to_string(tile) + "\">\n" + tilesets + layers +
           "</map>\n";
}

std::string tileset(int first, const std::string& image, int tile = 8, const std::string& more = "",
                    const std::string& attributes = "") {
    return "<tileset firstgid=\"" + std::to_string(first) + R"(" name="tiles" tilewidth=")" +
           std::to_string(tile) + R"(" tileheight=")" + std::to_string(tile) + "\" " + attributes +
           "><image source=\"" + image + "\"/>" + more + "</tileset>\n";
}

std::string layer(const std::vector<std::uint32_t>& tiles, int width, int height,
                  const std::string& attributes = "", const std::string& encoding = "csv",
                  const std::string& compression = "") {
    return "<layer name=\"Ground\" width=\"" + std::to_string(width) + "\" height=\"" +
           std::to_string(height) + "\" " + attributes + "><data encoding=\"" + encoding +
           "\" compression=\"" + compression + "\">" + test::layer_text(tiles, encoding, compression) +
           "</data></layer>\n";
}

TEST_F(MadeMap, EveryCellShowsItsTileInEveryCoding) {
    write_tiles("tiles.png", 4, 2, 8, 8, 1, 2);
    for (const auto& [encoding, compression] : std::vector<std::pair<std::string, std::string>>{
             {"csv", ""}, {"base64", ""}, {"base64", "zlib"}, {"base64", "gzip"}, {"base64", "zstd"}}) {
        write("map.tmx", map_of(tileset(1, "tiles.png", 8, "", "margin=\"1\" spacing=\"2\""),
                                layer({8, 1, 2, 3, 0, 5}, 3, 2, "", encoding, compression), 3, 2));
        const auto scene = import("map.tmx");
        ASSERT_TRUE(scene) << scene.error().detail;
        EXPECT_TRUE(scene->left_out.empty()) << joined(scene->left_out);
        const Rgba8Image shown = texels(0, 0, 32, 24);
        constexpr int tiles[2][3] = {{7, 0, 1}, {2, -1, 4}};
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 32; ++x) {
                const int tile = x < 24 && y < 16 ? tiles[y / 8][x / 8] : -1;
                const Texel expected = tile < 0 ? Texel{0, 0, 0, 0} : Texel{16 * tile, x % 8, y % 8, 255};
                ASSERT_EQ(texel(shown, x, y), expected) << x << ", " << y;
            }
    }
}

TEST_F(MadeMap, FlippedTilesAreTransposedThenMirrored) {
    write_tiles("tiles.png", 2, 1, 8, 8);
    std::vector<std::uint32_t> tiles;
    for (std::uint32_t flips = 0; flips < 8; ++flips) tiles.push_back(2 | flips << 29);
    write("map.tmx", map_of(tileset(1, "tiles.png"), layer(tiles, 8, 1), 8, 1));
    ASSERT_TRUE(import("map.tmx"));
    const Rgba8Image shown = texels(0, 0, 64, 8);
    for (int flips = 0; flips < 8; ++flips)
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) {
                int u = (flips & 4) != 0 ? 7 - x : x, v = (flips & 2) != 0 ? 7 - y : y;
                if ((flips & 1) != 0) std::swap(u, v);
                ASSERT_EQ(texel(shown, 8 * flips + x, y), (Texel{16, u, v, 255})) << flips;
            }
}

TEST_F(MadeMap, TilesetsMayBeFilesAndCollectionsOfImages) {
    write_tiles("tiles.png", 2, 1, 8, 8);
    write_tiles("one.png", 1, 1, 8, 8);
    write(
        "set.tsx",
        R"(<tileset name="set" tilewidth="8" tileheight="8"><image source="tiles.png" trans="100001"/></tileset>)");
    write("pieces.tsx", R"(<tileset name="pieces" tilewidth="8" tileheight="8">
        <tile id="5"><image source="one.png"/></tile></tileset>)");
    write("map.tmx",
          map_of(R"(<tileset firstgid="10" source="pieces.tsx"/><tileset firstgid="1" source="set.tsx"/>)",
                 layer({2, 15, 11, 3}, 4, 1), 4, 1));
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    const Rgba8Image shown = texels(0, 0, 32, 8);
    EXPECT_EQ(texel(shown, 3, 2), (Texel{16, 3, 2, 255}));
    EXPECT_EQ(texel(shown, 0, 1)[3], 0) << "the colour that is named as transparent";
    EXPECT_EQ(texel(shown, 8 + 3, 2), (Texel{0, 3, 2, 255}));
    EXPECT_EQ(texel(shown, 16, 0)[3], 0);
    EXPECT_THAT(joined(scene->left_out),
                HasSubstr("layer \"Ground\": 2 cells name tiles that no tileset has"));
}

TEST_F(MadeMap, AnInfiniteMapBeginsWhereItsTilesDo) {
    write_tiles("tiles.png", 4, 1, 8, 8);
    write("map.tmx",
          R"(<map orientation="orthogonal" width="1" height="1" tilewidth="8" tileheight="8" infinite="1">)" +
              tileset(1, "tiles.png") + R"(<layer name="a" width="1" height="1"><data encoding="csv">
<chunk x="-2" y="-1" width="2" height="2">1,2,3,4</chunk><chunk x="2" y="0" width="1" height="1">4</chunk>
</data></layer></map>)");
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_THAT(joined(scene->made), HasSubstr("its cell (-2, -1) is the texture's corner"));
    const Rgba8Image shown = texels(0, 0, 48, 16);
    EXPECT_EQ(texel(shown, 9, 1), (Texel{16, 1, 1, 255}));
    EXPECT_EQ(texel(shown, 8, 9), (Texel{48, 0, 1, 255}));
    EXPECT_EQ(texel(shown, 33, 9), (Texel{48, 1, 1, 255}));
    EXPECT_EQ(texel(shown, 20, 9)[3], 0);
}

TEST_F(MadeMap, TilesLargerThanCellsReachUpAndRightAndLieOverEarlierOnes) {
    write_tiles("large.png", 2, 1, 16, 16);
    write("map.tmx", map_of(tileset(1, "large.png", 16), layer({0, 0, 0, 1, 2, 0}, 3, 2), 3, 2));
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    const Rgba8Image shown = texels(0, 0, 32, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x)
            ASSERT_EQ(texel(shown, x, y), (x >= 24  ? Texel{0, 0, 0, 0}
                                           : x >= 8 ? Texel{16, x - 8, y, 255}
                                                    : Texel{0, x, y, 255}))
                << x << ", " << y;
}

TEST_F(MadeMap, LayersKeepOpacityTintAndOffset) {
    write_tiles("tiles.png", 4, 1, 8, 8);
    write("map.tmx", map_of(tileset(1, "tiles.png"),
                            "<group opacity=\"0.5\" offsetx=\"4\">" +
                                layer({4}, 1, 1, "tintcolor=\"#80ffffff\" offsety=\"-3\"") + "</group>",
                            1, 1));
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_TRUE(scene->left_out.empty()) << joined(scene->left_out);
    const Rgba8Image shown = texels(0, 0, 16, 8);
    EXPECT_EQ(texel(shown, 3, 0)[3], 0);
    EXPECT_EQ(texel(shown, 4, 0)[3], 64) << "half of 128";
    EXPECT_EQ(texel(shown, 11, 4)[3], 64);
    EXPECT_EQ(texel(shown, 12, 4)[3], 0);
    EXPECT_EQ(texel(shown, 5, 5)[3], 0) << "three texels higher";
}

TEST_F(MadeMap, OtherSizesAreResampledByArea) {
    for (const auto& [side, expected] : {std::pair{24, 32}, {6, 8}, {5, 4}, {3, 4}, {1, 1}, {31, 32}}) {
        write_tiles("tiles.png", 1, 1, side, side);
        write("map.tmx", map_of(tileset(1, "tiles.png", side), layer({1}, 1, 1), 1, 1, side));
        const auto scene = import("map.tmx");
        ASSERT_TRUE(scene) << scene.error().detail;
        const auto& sheet = scene->sheets.at(0).image;
        EXPECT_EQ(sheet.width, expected);
        if (side == expected) continue;
        EXPECT_THAT(joined(scene->left_out), HasSubstr("each texel the mean of the area"));
    }
    // Halves of black and white become halves: the mean of light does not change
    StraightRgba8Image board{6, 6, {}};
    for (int i = 0; i < 36; ++i)
        for (int c = 0; c < 4; ++c)
            board.bytes.push_back(static_cast<std::uint8_t>(c == 3 || i % 6 < 3 ? 255 : 0));
    ASSERT_TRUE(write_rgba_png(at("board.png"), board));
    write("map.tmx", map_of(tileset(1, "board.png", 6), layer({1}, 1, 1), 1, 1, 6));
    ASSERT_TRUE(import("map.tmx"));
    const Rgba8Image shown = texels(0, 0, 8, 8);
    for (int x = 0; x < 8; ++x) EXPECT_EQ(texel(shown, x, 5)[0], x < 4 ? 255 : 0) << x;
}

TEST_F(MadeMap, ProbabilitiesTerrainsAndAnimationsBecomeBlocks) {
    write_tiles("tiles.png", 6, 3, 8, 8);
    std::string more = R"(<tile id="0" probability="0.25"/><tile id="1" probability="0"/>
        <tile id="16"><animation><frame tileid="17" duration="100"/><frame tileid="16" duration="250"/></animation></tile>
        <wangsets><wangset name="land" type="corner"><wangcolor name="Grass"/><wangcolor name="Sea"/><wangcolor name="Sand"/>)";
    for (int bits = 0; bits < 16; ++bits) {
        const auto color = [&](int bit) { return std::to_string((bits >> bit & 1) + 1); };
        // top left, top right, bottom left, bottom right are bits 0 to 3
        more += "<wangtile tileid=\"" + std::to_string(bits) + "\" wangid=\"0," + color(1) + ",0," +
                color(3) + ",0," + color(2) + ",0," + color(0) + "\"/>";
    }
    more += R"(<wangtile tileid="17" wangid="0,1,0,3,0,3,0,3"/></wangset>
        <wangset name="roads" type="edge"><wangcolor name="Road"/></wangset></wangsets>)";
    write("map.tmx", map_of(tileset(1, "tiles.png", 8, more), layer({17, 1}, 2, 1), 2, 1));
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_EQ(texel(texels(0, 0, 8, 8), 0, 0), (Texel{(16 * 17) & 255, 0, 0, 255})) << "the first frame";
    EXPECT_THAT(joined(scene->made),
                AllOf(HasSubstr("probability map \"tiles-probabilities\""),
                      HasSubstr("Grass and Sea: transition tiles, shown by \"tiles-Grass-Sea\""),
                      HasSubstr("shown by \"tiles-16-animated\"")));
    EXPECT_THAT(joined(scene->left_out),
                AllOf(HasSubstr("Grass and Sand lack 14 of the 16 combinations"),
                      HasSubstr("\"roads\" colours edge sides"),
                      HasSubstr("1 animated tiles stand at their first frame"), HasSubstr("is 50 ms")));

    for (const auto& block : scene->scene.pattern().blocks()) {
        if (block.has_animation_sequence()) {
            ASSERT_EQ(block.animation_sequence().frames_size(), 2);
            EXPECT_EQ(block.animation_sequence().frames(0).pattern(), 17);
            EXPECT_EQ(block.animation_sequence().frames(1).steps(), 5u);
        }
        if (block.has_probability_map()) {
            const auto& entries = block.probability_map().material().entries();
            ASSERT_EQ(entries.size(), 17) << "tile 1 has probability 0";
            EXPECT_EQ(entries[0].weight(), 25u);
            EXPECT_EQ(entries[1].weight(), 100u);
        }
        if (!block.has_reference_texture()) continue;
        // Each of them is a texture of its own
        std::ifstream in{at("scene") / "scene.json"};
        std::string text{std::istreambuf_iterator<char>{in}, {}};
        const std::string output = "\"output\": \"" + scene->scene.pattern().output() + "\"";
        ASSERT_NE(text.find(output), std::string::npos);
        text.replace(text.find(output), output.size(), "\"output\": \"" + block.name() + "\"");
        std::filesystem::create_directories(at("other"));
        std::filesystem::copy(
            at("scene"), at("other"),
            std::filesystem::copy_options::overwrite_existing | std::filesystem::copy_options::recursive);
        std::ofstream{at("other") / "scene.json"} << text;
        const auto other = load_scene(at("other"));
        ASSERT_TRUE(other) << other.error().detail;
        if (block.name() != "tiles-Grass-Sea") continue;
        // The tile of a cell is that of its corners, and neighbours share these
        Rgba8Image shown;
        ASSERT_TRUE((*other)->texture->evaluate(TexelRegion{0, 0, 0, 256, 256}, {}, shown));
        std::set<int> seen;
        for (int y = 0; y < 31; ++y)
            for (int x = 0; x < 31; ++x) {
                const int bits = texel(shown, 8 * x, 8 * y)[0] / 16;
                const int right = texel(shown, 8 * x + 8, 8 * y)[0] / 16;
                const int below = texel(shown, 8 * x, 8 * y + 8)[0] / 16;
                seen.insert(bits);
                ASSERT_EQ(bits >> 1 & 1, right & 1);
                ASSERT_EQ(bits >> 3 & 1, right >> 2 & 1);
                ASSERT_EQ(bits >> 2 & 3, below & 3);
            }
        EXPECT_EQ(seen.size(), 16u);
    }
}

std::string objects(const std::string& objects, const std::string& attributes = "") {
    return "<objectgroup name=\"things\" " + attributes + ">" + objects + "</objectgroup>\n";
}

TEST_F(MadeMap, TilesAtFreePlacesBecomeSpritesTexelForTexel) {
    write_tiles("tiles.png", 4, 2, 8, 8);
    // Objects stand on their position; what stands lower lies over
    write("map.tmx", map_of(tileset(1, "tiles.png"),
                            layer(std::vector<std::uint32_t>(16, 1), 4, 4) +
                                objects(R"(<object gid="4" x="12" y="17"/><object gid="3" x="9" y="14"/>
                                           <object gid="2147483654" x="20" y="30" width="8" height="8"/>)"),
                            4, 4));
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_THAT(joined(scene->made), HasSubstr("object layer \"things\": 3 sprites"));
    EXPECT_THAT(scene->left_out, testing::IsEmpty());
    const Rgba8Image shown = texels(0, 0, 32, 32);
    EXPECT_EQ(texel(shown, 8, 6), (Texel{0, 0, 6, 255}));
    EXPECT_EQ(texel(shown, 9, 6), (Texel{32, 0, 0, 255}));
    EXPECT_EQ(texel(shown, 11, 13), (Texel{32, 2, 7, 255}));
    EXPECT_EQ(texel(shown, 12, 9), (Texel{48, 0, 0, 255})) << "the lower one lies over the other";
    EXPECT_EQ(texel(shown, 19, 16), (Texel{48, 7, 7, 255}));
    EXPECT_EQ(texel(shown, 20, 22), (Texel{80, 7, 0, 255})) << "mirrored";
}

TEST_F(MadeMap, SpritesAreAlignedTurnedAndStretchedAsTheEditorDoes) {
    write_tiles("tiles.png", 2, 1, 8, 8);
    write("map.tmx", map_of(tileset(1, "tiles.png", 8, "", R"(objectalignment="center")"),
                            objects(R"(<object gid="2" x="12" y="12" rotation="90"/>
                            <object gid="2" x="32" y="12" width="16" height="4"/>
                            <object gid="2" x="44" y="44" width="16" height="16"/>)"),
                            8, 8));
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    const proto::Sprites& sprites = scene->scene.sprites();
    ASSERT_EQ(sprites.placed_size(), 3);
    EXPECT_EQ(sprites.placed(0).turn(), 0.25);
    EXPECT_EQ(sprites.placed(2).scale(), 2);
    const Rgba8Image shown = texels(0, 0, 64, 64);
    // A quarter turn takes the tile's left column to the top row, from the right to the left
    EXPECT_EQ(texel(shown, 15, 8), (Texel{16, 0, 0, 255}));
    EXPECT_EQ(texel(shown, 8, 8), (Texel{16, 0, 7, 255}));
    EXPECT_EQ(texel(shown, 15, 15), (Texel{16, 7, 0, 255}));
    EXPECT_EQ(texel(shown, 0, 0), (Texel{0, 0, 0, 0})) << "nothing is below";
    EXPECT_EQ(texel(shown, 32, 12)[3], 255);
    EXPECT_EQ(texel(shown, 32, 15)[3], 0) << "a quarter as high as wide";
    EXPECT_EQ(texel(shown, 44, 44)[0], 16);
}

TEST_F(MadeMap, AVisitorBeginsInTheMiddleOfTheMap) {
    write_tiles("tiles.png", 2, 1, 8, 8);
    write("map.tmx",
          map_of(tileset(1, "tiles.png"), layer(std::vector<std::uint32_t>(512 * 3, 1), 512, 3), 512, 3));
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_EQ(scene->scene.view().x(), 2048);
    EXPECT_EQ(scene->scene.view().y(), 12);
    EXPECT_EQ(scene->scene.view().level(), 2);
}

TEST_F(MadeMap, SpritesBelowLayersAreListedAndAnimatedOnesMove) {
    write_tiles("tiles.png", 4, 2, 8, 8);
    write("map.tmx", map_of(tileset(1, "tiles.png", 8,
                                    R"(<tile id="2"><animation><frame tileid="2" duration="200"/>
                            <frame tileid="5" duration="400"/></animation></tile>)"),
                            objects(R"(<object gid="3" x="8" y="16"/>)") + layer({1, 0, 0, 1}, 2, 2), 2, 2));
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_THAT(joined(scene->left_out), HasSubstr("\"things\": lies below a layer of tiles"));
    EXPECT_EQ(scene->scene.clock().steps_per_second(), 5);
    const auto loaded = load_scene(at("scene"));
    ASSERT_TRUE(loaded) << loaded.error().detail;
    for (const auto& [step, red] : {std::pair{0, 32}, {1, 80}, {2, 80}, {3, 32}}) {
        Rgba8Image out;
        TexelRegion region{0, 8, 8, 8, 8};
        region.step = step;
        ASSERT_TRUE((*loaded)->texture->evaluate(region, {}, out));
        EXPECT_EQ(texel(out, 0, 0)[0], red) << step;
    }
}

TEST_F(MadeMap, WhatASceneCannotHoldIsListedAndWrittenBesideIt) {
    write_tiles("tiles.png", 2, 1, 8, 8);
    write("map.tmx", map_of(tileset(1, "tiles.png", 8, "<tile id=\"0\"><objectgroup/></tile>"),
                            layer({1}, 1, 1, "parallaxx=\"0.5\" offsetx=\"0.25\" mode=\"multiply\"") +
                                layer({1}, 1, 1, "visible=\"0\"") +
                                R"(<imagelayer name="sky"><image source="x.png"/></imagelayer>
                        <objectgroup name="things"><object gid="1" visible="0"/>
                        <object gid="99"/><object template="x.tx"/><object/></objectgroup>)",
                            1, 1));
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    std::ifstream in{at("scene") / "import.txt"};
    const std::string report{std::istreambuf_iterator<char>{in}, {}};
    EXPECT_EQ(report, scene->report());
    EXPECT_THAT(
        report,
        AllOf(HasSubstr("(parallax)"), HasSubstr("blended as \"multiply\""),
              HasSubstr("moved by parts of a texel"), HasSubstr("is hidden in the editor"),
              HasSubstr("image layer \"sky\""), HasSubstr("\"things\": one sprite is hidden in the editor"),
              HasSubstr("\"things\": one object of a template"),
              HasSubstr("one sprite of object layers: no tileset"),
              HasSubstr("\"things\": one shape, point or text"), HasSubstr("1 tiles have collision shapes")));
}

TEST_F(MadeMap, MoreDifferentCellsThanAnImageHoldsAreRefusedBeforeTheyArePainted) {
    // Each cell moves on by half a tile, so that four tiles meet in it: many stacks of few large tiles
    write_tiles("tiles.png", 4, 1, 512, 512);
    std::vector<std::uint32_t> tiles;
    for (std::uint32_t i = 0; i < 400; ++i) tiles.push_back(1 + (i * i / 7 + i / 3 + i * i * i / 11) % 4);
    write("map.tmx", map_of(tileset(1, "tiles.png", 512),
                            layer(tiles, 20, 20, "offsetx=\"256\" offsety=\"256\""), 20, 20, 512));
    const auto scene = import("map.tmx");
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().detail,
                HasSubstr("layer \"Ground\" has more than 128 different cells of 512×512 texels"));
}

TEST_F(MadeMap, TheSameMapGivesTheSameScene) {
    write_tiles("tiles.png", 4, 4, 8, 8);
    write("map.tmx", map_of(tileset(1, "tiles.png"), layer({3, 2, 1, 9}, 2, 2), 2, 2));
    ASSERT_TRUE(import("map.tmx"));
    const std::string first = load_scene(at("scene")).value()->fingerprint;
    ASSERT_TRUE(import("map.tmx")) << "a scene that is there is replaced";
    EXPECT_EQ(load_scene(at("scene")).value()->fingerprint, first);
}

}  // namespace
}  // namespace tessera
