#include "server/pattern/area_expectation.h"

#include <gtest/gtest.h>

#include "server/pattern/cell_texture.h"
#include "server/pattern/pattern_mips.h"
#include "tests/support/made_areas.h"

namespace tessera {
namespace {

using Sampling = VaryingMap::Sampling;

std::vector<std::array<double, 4>> means_of(const PatternImages& images) {
    const PatternMips mips{images};
    std::vector<std::array<double, 4>> means;
    for (std::int32_t pattern = 0; pattern < mips.count(); ++pattern)
        means.push_back(mips.mean(mips.image(pattern, 0)));
    return means;
}

/// One pattern for each state, or, of four corners, a pick that depends on all of them.
std::vector<std::int32_t> choice(std::span<const std::int32_t> states) {
    std::int32_t mixed = 0;
    for (const std::int32_t state : states) mixed = mixed * 3 + state + 1;
    return {mixed % 16, (mixed * 7 + 1) % 16, mixed % 5 == 0 ? -1 : 3};
}

/// An expectation, and what it is held against.
struct Held {
    explicit Held(const MadeAreas& of)
        : areas{of},
          plan{made_area_plan(of, made_patterns(1, 16))},
          means{.means = means_of(*plan.patterns)},
          expectation{make_area_expectation(*plan.program, means, 0)} {}

    /// The largest difference to sums over cells, in codes.
    double error(int up, std::int64_t x, std::int64_t y, std::int32_t side) const {
        LinearImage out{side, side}, expected{side, side};
        EXPECT_TRUE(expectation->evaluate({static_cast<std::uint8_t>(up), x, y, side, side, 0}, up, {}, out));
        const std::int64_t n = std::int64_t{1} << up;
        for (std::int32_t row = 0; row < side; ++row)
            for (std::int32_t column = 0; column < side; ++column) {
                std::array<double, 4> sum{};
                for (std::int64_t cell = 0; cell < n * n; ++cell) {
                    const auto of = areas.expected_cell((x + column) * n + cell % n, (y + row) * n + cell / n,
                                                        means.means);
                    for (std::size_t c = 0; c < 4; ++c) sum[c] += of[c];
                }
                for (std::size_t c = 0; c < 4; ++c)
                    expected.row(row)[column * 4 + static_cast<std::int32_t>(c)] =
                        static_cast<float>(sum[c] / static_cast<double>(n * n));
            }
        return difference_codes(out, expected);
    }

