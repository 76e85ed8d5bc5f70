// Animations that targets or requests drive, as pages show them.
#include <cmath>

#include <gmock/gmock.h>

#include "server/pattern/targeted_texture.h"
#include "tests/support/random_pattern_files.h"
#include "tests/unit/server/blocks/pattern_text.h"

namespace tessera {
namespace {

using testing::HasSubstr;

Result<Plan> compiled(const std::string& blocks) {
    RandomPatternFiles files{8};
    return compile_plan(pattern_of(blocks), files);
}

const std::string ground = R"(
  {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 4}},
  {"name": "grid", "virtual_tile_map": {"cell_texels": 4}},
  {"name": "draw", "virtual_indirection_map": {"grid": "grid", "count": 2}},
  {"name": "frames", "animation_sequence": {"frames": [{"pattern": 0}, {"pattern": 1}, {"pattern": 2}, {"pattern": 3}]}},)";
/// Two kinds of flowers, each with four frames.
const std::string flowers = R"(,
  {"name": "kind", "materials_map": {"material": {"block": "draw"}, "index": {"block": "x"}, "materials": [
    {"entries": [{"pattern": 0}, {"pattern": 1}, {"pattern": 2}, {"pattern": 3}]},
    {"entries": [{"pattern": 4}, {"pattern": 5}, {"pattern": 6}, {"pattern": 7}]}]}},
  {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "kind"}}})";

std::string animated(const std::string& driver) {
    return ground + R"({"name": "x", "animation_map": {"sequence": "frames", )" + driver + "}}" + flowers;
}
const std::string by_targets = R"("target_distance": {"near_texels": 10, "far_texels": 60})";
const std::string by_request = R"("request_parameter": {})";

/// Walks 300 texels to the right, waits, and goes back.
MovingTarget walker() {
    return {std::array<MovingTarget::Leg, 3>{{{{100, 100}, 75}, {{400, 160}, 25}, {{400, 160}, 100}}}, 0};
}

LinearImage texels_of(const Texture& texture, TexelRegion region, Evaluation* told = nullptr,
                      Accuracy accuracy = Accuracy::high) {
    LinearImage texels;
    const auto evaluation = texture.evaluate(region, Budget{.accuracy = accuracy}, texels);
    EXPECT_TRUE(evaluation) << evaluation.error().detail;
    if (evaluation && told != nullptr) *told = *evaluation;
    return texels;
}

/// The largest difference of a level from the reduction of one below it, in codes.
double off_by(const LinearImage& coarse, const LinearImage& fine, int up) {
    const std::int32_t n = 1 << up;
    double most = 0;
    for (std::int32_t y = 0; y < coarse.height; ++y)
        for (std::int32_t x = 0; x < coarse.width * 4; ++x) {
            double sum = 0;
            for (std::int32_t i = 0; i < n; ++i)
                for (std::int32_t j = 0; j < n; ++j)
                    sum += double{fine.row(y * n + i)[(x / 4 * n + j) * 4 + x % 4]};
            most = std::max(most, std::abs(sum / (n * n) - double{coarse.row(y)[x]}) * 255);
        }
    return most;
}

TEST(Targets, OpenTheFlowersNearThem) {
    const auto plan = compiled(animated(by_targets));
    ASSERT_TRUE(plan) << plan.error().detail;
    const auto far = make_pattern_texture(*plan);
    const std::array targets{walker()};
    const auto texture = make_targeted_texture(far, *plan, targets);
    EXPECT_TRUE(moved_by_targets(*texture));
    // Below the target all four frames are there, and elsewhere only the first
    const TexelRegion here{.level = 0, .x = 60, .y = 60, .width = 80, .height = 80};
    EXPECT_NE(texels_of(*texture, here).values, texels_of(*far, here).values);
    Evaluation told;
    const TexelRegion away{.level = 0, .x = 60, .y = 400, .width = 80, .height = 80};
    EXPECT_EQ(texels_of(*texture, away, &told).values, texels_of(*far, away).values);
    EXPECT_TRUE(told.validity.is_static());
}

TEST(Targets, AreFilteredAtEveryLevel) {
    const auto plan = compiled(animated(by_targets));
    ASSERT_TRUE(plan);
    const std::array targets{walker()};
    const auto far = make_pattern_texture(*plan);
    const auto texture = make_targeted_texture(far, *plan, targets);
    for (const Accuracy accuracy : {Accuracy::fast, Accuracy::high, Accuracy::exact})
        for (const Step step : {0, 37, 80, 160}) {
            const LinearImage cells =
                texels_of(*texture, {.level = 2, .width = 256, .height = 256, .step = step});
            for (std::uint8_t level = 3; level <= 9; ++level) {
                Evaluation told;
                const std::int32_t side = 256 >> (level - 2);
                const LinearImage page = texels_of(
                    *texture, {.level = level, .width = side, .height = side, .step = step}, &told, accuracy);
                ASSERT_LE(off_by(page, cells, level - 2), told.bound_codes)
                    << int{level} << " at step " << step;
                // Where its cells are summed or few, what a target does is no part of the bound
                Evaluation rest;
                texels_of(*far, {.level = level, .width = side, .height = side}, &rest, accuracy);
                ASSERT_LT(told.bound_codes, rest.bound_codes + 0.01);
            }
        }
}

