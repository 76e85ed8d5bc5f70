#include <gtest/gtest.h>

#include "server/pattern/instance_texture.h"
#include "server/pattern/layered_texture.h"
#include "server/pattern/mean_products.h"
#include "server/pattern/measured_error.h"
#include "server/texture/constant_texture.h"
#include "tests/unit/server/pattern/laws.h"
#include "tests/unit/server/pattern/made_programs.h"

namespace tessera {
namespace {

using namespace testing;

Plan plan_of(std::vector<std::variant<ReferencePlan, PixelMapPlan, LayersPlan, GivenPlan>> textures) {
    Plan plan;
    for (auto& texture : textures)
        plan.textures.push_back({"t" + std::to_string(plan.textures.size()), texture});
    return plan;
}

ReferencePlan filled(const Grid& grid, std::uint64_t seed, bool opaque, bool independent = false) {
    const std::int32_t side = std::int32_t{1} << grid.cell_log2;
    auto looks = made_looks(grid.quadtree->types(), 4, 1, 1, seed);
    if (opaque)
        for (Look& look : looks) look.pattern = std::max(look.pattern, 0);
    return {grid, made_patterns(side, 4, 1, opaque, seed),
            std::make_shared<MadeProgram>(looks, independent, seed), nullptr};
}

ReferencePlan turned(const Grid& grid, std::uint64_t seed, bool independent = false) {
    return {
        grid, made_patterns(16, 3, 1, false, seed),
        std::make_shared<MadeProgram>(made_looks(grid.quadtree->types(), 3, 8, 2, seed), independent, seed),
        made_transform(8, {0.5, 0.9})};
}

TEST(Layers, OfOneGridAreExactAtEveryLevel) {
    const Grid grid = made_grid(5);
    const Plan plan = plan_of({GivenPlan{make_constant_texture({40, 90, 30, 255})}, filled(grid, 1, false),
                               turned(grid, 2), GivenPlan{make_constant_texture({255, 255, 255, 60})},
                               turned(grid, 4), LayersPlan{{0, 1, 2, 3, 4}}});
    const auto texture = make_pattern_texture(plan);
    for (std::uint8_t level = 1; level <= 13; ++level) {
        Evaluation evaluation;
        const TexelRegion region{level, -9, 70, 20, 24};
        const LinearImage page = evaluated(*texture, region, Accuracy::fast, &evaluation);
        EXPECT_LE(largest_difference(page, reduced(evaluated(*texture, below(region), Accuracy::fast))), 0.01)
            << int(level);
        EXPECT_LE(evaluation.bound_codes, 0.001);
    }
}

/// `grid`, with cells 2^heights times as large, in the same quadtree.
Grid lifted(const Grid& grid, int heights) {
    Grid other = grid;
    other.cell_log2 += heights;
    other.quadtree = std::make_shared<const TypedQuadtree>(grid.quadtree->lifted(heights));
    return other;
}

TEST(Layers, OfSeveralGridsInOneQuadtreeAreExactAtEveryLevel) {
    const Grid grid = made_grid(5);
    const Plan plan = plan_of({filled(lifted(grid, -2), 1, true), filled(lifted(grid, 1), 2, false),
                               turned(grid, 3), LayersPlan{{0, 1, 2}}});
    const auto texture = make_pattern_texture(plan);
    const std::vector<std::shared_ptr<const Texture>> parts{
        make_pattern_texture(plan_of({std::get<ReferencePlan>(plan.textures[0].what)})),
        make_pattern_texture(plan_of({std::get<ReferencePlan>(plan.textures[1].what)})),
        make_pattern_texture(plan_of({std::get<ReferencePlan>(plan.textures[2].what)}))};
    // Level 0 is what the layers are by themselves
    const TexelRegion square{0, -70, 33, 150, 90};
    LinearImage expected = evaluated(*parts[0], square);
    for (std::size_t k = 1; k < 3; ++k) {
        const LinearImage layer = evaluated(*parts[k], square);
        for (std::size_t i = 0; i < layer.values.size(); ++i)
            expected.values[i] = layer.values[i] + (1 - layer.values[i / 4 * 4 + 3]) * expected.values[i];
    }
    EXPECT_LE(largest_difference(evaluated(*texture, square), expected), 1e-4);
    for (std::uint8_t level = 1; level <= 13; ++level) {
        Evaluation evaluation;
        const TexelRegion region{level, -9, 70, 20, 24};
        const LinearImage page = evaluated(*texture, region, Accuracy::fast, &evaluation);
        EXPECT_LE(largest_difference(page, reduced(evaluated(*texture, below(region), Accuracy::fast))), 0.01)
            << int(level);
        EXPECT_LE(evaluation.bound_codes, 0.001);
    }
}

TEST(Layers, OfOneGridEqualTheirCompositeAtLevelZero) {
    const Grid grid = made_grid(5);
    const std::vector<ReferencePlan> parts{filled(grid, 1, true), turned(grid, 2), filled(grid, 3, false)};
    const Plan plan = plan_of({parts[0], parts[1], parts[2], LayersPlan{{0, 1, 2}}});
    const TexelRegion region{0, -40, 13, 90, 50};
    LinearImage expected{90, 50};
    for (std::size_t k = 0; k < 3; ++k) {
        const LinearImage layer = evaluated(*make_pattern_texture(plan_of({parts[k]})), region);
        for (std::size_t i = 0; i < layer.values.size(); ++i)
            expected.values[i] = layer.values[i] + (1 - layer.values[i / 4 * 4 + 3]) * expected.values[i];
    }
    EXPECT_LE(largest_difference(evaluated(*make_pattern_texture(plan), region), expected), 1e-4);
}

/// The texture at `level` as it is: level 0, reduced.
LinearImage truth(const Texture& texture, const TexelRegion& region) {
    return region.level == 0 ? evaluated(texture, region)
                             : reduced(evaluated(texture, below(region, region.level)), region.level);
}

TEST(Layers, OfSeveralGridsAreNeverBeyondTheirBound) {
    const Plan plan = plan_of({filled(made_grid(4, 256, 1), 1, true), filled(made_grid(5, 256, 2), 2, false),
                               turned(made_grid(5, 256, 3), 3), LayersPlan{{0, 1, 2}}});
    const auto texture = make_pattern_texture(plan);
    for (const Accuracy accuracy : accuracies)
        for (const int level : {0, 1, 2, 3, 5, 7}) {
            const TexelRegion region{std::uint8_t(level), -13, 5, level < 5 ? 30 : 9, level < 5 ? 21 : 8};
            Evaluation evaluation;
            const LinearImage page = evaluated(*texture, region, accuracy, &evaluation);
            const double difference = largest_difference(page, truth(*texture, region));
            EXPECT_LE(difference, evaluation.bound_codes + 1e-3) << name_of(accuracy) << " " << level;
            // What exact leaves open is bounded by what was measured
            EXPECT_GE(evaluation.confidence,
                      accuracy == Accuracy::exact && level > 3 ? measured_confidence : 1.0);
            if (accuracy == Accuracy::exact && level <= 3) {
                EXPECT_LE(evaluation.bound_codes, 0.51) << level;
            }
            std::printf("%-5s level %d: off by %.2f, bound %.2f\n", std::string(name_of(accuracy)).c_str(),
                        level, difference, evaluation.bound_codes);
        }
}

TEST(Layers, DescentTightensTheBound) {
    const Plan plan = plan_of(
        {filled(made_grid(5, 256, 1), 1, true), filled(made_grid(6, 256, 2), 2, false), LayersPlan{{0, 1}}});
    const auto texture = make_pattern_texture(plan);
    const TexelRegion region{4, 3, 3, 64, 64};
    Evaluation fast, high, exact;
    evaluated(*texture, region, Accuracy::fast, &fast);
    evaluated(*texture, region, Accuracy::high, &high);
    evaluated(*texture, region, Accuracy::exact, &exact);
    EXPECT_LE(high.bound_codes, fast.bound_codes);
    EXPECT_LT(exact.bound_codes, high.bound_codes);
    EXPECT_GT(exact.work, fast.work);
}

TEST(Layers, GiveTheSameBytesHoweverARegionIsSplit) {
    const auto texture = make_pattern_texture(
        plan_of({filled(made_grid(4, 256, 1), 1, true), filled(made_grid(5, 256, 2), 2, false),
                 turned(made_grid(5, 256, 3), 3, true), LayersPlan{{0, 1, 2}}}));
    for (const Accuracy accuracy : accuracies)
        for (const int level : {0, 2, 4})
            expect_same_bytes_when_split(*texture, {std::uint8_t(level), -50, 1000001, 90, 70}, 37, 22,
                                         accuracy);
}

TEST(Layers, OneThatVariesOverAConstantIsExact) {
    const auto texture = make_layered_texture(
        {{make_constant_texture({10, 200, 90, 255}),
          texel_ranges(plan_of({GivenPlan{make_constant_texture({10, 200, 90, 255})}}))[0]},
         {make_pattern_texture(plan_of({turned(made_grid(5), 3)})), texel_range(turned(made_grid(5), 3))}});
    for (const int level : {1, 4, 9}) {
        Evaluation evaluation;
        const TexelRegion region{std::uint8_t(level), -5, -6, 40, 40};
        const LinearImage page = evaluated(*texture, region, Accuracy::fast, &evaluation);
        EXPECT_LE(evaluation.bound_codes, 0.01);
        EXPECT_LE(largest_difference(page, reduced(evaluated(*texture, below(region), Accuracy::fast))),
                  0.01);
    }
}

TEST(Layers, OfOneColourStayThatColour) {
    const Grid one = made_grid(4, 256, 1), other = made_grid(5, 256, 2);
    auto white = filled(one, 1, true), more = filled(other, 1, true);
    auto plain = std::make_shared<PatternImages>(*white.patterns),
         large = std::make_shared<PatternImages>(*more.patterns);
    for (auto* images : {plain.get(), large.get()})
        std::fill(images->codes.begin(), images->codes.end(), std::uint8_t{255});
    // Half covered above, and white all the same
    for (std::size_t i = 3; i < large->codes.size(); i += 8) large->codes[i] = 128;
    white.patterns = plain;
    more.patterns = large;
    const auto texture = make_pattern_texture(plan_of({white, more, LayersPlan{{0, 1}}}));
    for (const int level : {0, 1, 5, 12}) {
        const LinearImage page = evaluated(*texture, {std::uint8_t(level), 3, -4, 20, 20}, Accuracy::fast);
        for (const float value : page.values) EXPECT_NEAR(value, 1.0F, 3e-7F);
    }
}

TEST(Layers, DropWhatIsDead) {
    const Grid grid = made_grid(4), other = made_grid(5);
    const Plan alone = plan_of({filled(grid, 1, true)});
    const Plan buried =
        plan_of({turned(other, 2), filled(other, 3, false), filled(grid, 1, true),
                 GivenPlan{make_constant_texture({9, 9, 9, 0})}, LayersPlan{{0, 1}}, LayersPlan{{4, 2, 3}}});
    const auto texture = make_pattern_texture(buried);
    Evaluation one, all;
    const TexelRegion region{3, 5, 5, 60, 60};
    const LinearImage expected = evaluated(*make_pattern_texture(alone), region, Accuracy::high, &one);
    EXPECT_EQ(evaluated(*texture, region, Accuracy::high, &all).values, expected.values);
    EXPECT_EQ(one.work, all.work);
    EXPECT_EQ(texture->memory_bytes(), make_pattern_texture(alone)->memory_bytes());
    // Nothing left
    const auto nothing =
        make_pattern_texture(plan_of({GivenPlan{make_constant_texture({9, 9, 9, 0})}, LayersPlan{{0}}}));
    EXPECT_EQ(evaluated(*nothing, region).values, LinearImage(60, 60).values);
}

TEST(MeanProducts, LimitsHoldForAnyVariablesAndAreReached) {
    std::uint64_t bits = 1;
    const auto draw = [&] { return static_cast<float>((bits = mix(bits + 1)) >> 40) / 16777216.0F; };
    for (int trial = 0; trial < 2000; ++trial) {
        float w0 = draw(), w1 = draw(), v0 = draw(), v1 = draw();
        if (w0 > w1) std::swap(w0, w1);
        if (v0 > v1) std::swap(v0, v1);
        double share = 0, value = 0, product = 0;
        const int n = 1 + int(draw() * 6);
        for (int k = 0; k < n; ++k) {
            const auto w = w0 + (w1 - w0) * (trial % 2 ? draw() : std::round(draw()));
            const auto v = v0 + (v1 - v0) * (trial % 3 ? draw() : std::round(draw()));
            share += double{w} / n;
            value += double{v} / n;
            product += double{w} * double{v} / n;
        }
        const ProductLimits limits{w0, w1, v0, v1};
        EXPECT_LE(limits.least(float(share), float(value)), product + 1e-6);
        EXPECT_GE(limits.most(float(share), float(value)), product - 1e-6);
    }
    // Two halves of a texel: covered where dark, or covered where bright
    const ProductLimits limits{0, 1, 0.2F, 0.8F};
    EXPECT_FLOAT_EQ(limits.most(0.5F, 0.5F), 0.4F);
    EXPECT_FLOAT_EQ(limits.least(0.5F, 0.5F), 0.1F);
}

}  // namespace
}  // namespace tessera
