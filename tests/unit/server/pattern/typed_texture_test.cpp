#include "server/pattern/typed_texture.h"

#include <array>
#include <chrono>

#include <gtest/gtest.h>

#include "server/pattern/cell_texture.h"
#include "tests/support/made_patterns.h"

namespace tessera {
namespace {

LinearImage linear(const Texture& texture, const TexelRegion& region) {
    LinearImage out;
    EXPECT_TRUE(texture.evaluate(region, {}, out)) << int{region.level};
    return out;
}
Rgba8Image codes(const Texture& texture, const TexelRegion& region) {
    Rgba8Image out;
    EXPECT_TRUE(texture.evaluate(region, {}, out)) << int{region.level};
    return out;
}

/// Level 0, texel by texel.
LinearImage brute_force(const ReferencePlan& plan, const TexelRegion& region) {
    const PatternMips mips{*plan.patterns};
    const std::int64_t side = plan.patterns->side;
    LinearImage out{region.width, region.height};
    const TypeGrid types =
        plan.grid.quadtree->types_of(0, region.x >> plan.grid.cell_log2, region.y >> plan.grid.cell_log2,
                                     static_cast<std::int32_t>(region.width / side + 2),
                                     static_cast<std::int32_t>(region.height / side + 2));
    for (std::int32_t y = 0; y < region.height; ++y)
        for (std::int32_t x = 0; x < region.width; ++x) {
            const std::int64_t at_x = region.x + x, at_y = region.y + y;
            const std::uint16_t type = types.at(at_x >> plan.grid.cell_log2, at_y >> plan.grid.cell_log2);
            const std::int32_t pattern = plan.program->look_of_type(type).pattern;
            const auto row = static_cast<std::int64_t>(mips.image(pattern, 0)) * side + (at_y & (side - 1));
            for (int channel = 0; channel < 4; ++channel)
                out.row(y)[x * 4 + channel] =
                    mips.linear(0).row(static_cast<std::int32_t>(row))[(at_x & (side - 1)) * 4 + channel];
        }
    return out;
}

TEST(TypedTexture, EqualsBruteForceAtEveryLevelOfASmallScene) {
    for (const std::int32_t side : {1, 2, 4, 16}) {
        ReferencePlan plan = made_typed_plan(made_patterns(side, 16), 256);
        const auto texture = make_cell_texture(plan);
        TexelRegion finest{.level = 0, .x = -512, .y = 256, .width = 512, .height = 256};
        LinearImage expected = brute_force(plan, finest);
        EXPECT_LT(difference_codes(linear(*texture, finest), expected), 1e-4) << side;
        for (std::uint8_t level = 1; level <= 8; ++level) {
            expected = halved(expected);
            const TexelRegion region{.level = level,
                                     .x = finest.x >> level,
                                     .y = finest.y >> level,
                                     .width = expected.width,
                                     .height = expected.height};
            EXPECT_LT(difference_codes(linear(*texture, region), expected), 1e-3)
                << side << " at " << int{level};
        }
    }
}

TEST(TypedTexture, CodesWhatItsLinearTexelsSay) {
    for (const std::int32_t side : {1, 2, 8, 64}) {
        const auto texture = make_cell_texture(made_typed_plan(made_patterns(side, 16), 64));
        for (std::uint8_t level = 0; level <= max_level; ++level) {
            const TexelRegion region{.level = level, .x = -37, .y = 1003, .width = 77, .height = 50};
            Rgba8Image expected;
            encode(linear(*texture, region), expected);
            EXPECT_EQ(codes(*texture, region), expected) << side << " at " << int{level};
        }
    }
}

TEST(TypedTexture, GivesTheSameBytesForAnySplitOfARegion) {
    const auto texture = make_cell_texture(made_typed_plan(made_patterns(16, 16), 256));
    for (const std::uint8_t level : std::to_array<std::uint8_t>({0, 1, 2, 3, 4, 5, 9, 30})) {
        const TexelRegion whole{.level = level, .x = -19, .y = -7, .width = 61, .height = 43};
        const Rgba8Image all = codes(*texture, whole);
        for (std::int32_t y = 0; y < whole.height; y += 11)
            for (std::int32_t x = 0; x < whole.width; x += 7) {
                TexelRegion part = whole;
                part.x += x;
                part.y += y;
                part.width = std::min(7, whole.width - x);
                part.height = std::min(11, whole.height - y);
                const Rgba8Image piece = codes(*texture, part);
                for (std::int32_t row = 0; row < part.height; ++row)
                    ASSERT_TRUE(
                        std::equal(piece.row(row), piece.row(row) + part.width * 4, all.row(y + row) + x * 4))
                        << int{level};
            }
    }
}

TEST(TypedTexture, KeepsAConstantSetToTheLastBit) {
    PatternImages images{8, 3, 1, {}};
    for (int i = 0; i < 3 * 64; ++i) images.codes.insert(images.codes.end(), {17, 200, 3, 77});
    const auto texture = make_cell_texture(made_typed_plan(images, 4096));
    const std::vector<float> first(linear(*texture, {0, 0, 0, 1, 1, 0}).values);
    for (std::uint8_t level = 0; level <= max_level; ++level) {
        const LinearImage texels = linear(*texture, {level, -3, -5, 9, 9, 0});
        for (std::size_t i = 0; i < texels.values.size(); ++i)
            ASSERT_EQ(texels.values[i], first[i % 4]) << int{level};
    }
}

TEST(TypedTexture, OfDrawnImagesEqualsTheOneOfPatterns) {
    /// The patterns, as if they had to be drawn.
    class Drawn final : public TypeImages {
      public:
        explicit Drawn(const PatternImages& images) : mips_{images} {}
        void draw(std::uint16_t type, int level, std::int32_t slice, LinearImage& out) const override {
            const std::int32_t side = std::int32_t{1} << (mips_.side_log2() - level);
            const std::int32_t image = mips_.image(type % mips_.count(), slice);
            out = LinearImage{side, side};
            std::copy_n(mips_.linear(level).row(image * side), out.values.size(), out.values.begin());
        }
        std::size_t memory_bytes() const noexcept override { return mips_.memory_bytes(); }
        std::string description() const override { return "drawn"; }

      private:
        PatternMips mips_;
    };
    for (const std::int32_t side : {1, 2, 64}) {
        const PatternImages images = made_patterns(side, 16);
        const ReferencePlan plan = made_typed_plan(images, 1024);
        const auto by_rows = make_cell_texture(plan);
        const auto drawn = make_typed_texture(plan.grid, std::make_shared<const Drawn>(images));
        for (const std::uint8_t level : std::to_array<std::uint8_t>({0, 1, 2, 3, 4, 5, 6, 7, 8, 20, 30})) {
            const TexelRegion region{.level = level, .x = -37, .y = 1003, .width = 77, .height = 150};
            EXPECT_LT(difference_codes(linear(*drawn, region), linear(*by_rows, region)), 1e-4) << int{level};
            EXPECT_LE(difference_of_codes(codes(*drawn, region), codes(*by_rows, region)), 1) << int{level};
        }
    }
}

TEST(TypedTexture, LeavesBlankCellsTransparent) {
    ReferencePlan plan = made_typed_plan(made_patterns(4, 2, 1, true), 64);
    auto program = std::make_shared<MadeProgram>();
    program->made_basis = CellProgram::Basis::typed;
    program->pattern_of = [](std::int64_t, std::int64_t, std::int64_t, std::uint16_t type) {
        return type < 32 ? -1 : 1;
    };
    plan.program = program;
    const auto texture = make_cell_texture(plan);
    const LinearImage level_0 = linear(*texture, {0, 0, 0, 256, 256, 0});
    double alpha = 0;
    for (std::size_t i = 3; i < level_0.values.size(); i += 4) {
        ASSERT_TRUE(level_0.values[i] == 0.0F || level_0.values[i] == 1.0F);
        alpha += double{level_0.values[i]};
    }
    EXPECT_NEAR(alpha / (256 * 256), 0.5, 0.1);
    // Every type is equally frequent: the mean over the plane is one half
    EXPECT_NEAR(linear(*texture, {30, 0, 0, 1, 1, 0}).values[3], 0.5F, 1e-6F);
}

TEST(TypedTexture, ShowsTheSliceThatIsAskedFor) {
    const PatternImages images = made_patterns(4, 4, 6, true);
    // Cells as deep as the set: layers of cells lie one behind the other, each drawn by itself
    const auto deep = make_cell_texture(made_typed_plan(images, 4096, 6));
    EXPECT_NE(codes(*deep, {0, 0, 0, 64, 64, 1}), codes(*deep, {0, 0, 0, 64, 64, 2}));
    EXPECT_NE(codes(*deep, {0, 0, 0, 64, 64, 1}), codes(*deep, {0, 0, 0, 64, 64, 7}));
    EXPECT_NE(codes(*deep, {0, 0, 0, 64, 64, 1}), codes(*deep, {0, 0, 0, 64, 64, -5}));
    // One layer of cells: the set repeats
    const auto flat = make_cell_texture(made_typed_plan(images, 4096));
    EXPECT_EQ(codes(*flat, {0, 0, 0, 64, 64, 1}), codes(*flat, {0, 0, 0, 64, 64, 7}));
    EXPECT_EQ(codes(*flat, {0, 0, 0, 64, 64, 1}), codes(*flat, {0, 0, 0, 64, 64, -5}));
    EXPECT_EQ(codes(*flat, {0, 0, 0, 64, 64, 1}), codes(*deep, {0, 0, 0, 64, 64, 1}));
    // Cells deeper than the set: nothing behind it
    const auto thin = make_cell_texture(made_typed_plan(images, 4096, 8));
    for (const std::uint8_t level : std::to_array<std::uint8_t>({0, 1, 2, 9})) {
        const LinearImage behind = linear(*thin, {level, 0, 0, 16, 16, 7});
        EXPECT_EQ(std::count(behind.values.begin(), behind.values.end(), 0.0F), 16 * 16 * 4);
    }
}

TEST(TypedTexture, ReducesEverySliceByItself) {
    const auto texture = make_cell_texture(made_typed_plan(made_patterns(8, 4, 12), 64, 12));
    for (std::int64_t slice = -3; slice < 14; ++slice)
        for (std::uint8_t level = 1; level <= 7; ++level) {
            const TexelRegion region{level, 3, -5, 21, 13, slice};
            EXPECT_LT(
                difference_codes(linear(*texture, region), halved(linear(*texture, children_of(region)))),
                1e-3);
        }
}

TEST(TypedTexture, StopsWhenNobodyWaitsOrTheDeadlinePassed) {
    const auto texture = make_cell_texture(made_typed_plan(made_patterns(4, 4), 64));
    LinearImage out;
    std::stop_source source;
    source.request_stop();
    EXPECT_EQ(texture->evaluate({3, 0, 0, 64, 64, 0}, {.cancelled = source.get_token()}, out).error().code,
              ErrorCode::cancelled);
    const auto past = std::chrono::steady_clock::now() - std::chrono::seconds{1};
    EXPECT_EQ(texture->evaluate({0, 0, 0, 64, 64, 0}, {.deadline = past}, out).error().code,
              ErrorCode::timed_out);
}

TEST(TypedTexture, SaysHowItWorksAndWhatItHolds) {
    const auto texture = make_cell_texture(made_typed_plan(made_patterns(64, 16), 4096));
    EXPECT_EQ(texture->kind(), "pattern");
    EXPECT_EQ(texture->cell_level(), 6);
    EXPECT_NE(texture->description().find("4096 types"), std::string::npos);
    EXPECT_GT(texture->memory_bytes(), 16u * 64 * 64 * 20);
    LinearImage out;
    EXPECT_EQ(texture->evaluate({0, 0, 0, 8, 8, 0}, {}, out)->method, "patterns");
    const auto above = texture->evaluate({20, 0, 0, 8, 8, 0}, {}, out);
    EXPECT_EQ(above->method, "quadtree");
    EXPECT_LT(above->bound_codes, 0.001);
    EXPECT_EQ(above->confidence, 1);
}

}  // namespace
}  // namespace tessera