TEST(Targets, PagesKeepTheirIntervals) {
    const auto plan = compiled(animated(by_targets));
    ASSERT_TRUE(plan);
    const std::array targets{walker()};
    const auto texture = make_targeted_texture(make_pattern_texture(*plan), *plan, targets);
    int intervals = 0;
    for (const TexelRegion& place : {TexelRegion{.level = 0, .x = 380, .y = 150, .width = 24, .height = 20},
                                     TexelRegion{.level = 2, .x = 30, .y = 20, .width = 16, .height = 16},
                                     TexelRegion{.level = 4, .x = 0, .y = 0, .width = 8, .height = 8},
                                     TexelRegion{.level = 7, .x = 2, .y = 0, .width = 2, .height = 2}}) {
        Evaluation told;
        LinearImage page;
        for (Step step = 0; step < 600; ++step) {
            TexelRegion region = place;
            region.step = step;
            Evaluation now;
            const LinearImage texels = texels_of(*texture, region, &now);
            if (step > 0 && told.validity.holds(step)) {
                ASSERT_EQ(texels.values, page.values) << int{place.level} << " at " << step;
                ASSERT_EQ(now.validity, told.validity) << int{place.level} << " at " << step;
                continue;
            }
            if (step > 0) {
                ASSERT_EQ(told.validity.until, step);
                ASSERT_NE(texels.values, page.values) << int{place.level} << " at " << step;
            }
            told = now;
            page = texels;
            ++intervals;
        }
    }
    EXPECT_GT(intervals, 200);
}

TEST(Targets, OthersCostNoCompiling) {
    const auto plan = compiled(animated(by_targets));
    ASSERT_TRUE(plan);
    const auto far = make_pattern_texture(*plan);
    const std::array targets{walker()};
    const auto first = make_targeted_texture(far, *plan, targets);
    const std::array<MovingTarget, 1> moved{
        MovingTarget{std::array<MovingTarget::Leg, 1>{{{{-500, -500}, 1}}}, 0}};
    const auto second = with_targets(first, moved);
    EXPECT_FALSE(moved_by_targets(*second));
    const TexelRegion here{.level = 0, .x = 60, .y = 60, .width = 80, .height = 80};
    EXPECT_EQ(texels_of(*second, here).values, texels_of(*far, here).values);
    EXPECT_NE(texels_of(*first, here).values, texels_of(*far, here).values) << "as before";
    EXPECT_EQ(with_targets(far, moved), far) << "it looks at nothing";
    const auto boxes = texels_near(*first, moved[0]);
    ASSERT_EQ(boxes.size(), 1u);
    EXPECT_TRUE(boxes[0].meets({-560, -500, -559, -499}));
    EXPECT_FALSE(boxes[0].meets({-400, -500, -399, -499}));
}

TEST(Requests, ShowTheFrameThatTheyAskFor) {
    const auto plan = compiled(animated(by_request));
    ASSERT_TRUE(plan) << plan.error().detail;
    EXPECT_EQ(plan->parameters, (std::vector<std::int32_t>{0, 16384, 32768, 49152}));
    const auto texture = make_pattern_texture(*plan);
    for (const int level : {0, 2, 4, 8}) {
        std::vector<LinearImage> seen;
        for (const std::int32_t parameter : {0, 16383, 16384, 50000, 65535}) {
            Evaluation told;
            seen.push_back(texels_of(*texture,
                                     {.level = static_cast<std::uint8_t>(level),
                                      .width = 16,
                                      .height = 16,
                                      .parameter = parameter},
                                     &told));
            EXPECT_TRUE(told.validity.is_static());
        }
        EXPECT_EQ(seen[0].values, seen[1].values);
        EXPECT_NE(seen[1].values, seen[2].values);
        EXPECT_NE(seen[2].values, seen[3].values);
        EXPECT_EQ(seen[3].values, seen[4].values);
    }
    // Each level is the reduction of the one below, at every parameter
    for (const std::int32_t parameter : {0, 20000, 50000}) {
        const LinearImage cells =
            texels_of(*texture, {.level = 2, .width = 512, .height = 512, .parameter = parameter});
        Evaluation told;
        const LinearImage page = texels_of(
            *texture, {.level = 9, .width = 4, .height = 4, .parameter = parameter}, &told, Accuracy::fast);
        EXPECT_LE(off_by(page, cells, 7), told.bound_codes);
        EXPECT_LT(told.bound_codes, 12);
    }
}

