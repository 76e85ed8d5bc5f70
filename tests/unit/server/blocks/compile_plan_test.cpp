#include <numeric>

#include <gmock/gmock.h>

#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

constexpr const char* tiles = R"(
  {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8}},
  {"name": "grid", "virtual_tile_map": {"cell_texels": 8}},
  {"name": "index", "virtual_indirection_map": {"grid": "grid", "count": 16}},
  {"name": "texture", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "index"}}})";

TEST(CompilePlan, MakesABasicAperiodicTilingTyped) {
    const auto plan = plan_of(tiles);
    ASSERT_TRUE(plan) << plan.error().detail;
    const ReferencePlan& reference = reference_of(*plan);
    EXPECT_EQ(reference.program->basis(), CellProgram::Basis::typed);
    EXPECT_TRUE(reference.program->needs_types());
    ASSERT_NE(reference.grid.quadtree, nullptr);
    std::vector<int> seen(16, 0);
    for (std::uint32_t type = 0; type < 4096; ++type)
        ++seen[static_cast<std::size_t>(
            reference.program->look_of_type(static_cast<std::uint16_t>(type)).pattern)];
    EXPECT_THAT(seen, testing::Each(256));
}

TEST(CompilePlan, FollowsDitheredMaterialsThroughTransitionTiles) {
    const std::string combinations = sixteen_combinations([](int i) { return int{i}; });
    const auto plan = plan_of(R"(
      {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8}},
      {"name": "grid", "virtual_tile_map": {"cell_texels": 8}},
      {"name": "areas", "dithered_areas_map": {"areas": {"grid": "grid", "values": [0, 1, 1, 0], "width": 2, "cells": 64}}},
      {"name": "index", "virtual_indirection_map": {"grid": "grid", "count": 16}},
      {"name": "tiles", "transition_tiles": {"material": {"block": "areas"}, "index": {"block": "index"}, "families": 2,
         "combinations": [)" + combinations +
                              R"(]}},
      {"name": "texture", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "tiles"}}})");
    ASSERT_TRUE(plan) << plan.error().detail;
    const CellProgram& program = *reference_of(*plan).program;
    EXPECT_EQ(program.basis(), CellProgram::Basis::varying);
    EXPECT_TRUE(program.varying()->corners);
    // The pattern's bits are the corners: neighbours agree on those they share
    std::vector<std::int32_t> row(3000), below(3000);
    for (std::int64_t y = -70; y < 70; ++y) {
        program.patterns({.x = -1500, .y = y, .count = 3000}, row.data());
        program.patterns({.x = -1500, .y = y + 1, .count = 3000}, below.data());
        for (std::size_t i = 0; i + 1 < row.size(); ++i) {
            ASSERT_EQ(row[i] >> 1 & 1, row[i + 1] & 1);
            ASSERT_EQ(row[i] >> 2, below[i] & 3);
        }
    }
    const auto shares = program.shares(std::array{0, 1, 1, 0});
    ASSERT_EQ(shares.size(), 1u);
    EXPECT_EQ(shares[0].pattern, 6);
}

}  // namespace
}  // namespace tessera
