// Pages of animated textures over 10,000 steps: no byte changes inside a stated interval, and where it ends a
// cell that the page meets shows another frame.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/pattern/pattern_texture.h"
#include "tests/support/random_pattern_files.h"
#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

const std::string ground = R"(
  {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 4}},
  {"name": "grid", "virtual_tile_map": {"cell_texels": 4}},
  {"name": "frames", "animation_sequence": {"frames": [{"pattern": 0, "steps": 3}, {"pattern": 1}, {"pattern": 2, "steps": 4}, {"pattern": 3}]}},)";
const std::string shown =
    R"(, {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "x"}}})";

struct Moving {
    std::string name, blocks;
    std::int32_t parameter = 0;  ///< What requests say.
};

/// Every way that a texture can move.
std::vector<Moving> all_kinds() {
    const std::string drawn = R"(
      {"name": "phase", "virtual_indirection_map": {"grid": "grid", "count": 400}},
      {"name": "rest", "virtual_random_map": {"grid": "grid", "from": 0, "to": 300}},)";
    const std::string signs = R"(
      {"name": "sign", "explicit_indirection_map": {"grid": "grid", "width": 5, "values": [0, 7, -1, 90, -1, -1, 500, 3, -1, 40]}},)";
    return {
        {"drawn",
         ground + drawn +
             R"({"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": {"block": "rest"}, "density": 1.5}})" +
             shown},
        {"signs",
         ground + drawn + signs +
             R"({"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": {"block": "sign"}}})" +
             shown},
        {"together",
         ground +
             R"({"name": "x", "animation_map": {"sequence": "frames", "phase": {"integer": "1000000000"}, "rest": {"integer": 60}}})" +
             shown},
        {"slow", ground + R"({"name": "phase", "virtual_indirection_map": {"grid": "grid", "count": 65536}},
          {"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": {"integer": 1000000000}, "density": 1}})" +
                     shown},
        {"changing",
         ground + drawn + signs +
             R"({"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": {"integer": 50},
          "changes": [{"step": 1000, "rest": {"block": "sign"}}, {"step": 1003, "density": 2}, {"step": 3000, "rest": {"integer": "9223372036854775807"}},
                      {"step": 4500, "rest": {"block": "rest"}, "density": 0.25}, {"step": 7000, "density": "Infinity"}]}})" +
             shown},
        {"instances", ground + drawn + R"({"name": "wide", "virtual_tile_map": {"cell_texels": 16}},
          {"name": "wphase", "virtual_indirection_map": {"grid": "wide", "count": 100}},
          {"name": "r", "virtual_random_map": {"grid": "wide"}},
          {"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "wphase"}, "rest": {"integer": 80}}},
          {"name": "move", "tile_transform": {"grid": "wide", "x": {"block": "r"}, "turn": {"block": "r"}}},
          {"name": "t", "reference_texture": {"patterns": "set", "grid": "wide", "index": {"block": "x"}, "transform": "move"}})"},
        {"over a ground",
         ground + drawn + R"({"name": "still", "virtual_indirection_map": {"grid": "grid", "count": 4}},
          {"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": {"block": "rest"}}},
          {"name": "below", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "still"}}},
          {"name": "above", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "x"}}},
          {"name": "t", "layers": {"textures": ["below", "above"]}})"},
        {"by the clock and the request",
         ground + drawn +
             R"({"name": "views", "animation_sequence": {"frames": [{"pattern": 0}, {"pattern": 1}, {"pattern": 2}]}},
          {"name": "clock", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": {"block": "rest"}}},
          {"name": "view", "animation_map": {"sequence": "views", "request_parameter": {}}},
          {"name": "x", "materials_map": {"material": {"block": "clock"}, "index": {"block": "view"}, "materials": [
            {"entries": [{"pattern": 0}, {"pattern": 1}, {"pattern": 3}]}, {"entries": [{"pattern": 1}, {"pattern": 2}, {"pattern": 0}]},
            {"entries": [{"pattern": 2}, {"pattern": 3}, {"pattern": 1}]}, {"entries": [{"pattern": 3}, {"pattern": 0}, {"pattern": 2}]}]}})" +
             shown,
         40000},
        {"over a ground that the request drives",
         ground + drawn +
             R"({"name": "view", "animation_map": {"sequence": "frames", "request_parameter": {}}},
          {"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": {"block": "rest"}}},
          {"name": "below", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "view"}}},
          {"name": "above", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "x"}}},
          {"name": "t", "layers": {"textures": ["below", "above"]}})",
         60000},
    };
}

