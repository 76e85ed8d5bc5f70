// Small crops of the samples of pattern blocks, at three levels each, against pictures that were looked at:
// tests/golden/README.md.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "server/scene/image_file.h"
#include "server/scene/scene.h"
#include "shared/math/srgb.h"
#include "tests/property/scenes/pattern_test_scenes.h"

namespace tessera {
namespace {

constexpr std::int32_t side = 128;
constexpr std::array<std::uint8_t, 3> levels{0, 3, 6};

/// Over grey, so that what is transparent shows too; a texel more on each side than the golden picture.
Rgb8Image crop_of(const Texture& texture, const tests::PatternTestScene& scene, std::uint8_t level) {
    const TexelRegion region{level,      (scene.x >> level) - 1, (scene.y >> level) - 1, side + 2, side + 2,
                             scene.slice};
    LinearImage texels;
    const auto evaluation = texture.evaluate(region, Budget{.accuracy = Accuracy::exact}, texels);
    EXPECT_TRUE(evaluation.has_value()) << evaluation.error().detail;
    Rgb8Image crop{region.width, region.height, {}};
    for (std::size_t i = 0; i < texels.values.size(); i += 4)
        for (std::size_t c = 0; c < 3; ++c)
            crop.bytes.push_back(
                steps_to_srgb()[to_steps(texels.values[i + c] + 0.2F * (1 - texels.values[i + 3]))]);
    return crop;
}

Rgb8Image shifted(const Rgb8Image& crop, std::int32_t dx, std::int32_t dy) {
    Rgb8Image part{side, side, {}};
    for (std::int32_t y = 0; y < side; ++y) {
        const auto row = crop.bytes.begin() + 3 * (std::ptrdiff_t{crop.width} * (y + 1 + dy) + 1 + dx);
        part.bytes.insert(part.bytes.end(), row, row + std::ptrdiff_t{3} * side);
    }
    return part;
}

/// Root of the mean squared difference, in codes.
double difference(const Rgb8Image& a, const Rgb8Image& b) {
    if (a.bytes.size() != b.bytes.size()) return 255;
    double sum = 0;
    for (std::size_t i = 0; i < a.bytes.size(); ++i)
        sum += (a.bytes[i] - b.bytes[i]) * (a.bytes[i] - b.bytes[i]);
    return std::sqrt(sum / static_cast<double>(a.bytes.size()));
}

/// Rounding moves a code here and there; anything else moves many.
constexpr double tolerance = 0.5;

class PatternGolden : public testing::TestWithParam<tests::PatternTestScene> {};

TEST_P(PatternGolden, LooksAsItWasJudgedGood) {
    const tests::PatternTestScene& what = GetParam();
    const tests::WrittenScene written{what};
    const auto scene = load_scene(written.folder());
    ASSERT_TRUE(scene.has_value()) << scene.error().detail;
    for (const std::uint8_t level : levels) {
        const std::filesystem::path file =
            std::filesystem::path{GOLDEN_FOLDER} / (what.name + "-" + std::to_string(level) + ".png");
        const Rgb8Image crop = crop_of(*(*scene)->texture, what, level);
        const Rgb8Image here = shifted(crop, 0, 0);
        if (std::getenv("TESSERA_UPDATE_GOLDEN") != nullptr) {
            ASSERT_TRUE(write_rgb_png(file, here).has_value()) << file;
            continue;
        }
        const auto golden = read_rgb_image(file);
        ASSERT_TRUE(golden.has_value()) << golden.error().detail;
        EXPECT_LT(difference(here, *golden), tolerance) << file;
        // The tolerance is tight enough to tell a shift by one texel, in each direction
        EXPECT_GT(difference(shifted(crop, 1, 0), *golden), 2 * tolerance) << file;
        EXPECT_GT(difference(shifted(crop, 0, 1), *golden), 2 * tolerance) << file;
        EXPECT_GT(difference(shifted(crop, -1, 0), *golden), 2 * tolerance) << file;
        EXPECT_GT(difference(shifted(crop, 0, -1), *golden), 2 * tolerance) << file;
    }
}

std::vector<tests::PatternTestScene> samples() {
    std::vector<tests::PatternTestScene> chosen;
    for (const tests::PatternTestScene& scene : tests::pattern_test_scenes())
        if (scene.json.empty()) chosen.push_back(scene);
    return chosen;
}

INSTANTIATE_TEST_SUITE_P(Samples, PatternGolden, testing::ValuesIn(samples()), [](const auto& scene) {
    std::string name = scene.param.name;
    for (char& c : name)
        if (c == '-') c = '_';
    return name;
});

}  // namespace
}  // namespace tessera
