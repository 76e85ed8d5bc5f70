// What each block gives, cell by cell, against its definition.
#include <array>
#include <random>

#include <gmock/gmock.h>

#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

const std::string ground = R"(
  {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8, "count": 256}},
  {"name": "grid", "virtual_tile_map": {"cell_texels": 8}},)";

/// The plan that shows block "x" as pattern.
Plan show(const std::string& blocks, const std::string& more = "") {
    auto plan = plan_of(ground + blocks + R"(, {"name": "t", "reference_texture":
        {"patterns": "set", "grid": "grid", "index": {"block": "x"}}})",
                        more);
    EXPECT_TRUE(plan) << plan.error().detail;
    return plan ? std::move(*plan) : Plan{};
}

std::vector<std::int32_t> cells(const Plan& plan, std::int64_t x, std::int64_t y, std::int32_t count,
                                std::int64_t step = 0, std::int64_t z = 0) {
    const ReferencePlan& reference = reference_of(plan);
    std::vector<std::int32_t> out(static_cast<std::size_t>(count));
    TypeGrid types;
    CellRow row{.x = x, .y = y, .count = count, .z = z, .step = step};
    if (reference.grid.quadtree != nullptr) {
        types = reference.grid.quadtree->types_of(0, x, y, count, 1);
        row.types = types.row(y) + (x - types.x);
    }
    reference.program->patterns(row, out.data());
    return out;
}

TEST(ExplicitMaps, WrapClampOrAreBlankOutside) {
    const auto at = [](const std::string& edge, std::int64_t x, std::int64_t y) {
        static std::map<std::string, Plan> plans;
        if (!plans.contains(edge))
            plans[edge] =
                show(R"({"name": "x", "areas_map": {"grid": "grid", "width": 3, "values": [1,2,3,4,5,6],
                "cells": 4, "x": "-8", "y": "4", "edge": ")" +
                     edge + "\"}}");
        return cells(plans[edge], x, y, 1)[0];
    };
    for (const std::string edge : {"wrap", "clamp", "blank"}) {
        EXPECT_EQ(at(edge, -8, 4), 1);
        EXPECT_EQ(at(edge, -5, 7), 1);
        EXPECT_EQ(at(edge, -4, 4), 2);
        EXPECT_EQ(at(edge, 3, 11), 6);
    }
    EXPECT_EQ(at("wrap", 4, 4), 1);
    EXPECT_EQ(at("wrap", -9, 3), 6);
    EXPECT_EQ(at("clamp", 100, 100), 6);
    EXPECT_EQ(at("clamp", -9, 3), 1);
    EXPECT_EQ(at("blank", 4, 4), -1);
    EXPECT_EQ(at("blank", -9, 4), -1);
}

TEST(ExplicitMaps, OneEntryACellIsRead) {
    const Plan plan = show(R"({"name": "x", "explicit_indirection_map": {"grid": "grid", "width": 3,
        "values": [1,2,3,4,5,-1]}})");
    EXPECT_EQ(cells(plan, -1, 0, 5), (std::vector<std::int32_t>{3, 1, 2, 3, 1}));
    EXPECT_EQ(cells(plan, 2, -1, 3), (std::vector<std::int32_t>{-1, 4, 5}));
}

TEST(ProbabilityMaps, TypedDrawsShowEachEntryAsOftenAsItsWeight) {
    const Plan plan = show(R"({"name": "draw", "virtual_indirection_map": {"grid": "grid", "count": 10}},
        {"name": "x", "probability_map": {"index": {"block": "draw"}, "material": {"entries":
           [{"pattern": 7, "weight": 5}, {"pattern": -1, "weight": 3}, {"pattern": 9, "weight": 0}, {"pattern": 2, "weight": 2}]}}})");
    const CellProgram& program = *reference_of(plan).program;
    std::map<int, int> seen;
    for (std::uint32_t type = 0; type < 4096; ++type)
        ++seen[program.look_of_type(static_cast<std::uint16_t>(type)).pattern];
    EXPECT_EQ(seen.size(), 3u);
    EXPECT_NEAR(seen[7], 2048, 5);
    EXPECT_NEAR(seen[-1], 1228.8, 3);
    EXPECT_NEAR(seen[2], 819.2, 2);
}