Result<Plan> compile(const std::string& blocks) {
    RandomPatternFiles files{16};
    return compile_plan(pattern_of(blocks), files);
}

/// The looks of the cells that a region meets, of all animated textures.
std::vector<Look> looks_under(const Plan& plan, TexelRegion region, Step step) {
    std::vector<Look> all;
    for (const PlannedTexture& texture : plan.textures) {
        const auto* reference = std::get_if<ReferencePlan>(&texture.what);
        if (reference == nullptr || !reference->program->moves()) continue;
        const int cell = reference->grid.cell_log2 - region.level;
        const auto at = [&](std::int64_t texel) { return cell >= 0 ? texel >> cell : texel << -cell; };
        const std::int64_t x = at(region.x), y = at(region.y);
        const std::int64_t right =
            cell >= 0 ? at(region.x + region.width - 1) : at(region.x + region.width) - 1;
        const std::int64_t bottom =
            cell >= 0 ? at(region.y + region.height - 1) : at(region.y + region.height) - 1;
        const auto width = static_cast<std::int32_t>(right - x + 1);
        std::vector<Look> row(static_cast<std::size_t>(width));
        for (std::int64_t cell_y = y; cell_y <= bottom; ++cell_y) {
            reference->program->looks(
                {.x = x, .y = cell_y, .count = width, .step = step, .parameter = region.parameter},
                row.data());
            // Where nothing is shown, it does not matter how
            for (Look& look : row)
                if (look.pattern < 0) look = {};
            all.insert(all.end(), row.begin(), row.end());
        }
    }
    return all;
}

struct Page {
    LinearImage texels;
    Evaluation evaluation;
};
Page evaluate(const Texture& texture, TexelRegion region, Step step, Accuracy accuracy) {
    region.step = step;
    Page page;
    const auto evaluation = texture.evaluate(region, Budget{.accuracy = accuracy}, page.texels);
    EXPECT_TRUE(evaluation) << evaluation.error().detail;
    if (evaluation) page.evaluation = *evaluation;
    return page;
}

TEST(PageValidity, HoldsOverTenThousandSteps) {
    for (const Moving& moving : all_kinds()) {
        SCOPED_TRACE(moving.name);
        const auto plan = compile(moving.blocks);
        ASSERT_TRUE(plan) << plan.error().detail;
        const auto texture = make_pattern_texture(*plan);
        std::size_t intervals = 0;
        // Composites decide by blocks of 32 texels, which pages are made of
        const std::vector<TexelRegion> regions =
            moving.name.starts_with("over a ground")
                ? std::vector<TexelRegion>{{0, -3, 5, 24, 20}, {1, 96, -32, 32, 32}}
                : std::vector<TexelRegion>{
                      {0, -3, 5, 24, 20}, {1, 100, -40, 8, 8}, {3, 7, 7, 4, 4}, {4, 2, 2, 2, 2}};
        for (TexelRegion region : regions) {
            SCOPED_TRACE(int{region.level});
            region.parameter = moving.parameter;
            Page page = evaluate(*texture, region, 0, Accuracy::high);
            for (Step step = 0; step < 10'000; ++step) {
                const Validity& valid = page.evaluation.validity;
                if (valid.holds(step)) {
                    const Page again = evaluate(*texture, region, step, Accuracy::high);
                    ASSERT_EQ(again.texels.values, page.texels.values) << step;
                    ASSERT_EQ(again.evaluation.validity, valid) << step;
                    ASSERT_EQ(again.evaluation.bound_codes, page.evaluation.bound_codes) << step;
                    continue;
                }
                ASSERT_EQ(step, valid.until);
                ASSERT_NE(looks_under(*plan, region, step), looks_under(*plan, region, step - 1)) << step;
                page = evaluate(*texture, region, step, Accuracy::high);
                ASSERT_EQ(page.evaluation.validity.from, step);
                ++intervals;
            }
        }
        if (moving.name != "slow") {
            EXPECT_GT(intervals, 100u);
        }
    }
}