    const MadeAreas& areas;
    ReferencePlan plan;
    LookMeans means;
    std::unique_ptr<const AreaExpectation> expectation;
};

TEST(AreaExpectation, EqualsTheSumOverCellsForEverySamplingAndEdge) {
    for (const auto sampling :
         {Sampling::nearest, Sampling::dithered, Sampling::dithered_x, Sampling::dithered_y})
        for (const auto edge : {StoredMap::Edge::wrap, StoredMap::Edge::clamp, StoredMap::Edge::blank}) {
            if (edge == StoredMap::Edge::blank && sampling != Sampling::nearest) continue;
            MadeAreas areas{
                .map = made_map(5, 3, 6, edge, 2, -1, 1), .sampling = sampling, .choice_of = choice};
            const Held held{areas};
            for (int up = 1; up <= 5; ++up)
                EXPECT_LT(held.error(up, -3, -2, up < 4 ? 12 : 5), 1e-4)
                    << "sampling " << int(sampling) << ", edge " << int(edge) << ", up " << up;
        }
}

TEST(AreaExpectation, OfTransitionTilesIsTheProductOverTheirCorners) {
    for (const auto sampling :
         {Sampling::nearest, Sampling::dithered, Sampling::dithered_x, Sampling::dithered_y})
        for (const auto edge : {StoredMap::Edge::wrap, StoredMap::Edge::clamp}) {
            MadeAreas areas{.map = made_map(3, 5, 3, edge, 3, 1, -2),
                            .sampling = sampling,
                            .corners = true,
                            .choice_of = choice};
            const Held held{areas};
            for (int up = 1; up <= 4; ++up)
                EXPECT_LT(held.error(up, -3, 2, up < 3 ? 9 : 4), 1e-4)
                    << "sampling " << int(sampling) << ", edge " << int(edge) << ", up " << up;
        }
    // An entry for every cell: corners lie in four entries
    MadeAreas fine{.map = made_map(7, 4, 3, StoredMap::Edge::wrap, 0), .corners = true, .choice_of = choice};
    const Held held{fine};
    for (int up = 1; up <= 4; ++up) EXPECT_LT(held.error(up, -3, 2, 5), 1e-4) << up;
}

TEST(AreaExpectation, SumsBlocksOfPatchesOfLargeMaps) {
    struct Case {
        std::int32_t width, height;
        StoredMap::Edge edge;
    };
    for (const Case& of :
         {Case{1200, 1100, StoredMap::Edge::clamp}, Case{1200, 1104, StoredMap::Edge::wrap},
          Case{1201, 1103, StoredMap::Edge::wrap}, Case{1201, 1103, StoredMap::Edge::blank}}) {
        MadeAreas areas{.map = made_map(of.width, of.height, 6, of.edge, 0, 13, -27), .choice_of = choice};
        const Held held{areas};
        for (const std::int64_t x : {-1, 0, 36, 75})
            for (int up = 2; up <= 5; ++up)
                EXPECT_LT(held.error(up, x << (5 - up), 30 << (5 - up), 3), 1e-4) << of.width << " up " << up;
    }
}

TEST(AreaExpectation, GoesOnAsFarAsTexturesDo) {
    // A map of period 5 × 3 under texels of 2^30 cells, far out: the mean of a whole number of periods and a
    // rest
    const PatternImages images = made_patterns(1, 16);
    MadeAreas areas{.map = made_map(5, 3, 6, StoredMap::Edge::wrap, 0), .choice_of = choice};
    const ReferencePlan plan = made_area_plan(areas, images);
    const LookMeans means{.means = means_of(images)};
    const auto expectation = make_area_expectation(*plan.program, means, 0);
    std::array<double, 4> mean{};
    for (int i = 0; i < 15; ++i) {
        const auto of = areas.expected_cell(i % 5, i / 5, means.means);
        for (std::size_t c = 0; c < 4; ++c) mean[c] += of[c] / 15;
    }
    LinearImage far{2, 2}, below{4, 4};
    ASSERT_TRUE(expectation->evaluate({30, 255, -255, 2, 2, 0}, 30, {}, far));
    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(far.values[c], mean[c], 1e-6);
    for (int up = 2; up <= 30; ++up) {
        const std::int64_t x = (std::int64_t{1} << (38 - up)) - 1;
        ASSERT_TRUE(expectation->evaluate({0, x, -x, 2, 2, 0}, up, {}, far));
        ASSERT_TRUE(expectation->evaluate({0, 2 * x, -2 * x, 4, 4, 0}, up - 1, {}, below));
        EXPECT_LT(difference_codes(far, halved(below)), 1e-4) << up;
    }
}

TEST(AreaExpectation, KeepsAConstantSetToTheLastBit) {
    PatternImages images{1, 16, 1, {}};
    for (int i = 0; i < 16; ++i) images.codes.insert(images.codes.end(), {7, 201, 77, 91});
    const PatternMips mips{images};
    for (const auto sampling : {Sampling::nearest, Sampling::dithered})
        for (const bool corners : {false, true}) {
            MadeAreas areas{.map = made_map(5, 3, 3, StoredMap::Edge::wrap, 3),
                            .sampling = sampling,
                            .corners = corners,
                            .choice_of = [](auto states) {
                                return std::vector<std::int32_t>{states[0], 5, 9};
                            }};
            const auto texture = make_cell_texture(made_area_plan(areas, images));
            for (const auto accuracy : accuracies)
                for (std::uint8_t level = 0; level <= 12; ++level) {
                    LinearImage out;
                    const auto did = texture->evaluate({level, -3, 5, 6, 6, 0}, {.accuracy = accuracy}, out);
                    ASSERT_TRUE(did);
                    EXPECT_LT(did->bound_codes, 1e-3);
                    for (std::size_t i = 0; i < out.values.size(); ++i)
                        ASSERT_EQ(out.values[i], mips.linear(0).row(mips.image(0, 0))[i % 4]) << int{level};
                }
        }
}

TEST(AreaExpectation, IsExactAndCertainWhereAMapSaysAll) {
    MadeAreas areas{.map = made_map(13, 9, 16, StoredMap::Edge::wrap, 0, 3, -4),
                    .choice_of = [](auto states) { return std::vector<std::int32_t>{states[0]}; }};
    const auto texture = make_cell_texture(made_area_plan(areas, made_patterns(4, 16)));
    EXPECT_EQ(texture->cell_level(), -1);
    for (std::uint8_t level = 1; level <= max_level; ++level) {
        LinearImage page, below;
        const TexelRegion region{level, -17, 23, 31, 29, 0};
        const auto did = texture->evaluate(region, {}, page);
        ASSERT_TRUE(did);
        EXPECT_EQ(did->confidence, 1);
        EXPECT_LT(did->bound_codes, 1e-3);
        ASSERT_TRUE(texture->evaluate(children_of(region), {}, below));
        EXPECT_LT(difference_codes(page, halved(below)), 0.02) << int{level};
    }
}

TEST(AreaExpectation, IsNotMadeWhereLooksCannotBeListed) {
    MadeProgram program;
    program.made_basis = CellProgram::Basis::other;
    EXPECT_EQ(make_area_expectation(program, {}, 0), nullptr);
    // Too many kinds of patches for transition tiles
    MadeAreas areas{.map = made_map(200, 200, 60000, StoredMap::Edge::wrap, 1),
                    .sampling = Sampling::dithered,
                    .corners = true,
                    .choice_of = choice};
    const ReferencePlan plan = made_area_plan(areas, made_patterns(1, 16));
    const LookMeans means{.means = means_of(*plan.patterns)};
    EXPECT_EQ(make_area_expectation(*plan.program, means, 0), nullptr);
}

}  // namespace
}  // namespace tessera
