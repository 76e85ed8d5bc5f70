// How often cells show what: enumerated, and as counted over many cells.
#include <array>
#include <cmath>

#include <gmock/gmock.h>

#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

const std::string ground = R"(
  {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8, "count": 256}},
  {"name": "grid", "virtual_tile_map": {"cell_texels": 32}},)";

Plan show(const std::string& blocks, const std::string& transform = "{}") {
    auto plan =
        plan_of(ground + blocks + R"(, {"name": "move", "tile_transform": {"grid": "grid", )" + transform +
                R"(}}, {"name": "t", "reference_texture":
        {"patterns": "set", "grid": "grid", "index": {"block": "x"}, "transform": "move"}})");
    EXPECT_TRUE(plan) << plan.error().detail;
    return plan ? std::move(*plan) : Plan{};
}

using Key = std::array<int, 3>;

std::map<Key, double> table(const std::vector<LookShare>& shares) {
    std::map<Key, double> sums;
    double total = 0;
    for (const LookShare& share : shares) {
        sums[{share.pattern, share.turn, share.scale}] += share.share;
        total += share.share;
    }
    EXPECT_NEAR(total, 1, 1e-12);
    return sums;
}

/// Counted over cells of rows from y on.
std::map<Key, double> counted(const CellProgram& program, std::int32_t rows, std::int32_t width) {
    std::map<Key, double> sums;
    std::vector<Look> looks(static_cast<std::size_t>(width));
    for (std::int32_t y = 0; y < rows; ++y) {
        program.looks({.x = 0, .y = y, .count = width}, looks.data());
        for (const Look& look : looks) sums[{look.pattern, look.turn, look.scale}] += 1.0 / rows / width;
    }
    return sums;
}

void expect_near(const std::map<Key, double>& counts, const std::map<Key, double>& shares, double cells) {
    for (const auto& [key, count] : counts) {
        ASSERT_TRUE(shares.contains(key)) << key[0] << " " << key[1] << " " << key[2];
        const double share = shares.at(key);
        EXPECT_NEAR(count, share, 5 * std::sqrt(share * (1 - share) / cells))
            << key[0] << " " << key[1] << " " << key[2];
    }
    for (const auto& [key, share] : shares)
        if (share * cells > 30) {
            EXPECT_TRUE(counts.contains(key)) << key[0] << " " << key[1] << " " << key[2];
        }
}

TEST(Shares, OfIndependentDrawsAreProducts) {
    const Plan plan = show(
        R"({"name": "x", "virtual_indirection_map": {"grid": "grid", "count": 3, "generator": "independent"}},
        {"name": "r", "virtual_random_map": {"grid": "grid", "levels": 5, "generator": "independent"}})",
        R"("turns": 4, "turn": {"block": "r"})");
    const CellProgram& program = *reference_of(plan).program;
    EXPECT_EQ(program.basis(), CellProgram::Basis::stationary);
    EXPECT_TRUE(program.independent_cells());
    const auto shares = table(program.shares({}));
    ASSERT_EQ(shares.size(), 12u);
    // Turn 0 stands for 0 and for 1
    EXPECT_NEAR(shares.at({0, 0, 0}), 2.0 / 15, 1e-12);
    EXPECT_NEAR(shares.at({2, 3, 0}), 1.0 / 15, 1e-12);
    expect_near(counted(program, 100, 4096), shares, 100 * 4096);
}

TEST(Shares, OfDrawsThatInputsShareAreJoint) {
    const Plan plan = show(
        R"({"name": "x", "virtual_indirection_map": {"grid": "grid", "count": 6, "generator": "independent", "stream": 9}},
        {"name": "r", "virtual_random_map": {"grid": "grid", "from": 0, "to": 0.75, "levels": 4, "generator": "independent", "stream": 9}},
        {"name": "s", "virtual_random_map": {"grid": "grid", "from": 1, "to": 2, "levels": 2, "generator": "independent"}})",
        R"("turns": 4, "turn": {"block": "r"}, "scale": {"block": "s"}, "scales": 2)");
    const CellProgram& program = *reference_of(plan).program;
    const auto shares = table(program.shares({}));
    // ⌊6u⌋ and ⌊4u⌋ of one u: 8 pairs, each at two scales
    ASSERT_EQ(shares.size(), 16u);
    EXPECT_NEAR(shares.at({0, 0, 1}), 1.0 / 12, 1e-12);
    EXPECT_NEAR(shares.at({1, 0, 0}), 1.0 / 24, 1e-12);
    EXPECT_NEAR(shares.at({1, 1, 0}), 1.0 / 24, 1e-12);
    expect_near(counted(program, 100, 4096), shares, 100 * 4096);
}

TEST(Shares, OfTypedDrawsCountTypes) {
    const Plan plan = show(R"({"name": "x", "virtual_indirection_map": {"grid": "grid", "count": 5}},
        {"name": "r", "virtual_random_map": {"grid": "grid"}})",
                           R"("turn": {"block": "r"}, "turns": 8)");
    const CellProgram& program = *reference_of(plan).program;
    EXPECT_EQ(program.basis(), CellProgram::Basis::typed);
    std::map<Key, double> counts;
    for (std::uint32_t type = 0; type < 4096; ++type) {
        const Look look = program.look_of_type(static_cast<std::uint16_t>(type));
        counts[{look.pattern, look.turn, look.scale}] += 1.0 / 4096;
    }
    const auto shares = table(program.shares({}));
    ASSERT_EQ(shares.size(), counts.size());
    for (const auto& [key, share] : shares) EXPECT_NEAR(share, counts[key], 1e-12);
}