/// Cells that run, in all ways that tell how long they look alike.
std::vector<Moving> running_kinds() {
    // Mostly one value, here and there others: 96 × 24 entries
    std::string signs;
    for (std::int64_t i = 0; i < 96 * 24; ++i) {
        const std::uint64_t dice = hash(5, stream("signs"), i, 0);
        const bool empty = i % 96 < 40 || i / 96 % 6 == 1;
        signs += (i > 0 ? ", " : "") + std::to_string(empty || dice % 40 != 0 ? 0 : 1 + dice / 64 % 3);
    }
    const auto map = [&](const std::string& more) {
        return R"({"name": "map", "explicit_indirection_map": {"grid": "grid", "width": 96, "values": [)" +
               signs + "]" + more + "}},";
    };
    const std::string phase =
        R"({"name": "phase", "virtual_indirection_map": {"grid": "grid", "count": 65536}},)";
    const auto rests = [](const std::string& name, const std::string& of) {
        std::string entries;
        for (const char c : of)
            entries += std::string{entries.empty() ? "" : ", "} + R"({"pattern": )" +
                       (c == '-'   ? "-1"
                        : c == 's' ? "9"
                        : c == 'm' ? "170"
                                   : "4000") +
                       "}";
        return R"({"name": ")" + name +
               R"(", "probability_map": {"index": {"block": "map"}, "material": {"entries": [)" + entries +
               "]}}},";
    };
    const auto scrolled = [](const std::string& scroll, const std::string& transform = "") {
        return R"(, {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "x"}, "scroll": )" +
               scroll + transform + "}}";
    };
    const std::string lit =
        R"({"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": {"block": "first"})";
    const std::string mixed =
        R"({"name": "x", "materials_map": {"material": {"block": "map"}, "index": {"block": "few"}, "materials": [
            {"entries": [{"pattern": 2}]}, {"entries": [{"pattern": 2}, {"pattern": 3}]}, {"entries": [{"pattern": 1}]},
            {"entries": [{"pattern": 2}, {"pattern": 2}]}]}})";
    const std::string few = R"({"name": "few", "virtual_indirection_map": {"grid": "grid", "count": 2}},)";
    return {
        {"a board",
         ground + phase + map("") + rests("first", "--ml") + lit + "}}" + scrolled(R"({"cells": 8})")},
        {"to the right, slowly", ground + phase + map("") + rests("first", "-smm") + lit + "}}" +
                                     scrolled(R"({"cells": -8, "steps": 3})")},
        {"two messages",
         ground + phase + map(R"(, "edge": "clamp", "x": 16)") + rests("first", "--sm") +
             rests("second", "-s-l") + lit +
             R"(, "changes": [{"step": -900, "density": 4}, {"step": -600, "density": "Infinity"},
             {"step": -300, "rest": {"block": "second"}, "density": 2}, {"step": 500, "density": 1}, {"step": 1100, "rest": {"block": "first"}}]}})" +
             scrolled(R"({"cells": 8, "steps": 2})")},
        {"further than they are wide",
         ground + few + map(R"(, "edge": "clamp", "x": -200)") + mixed + scrolled(R"({"cells": 48})")},
        {"still, over a map", ground + few + map("") + mixed + scrolled(R"({"cells": 8, "steps": 7})")},
        {"of a period",
         ground +
             R"({"name": "x", "explicit_indirection_map": {"grid": "grid", "width": 16, "values": [0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 2, 1]}})" +
             scrolled(R"({"cells": 8, "steps": 2})")},
        {"once past",
         ground +
             R"({"name": "x", "explicit_indirection_map": {"grid": "grid", "edge": "blank", "x": 640, "width": 5, "values": [1, 1, -1, 2, 1, 1, 1, 1, 1, 1]}})" +
             scrolled(R"({"cells": 16, "steps": 3})")},
        {"drawn",
         ground + few +
             R"({"name": "x", "materials_map": {"material": {"integer": 0}, "index": {"block": "few"}, "materials": [
            {"entries": [{"pattern": 2}, {"pattern": 3}]}]}})" +
             scrolled(R"({"cells": 1, "steps": 3})")},
        {"blank instances",
         ground + phase + map("") + rests("first", "-m--") +
             R"({"name": "dark", "animation_sequence": {"frames": [{"pattern": -1}, {"pattern": 1, "steps": 9}, {"pattern": 3}]}},
                {"name": "r", "virtual_random_map": {"grid": "grid"}},
                {"name": "move", "tile_transform": {"grid": "grid", "turn": {"block": "r"}, "scale": {"number": 0.5}}},
                {"name": "x", "animation_map": {"sequence": "dark", "phase": {"block": "phase"}, "rest": {"block": "first"}}})" +
             scrolled(R"({"cells": 8})", R"(, "transform": "move")")},
        {"hanging over", ground + few + map("") + mixed +
                             R"(, {"name": "r", "virtual_random_map": {"grid": "grid"}},
                {"name": "move", "tile_transform": {"grid": "grid", "x": {"block": "r"}, "overflow": true, "scale": {"number": 0.9}}})" +
                             scrolled(R"({"cells": 8, "steps": 5})", R"(, "transform": "move")")},
    };
}

