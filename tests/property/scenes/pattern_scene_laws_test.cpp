// Every scene of pattern blocks keeps the one law: a page is the box reduction of its four children, at every
// level. The walk takes the samples and the small scenes of made_scenes.cpp: adding a scene there adds a
// test.
#include <algorithm>
#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "server/scene/scene.h"
#include "shared/math/srgb.h"
#include "tests/property/scenes/pattern_test_scenes.h"

namespace tessera {
namespace {

struct Walked {
    LinearImage texels;
    Evaluation evaluation;
};

Walked walk(const Texture& texture, const TexelRegion& region) {
    Walked walked;
    const auto evaluation = texture.evaluate(region, Budget{.accuracy = Accuracy::exact}, walked.texels);
    EXPECT_TRUE(evaluation.has_value()) << evaluation.error().detail;
    if (evaluation) walked.evaluation = *evaluation;
    return walked;
}

/// The mean of `value` over the four texels under (x, y).
template <typename Image, typename F>
double reduced(const Image& children, std::int32_t x, std::int32_t y, std::int32_t c, F&& value) {
    return 0.25 * (value(children.row(2 * y)[8 * x + c]) + value(children.row(2 * y)[8 * x + 4 + c]) +
                   value(children.row(2 * y + 1)[8 * x + c]) + value(children.row(2 * y + 1)[8 * x + 4 + c]));
}

/// A square of a page of `level` that lies off the grid of cells, and on all lattices' far side.
TexelRegion region_at(const tests::PatternTestScene& scene, std::uint8_t level, int place) {
    const std::int64_t x = (place == 0 ? scene.x : scene.x - 123457) >> level;
    const std::int64_t y = (place == 0 ? scene.y : -scene.y) >> level;
    return {level, x - 11, y - 5, scene.side, scene.side, scene.slice};
}

class PatternScenes : public testing::TestWithParam<tests::PatternTestScene> {};

TEST_P(PatternScenes, EveryPageIsTheReductionOfItsFourChildren) {
    const tests::PatternTestScene& what = GetParam();
    const tests::WrittenScene written{what};
    const auto scene = load_scene(written.folder());
    ASSERT_TRUE(scene.has_value()) << scene.error().detail;
    const Texture& texture = *(*scene)->texture;
    const std::int32_t side = what.side;
    double largest_bound = 0;
    for (std::uint8_t level = 1; level <= (*scene)->extent.n; ++level)
        for (const int place : {0, 1}) {
            SCOPED_TRACE("level " + std::to_string(level) + ", place " + std::to_string(place));
            const TexelRegion region = region_at(what, level, place);
            const TexelRegion below{static_cast<std::uint8_t>(level - 1),
                                    region.x * 2,
                                    region.y * 2,
                                    2 * side,
                                    2 * side,
                                    region.slice};
            const Walked parent = walk(texture, region), children = walk(texture, below);
            if (HasFailure()) return;
            const double bounds = parent.evaluation.bound_codes + children.evaluation.bound_codes;
            largest_bound = std::max(largest_bound, parent.evaluation.bound_codes);
            if (what.is_exact) {
                ASSERT_LT(bounds, 0.001);  // rounding
            }
            double worst = 0;
            for (std::int32_t y = 0; y < side; ++y)
                for (std::int32_t x = 0; x < side; ++x)
                    for (std::int32_t c = 0; c < 4; ++c)
                        worst = std::max(worst, std::abs(double{parent.texels.row(y)[4 * x + c]} -
                                                         reduced(children.texels, x, y, c,
                                                                 [](float v) { return double{v}; })));
            ASSERT_LE(worst / code_in_linear, bounds + 0.02);

            // As they are sent: whole codes, so 1.1 apart is 1 apart; the children's own rounding moves their
            // mean
            if (bounds > 0.001) continue;
            Rgba8Image sent, sent_children;
            ASSERT_TRUE(texture.evaluate(region, Budget{.accuracy = Accuracy::exact}, sent).has_value());
            ASSERT_TRUE(
                texture.evaluate(below, Budget{.accuracy = Accuracy::exact}, sent_children).has_value());
            int worst_sent = 0;
            for (std::int32_t y = 0; y < side; ++y)
                for (std::int32_t x = 0; x < side; ++x)
                    for (std::int32_t c = 0; c < 4; ++c) {
                        const double mean =
                            c == 3 ? reduced(sent_children, x, y, c, [](std::uint8_t v) { return double(v); })
                                   : reduced(sent_children, x, y, c,
                                             [](std::uint8_t v) { return double{from_srgb(v)}; });
                        const int code = c == 3 ? static_cast<int>(mean + 0.5)
                                                : steps_to_srgb()[to_steps(static_cast<float>(mean))];
                        worst_sent = std::max(worst_sent, std::abs(code - sent.row(y)[4 * x + c]));
                    }
            ASSERT_LE(worst_sent, 1);
        }
    // What "exact" may still leave open where layers or chance are in play
    EXPECT_LE(largest_bound, what.largest_bound);
    if (!what.is_exact) std::cout << what.name << ": bounds up to " << largest_bound << " codes\n";
}

TEST_P(PatternScenes, ATexelIsTheSameInWhateverRectangleItIsAskedFor) {
    const tests::PatternTestScene& what = GetParam();
    const tests::WrittenScene written{what};
    const auto scene = load_scene(written.folder());
    ASSERT_TRUE(scene.has_value()) << scene.error().detail;
    for (const std::uint8_t level : {std::uint8_t{0}, std::uint8_t{3}, std::uint8_t{8}, (*scene)->extent.n}) {
        const TexelRegion region = region_at(what, level, 0);
        TexelRegion part = region;
        part.x += 3;
        part.y += 2;
        part.width = what.side / 2;
        part.height = what.side / 3;
        const Walked whole = walk(*(*scene)->texture, region), cut = walk(*(*scene)->texture, part);
        if (HasFailure()) return;
        // A larger rectangle may be answered less exactly where it would cost too much, but never beyond its
        // bound
        const double bounds = whole.evaluation.bound_codes + cut.evaluation.bound_codes;
        for (std::int32_t y = 0; y < part.height; ++y)
            for (std::int32_t i = 0; i < 4 * part.width; ++i) {
                const float apart = cut.texels.row(y)[i] - whole.texels.row(y + 2)[4 * 3 + i];
                ASSERT_LE(std::abs(double{apart}) / code_in_linear, bounds < 0.001 ? 0 : bounds)
                    << "level " << int{level} << " row " << y;
            }
    }
}

INSTANTIATE_TEST_SUITE_P(All, PatternScenes, testing::ValuesIn(tests::pattern_test_scenes()),
                         [](const auto& scene) {
                             std::string name = scene.param.name;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

}  // namespace
}  // namespace tessera