/// Nine of sixteen cells lit, drawn out of what a map says, running to the left.
std::string running(const std::string& scroll) {
    std::string values;
    for (int i = 0; i < 32 * 16; ++i) values += (i > 0 ? ", " : "") + std::to_string(i % 7 % 2 + i / 96 % 2);
    return R"(
  {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 4}},
  {"name": "grid", "virtual_tile_map": {"cell_texels": 4}},
  {"name": "draw", "virtual_indirection_map": {"grid": "grid", "count": 4}},
  {"name": "map", "explicit_indirection_map": {"grid": "grid", "width": 32, "values": [)" +
           values + R"(]}},
  {"name": "kind", "materials_map": {"material": {"block": "map"}, "index": {"block": "draw"}, "materials": [
    {"entries": [{"pattern": 0}, {"pattern": 1}]}, {"entries": [{"pattern": 2}, {"pattern": 3}]},
    {"entries": [{"pattern": 4}]}]}},
  {"name": "t", "reference_texture": {"patterns": "set", "grid": "grid", "index": {"block": "kind"})" +
           scroll + "}}";
}

TEST(Scrolling, ShowsWhatIsFurtherRight) {
    const auto still = compiled(running(""));
    const auto plan = compiled(running(R"(, "scroll": {"cells": 8, "steps": 3})"));
    ASSERT_TRUE(plan) << plan.error().detail;
    ASSERT_TRUE(still);
    const auto texture = make_pattern_texture(*plan), stands = make_pattern_texture(*still);
    for (const Step step : {0, 2, 3, 31, -1}) {
        const std::int64_t cells = 8 * (step < 0 ? -1 : step / 3) + (step < 0 ? std::int64_t{1} << 36 : 0);
        Evaluation told;
        const LinearImage shown =
            texels_of(*texture, {.level = 0, .x = 8, .y = 4, .width = 64, .height = 64, .step = step}, &told);
        EXPECT_EQ(
            shown.values,
            texels_of(*stands, {.level = 0, .x = 8 + 4 * cells, .y = 4, .width = 64, .height = 64}).values)
            << step;
        EXPECT_TRUE(told.validity.holds(step));
        EXPECT_EQ(told.validity.until - told.validity.from, 3);
    }
    // Far above the cells, by expectation, the same to within what both state
    for (const Step step : {3, 33}) {
        const LinearImage fine = texels_of(*texture, {.level = 2, .width = 512, .height = 512, .step = step});
        for (const int level : {3, 6, 7, 9}) {
            Evaluation told;
            const std::int32_t side = 512 >> (level - 2);
            const LinearImage page = texels_of(
                *texture,
                {.level = static_cast<std::uint8_t>(level), .width = side, .height = side, .step = step},
                &told, Accuracy::fast);
            EXPECT_LE(off_by(page, fine, level - 2), told.bound_codes) << level;
            EXPECT_EQ(told.validity, (Validity{step, step + 3})) << level;
        }
    }
    const auto odd = compiled(running(R"(, "scroll": {"cells": 4})"));
    ASSERT_FALSE(odd);
    EXPECT_THAT(odd.error().detail, HasSubstr(".scroll.cells: is 4; a multiple of 8"));
}

TEST(DrivenAnimations, AreCheckedByTheirField) {
    const auto refusal_of = [](const std::string& fields) {
        const auto plan = compiled(animated(fields));
        EXPECT_FALSE(plan) << fields;
        return plan ? std::string{} : plan.error().detail;
    };
    EXPECT_THAT(refusal_of(by_targets + R"(, "rest": {"integer": 3})"),
                HasSubstr(".rest: is for animations"));
    EXPECT_THAT(refusal_of(by_request + R"(, "phase": {"integer": 3})"),
                HasSubstr("follows the request's parameter"));
    EXPECT_THAT(refusal_of(R"("target_distance": {"near_texels": 60, "far_texels": 60})"),
                HasSubstr("near_texels: is 60; below far_texels"));
    EXPECT_THAT(refusal_of(R"("target_distance": {"near_texels": 60, "far_texels": 300000000})"),
                HasSubstr("far_texels: is 300000000; at most 2^28"));
    EXPECT_THAT(refusal_of(by_request + R"(, "changes": [{"step": 4}])"), HasSubstr(".changes: is for"));
}

}  // namespace
}  // namespace tessera