/// The frames that places show, cell by cell: an interval ends where one of them changes, and nowhere else,
/// from whichever of its steps it is asked for.
TEST(PageValidity, OfCellsThatRunIsMaximal) {
    for (const Moving& moving : running_kinds()) {
        SCOPED_TRACE(moving.name);
        const auto plan = compile(moving.blocks);
        ASSERT_TRUE(plan) << plan.error().detail;
        const auto texture = make_pattern_texture(*plan);
        std::size_t intervals = 0, shifts = 0;
        const auto* cells = std::get_if<ReferencePlan>(&plan->textures.back().what);
        const Scroll scroll = cells->program->scroll();
        // Nothing that is near: then the row where all is still, and whole rows of cells
        for (const TexelRegion& region : {TexelRegion{0, -3, 5, 24, 20}, TexelRegion{0, 64, 28, 64, 4},
                                          TexelRegion{1, 16, -8, 6, 40}, TexelRegion{3, 7, 7, 4, 4}}) {
            SCOPED_TRACE(std::to_string(region.level) + " at " + std::to_string(region.x));
            for (const Step begin : {Step{-1000}, Step{-100}, Step{3'000'000'000'000}}) {
                Page page;
                page.evaluation.validity = {0, 0};
                std::vector<Look> looks, before = looks_under(*plan, region, begin - 1);
                for (Step step = begin; step < begin + 420; ++step, before = std::move(looks)) {
                    looks = looks_under(*plan, region, step);
                    // Composites look at cells around, too
                    const bool wider = moving.name == "hanging over", changes = looks != before;
                    const Validity valid = page.evaluation.validity;
                    if (valid.holds(step)) {
                        ASSERT_FALSE(changes && step != begin) << step;
                        // Now and then, from within
                        if (hash(3, stream("within"), step, 0) % 4 != 0 && valid.until - step > 2) continue;
                        const Page again = evaluate(*texture, region, step, Accuracy::high);
                        ASSERT_EQ(again.texels.values, page.texels.values) << step;
                        ASSERT_EQ(again.evaluation.validity, valid) << step;
                        continue;
                    }
                    page = evaluate(*texture, region, step, Accuracy::high);
                    ASSERT_TRUE(page.evaluation.validity.holds(step));
                    ++intervals;
                    if (step == begin) continue;
                    ASSERT_EQ(page.evaluation.validity.from, step);
                    ASSERT_TRUE(changes || wider) << step;
                }

                shifts += 420 / scroll.steps;
            }
        }
        // Most shifts change nothing, but where all is drawn
        EXPECT_GT(intervals, 8u);
        if (moving.name != "drawn" && moving.name != "hanging over") {
            EXPECT_LT(intervals, shifts * 2 / 3);
        }
    }
}

