#include "server/scenes/pattern_scenes.h"

#include <fstream>
#include <map>

#include <gtest/gtest.h>

#include "server/scene/digest.h"
#include "server/scene/scene.h"
#include "server/scenes/painted_folder.h"
#include "server/scenes/patterns/litter.h"
#include "server/scenes/patterns/meadow.h"
#include "server/scenes/patterns/shore.h"
#include "server/scenes/patterns/terrain.h"
#include "server/scenes/sample_scenes.h"
#include "shared/wire/json.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using namespace painting;

/// What a scene is painted as; also by another compiler or with other flags.
std::string digest_of(const PaintedScene& painted) {
    Digest digest;
    const std::string text = write_brief_json(painted.scene);
    digest.add(text.data(), text.size());
    for (const PaintedFile& file : painted.files) {
        digest.add(file.name.data(), file.name.size());
        digest.add(file.bytes.data(), file.bytes.size());
    }
    return digest.hex();
}

TEST(PatternScenes, ArePaintedAsThisVersionPaintsThem) {
    // If this fails because painting was changed on purpose: raise painting_version, and put the new digests
    // here
    const std::map<std::string_view, std::string> golden{{"tiles", ""},  {"meadow-sand", ""}, {"leaves", ""},
                                                         {"autumn", ""}, {"terrain", ""},     {"petals", ""},
                                                         {"grove", ""}};
    ASSERT_EQ(painting_version, 1u);
    ASSERT_EQ(golden.size(), pattern_scene_names().size());
    for (const std::string_view name : pattern_scene_names())
        EXPECT_EQ(digest_of(paint_pattern_scene(name)), golden.at(name)) << name;
}

TEST(PatternScenes, AreSamples) {
    for (const std::string_view name : pattern_scene_names()) {
        ASSERT_NE(find_sample(name), nullptr) << name;
        EXPECT_EQ(find_sample(name)->source, Sample::Source::patterns);
    }
}

/// The largest step between the last column (or row) of one tile and the first of another.
double seam(const Rgba8Image& first, const Rgba8Image& second, bool beside) {
    double sum = 0;
    const std::int32_t side = first.width;
    for (std::int32_t i = 0; i < side; ++i)
        for (std::int32_t c = 0; c < 3; ++c) {
            const int a = beside ? first.row(i)[4 * (side - 1) + c] : first.row(side - 1)[4 * i + c];
            const int b = beside ? second.row(i)[c] : second.row(0)[4 * i + c];
            sum += std::abs(a - b) / (3.0 * side);
        }
    return sum;
}

/// The mean step between neighbouring columns inside a tile.
double own_step(const Rgba8Image& tile) {
    double sum = 0;
    for (std::int32_t y = 0; y < tile.height; ++y)
        for (std::int32_t x = 8; x < tile.width - 8; ++x)
            for (std::int32_t c = 0; c < 3; ++c)
                sum += std::abs(tile.row(y)[4 * x + c] - tile.row(y)[4 * x + 4 + c]) /
                       (3.0 * tile.height * (tile.width - 16));
    return sum;
}

TEST(PatternScenes, TilesOfOneKindMeet) {
    for (const auto paint : {paint_meadow_tile, paint_forest_floor, paint_lawn}) {
        const Rgba8Image first = paint(1, 64), second = paint(4, 64), third = paint(0, 64);
        for (const bool beside : {false, true}) {
            EXPECT_LT(seam(first, second, beside), 1.3 * own_step(first));
            EXPECT_LT(seam(second, third, beside), 1.3 * own_step(first));
        }
    }
}

TEST(PatternScenes, TilesWithTheSameCornersMeet) {
    const Rgba8Image left = paint_shore_tile({0, 1, 0, 1}, 0, 64),
                     right = paint_shore_tile({1, 0, 1, 1}, 1, 64);
    EXPECT_LT(seam(left, right, true), 1.3 * std::max(own_step(left), own_step(right)));
    const Rgba8Image above = paint_shore_tile({0, 0, 0, 1}, 0, 64),
                     below = paint_shore_tile({0, 1, 1, 1}, 1, 64);
    EXPECT_LT(seam(above, below, false), 1.3 * std::max(own_step(above), own_step(below)));
    // And tiles that may never lie beside each other do not: the measure can fail
    EXPECT_GT(seam(left, paint_shore_tile({0, 0, 0, 0}, 0, 64), true), 1.5 * own_step(left));

    const Rgba8Image land = paint_land_tile({0, 1, 2, 3}, 0, 64),
                     beside = paint_land_tile({1, 2, 3, 0}, 0, 64);
    EXPECT_LT(seam(land, beside, true), 1.3 * std::max(own_step(land), own_step(beside)));
}

TEST(PatternScenes, LeavesStayInsideTheirSquares) {
    for (std::int32_t leaf = 0; leaf < leaf_patterns; ++leaf) {
        const Rgba8Image picture = paint_autumn_leaf(leaf, 128);
        for (std::int32_t i = 0; i < 128; ++i)
            for (const std::uint8_t* texel :
                 {picture.row(0) + 4 * i, picture.row(127) + 4 * i, picture.row(i), picture.row(i) + 4 * 127})
                EXPECT_LT(texel[3], 128) << leaf << " is cut at its square's border";
    }
}

/// `painted.txt` as an earlier version would have left it.
void make_older(const fs::path& folder) {
    std::string record;
    std::getline(std::ifstream{folder / "painted.txt"}, record);
    std::ofstream{folder / "painted.txt"} << 0 << record.substr(record.find(' ')) << '\n';
}

TEST(PaintedFolder, IsPaintedAgainByALaterVersionUnlessAPersonChangedIt) {
    const tests::TemporaryFolder temporary;
    SilentProgress progress;
    const Sample& sample = *find_sample("tiles");
    const auto make = [&](bool force = false) {
        const auto made = make_sample(sample, temporary.path, "", force, progress);
        EXPECT_TRUE(made.has_value()) << made.error().detail;
        return made.value();
    };
    const fs::path folder = temporary.path / "tiles";
    EXPECT_EQ(make(), Made::written);
    EXPECT_EQ(make(), Made::kept);
    EXPECT_EQ(standing_of(folder), Standing::current);

    make_older(folder);
    EXPECT_EQ(standing_of(folder), Standing::outdated);
    EXPECT_EQ(make(), Made::written);
    EXPECT_EQ(standing_of(folder), Standing::current);

    make_older(folder);
    std::string text{std::istreambuf_iterator<char>{std::ifstream{folder / "scene.json"}.rdbuf()}, {}};
    text.replace(text.find("\"seed\": \"1\""), 11, "\"seed\": \"2\"");
    std::ofstream{folder / "scene.json"} << text;
    EXPECT_EQ(make(), Made::kept);
    EXPECT_EQ(make(true), Made::written);
}

}  // namespace
}  // namespace tessera
