// Animation maps that change: what is refused, when changes take effect, and how often cells show what.
#include <cmath>

#include <gmock/gmock.h>

#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

using testing::HasSubstr;

const std::string ground = R"(
  {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 8, "count": 8}},
  {"name": "grid", "virtual_tile_map": {"cell_texels": 8}},
  {"name": "frames", "animation_sequence": {"frames": [{"pattern": 0}, {"pattern": 1, "steps": 2}, {"pattern": 2}, {"pattern": -1}]}},
  {"name": "phase", "virtual_indirection_map": {"grid": "grid", "count": 60}},
  {"name": "rest", "virtual_random_map": {"grid": "grid", "from": 0, "to": 40}},
  {"name": "map", "explicit_indirection_map": {"grid": "grid", "width": 3, "values": [5, -1, 25]}},)";
const std::string shown =
    R"(, {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "x"}}})";

Result<Plan> animated(const std::string& fields) {
    return plan_of(ground + R"({"name": "x", "animation_map": {"sequence": "frames", )" + fields + "}}" +
                   shown);
}

std::string refusal_of(const std::string& fields) {
    const auto plan = animated(fields);
    EXPECT_FALSE(plan) << fields;
    return plan ? "" : plan.error().detail;
}

TEST(AnimationChanges, AreCheckedByTheirField) {
    EXPECT_THAT(refusal_of(R"("density": -1)"),
                HasSubstr(".density: is -1; a number from 0 to 32767, or Infinity"));
    EXPECT_THAT(refusal_of(R"("density": "NaN")"), HasSubstr(".density: is nan"));
    EXPECT_THAT(refusal_of(R"("rest": {"integer": -1})"), HasSubstr(".rest: is -1; from 0 on"));
    EXPECT_THAT(refusal_of(R"("changes": [{"step": 10}, {"step": 9}])"),
                HasSubstr(".changes[1].step: is 9, before the change above it; sort them"));
    EXPECT_THAT(refusal_of(R"("changes": [{"step": "4611686018427387905"}])"),
                HasSubstr(".changes[0].step: is 4611686018427387905; from -2^62 to 2^62"));
    EXPECT_THAT(refusal_of(R"("changes": [{"rest": {"block": "nobody"}}])"), HasSubstr(".changes[0].rest"));
    std::string many = R"("changes": [{"step": 0})";
    for (int i = 1; i < 65; ++i) many += R"(, {"step": )" + std::to_string(i * 100) + "}";
    EXPECT_THAT(refusal_of(many + "]"), HasSubstr(".changes: lists 65; at most 64"));
    const auto blinking_rest = plan_of(
        ground +
        R"({"name": "y", "animation_map": {"sequence": "frames"}}, {"name": "z", "probability_map": {"index": {"block": "y"},
        "material": {"entries": [{"pattern": 1}, {"pattern": 2}, {"pattern": 3}]}}},
        {"name": "x", "animation_map": {"sequence": "frames", "rest": {"block": "z"}}})" +
        shown);
    ASSERT_FALSE(blinking_rest);
}

TEST(AnimationChanges, ThatComeTooSoonSayWhenTheyTakeEffect) {
    // n is 5: 8 steps apart
    const auto plan = animated(
        R"("rest": {"integer": 3}, "changes": [{"step": 100, "density": 2}, {"step": 105, "density": 3}, {"step": 107, "density": 4}])");
    ASSERT_TRUE(plan) << plan.error().detail;
    for (const PlanLine& line : plan->lines)
        if (line.name == "x") {
            EXPECT_THAT(line.note, HasSubstr("change 1 waits until step 108"));
            EXPECT_THAT(line.note, HasSubstr("change 2 waits until step 108"));
        }
}