TEST(PageValidity, IsAboutFarStepsToo) {
    const auto plan = compile(all_kinds().front().blocks);
    ASSERT_TRUE(plan);
    const auto texture = make_pattern_texture(*plan);
    for (Step step : {Step{1'000'000'000'000'000}, max_step, -max_step}) {
        const TexelRegion region{0, 8, 8, 8, 8};
        for (int i = 0; i < 50; ++i) {
            const Page page = evaluate(*texture, region, step, Accuracy::high);
            const Validity& valid = page.evaluation.validity;
            ASSERT_TRUE(valid.holds(step));
            ASSERT_EQ(evaluate(*texture, region, valid.until - 1, Accuracy::high).texels.values,
                      page.texels.values);
            ASSERT_NE(looks_under(*plan, region, valid.until), looks_under(*plan, region, step));
            step = valid.until;
        }
    }
}

TEST(PageValidity, IsForEverWhereAnimationFallsUnderTheBudget) {
    // Phases are whole cycles: what cells show on average is the same at every step
    const auto plan =
        compile(ground + R"({"name": "phase", "virtual_indirection_map": {"grid": "grid", "count": 1200}},
        {"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": {"integer": 291}}})" +
                shown);
    ASSERT_TRUE(plan) << plan.error().detail;
    const auto texture = make_pattern_texture(*plan);
    for (const Accuracy accuracy : {Accuracy::fast, Accuracy::high, Accuracy::exact}) {
        // An exact page sums its cells for as long as that takes a second, and a sum moves: a level more
        const std::uint8_t level = accuracy == Accuracy::exact ? 8 : 7;
        const Page above = evaluate(*texture, {level, 0, 0, 8, 8}, 0, accuracy);
        EXPECT_TRUE(above.evaluation.validity.is_static());
        EXPECT_EQ(evaluate(*texture, {level, 0, 0, 8, 8}, 12345, accuracy).texels.values,
                  above.texels.values);
    }
    EXPECT_FALSE(evaluate(*texture, {3, 0, 0, 8, 8}, 0, Accuracy::high).evaluation.validity.is_static());

    // All at once: no level is static, and far up all texels still blink together
    const auto together = compile(all_kinds()[2].blocks);
    ASSERT_TRUE(together);
    const auto blinking = make_pattern_texture(*together);
    const Page far = evaluate(*blinking, {12, 0, 0, 2, 2}, 0, Accuracy::high);
    EXPECT_FALSE(far.evaluation.validity.is_static());
    EXPECT_NE(
        evaluate(*blinking, {12, 0, 0, 2, 2}, far.evaluation.validity.until, Accuracy::high).texels.values,
        far.texels.values);
    EXPECT_LT(far.evaluation.bound_codes, 0.01);
}

TEST(PageValidity, OfATimeAverageStatesABoundThatHolds) {
    // Sums of cells at a step against what the level above says of all steps
    for (const Moving& moving : all_kinds()) {
        if (moving.name.starts_with("over a ground") || moving.name == "instances") continue;
        SCOPED_TRACE(moving.name);
        const auto plan = compile(moving.blocks);
        ASSERT_TRUE(plan);
        const auto texture = make_pattern_texture(*plan);
        for (const Step step : {Step{0}, Step{17}, Step{1001}, Step{3002}, Step{5000}, Step{9999}}) {
            const Page page =
                evaluate(*texture, {.level = 6, .width = 2, .height = 2, .parameter = moving.parameter}, step,
                         Accuracy::fast);
            const Page cells =
                evaluate(*texture, {.level = 5, .width = 4, .height = 4, .parameter = moving.parameter}, step,
                         Accuracy::high);
            for (std::size_t texel = 0; texel < 4; ++texel)
                for (std::size_t c = 0; c < 4; ++c) {
                    double sum = 0;
                    for (std::size_t child = 0; child < 4; ++child)
                        sum += double{cells.texels.values[(((texel / 2) * 2 + child / 2) * 4 +
                                                           (texel % 2) * 2 + child % 2) *
                                                              4 +
                                                          c]} /
                               4;
                    EXPECT_NEAR(page.texels.values[texel * 4 + c], sum,
                                (page.evaluation.bound_codes + cells.evaluation.bound_codes) * code_in_linear)
                        << step;
                }
        }
    }
}

}  // namespace
}  // namespace tessera