TEST(TypedDraws, AreEvenToWithinOneAndOfOneShuffleForOneStream) {
    const Plan plan =
        show(R"({"name": "a", "virtual_indirection_map": {"grid": "grid", "count": 48, "stream": 3}},
        {"name": "b", "virtual_indirection_map": {"grid": "grid", "count": 3, "stream": 3}},
        {"name": "x", "materials_map": {"material": {"block": "b"}, "index": {"block": "a"}, "materials": [
            {"entries": [{"pattern": 0}, {"pattern": 1}, {"pattern": 2}]}, {"entries": [{"pattern": 0}, {"pattern": 1}, {"pattern": 2}]},
            {"entries": [{"pattern": 0}, {"pattern": 1}, {"pattern": 2}]}]}})");
    // Of one stream: the material is the third of the index, so pattern = material always
    const CellProgram& program = *reference_of(plan).program;
    std::array<int, 3> seen{};
    for (std::uint32_t type = 0; type < 4096; ++type)
        ++seen[static_cast<std::size_t>(program.look_of_type(static_cast<std::uint16_t>(type)).pattern)];
    for (const int count : seen) EXPECT_NEAR(count, 4096 / 3.0, 1);
}

TEST(Dithering, ShowsNodesAtNodesAndBilinearSharesBetween) {
    for (const std::string generator : {"independent", "nested"}) {
        for (const int side : {2, 8, 32, 64}) {
            const Plan plan = show(R"({"name": "x", "dithered_areas_map": {"generator": ")" + generator +
                                   R"(", "areas": {"grid": "grid", "width": 2,
                "values": [10, 20, 30, 40], "cells": )" +
                                   std::to_string(side) + "}}}");
            // Cell (fx, fy) of each patch with node 10 at its corner; patches repeat every 2·side cells
            const int fx = side / 4 + 1 - side / 2 % 2, fy = side / 2;
            std::map<int, int> seen;
            constexpr int patches = 40;
            for (int j = 0; j < patches; ++j) {
                const std::int64_t y = 2 * side * j;
                const auto on_nodes = cells(plan, 0, y, 2 * side * patches);
                const auto between = cells(plan, 0, y + fy, 2 * side * patches);
                for (int i = 0; i < patches; ++i) {
                    EXPECT_EQ(on_nodes[static_cast<std::size_t>(2 * side * i)], 10);
                    EXPECT_EQ(on_nodes[static_cast<std::size_t>(2 * side * i + side)], 20);
                    ++seen[between[static_cast<std::size_t>(2 * side * i + fx)]];
                }
            }
            const double x = static_cast<double>(fx) / side, y = static_cast<double>(fy) / side;
            const auto expect = [&](int value, double share) {
                const double sigma = std::sqrt(share * (1 - share) / (patches * patches));
                EXPECT_NEAR(seen[value] / static_cast<double>(patches * patches), share, 4.5 * sigma + 1e-9)
                    << generator << " " << side << " " << value;
            };
            expect(10, (1 - x) * (1 - y));
            expect(20, x * (1 - y));
            expect(30, (1 - x) * y);
            expect(40, x * y);
        }
    }
}

TEST(Dithering, AlongOneAxisTakesTheEntryThatTheCellLiesInAlongTheOther) {
    for (const int side : {4, 64}) {
        const auto areas = [&](const std::string& axes) {
            return show(R"({"name": "x", "dithered_areas_map": {"axes": ")" + axes +
                        R"(", "areas": {"grid": "grid", "width": 2, "values": [10, 20, 30, 40], "cells": )" +
                        std::to_string(side) + "}}}");
        };
        const Plan across = areas("x_only"), down = areas("y_only");
        for (int y = 0; y < side; ++y) {
            const auto row = cells(across, 0, y, side), column = cells(down, 0, y, side);
            EXPECT_THAT(row, testing::Each(testing::AnyOf(10, 20)));
            EXPECT_EQ(row[0], 10);
            EXPECT_THAT(column, testing::Each(testing::AnyOf(10, 30)));
            if (y == 0) {
                EXPECT_THAT(column, testing::Each(10));
            }
        }
    }
}

