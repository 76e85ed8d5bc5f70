#include "server/pattern/cell_texture.h"

#include <gtest/gtest.h>

#include "server/pattern/pattern_mips.h"
#include "tests/support/made_areas.h"

namespace tessera {
namespace {

ReferencePlan plan_of(MadeProgram::Patterns pattern_of, PatternImages images, CellProgram::Basis basis,
                      std::int32_t cell_slices = 0) {
    auto program = std::make_shared<MadeProgram>();
    program->made_basis = basis;
    program->pattern_of = std::move(pattern_of);
    int log2 = 0;
    while (std::int32_t{1} << log2 < images.side) ++log2;
    return {made_grid(log2, 0, cell_slices), std::make_shared<const PatternImages>(std::move(images)),
            program, nullptr};
}

TEST(CellTexture, CopiesPatternsUpToTheCell) {
    const PatternImages images = made_patterns(8, 5);
    const PatternMips mips{images};
    const auto pattern_of = [](std::int64_t x, std::int64_t y, std::int64_t, std::uint16_t) {
        return static_cast<std::int32_t>(((x * 3 + y * 7) % 6 + 6) % 6 - 1);
    };
    const auto texture = make_cell_texture(plan_of(pattern_of, images, CellProgram::Basis::other));
    for (int level = 0; level <= 3; ++level) {
        const std::int64_t side = 8 >> level;
        const TexelRegion region{static_cast<std::uint8_t>(level), -21, -13, 50, 37, 0};
        Rgba8Image codes;
        ASSERT_TRUE(texture->evaluate(region, {}, codes));
        LinearImage linear;
        ASSERT_TRUE(texture->evaluate(region, {}, linear));
        for (std::int32_t y = 0; y < region.height; ++y)
            for (std::int32_t x = 0; x < region.width; ++x) {
                const std::int64_t at_x = region.x + x, at_y = region.y + y;
                const std::int32_t image =
                    mips.image(pattern_of(at_x >> (3 - level), at_y >> (3 - level), 0, 0), 0);
                const auto row = static_cast<std::int32_t>(image * side + (at_y & (side - 1)));
                for (std::int64_t c = 0; c < 4; ++c) {
                    ASSERT_EQ(codes.row(y)[x * 4 + c],
                              mips.codes(level).row(row)[(at_x & (side - 1)) * 4 + c]);
                    ASSERT_EQ(linear.row(y)[x * 4 + c],
                              mips.linear(level).row(row)[(at_x & (side - 1)) * 4 + c]);
                }
            }
    }
}

TEST(CellTexture, OfOneConstantPatternIsItsMeanAtEveryLevelAboveIt) {
    ReferencePlan plan =
        plan_of([](auto...) { return 1; }, made_patterns(8, 2), CellProgram::Basis::constant);
    auto program = std::make_shared<MadeProgram>();
    program->made_basis = CellProgram::Basis::constant;
    program->pattern_of = [](auto...) { return 1; };
    program->shares_of = [](auto) { return std::vector<LookShare>{{1, 0, 0, 1.0}}; };
    plan.program = program;
    const auto texture = make_cell_texture(plan);
    EXPECT_EQ(texture->cell_level(), -1);
    LinearImage cell, above;
    ASSERT_TRUE(texture->evaluate({3, 5, 5, 1, 1, 0}, {}, cell));
    for (std::uint8_t level = 4; level <= max_level; ++level) {
        const auto did = texture->evaluate({level, -5, 5, 1, 1, 0}, {}, above);
        ASSERT_TRUE(did);
        EXPECT_EQ(did->confidence, 1);
        EXPECT_LT(did->bound_codes, 1e-3);
        EXPECT_EQ(above.values, cell.values);
    }
}

TEST(CellTexture, SamplesLargeTexelsOfCellsOfWhichNothingIsKnown) {
    // Halves of the plane: the mean of a texel across the border is known
    const auto pattern_of = [](std::int64_t x, std::int64_t y, std::int64_t, std::uint16_t) {
        return hash(1, 2, x, y) % 4 == 0 ? 1 : 0;
    };
    PatternImages images{1, 2, 1, {0, 0, 0, 255, 255, 255, 255, 255}};
    const auto texture = make_cell_texture(plan_of(pattern_of, images, CellProgram::Basis::other));
    for (const auto accuracy : accuracies)
        for (const std::uint8_t level : std::to_array<std::uint8_t>({5, 9, 30})) {
            LinearImage out;
            const auto did = texture->evaluate({level, -8, 3, 16, 16, 0}, {.accuracy = accuracy}, out);
            ASSERT_TRUE(did);
            EXPECT_EQ(did->method, "sampled");
            EXPECT_EQ(did->confidence, 1 - 1e-9);
            for (std::size_t i = 0; i < out.values.size(); i += 4)
                EXPECT_NEAR(out.values[i], 0.25F, did->bound_codes / 255);
        }
}

TEST(CellTexture, ShowsLayersOfCellsAndSlicesOfPatterns) {
    const auto pattern_of = [](std::int64_t, std::int64_t, std::int64_t z, std::uint16_t) {
        return static_cast<std::int32_t>(((z % 2) + 2) % 2);
    };
    const PatternImages images = made_patterns(2, 2, 3, true);
    const auto texture = make_cell_texture(plan_of(pattern_of, images, CellProgram::Basis::other, 4));
    for (std::int64_t slice = -9; slice < 9; ++slice) {
        Rgba8Image out;
        ASSERT_TRUE(texture->evaluate({0, 0, 0, 2, 2, slice}, {}, out));
        const std::int64_t z = slice >= 0 ? slice / 4 : -((-slice + 3) / 4), inside = slice - z * 4;
        if (inside == 3) {
            EXPECT_EQ(out, Rgba8Image(2, 2)) << slice;
            continue;
        }
        const std::uint8_t* expected =
            images.image(static_cast<std::int32_t>(((z % 2) + 2) % 2), static_cast<std::int32_t>(inside));
        EXPECT_TRUE(std::equal(out.bytes.begin(), out.bytes.end(), expected)) << slice;
    }
}

TEST(CellTexture, StopsWhenNobodyWaits) {
    MadeAreas areas{.map = made_map(5, 7, 3, StoredMap::Edge::wrap, 3),
                    .sampling = VaryingMap::Sampling::dithered,
                    .choice_of = [](auto states) {
                        return std::vector<std::int32_t>{states[0], 0};
                    }};
    const auto texture = make_cell_texture(made_area_plan(areas, made_patterns(2, 8)));
    std::stop_source source;
    source.request_stop();
    for (std::uint8_t level = 0; level <= 9; ++level) {
        LinearImage out;
        EXPECT_EQ(
            texture->evaluate({level, 0, 0, 64, 64, 0}, {.cancelled = source.get_token()}, out).error().code,
            ErrorCode::cancelled);
    }
}

}  // namespace
}  // namespace tessera
