// Random animations over random maps, some of which scroll, with random changes of their parameters, about
// near and far steps: what places show is worked out step by step, and the intervals that pages state are
// held against it. No end is missed, and none is stated where nothing changes.
//   TESSERA_RANDOM_BOARDS=100000 build/release/bin/random_boards_test
// tries so many instead of a few.
#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/pattern/pattern_texture.h"
#include "tests/support/random_pattern_files.h"
#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

class Dice {
  public:
    explicit Dice(std::uint64_t number) : number_{number} {}
    /// From 0 to `count` − 1.
    std::int64_t operator()(std::int64_t count) {
        return static_cast<std::int64_t>(hash(11, number_, ++thrown_, 0) % static_cast<std::uint64_t>(count));
    }
    std::int64_t from(std::int64_t least, std::int64_t most) { return least + (*this)(most - least + 1); }

  private:
    std::uint64_t number_;
    std::int64_t thrown_ = 0;
};

struct Board {
    std::string blocks;
    std::int64_t period = 1;  ///< Steps that say something of it.
    Step changes_from = 0;
};

std::string step_text(Step step) { return "\"" + std::to_string(step) + "\""; }

Board random_board(Dice& dice) {
    Board board;
    std::string frames;
    const std::int64_t count = dice.from(2, 6), dark = dice.from(0, 15);  // No two look alike
    for (std::int64_t i = 0; i < count; ++i)
        frames += std::string{i > 0 ? "," : ""} + R"({"pattern": )" + std::to_string(i == dark ? -1 : i) +
                  R"(, "steps": )" + std::to_string(dice(3) == 0 ? dice.from(2, 12) : 1) + "}";
    // Mostly one value, in some rows no other
    const bool wide = dice(8) == 0;  // So that what is known of a row is known in parts
    const std::int64_t width = wide           ? dice.from(900, 2300)
                               : dice(2) == 0 ? dice.from(8, 120)
                                              : std::int64_t{1} << dice.from(3, 6),
                       height = dice.from(1, wide ? 3 : 12), rare = dice.from(2, wide ? 1000 : 60);
    std::string entries;
    for (std::int64_t i = 0; i < width * height; ++i)
        entries += std::string{i > 0 ? "," : ""} +
                   std::to_string(i / width % 4 == 3 || dice(rare) != 0 ? 0 : dice.from(1, 3));
    const char* edges[] = {"wrap", "clamp"};
    board.blocks = R"({"name": "set", "pattern_set": {"image": "a.png", "side_texels": 4}},
      {"name": "grid", "virtual_tile_map": {"cell_texels": 4}},
      {"name": "frames", "animation_sequence": {"frames": [)" +
                   frames +
                   R"(]}}, {"name": "phase", "virtual_indirection_map": {"grid": "grid", "count": )" +
                   std::to_string(dice(2) == 0 ? dice.from(1, 40) : 65536) +
                   R"(}}, {"name": "map", "explicit_indirection_map": {"grid": "grid", "width": )" +
                   std::to_string(width) + R"(, "edge": ")" + edges[dice(2)] + R"(", "x": )" +
                   std::to_string(dice.from(-100, 100)) + R"(, "values": [)" + entries + "]}},";
    const auto rests = [&](const std::string& name) {
        std::string of;
        for (int i = 0; i < 4; ++i) {
            const std::int64_t kind = dice(5);
            const std::int64_t rest = kind < 2    ? -1
                                      : kind == 2 ? dice(12)
                                      : kind == 3 ? dice(300)
                                                  : dice(5000);
            of += std::string{i > 0 ? "," : ""} + R"({"pattern": )" + std::to_string(rest) + "}";
        }
        board.blocks += R"({"name": ")" + name +
                        R"(", "probability_map": {"index": {"block": "map"}, "material": {"entries": [)" +
                        of + "]}}},";
    };
    rests("first"), rests("second");
    const Step far[] = {0, 0, 0, -700, 1'000'000'000'000, max_step - 5000, 5000 - max_step};
    board.changes_from = far[dice(7)];
    std::string changes;
    Step step = board.changes_from + dice.from(-300, 300);
    for (std::int64_t i = dice(2) * dice(7); i > 0; --i) {
        step += dice(3) == 0 ? dice(200) : dice(40);
        const char* densities[] = {"\"Infinity\"", "0", "0.25", "1", "2.5", "40"};
        changes += std::string{changes.empty() ? "" : ","} + R"({"step": )" + step_text(step) +
                   R"(, "density": )" + densities[dice(6)] +
                   (dice(2) == 0 ? R"(, "rest": {"block": "second"})" : R"(, "rest": {"block": "first"})") +
                   "}";
    }
    board.blocks +=
        R"({"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": {"block": "first"}, "changes": [)" +
        changes + "]}},";
    std::string more;
    if (dice(4) == 0) {
        board.blocks +=
            R"({"name": "r", "virtual_random_map": {"grid": "grid"}}, {"name": "move", "tile_transform": {"grid": "grid", "turn": {"block": "r"}, "scale": {"number": 0.5}}},)";
        more += R"(, "transform": "move")";
    }
    if (dice(5) != 0) {
        const std::int64_t by = 8 * (dice(2) == 0 ? 1 : dice.from(1, 6)) * (dice(2) * 2 - 1);
        board.period = dice(2) == 0 ? 1 : dice.from(2, 9);
        more += R"(, "scroll": {"cells": )" + std::to_string(by) + R"(, "steps": )" +
                std::to_string(board.period) + "}";
    }
    board.blocks +=
        R"({"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "x"})" +
        more + "}}";
    return board;
}

std::vector<Look> looks_at(const ReferencePlan& cells, const TexelRegion& region, Step step) {
    const int shift = cells.grid.cell_log2 - region.level;
    const std::int64_t x = region.x >> shift, y = region.y >> shift,
                       right = (region.x + region.width - 1) >> shift,
                       bottom = (region.y + region.height - 1) >> shift;
    std::vector<Look> all, row(static_cast<std::size_t>(right - x + 1));
    for (std::int64_t j = y; j <= bottom; ++j) {
        cells.program->looks({.x = x, .y = j, .count = static_cast<std::int32_t>(row.size()), .step = step},
                             row.data());
        for (const Look& look : row) all.push_back(look.pattern < 0 ? Look{} : look);
    }
    return all;
}

/// Intervals end there although nothing changes: see scroll_interval().
bool may_be_cut(const Board& board, Step step) {
    const std::int64_t shift = step / board.period;
    return step % board.period == 0 && (shift % 16 == 8 || shift % 16 == -8 || shift % 32 == 0);
}

void try_board(std::uint64_t number) {
    Dice dice{number};
    const Board board = random_board(dice);
    SCOPED_TRACE("board " + std::to_string(number));
    RandomPatternFiles files{16};
    const auto plan = compile_plan(pattern_of(board.blocks), files);
    ASSERT_TRUE(plan) << plan.error().detail;
    const auto texture = make_pattern_texture(*plan);
    const auto& cells = std::get<ReferencePlan>(plan->textures.back().what);
    const bool scrolls = cells.program->scroll().cells != 0;
    for (int look = 0; look < 2; ++look) {
        const auto level = static_cast<std::uint8_t>(dice(3));
        const TexelRegion region{level, dice.from(-60, 200), dice.from(-60, 60),
                                 static_cast<std::int32_t>(dice.from(1, 40)),
                                 static_cast<std::int32_t>(dice.from(1, 30))};
        const Step begin = board.changes_from + dice.from(-300, 300), end = begin + 250;
        LinearImage texels, again;
        Validity valid{begin, begin};
        std::vector<Look> before = looks_at(cells, region, begin - 1);
        for (Step step = begin; step < end; ++step) {
            std::vector<Look> looks = looks_at(cells, region, step);
            const bool changes = looks != before, held = step != begin && valid.holds(step);
            before = std::move(looks);
            ASSERT_FALSE(held && changes) << "step " << step;
            if (held && dice(6) != 0) continue;
            TexelRegion at = region;
            at.step = step;
            const auto done = texture->evaluate(at, Budget{}, held ? again : texels);
            ASSERT_TRUE(done);
            ASSERT_TRUE(done->validity.holds(step));
            if (held) {
                ASSERT_EQ(done->validity, valid) << "step " << step;
                ASSERT_EQ(again.values, texels.values) << "step " << step;
            } else if (step != begin) {
                ASSERT_EQ(done->validity.from, step);
                ASSERT_TRUE(changes || (scrolls && may_be_cut(board, step))) << "step " << step;
            }
            valid = done->validity;
        }
    }
}

TEST(RandomBoards, StateTheStepsInWhichTheyStayTheSame) {
    const char* many = std::getenv("TESSERA_RANDOM_BOARDS");
    const std::uint64_t boards = many != nullptr ? std::strtoull(many, nullptr, 10) : 10;
    for (std::uint64_t number = 0; number < boards && !testing::Test::HasFailure(); ++number)
        try_board(number);
}

}  // namespace
}  // namespace tessera