TEST(Transitions, BorderedTilesSeeWhereTheFamilyBegins) {
    const std::string combinations = sixteen_combinations([](int i) { return int{i == 0 ? -1 : i}; });
    const Plan plan =
        show(R"({"name": "areas", "areas_map": {"grid": "grid", "width": 4, "values": [0,1,2,1, 2,2,0,0]}},
        {"name": "x", "transition_tiles": {"material": {"block": "areas"}, "families": 3, "family": 2, "combinations": [)" +
             combinations + "]}}");
    const int values[2][4] = {{0, 1, 2, 1}, {2, 2, 0, 0}};
    for (int y = 0; y < 2; ++y) {
        const auto row = cells(plan, 0, y, 4);
        for (int x = 0; x < 4; ++x) {
            const auto at = [&](int dx, int dy) { return int{values[(y + dy) % 2][(x + dx) % 4] >= 2}; };
            const int code = at(0, 0) | at(1, 0) << 1 | at(0, 1) << 2 | at(1, 1) << 3;
            EXPECT_EQ(row[static_cast<std::size_t>(x)], code == 0 ? -1 : code);
        }
    }
}

TEST(Transitions, OfTransitionsReadCornersOfCorners) {
    const std::string combinations = sixteen_combinations([](int i) { return int{i == 15}; });
    const auto chain = [&](int length) {
        std::string blocks = R"({"name": "a0", "virtual_indirection_map": {"grid": "grid", "count": 2}})";
        for (int i = 1; i <= length; ++i)
            blocks += R"(, {"name": ")" + (i == length ? std::string{"x"} : "a" + std::to_string(i)) +
                      R"(", "transition_tiles": {"families": 2, "material": {"block": "a)" +
                      std::to_string(i - 1) + R"("}, "combinations": [)" + combinations + "]}}";
        return blocks;
    };
    // All of the 3 × 3 draws from the cell on
    const Plan plan = show(chain(2));
    const Plan draws = show(R"({"name": "x", "probability_map": {"index": {"block": "a0"},
            "material": {"entries": [{"pattern": 0}, {"pattern": 1}]}}},
        {"name": "a0", "virtual_indirection_map": {"grid": "grid", "count": 2, "generator": "independent"}})");
    for (int y = -3; y < 3; ++y) {
        const auto shown = cells(plan, -700, y, 1400);
        std::array<std::vector<std::int32_t>, 3> drawn;
        for (int dy = 0; dy < 3; ++dy) drawn[static_cast<std::size_t>(dy)] = cells(draws, -700, y + dy, 1402);
        for (std::size_t i = 0; i < shown.size(); ++i) {
            int all = 1;
            for (const auto& row : drawn) all &= row[i] & row[i + 1] & row[i + 2];
            ASSERT_EQ(shown[i], all);
        }
    }
    EXPECT_FALSE(reference_of(plan).program->independent_cells());
    const auto too_deep = plan_of(ground + chain(5) + R"(, {"name": "t", "reference_texture":
        {"patterns": "set", "grid": "grid", "index": {"block": "x"}}})");
    ASSERT_FALSE(too_deep);
    EXPECT_THAT(too_deep.error().detail, testing::HasSubstr("corners of corners more than 4 deep"));
}

TEST(Animation, FollowsThePaperForAnyStep) {
    const Plan plan = show(
        R"({"name": "frames", "animation_sequence": {"frames": [{"pattern": 9}, {"pattern": 5, "steps": 2}, {"pattern": 6}]}},
        {"name": "phase", "explicit_indirection_map": {"grid": "grid", "width": 4, "values": [0, 1, 7, 1000000000]}},
        {"name": "rest", "explicit_indirection_map": {"grid": "grid", "width": 3, "values": [0, 3, 10]}},
        {"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": {"block": "rest"}, "density": 1.5}})");
    const std::int64_t phases[] = {0, 1, 7, 1000000000}, rests[] = {0, 4, 15};
    const int frames[] = {9, 5, 5, 6};
    for (const std::int64_t step :
         {std::int64_t{0}, std::int64_t{1}, std::int64_t{5}, std::int64_t{-3}, std::int64_t{1000000000000000},
          std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()}) {
        const auto row = cells(plan, 0, 0, 12, step);
        for (int i = 0; i < 12; ++i) {
            __extension__ using Wide = __int128;
            const Wide rest = rests[i % 3], cycle = 4 + rest, sum = Wide{step} + phases[i % 4];
            const Wide at = ((sum % cycle + cycle) % cycle) - rest;
            EXPECT_EQ(row[static_cast<std::size_t>(i)], frames[static_cast<std::size_t>(at < 0 ? 0 : at)])
                << step << " " << i;
        }
    }
}

TEST(Animation, WithAnEndlessRestNeverMoves) {
    const Plan plan =
        show(R"({"name": "frames", "animation_sequence": {"frames": [{"pattern": 9}, {"pattern": 5}]}},
        {"name": "x", "animation_map": {"sequence": "frames", "rest": {"integer": "9223372036854775807"}}})");
    EXPECT_EQ(reference_of(plan).program->basis(), CellProgram::Basis::constant);
    EXPECT_EQ(cells(plan, 0, 0, 1, 1000000000000000)[0], 9);
}

