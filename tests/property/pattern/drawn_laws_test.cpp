#include <gtest/gtest.h>

#include "server/pattern/cell_texture.h"
#include "tests/property/pattern/evaluated_page.h"
#include "tests/support/made_areas.h"

namespace tessera {
namespace {

using Sampling = VaryingMap::Sampling;

/// Patterns 0 to 7 as often as listed, drawn cell by cell.
ReferencePlan stationary_plan(std::uint64_t seed, std::vector<std::int32_t> list, PatternImages images) {
    auto program = std::make_shared<MadeProgram>();
    program->made_basis = CellProgram::Basis::stationary;
    program->pattern_of = [seed, list](std::int64_t x, std::int64_t y, std::int64_t z, std::uint16_t) {
        return list[uniform_below(hash(seed, stream("tiles", std::uint64_t(z)), x, y),
                                  std::uint32_t(list.size()))];
    };
    program->shares_of = [list](std::span<const std::int32_t>) {
        std::vector<LookShare> shares;
        for (const std::int32_t pattern : list) shares.push_back({pattern, 0, 0, 1.0 / double(list.size())});
        return shares;
    };
    int log2 = 0;
    while (std::int32_t{1} << log2 < images.side) ++log2;
    return {made_grid(log2), std::make_shared<const PatternImages>(std::move(images)), program, nullptr};
}

std::vector<std::int32_t> choice(std::span<const std::int32_t> states) {
    std::int32_t mixed = 0;
    for (const std::int32_t state : states) mixed = mixed * 3 + state;
    return {mixed % 8, (mixed * 5 + 1) % 8};
}

/// A page = reduction of its children, within the two stated bounds; up to the cell and while cells
/// are summed, exactly.
void expect_reduction(const Texture& texture, int cell_log2, const std::string& name) {
    for (const auto accuracy : accuracies)
        for (std::uint8_t level = 1; level <= 16; ++level) {
            // Exact sums many cells a texel
            const bool is_large = accuracy == Accuracy::exact && level > cell_log2 + 4;
            const TexelRegion region{level, -9, 1000, is_large ? 3 : 24, is_large ? 2 : 16, 0};
            const EvaluatedPage page = page_of(texture, region, accuracy);
            const EvaluatedPage below = page_of(texture, children_of(region), accuracy);
            const double difference = difference_codes(page.texels, halved(below.texels));
            const auto is_summed = [](const EvaluatedPage& of) {
                return of.did.method == "patterns" || of.did.method == "cells";
            };
            const bool same_regime = (is_summed(page) && is_summed(below)) ||
                                     (page.did.method == "expectation" && below.did.method == "expectation");
            EXPECT_LE(difference, page.did.bound_codes + below.did.bound_codes)
                << name << ", level " << int{level} << ", " << name_of(accuracy);
            if (!same_regime) continue;
            EXPECT_LT(difference, 0.02) << name << ", level " << int{level} << ", " << name_of(accuracy);
        }
}

TEST(DrawnLaws, APageIsTheReductionOfItsChildren) {
    for (const std::int32_t side : {1, 8}) {
        const int log2 = side == 1 ? 0 : 3;
        expect_reduction(*make_cell_texture(stationary_plan(1, {0, 1, 2, 2, 3, -1}, made_patterns(side, 8))),
                         log2, "stationary");
        for (const auto sampling : {Sampling::nearest, Sampling::dithered, Sampling::dithered_x})
            for (const bool corners : {false, true}) {
                MadeAreas areas{.map = made_map(5, 7, 3, StoredMap::Edge::wrap, 5, 2, 1),
                                .sampling = sampling,
                                .corners = corners,
                                .choice_of = choice};
                expect_reduction(
                    *make_cell_texture(made_area_plan(areas, made_patterns(side, 8))), log2,
                    "sampling " + std::to_string(int(sampling)) + (corners ? " with corners" : ""));
            }
    }
}

/// What was drawn is inside the stated bound, over many draws; and the bound is not empty words: the largest
/// distance met is a fair part of it.
TEST(DrawnLaws, WhatIsDrawnIsWithinTheStatedBound) {
    double largest = 0;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        MadeAreas areas{.map = made_map(3, 3, 3, StoredMap::Edge::wrap, 4, 0, 0),
                        .sampling = Sampling::dithered,
                        .corners = seed % 2 == 1,
                        .seed = seed,
                        .choice_of = choice};
        const auto varying = make_cell_texture(made_area_plan(areas, made_patterns(1, 8)));
        const auto stationary =
            make_cell_texture(stationary_plan(seed, {0, 1, 2, 3, 4, 5, 6, 7}, made_patterns(1, 8)));
        for (const Texture* texture : {varying.get(), stationary.get()})
            for (std::uint8_t level = 2; level <= 4; ++level) {
                const TexelRegion region{level, std::int64_t(seed) * 100 - 300, 77, 16, 16, 0};
                const EvaluatedPage drawn = page_of(*texture, region, Accuracy::exact);
                const EvaluatedPage expected = page_of(*texture, region, Accuracy::fast);
                ASSERT_EQ(drawn.did.method, "cells");
                ASSERT_EQ(expected.did.method, "expectation");
                if (level == 4) {
                    ASSERT_LT(expected.did.confidence, 1);
                }
                const double difference = difference_codes(drawn.texels, expected.texels);
                EXPECT_LE(difference, expected.did.bound_codes)
                    << "seed " << seed << ", level " << int{level};
                largest = std::max(largest, difference / expected.did.bound_codes);
            }
    }
    EXPECT_GT(largest, 0.2);
}

TEST(DrawnLaws, TheStepBetweenTheTwoRegimesIsBelowTheBound) {
    const auto texture = make_cell_texture(stationary_plan(3, {0, 1, 2, 3, 4, 5, 6, 7}, made_patterns(4, 8)));
    for (const auto accuracy : {Accuracy::high, Accuracy::exact}) {
        std::uint8_t first = 3;
        while (page_of(*texture, {first, 0, 0, 1, 1, 0}, accuracy).did.method != "expectation") ++first;
        EXPECT_GT(first, 5);
        const std::int32_t side = accuracy == Accuracy::high ? 64 : 6;
        const TexelRegion region{first, -40, 12, side, side, 0};
        const EvaluatedPage page = page_of(*texture, region, accuracy);
        const EvaluatedPage below = page_of(*texture, children_of(region), accuracy);
        EXPECT_NE(below.did.method, "expectation");
        if (accuracy == Accuracy::exact) {
            EXPECT_LE(below.did.bound_codes, 0.5);
        }
        EXPECT_LT(difference_codes(page.texels, halved(below.texels)), page.did.bound_codes);
    }
}

TEST(DrawnLaws, AnySplitOfARegionGivesTheSameBytes) {
    MadeAreas areas{.map = made_map(5, 7, 3, StoredMap::Edge::clamp, 3, -2, 1),
                    .sampling = Sampling::dithered,
                    .corners = true,
                    .choice_of = choice};
    const auto varying = make_cell_texture(made_area_plan(areas, made_patterns(4, 8)));
    auto unknown = std::make_shared<MadeProgram>();
    unknown->made_basis = CellProgram::Basis::other;
    unknown->pattern_of = [&](std::int64_t x, std::int64_t y, std::int64_t, std::uint16_t) {
        return areas.pattern(x, y);
    };
    ReferencePlan other_plan = made_area_plan(areas, made_patterns(4, 8));
    other_plan.program = unknown;
    const auto other = make_cell_texture(other_plan);
    for (const Texture* texture :
         {static_cast<const Texture*>(varying.get()), static_cast<const Texture*>(other.get())})
        for (std::uint8_t level = 0; level <= 9; ++level) {
            const TexelRegion whole{level, -9, -11, 23, 19, 0};
            Rgba8Image all;
            ASSERT_TRUE(texture->evaluate(whole, {.accuracy = Accuracy::fast}, all));
            for (std::int32_t y = 0; y < whole.height; y += 8)
                for (std::int32_t x = 0; x < whole.width; x += 5) {
                    TexelRegion part = whole;
                    part.x += x;
                    part.y += y;
                    part.width = std::min(5, whole.width - x);
                    part.height = std::min(8, whole.height - y);
                    Rgba8Image piece;
                    ASSERT_TRUE(texture->evaluate(part, {.accuracy = Accuracy::fast}, piece));
                    for (std::int32_t row = 0; row < part.height; ++row)
                        ASSERT_TRUE(std::equal(piece.row(row), piece.row(row) + part.width * 4,
                                               all.row(y + row) + x * 4))
                            << int{level};
                }
        }
}

}  // namespace
}  // namespace tessera
