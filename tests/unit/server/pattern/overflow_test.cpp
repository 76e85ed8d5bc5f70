#include <gtest/gtest.h>

#include "server/pattern/instance_images.h"
#include "server/pattern/overflow_texture.h"
#include "tests/unit/server/pattern/laws.h"
#include "tests/unit/server/pattern/made_programs.h"

namespace tessera {
namespace {

using namespace testing;

ReferencePlan hanging(bool independent, std::int32_t side = 16, double scale = 1.0) {
    const Grid grid = made_grid(5);
    return {grid, made_patterns(side, 3),
            std::make_shared<MadeProgram>(made_looks(256, 3, 8, 2), independent),
            made_transform(8, {scale * 0.6, scale * 1.3}, true)};
}

TEST(Overflow, LevelZeroIsTheInstancesInReadingOrder) {
    const ReferencePlan plan = hanging(false);
    const auto texture = make_overflow_texture(plan);
    const InstanceImages images{plan};
    const TexelRegion region{0, -70, 40, 120, 90};
    LinearImage expected{120, 90};
    for (std::int64_t j = -3; j < 6; ++j)
        for (std::int64_t i = -6; i < 4; ++i) {
            const Look look =
                plan.program->look_of_type(plan.grid.quadtree->types_of(0, i, j, 1, 1).at(i, j));
            const SummedArea* image = images.find(look, 0);
            if (image == nullptr) continue;
            const std::int64_t left = i * 32 + (std::int64_t{look.x} * 32 >> 16) - region.x;
            const std::int64_t top = j * 32 + (std::int64_t{look.y} * 32 >> 16) - region.y;
            for (std::int32_t y = 0; y < image->height(); ++y)
                for (std::int32_t x = 0; x < image->width(); ++x) {
                    const std::int64_t ox = left + x, oy = top + y;
                    if (ox < 0 || oy < 0 || ox >= region.width || oy >= region.height) continue;
                    const auto sums = image->sum(x, y, x + 1, y + 1);
                    float* out = expected.row(std::int32_t(oy)) + ox * 4;
                    for (std::size_t c = 0; c < 4; ++c)
                        out[c] =
                            float(double(sums[c]) / 65535 + (1 - double(sums[3]) / 65535) * double{out[c]});
                }
        }
    Evaluation evaluation;
    EXPECT_LE(largest_difference(evaluated(*texture, region, Accuracy::fast, &evaluation), expected), 1e-3);
    EXPECT_LE(evaluation.bound_codes, 0.001);
}

TEST(Overflow, IsNeverBeyondItsBound) {
    for (const bool independent : {false, true}) {
        const auto texture = make_overflow_texture(hanging(independent));
        for (const Accuracy accuracy : accuracies)
            for (const int level : {1, 3, 5, 6, 8}) {
                const std::int32_t side = level < 6 ? 24 : 6;
                const TexelRegion region{std::uint8_t(level), -7, 11, side, side};
                Evaluation evaluation;
                const LinearImage page = evaluated(*texture, region, accuracy, &evaluation);
                const LinearImage truth = reduced(evaluated(*texture, below(region, level)), level);
                const double difference = largest_difference(page, truth);
                EXPECT_LE(difference, evaluation.bound_codes + 1e-3) << name_of(accuracy) << " " << level;
                if (accuracy == Accuracy::exact && level <= 3) {
                    EXPECT_LE(evaluation.bound_codes, 0.51);
                }
                std::printf("%-5s level %d: off by %.2f, bound %.2f\n",
                            std::string(name_of(accuracy)).c_str(), level, difference,
                            evaluation.bound_codes);
            }
    }
}

TEST(Overflow, GivesTheSameBytesHoweverARegionIsSplit) {
    for (const bool independent : {false, true}) {
        const auto texture = make_overflow_texture(hanging(independent));
        for (const Accuracy accuracy : accuracies)
            for (const int level : {0, 2, 5, 7})
                expect_same_bytes_when_split(*texture, {std::uint8_t(level), -50, 100001, 90, 70}, 37, 22,
                                             accuracy);
    }
}

}  // namespace
}  // namespace tessera
