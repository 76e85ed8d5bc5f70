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
    const std::map<std::string_view, std::string> golden{
        {"tiles", "b96a8b3eb66228e8"},  {"meadow-sand", "bd2c54f1342ea8f7"}, {"leaves", "ed0dd642de4fac03"},
        {"autumn", "11bb1874deeb97e1"}, {"terrain", "3bc9bc57c90d3e73"},     {"petals", "87e52a98ab5ed5e2"},
        {"grove", "9cb5f234b7b54fbe"}};
    ASSERT_EQ(painting_version, 3u);
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

/// The mean step from a column (or row) of one tile to one of another.
double step(const Rgba8Image& first, std::int32_t from, const Rgba8Image& second, std::int32_t to,
            bool beside) {
    double sum = 0;
    const std::int32_t side = first.width;
    for (std::int32_t i = 0; i < side; ++i)
        for (std::int32_t c = 0; c < 3; ++c) {
            const int a = beside ? first.row(i)[4 * from + c] : first.row(from)[4 * i + c];
            const int b = beside ? second.row(i)[4 * to + c] : second.row(to)[4 * i + c];
            sum += std::abs(a - b) / (3.0 * side);
        }
    return sum;
}

/// How strong the seam between two tiles is, against a step between places that have nothing to do with each
/// other: about 1 where tiles do not meet.
double seam(const Rgba8Image& first, const Rgba8Image& second, bool beside) {
    const std::int32_t last = first.width - 1;
    double strange = 0;
    for (std::int32_t i = 0; i < 4; ++i) strange += 0.25 * step(first, last, second, 20 + 7 * i, beside);
    return step(first, last, second, 0, beside) / strange;
}

TEST(PatternScenes, TilesOfOneKindMeet) {
    constexpr std::int32_t count = 8;
    for (const auto paint : {paint_meadow_tile, paint_forest_floor, paint_lawn}) {
        const std::vector<Rgba8Image> tiles = paint_all(count, [&](std::int32_t i) { return paint(i, 64); });
        double mean = 0;  // one blade of grass may end at a border by chance
        for (std::int32_t i = 0; i < count; ++i)
            for (const bool beside : {false, true})
                mean += seam(tiles[static_cast<std::size_t>(i)],
                             tiles[static_cast<std::size_t>((i + 3) % count)], beside) /
                        (2 * count);
        EXPECT_LT(mean, 0.85);
    }
}

TEST(PatternScenes, TilesWithTheSameCornersMeet) {
    const Rgba8Image left = paint_shore_tile({0, 1, 0, 1}, 0, 64),
                     right = paint_shore_tile({1, 0, 1, 1}, 1, 64);
    EXPECT_LT(seam(left, right, true), 0.85);
    const Rgba8Image above = paint_shore_tile({0, 0, 0, 1}, 0, 64),
                     below = paint_shore_tile({0, 1, 1, 1}, 1, 64);
    EXPECT_LT(seam(above, below, false), 0.85);
    const Rgba8Image land = paint_land_tile({0, 1, 2, 3}, 0, 64),
                     beside = paint_land_tile({1, 2, 3, 0}, 0, 64);
    EXPECT_LT(seam(land, beside, true), 0.85);
    // The measure tells what does not meet
    EXPECT_GT(seam(left, paint_shore_tile({0, 0, 0, 0}, 0, 64), true), 0.85);
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