TEST(Animation, IsDrawnCellByCell) {
    const auto typed = plan_of(
        ground +
        R"({"name": "t-phase", "virtual_indirection_map": {"grid": "grid", "count": 60, "generator": "typed"}},
        {"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "t-phase"}}})" +
        shown);
    ASSERT_FALSE(typed);
    EXPECT_THAT(typed.error().detail, HasSubstr("is typed, but the looks of \"t\" move with \"x\""));
    const auto free = animated(R"("phase": {"block": "phase"})");
    ASSERT_TRUE(free);
    EXPECT_TRUE(reference_of(*free).program->moves());
    EXPECT_FALSE(reference_of(*free).program->needs_types());
    EXPECT_EQ(reference_of(*free).program->basis(), CellProgram::Basis::stationary);
}

TEST(Animation, OfABlankRestNeverRuns) {
    const auto plan = animated(R"("phase": {"block": "phase"}, "rest": {"block": "map"})");
    ASSERT_TRUE(plan) << plan.error().detail;
    const CellProgram& program = *reference_of(*plan).program;
    EXPECT_EQ(program.basis(), CellProgram::Basis::varying);
    std::array<std::int32_t, 3> row{};
    for (Step step = 0; step < 200; ++step) {
        program.patterns({.count = 3, .step = step}, row.data());
        ASSERT_EQ(row[1], 0);
    }
    Validity validity;
    program.patterns({.x = 1, .count = 1, .step = 70, .validity = &validity}, row.data());
    EXPECT_TRUE(validity.is_static());
}

std::map<std::int32_t, double> table(const std::vector<LookShare>& shares) {
    std::map<std::int32_t, double> sums;
    for (const LookShare& share : shares) sums[share.pattern] += share.share;
    return sums;
}

TEST(AnimationShares, AreThoseOfTimeWherePhasesAreEven) {
    // Rest 7: a cycle of 12, five times in 60 phases
    const auto plan = animated(R"("phase": {"block": "phase"}, "rest": {"integer": 7})");
    ASSERT_TRUE(plan);
    const CellProgram& program = *reference_of(*plan).program;
    const Epoch epoch = program.epoch(1'000'000, 0, 0);
    EXPECT_TRUE(epoch.average);
    EXPECT_EQ(epoch.uneven, 0);
    EXPECT_TRUE(epoch.validity.is_static());
    const auto shares = table(program.shares_in(epoch, {}));
    EXPECT_NEAR(shares.at(0), 8.0 / 12, 1e-12);
    EXPECT_NEAR(shares.at(1), 2.0 / 12, 1e-12);
    EXPECT_NEAR(shares.at(2), 1.0 / 12, 1e-12);
    EXPECT_NEAR(shares.at(-1), 1.0 / 12, 1e-12);
}

TEST(AnimationShares, AreThoseOfAStepWhereTheyAreNot) {
    const auto plan = animated(R"("phase": {"block": "phase"}, "rest": {"block": "rest"})");
    ASSERT_TRUE(plan);
    const CellProgram& program = *reference_of(*plan).program;
    EXPECT_TRUE(program.epoch(5, 0, 1).average);
    for (const Step step : {Step{5}, Step{77}, Step{-12}}) {
        const Epoch epoch = program.epoch(step, 0, 0);
        ASSERT_FALSE(epoch.average);
        ASSERT_TRUE(epoch.validity.holds(step));
        const auto shares = table(program.shares_in(epoch, {}));
        std::map<std::int32_t, double> counted;
        std::vector<std::int32_t> row(1024);
        for (std::int64_t y = 0; y < 64; ++y) {
            program.patterns({.y = y, .count = 1024, .step = step}, row.data());
            for (const std::int32_t pattern : row) counted[pattern] += 1.0 / (1024 * 64);
        }
        for (const auto& [pattern, share] : shares)
            EXPECT_NEAR(counted[pattern], share, 5 * std::sqrt(share * (1 - share) / (1024 * 64))) << pattern;
    }
}

TEST(AnimationShares, OfAnEpochAreThoseOfItsSetting) {
    const auto plan = animated(
        R"("phase": {"block": "phase"}, "rest": {"integer": 7}, "changes": [{"step": 100, "rest": {"integer": 25}}, {"step": 200, "density": "Infinity"}])");
    ASSERT_TRUE(plan) << plan.error().detail;
    const CellProgram& program = *reference_of(*plan).program;
    EXPECT_EQ(program.epoch(50, 0, 0.01).validity, (Validity{always, 101}));
    const Epoch passing = program.epoch(103, 0, 0.01);
    EXPECT_FALSE(passing.average) << "while cells go from one setting to the next";
    EXPECT_EQ(program.epoch(108, 0, 0.01).validity, (Validity{108, 201}));
    const Epoch at_rest = program.epoch(5000, 0, 0.01);
    EXPECT_EQ(at_rest.validity, (Validity{208, never}));
    const auto shares = table(program.shares_in(at_rest, {}));
    EXPECT_NEAR(shares.at(0), 1, 1e-12);
    // Of all settings together every look is listed
    EXPECT_EQ(table(program.shares({})).size(), 4u);
}

}  // namespace
}  // namespace tessera
