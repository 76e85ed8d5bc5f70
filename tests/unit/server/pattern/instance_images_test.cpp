#include "server/pattern/instance_images.h"

#include <chrono>

#include <gtest/gtest.h>

#include "server/filter/turning.h"
#include "server/pattern/instance_texture.h"
#include "shared/math/srgb.h"
#include "tests/unit/server/pattern/laws.h"
#include "tests/unit/server/pattern/made_programs.h"

namespace tessera {
namespace {

using namespace testing;

ReferencePlan plan_of(std::shared_ptr<const PatternImages> patterns, int cell_log2, std::uint32_t turns,
                      std::vector<double> scales, std::int32_t cell_slices = 0) {
    const auto looks = made_looks(256, std::uint32_t(patterns->count), turns, std::uint32_t(scales.size()));
    return {made_grid(cell_log2, 256, 9, cell_slices), patterns, std::make_shared<MadeProgram>(looks, false),
            made_transform(turns, std::move(scales))};
}

LinearImage level_0(const SummedArea& image) {
    LinearImage out{image.width(), image.height()};
    for (std::int32_t y = 0; y < image.height(); ++y)
        instance_row(image, 0, 0, 0, y, 0, image.width(), out.row(y));
    return out;
}

TEST(InstanceImages, QuarterTurnsAtScaleOneMoveTexelsOnTexels) {
    const auto patterns = made_patterns(8, 1, 1, true);
    const ReferencePlan plan = plan_of(patterns, 4, 4, {1.0});
    const InstanceImages images{plan};
    for (std::uint8_t turn = 0; turn < 4; ++turn) {
        const SummedArea* image = images.find({.pattern = 0, .turn = turn}, 0);
        ASSERT_NE(image, nullptr);
        ASSERT_EQ(image->width(), 8);
        const LinearImage texels = level_0(*image);
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) {
                // A turn takes x to y
                const int tx[] = {x, 7 - y, 7 - x, y}, ty[] = {y, x, 7 - y, 7 - x};
                const std::uint8_t* code = patterns->image(0, 0) + (y * 8 + x) * 4;
                const float* texel = texels.row(ty[turn]) + tx[turn] * 4;
                for (int c = 0; c < 3; ++c) EXPECT_EQ(to_steps(texel[c]), srgb_to_steps[code[c]]);
                EXPECT_EQ(texel[3], 1.0F);
            }
    }
}

TEST(InstanceImages, AnOpaquePatternCoversItsAreaAndKeepsItsColour) {
    auto patterns = std::make_shared<PatternImages>();
    *patterns = {16, 1, 1, std::vector<std::uint8_t>(16 * 16 * 4, 255)};
    const ReferencePlan plan = plan_of(patterns, 6, 16, {0.5, 1.0, 1.37, 2.5});
    const InstanceImages images{plan};
    for (std::uint8_t turn = 0; turn < 16; ++turn)
        for (std::uint8_t scale = 0; scale < 4; ++scale) {
            const SummedArea* image = images.find({.pattern = 0, .turn = turn, .scale = scale}, 0);
            if (image == nullptr) continue;
            const double side = 16 * plan.transform->scales[scale];
            const auto sums = image->sum(0, 0, image->width(), image->height());
            EXPECT_NEAR(double(sums[3]) / 65535, side * side, 0.02) << int(turn) << " " << int(scale);
            EXPECT_EQ(sums[0], sums[3]);
            const std::int32_t middle = image->width() / 2;
            EXPECT_EQ(image->sum(middle, middle, middle + 1, middle + 1)[3], 65535u);
        }
}

TEST(InstanceImages, AgreeWithDenseSupersampling) {
    const auto patterns = made_patterns(8, 2);
    ReferencePlan plan = plan_of(patterns, 5, 32, {0.4, 1.0, 1.9});
    plan.program = std::make_shared<MadeProgram>(made_looks(5000, 2, 32, 3), true);
    const InstanceImages images{plan};
    const auto texel = [&](int x, int y, int c) {
        const std::uint8_t* code =
            patterns->image(1, 0) + (std::clamp(y, 0, 7) * 8 + std::clamp(x, 0, 7)) * 4;
        return c == 3 ? code[3] / 255.0 : srgb_to_steps[code[c]] / 65535.0 * code[3] / 255.0;
    };
    for (const auto& [turn, scale] : {std::pair{3, 1}, {13, 0}, {25, 2}}) {
        const SummedArea* found =
            images.find({.pattern = 1, .turn = std::uint8_t(turn), .scale = std::uint8_t(scale)}, 0);
        ASSERT_NE(found, nullptr);
        const LinearImage image = level_0(*found);
        const Turning t = turning(turn / 32.0);
        const double size = plan.transform->scales[std::size_t(scale)];
        for (const int c : {0, 3})
            for (int y = 0; y < image.height; y += 2)
                for (int x = 0; x < image.width; ++x) {
                    double sum = 0;
                    const int n = 40;
                    for (int k = 0; k < n * n; ++k) {
                        const double px = x + (k % n + 0.5) / n - 0.5 * image.width;
                        const double py = y + (k / n + 0.5) / n - 0.5 * image.height;
                        const double u = 4 + (t.cosine * px + t.sine * py) / size;
                        const double v = 4 + (-t.sine * px + t.cosine * py) / size;
                        if (u < 0 || v < 0 || u > 8 || v > 8) continue;
                        const int i = int(std::floor(u - 0.5)), j = int(std::floor(v - 0.5));
                        const double fu = u - 0.5 - i, fv = v - 0.5 - j;
                        sum += (texel(i, j, c) * (1 - fu) + texel(i + 1, j, c) * fu) * (1 - fv) +
                               (texel(i, j + 1, c) * (1 - fu) + texel(i + 1, j + 1, c) * fu) * fv;
                    }
                    EXPECT_NEAR(double{image.row(y)[x * 4 + c]}, sum / n / n, 0.012) << x << " " << y;
                }
    }
}

TEST(InstanceImages, RowsOfEveryLevelAreExactReductionsAtAnyOffset) {
    const ReferencePlan plan = plan_of(made_patterns(64, 1), 10, 3, {4.0});
    const InstanceImages images{plan};
    const SummedArea* image = nullptr;
    for (std::uint8_t turn = 0; turn < 32 && image == nullptr; ++turn)
        image = images.find({.pattern = 0, .turn = turn}, 0);
    ASSERT_NE(image, nullptr);
    const std::int64_t left = -37, top = 1021;
    for (const int level : {1, 5, 8, 9, 10}) {
        const TexelSpan columns = texels_met(left, image->width(), level),
                        rows = texels_met(top, image->width(), level);
        std::vector<float> row(std::size_t(columns.to - columns.from) * 4);
        for (std::int64_t y = rows.from; y < rows.to; ++y) {
            instance_row(*image, left, top, level, y, columns.from, columns.to, row.data());
            for (std::int64_t x = columns.from; x < columns.to; ++x) {
                const auto inside = [&](std::int64_t at) {
                    return std::int32_t(std::clamp<std::int64_t>(at, 0, image->width()));
                };
                const std::int64_t side = std::int64_t{1} << level;
                const auto sums = image->sum(inside(x * side - left), inside(y * side - top),
                                             inside((x + 1) * side - left), inside((y + 1) * side - top));
                for (std::size_t c = 0; c < 4; ++c)
                    EXPECT_NEAR(double{row[std::size_t(x - columns.from) * 4 + c]},
                                double(sums[c]) / 65535 / double(side * side), 1e-7);
            }
        }
    }
}

TEST(InstanceImages, KnowTheirBytesBeforeTheyAreMade) {
    const ReferencePlan plan = plan_of(made_patterns(16, 3, 2), 6, 8, {0.5, 1.0});
    const InstanceImages images{plan};
    const std::uint64_t foreseen = InstanceImages::bytes(plan);
    EXPECT_GE(foreseen + 1000, images.memory_bytes());
    EXPECT_LE(foreseen, images.memory_bytes() + plan.patterns->codes.size() * 2 + 1000);
}

TEST(InstanceImages, OfSixteenPatternsTakeASecondOrTwo) {
    ReferencePlan plan = plan_of(made_patterns(64, 16), 7, 32, {0.25, 0.5, 0.75, 1.0});
    plan.program = std::make_shared<MadeProgram>(made_looks(20000, 16, 32, 4), true);
    const auto from = std::chrono::steady_clock::now();
    const InstanceImages images{plan};
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
    RecordProperty("milliseconds", int(seconds * 1000));
    std::printf("2048 instances: %.0f ms, %.0f MB\n", seconds * 1000, double(images.memory_bytes()) / 1e6);
#ifndef TESSERA_SANITIZED
    EXPECT_LT(seconds, 20);  // About one on an idle machine; this catches another order of growth
#endif
}

TEST(TypedInstances, EveryLevelIsTheReductionOfTheOneBelow) {
    const auto texture = make_instance_texture(plan_of(made_patterns(16, 4), 5, 16, {0.5, 0.8, 1.2}));
    for (const std::int64_t at : {std::int64_t{0}, std::int64_t{-77}, std::int64_t{1} << 24})
        for (std::uint8_t level = 1; level <= 12; ++level) {
            const TexelRegion region{level, at, -at - 3, 24, 20};
            EXPECT_LE(
                largest_difference(evaluated(*texture, region), reduced(evaluated(*texture, below(region)))),
                0.001)
                << int(level) << " at " << at;
        }
}

TEST(TypedInstances, GiveTheSameBytesHoweverARegionIsSplit) {
    const auto texture = make_instance_texture(plan_of(made_patterns(16, 4), 5, 16, {0.5, 0.8, 1.2}));
    for (const int level : {0, 2, 5, 7})
        expect_same_bytes_when_split(*texture, {std::uint8_t(level), -100, 45, 90, 70}, 37, 22,
                                     Accuracy::high);
}

TEST(TypedInstances, KeepTheirSlicesApart) {
    const auto flat = plan_of(made_patterns(16, 4, 3), 5, 4, {0.5});
    const auto texture = make_instance_texture(flat);
    const TexelRegion region{1, 5, 6, 40, 30, 1};
    TexelRegion repeated = region, other = region;
    repeated.slice = -2;
    other.slice = 2;
    EXPECT_EQ(evaluated(*texture, region).values, evaluated(*texture, repeated).values);
    EXPECT_NE(evaluated(*texture, region).values, evaluated(*texture, other).values);
    // Cells of five slices, of which the set has three: the rest is blank
    const auto deep = make_instance_texture(plan_of(made_patterns(16, 4, 3), 5, 4, {0.5}, 5));
    TexelRegion last = region;
    last.slice = 4;
    EXPECT_EQ(evaluated(*deep, last).values, LinearImage(40, 30).values);
}

}  // namespace
}  // namespace tessera
