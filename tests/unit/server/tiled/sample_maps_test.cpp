// The maps that Debian's package "tiled" ships as examples.
#include <cstdlib>

#include "tests/unit/server/tiled/map_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SampleMaps : public test::MapFolder {
  protected:
    void SetUp() override {
        if (!fs::exists(maps / "desert.tmx") &&
            std::system((std::string{TESSERA_FETCH_MAPS} + " '" + maps.string() + "'").c_str()) != 0)
            GTEST_SKIP() << "NOT TRIED: the sample maps could not be fetched: run server/tiled/fetch_maps.sh "
                         << maps << " where Debian's packages can be had";
    }
    Result<TiledScene> import_sample(const std::string& map) const {
        SilentProgress progress;
        return import_tiled_map(maps / map, at("scene"), {}, progress);
    }

    const fs::path maps = TESSERA_SAMPLE_MAPS;
};

/// What the first layer of a map of whole tiles shows: each cell its tile's texels, as they are in the image.
void expect_cells(const TiledMap& map, const Rgba8Image& shown) {
    const TileLayer& ground = map.layers.front();
    const Tileset& set = map.tilesets.front();
    const std::int32_t side = map.tile_width;
    for (std::int32_t y = 0; y < shown.height; ++y)
        for (std::int32_t x = 0; x < shown.width; ++x) {
            const TileRef tile = ground.tiles[std::size_t(y / side * ground.width + x / side)];
            std::uint32_t local = tile.number() - set.first;
            if (const auto moving = set.animations.find(local); moving != set.animations.end())
                local = moving->second.frames.front().tile;
            const TileImage& part = set.tiles.at(local);
            const std::uint8_t* const texel =
                map.images[part.image].bytes.data() +
                std::size_t((part.y + y % side) * map.images[part.image].width + part.x + x % side) * 4;
            ASSERT_EQ(std::vector<int>(shown.row(y) + 4 * x, shown.row(y) + 4 * x + 4),
                      std::vector<int>(texel, texel + 4))
                << x << ", " << y;
        }
}

TEST_F(SampleMaps, TheDesertIsShownTexelByTexel) {
    const auto scene = import_sample("desert.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    expect_cells(*read_tiled_map(maps / "desert.tmx"), texels(0, 0, 1280, 1280));
    EXPECT_THAT(test::joined(scene->made), HasSubstr("probability map \"Desert-probabilities\""));
    EXPECT_THAT(test::joined(scene->left_out),
                HasSubstr("Desert and Brick lack 2 of the 16 combinations of corners"));
}

TEST_F(SampleMaps, TheIslandHasThreeLayersAndTwoAnimations) {
    const auto scene = import_sample("rpg/island.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    auto map = read_tiled_map(maps / "rpg/island.tmx");
    ASSERT_TRUE(map);
    EXPECT_EQ(map->layers.size(), 3u);
    EXPECT_THAT(test::joined(scene->made), HasSubstr("beach_tileset-148-animated"));
    EXPECT_THAT(test::joined(scene->left_out), HasSubstr("object layer \"Objects\": 3 shapes"));
}

TEST_F(SampleMaps, TheOutsideHasTransitionTilesAndSprites) {
    const auto scene = import_sample("orthogonal-outside.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    for (const char* pair : {"Grass-Dirt", "Grass-Dark-Dirt", "Grass-Water", "Dirt-Dark-Dirt", "Dirt-Water"})
        EXPECT_THAT(test::joined(scene->made), HasSubstr(std::string{"shown by \"outdoor-"} + pair + "\""));
    EXPECT_THAT(test::joined(scene->made), HasSubstr("object layer \"Objects\": 23 sprites"));
    EXPECT_EQ(scene->scene.sprites().placed_size(), 23);
}

TEST_F(SampleMaps, SewersAndWallsAreResampledAndTheRestIsRefusedWithItsReason) {
    for (const char* map : {"sewers.tmx", "sewer_automap/sewers.tmx", "perspective_walls.tmx"}) {
        const auto scene = import_sample(map);
        ASSERT_TRUE(scene) << scene.error().detail;
        EXPECT_THAT(test::joined(scene->left_out), HasSubstr("so they have 32×32"));
    }
    EXPECT_THAT(import_sample("isometric_grass_and_water.tmx").error().detail, HasSubstr("is isometric"));
    EXPECT_THAT(import_sample("hexagonal-mini.tmx").error().detail, HasSubstr("is hexagonal"));
}

TEST_F(SampleMaps, AMapOfSpritesAloneIsATexture) {
    const auto scene = import_sample("sticker-knight/map/sandbox.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_EQ(scene->scene.sprites().placed_size(), 103);
    EXPECT_THAT(test::joined(scene->left_out), HasSubstr("9 objects of templates"));
}

}  // namespace
}  // namespace tessera
