#include "server/pattern/measured_error.h"

#include <gtest/gtest.h>

#include "server/pattern/draw_law.h"
#include "server/pattern/overflow_texture.h"
#include "tests/unit/server/pattern/laws.h"
#include "tests/unit/server/pattern/made_programs.h"

namespace tessera {
namespace {

using namespace testing;

/// Turned, instances are as large as a cell at most.
ReferencePlan hanging(bool independent) {
    return {made_grid(4), made_patterns(16, 3),
            std::make_shared<MadeProgram>(made_looks(256, 3, 8, 2), independent),
            made_transform(8, {0.4, 0.68}, true)};
}

/// Drawn independently of each other, so that no table decides them together.
Plan two_layers() {
    Plan plan;
    for (const std::uint64_t seed : {1, 2}) {
        auto looks = made_looks(256, 3, 8, 2, seed);
        plan.textures.push_back({"layer " + std::to_string(seed),
                                 ReferencePlan{made_grid(4), made_patterns(16, 3, 1, false, seed),
                                               std::make_shared<MadeProgram>(std::move(looks), true, seed),
                                               made_transform(8, {0.4, 0.68})}});
    }
    plan.textures.push_back({"both", LayersPlan{{0, 1}}});
    return plan;
}

void expect_kept(const Texture& texture) {
    for (const std::uint8_t level : {std::uint8_t{5}, std::uint8_t{6}, std::uint8_t{8}}) {
        double worst = 0, bound = 0;
        for (std::int64_t place = 0; place < 10; ++place) {
            const TexelRegion region{level, 40000 * place * place - 77777, 3 - 90001 * place, 8, 8};
            Evaluation evaluation;
            const LinearImage page = evaluated(texture, region, Accuracy::exact, &evaluation);
            const double off =
                largest_difference(page, reduced(evaluated(texture, below(region, level)), level));
            EXPECT_LE(off, evaluation.bound_codes) << int{level} << " at " << place;
            worst = std::max(worst, off);
            bound = std::max(bound, evaluation.bound_codes);
            if (evaluation.confidence < 1) {
                EXPECT_GE(evaluation.confidence, measured_confidence);
            }
        }
        // Bounds are near what they bound
        EXPECT_LE(bound, 0.5 + 12 * worst) << int{level};
        Evaluation certain;
        evaluated(texture, {level, 0, 0, 8, 8}, Accuracy::high, &certain);
        EXPECT_LE(bound, certain.bound_codes * 0.6) << int{level};
    }
}

TEST(MeasuredError, IsKeptAllOverThePlaneByInstancesThatHangOver) {
    for (const bool independent : {false, true}) expect_kept(*make_overflow_texture(hanging(independent)));
}

TEST(MeasuredError, IsKeptAllOverThePlaneByLayers) { expect_kept(*make_pattern_texture(two_layers())); }

TEST(MeasuredError, FarUpCostsAHundredthOfNear) {
    const auto texture = make_pattern_texture(two_layers());
    Evaluation near, far;
    evaluated(*texture, {4, 0, 0, 32, 32}, Accuracy::exact, &near);
    evaluated(*texture, {14, 0, 0, 32, 32}, Accuracy::exact, &far);
    EXPECT_LT(near.bound_codes, 0.01);  // Level 0
    EXPECT_LT(far.work, near.work / 100);
}

TEST(DrawLaw, IsKnownOfWhatIsDrawnAlikeEverywhere) {
    const auto law = draw_law(two_layers(), 2);
    ASSERT_TRUE(law);
    EXPECT_EQ(law->cell_log2, 4);
    EXPECT_EQ(law->period_log2, 4);
    // Of volumes a slice says nothing about the next
    Plan plan = two_layers();
    std::get<ReferencePlan>(plan.textures[1].what).grid.cell_slices = 4;
    EXPECT_FALSE(draw_law(plan, 2));
}

}  // namespace
}  // namespace tessera