TEST(Animation, ATableOfTypesIsForTheStepItWasMadeFor) {
    const Plan plan = show(
        R"({"name": "frames", "animation_sequence": {"frames": [{"pattern": 0}, {"pattern": 1}, {"pattern": 2}]}},
        {"name": "phase", "virtual_indirection_map": {"grid": "grid", "count": 3}},
        {"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}}})");
    const auto now = cells(plan, 0, 0, 100), later = cells(plan, 0, 0, 100, 4);
    for (std::size_t i = 0; i < now.size(); ++i) EXPECT_EQ(later[i], (now[i] + 1) % 3);
}

TEST(RandomNumbers, AreTheQuantisedValuesAndEndsAreIncluded) {
    const auto plan = plan_of(
        ground +
        R"({"name": "r", "virtual_random_map": {"grid": "grid", "from": 0.25, "to": 0.75, "levels": 3}},
        {"name": "move", "tile_transform": {"grid": "grid", "x": {"block": "r"}, "y": {"integer": 1}}},
        {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "transform": "move"}})");
    ASSERT_TRUE(plan) << plan.error().detail;
    std::map<int, int> seen;
    for (std::uint32_t type = 0; type < 4096; ++type) {
        const Look look = reference_of(*plan).program->look_of_type(static_cast<std::uint16_t>(type));
        ++seen[look.x];
        EXPECT_EQ(look.y, 65535);
    }
    EXPECT_THAT(seen, testing::UnorderedElementsAre(testing::Pair(16384, 1366), testing::Pair(32768, 1365),
                                                    testing::Pair(49152, 1365)));
}

TEST(Volumes, LayersOfCellsDrawByThemselves) {
    for (const std::string generator : {"independent", "nested", "sigma"}) {
        const Plan plan =
            show(R"({"name": "x", "virtual_indirection_map": {"grid": "grid", "count": 16, "generator": ")" +
                 generator + "\"}}");
        const auto low = cells(plan, 0, 0, 4096, 0, 0), high = cells(plan, 0, 0, 4096, 0, 1);
        int same = 0;
        for (std::size_t i = 0; i < low.size(); ++i) same += low[i] == high[i];
        EXPECT_NE(low, high) << generator;
        if (generator != "sigma") {
            EXPECT_NEAR(same, 256, 80) << generator;
        }
    }
}

TEST(Rows, AreTheSameWhetherOrNotTheRowAboveWasAskedBefore) {
    const std::string combinations = sixteen_combinations([](int i) { return int{i}; });
    const Plan plan = show(R"({"name": "areas", "dithered_areas_map": {"areas": {"grid": "grid", "width": 2,
          "values": [0, 1, 1, 0], "cells": 32}}},
        {"name": "x", "transition_tiles": {"families": 2, "material": {"block": "areas"}, "combinations": [)" +
                           combinations + "]}}");
    const Plan other = show(R"({"name": "x", "virtual_indirection_map": {"grid": "grid", "count": 13,
          "generator": "independent"}})");
    std::vector<std::vector<std::int32_t>> downwards, upwards;
    for (int y = 0; y < 100; ++y) downwards.push_back(cells(plan, -100, y, 300));
    for (int y = 99; y >= 0; --y) {
        upwards.push_back(cells(plan, -100, y, 300));
        if (y % 7 == 0) cells(other, -100, y - 2, 300);
    }
    for (std::size_t y = 0; y < 100; ++y) EXPECT_EQ(downwards[y], upwards[99 - y]);
    // The same cells, but another layer of them, or more of them
    cells(plan, -100, 20, 300, 0, 1);
    EXPECT_EQ(cells(plan, -100, 21, 300), downwards[21]);
    cells(plan, -100, 20, 200);
    EXPECT_EQ(cells(plan, -100, 21, 300), downwards[21]);
}

TEST(Rows, AreTheSameInWhateverStretchTheyAreAsked) {
    std::mt19937 random{7};
    for (const std::string generator : {"independent", "nested", "sigma", "typed"}) {
        const Plan plan =
            show(R"({"name": "x", "virtual_indirection_map": {"grid": "grid", "count": 13, "generator": ")" +
                 generator + "\"}}");
        const auto whole = cells(plan, 65536 - 5000, -3, 10000);
        for (int i = 0; i < 40; ++i) {
            const auto from = static_cast<std::int32_t>(random() % 9000);
            const auto count = static_cast<std::int32_t>(1 + random() % static_cast<unsigned>(10000 - from));
            const auto part = cells(plan, 65536 - 5000 + from, -3, count);
            ASSERT_TRUE(std::equal(part.begin(), part.end(), whole.begin() + from)) << generator;
        }
    }
    for (const int side : {2, 16, 128, 65536}) {
        const Plan plan = show(R"({"name": "x", "dithered_areas_map": {"areas": {"grid": "grid", "width": 3,
            "values": [1,2,3,4,5,6,7,8,9], "cells": )" +
                               std::to_string(side) + "}}}");
        const auto whole = cells(plan, 65536 - 5000, -3, 10000);
        for (int i = 0; i < 40; ++i) {
            const auto from = static_cast<std::int32_t>(random() % 9000);
            const auto count = static_cast<std::int32_t>(1 + random() % static_cast<unsigned>(10000 - from));
            const auto part = cells(plan, 65536 - 5000 + from, -3, count);
            ASSERT_TRUE(std::equal(part.begin(), part.end(), whole.begin() + from)) << side;
        }
    }
}

}  // namespace
}  // namespace tessera