TEST(Shares, GivenTheMapsStateAreThoseOfTheMaterial) {
    const Plan plan = show(
        R"({"name": "areas", "dithered_areas_map": {"areas": {"grid": "grid", "width": 2, "values": [0, 1], "cells": 16}}},
        {"name": "draw", "virtual_indirection_map": {"grid": "grid", "count": 12}},
        {"name": "x", "materials_map": {"material": {"block": "areas"}, "index": {"block": "draw"}, "materials":
            [{"entries": [{"pattern": 1, "weight": 3}, {"pattern": 2}]}, {"entries": [{"pattern": -1, "weight": 2}, {"pattern": 2}]}]}})",
        R"("x": {"number": 0.5})");
    const CellProgram& program = *reference_of(plan).program;
    ASSERT_EQ(program.basis(), CellProgram::Basis::varying);
    const VaryingMap varying = *program.varying();
    EXPECT_EQ(varying.sampling, VaryingMap::Sampling::dithered);
    EXPECT_FALSE(varying.corners);
    EXPECT_EQ(varying.map->cells_log2, 4);
    EXPECT_EQ(table(program.shares(std::array{0})),
              (std::map<Key, double>{{{1, 0, 0}, 0.75}, {{2, 0, 0}, 0.25}}));
    const auto other = table(program.shares(std::array{1}));
    EXPECT_NEAR(other.at({-1, 0, 0}), 2.0 / 3, 1e-12);
    EXPECT_TRUE(program.shares({}).empty()) << "a state is missing";
}

TEST(Shares, OfNestedDrawsNameThePatternsByRisingThreshold) {
    const Plan plan = show(
        R"({"name": "draw", "virtual_indirection_map": {"grid": "grid", "count": 4, "generator": "nested"}},
        {"name": "x", "probability_map": {"index": {"block": "draw"}, "material": {"entries":
            [{"pattern": 8}, {"pattern": 5, "weight": 2}, {"pattern": 1}]}}})",
        R"("x": {"number": 0.5})");
    const CellProgram& program = *reference_of(plan).program;
    EXPECT_EQ(program.basis(), CellProgram::Basis::stationary);
    EXPECT_FALSE(program.independent_cells());
    EXPECT_THAT(program.nested_patterns(), testing::ElementsAre(8, 5, 5, 1));
}

TEST(Shares, AreNotStatedWhereTheyCannotBeKnown) {
    // Sigma draws as often as it happens to
    EXPECT_EQ(
        reference_of(
            show(
                R"({"name": "x", "virtual_indirection_map": {"grid": "grid", "count": 4, "generator": "sigma"}})",
                R"("x": {"number": 0.5})"))
            .program->basis(),
        CellProgram::Basis::other);
    // Two maps
    const Plan two = show(R"({"name": "a", "areas_map": {"grid": "grid", "width": 2, "values": [0, 1]}},
        {"name": "b", "areas_map": {"grid": "grid", "width": 2, "values": [0, 1], "cells": 2}},
        {"name": "x", "materials_map": {"material": {"block": "a"}, "index": {"block": "b"}, "materials":
            [{"entries": [{"pattern": 1}, {"pattern": 2}]}, {"entries": [{"pattern": 3}, {"pattern": 2}]}]}})",
                          R"("x": {"number": 0.5})");
    EXPECT_EQ(reference_of(two).program->basis(), CellProgram::Basis::other);
    EXPECT_TRUE(reference_of(two).program->shares({}).empty());
    // A draw of the stream that dithers
    const Plan shared = show(
        R"({"name": "a", "dithered_areas_map": {"stream": 4, "areas": {"grid": "grid", "width": 2, "values": [0, 1], "cells": 8}}},
        {"name": "b", "virtual_indirection_map": {"grid": "grid", "count": 2, "stream": 4}},
        {"name": "x", "materials_map": {"material": {"block": "a"}, "index": {"block": "b"}, "materials":
            [{"entries": [{"pattern": 1}, {"pattern": 2}]}, {"entries": [{"pattern": 3}, {"pattern": 2}]}]}})",
        R"("x": {"number": 0.5})");
    EXPECT_EQ(reference_of(shared).program->basis(), CellProgram::Basis::other);
}

TEST(Shares, WhereOnlyThePlaceVariesAreThoseOfTheRest) {
    const Plan plan = show(R"({"name": "x", "virtual_indirection_map": {"grid": "grid", "count": 4}},
        {"name": "place", "explicit_indirection_map": {"grid": "grid", "width": 2, "values": [0, 1]}})",
                           R"("x": {"block": "place"})");
    const CellProgram& program = *reference_of(plan).program;
    EXPECT_EQ(program.basis(), CellProgram::Basis::stationary);
    EXPECT_TRUE(program.independent_cells());
    EXPECT_EQ(table(program.shares({})).size(), 4u);
}

}  // namespace
}  // namespace tessera
