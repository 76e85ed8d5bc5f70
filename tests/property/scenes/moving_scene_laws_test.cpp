// The sample scenes that move, over 10,000 steps: no byte of a page changes inside the interval that it
// states, and at both its ends the frame of a cell that the page meets does, or one of its sprites. Pages of
// all levels; steps by the intervals' own ends and by leaps. What is drawn at some steps is held to digests.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include "proto/scene.pb.h"

#include "server/blocks/animation_op.h"
#include "server/blocks/plan.h"
#include "server/scene/pattern_files.h"
#include "server/scene/scene.h"
#include "server/scenes/moving_scenes.h"
#include "shared/math/hash.h"
#include "shared/wire/target_message.h"
#include "tests/property/scenes/pattern_test_scenes.h"

namespace tessera {
namespace {

constexpr Step all_steps = 10'000;

/// Where a scene is looked at: texels of level 0 where something moves.
struct Place {
    std::string_view scene;
    std::int64_t x, y;
    std::vector<int> levels;
};
const std::vector<Place>& places() {
    constexpr std::int64_t middle_20 = std::int64_t{1} << 27, middle_10 = std::int64_t{1} << 17;
    static const std::vector<Place> all{
        {"message-board", 131072, 131072, {0, 3, 4, 6, 8}},
        {"fireflies", 4096, 8192, {0, 2, 5}},
        {"windfall", middle_20, middle_20 + 160, {0, 2, 4}},
        {"flower-field", middle_10 - 400, middle_10 - 200, {0, 3, 6, 8}},
        {"road", middle_10 - 150, middle_10, {0, 2, 5}},
    };
    return all;
}

/// A scene, and what decides about its cells.
struct Moving {
    ScenePtr scene;
    proto::Scene message;
    Plan plan;
    TargetDistances targets;
};

Moving read_scene(const std::string& name) {
    const tests::WrittenScene written{{.name = name}};
    Moving moving;
    auto scene = load_scene(written.folder());
    EXPECT_TRUE(scene) << scene.error().detail;
    if (!scene) return moving;
    moving.scene = *scene;
    std::ifstream file{written.folder() / "scene.json"};
    const std::string json{std::istreambuf_iterator<char>{file}, {}};
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(json, &moving.message).ok());
    if (!moving.message.has_pattern()) return moving;
    PatternFiles files{written.folder()};
    auto plan = compile_plan(moving.message.pattern(), files);
    EXPECT_TRUE(plan) << plan.error().detail;
    if (!plan) return moving;
    moving.plan = std::move(*plan);
    const auto targets = targets_of(moving.message.targets());
    EXPECT_TRUE(targets);
    for (const TargetLaw& law : moving.plan.target_laws)
        moving.targets.laws.emplace_back(law.frames->line, law.near, law.far, *targets);
    return moving;
}

/// Read once for all tests.
const Moving& moving_scene(std::string_view name) {
    static std::map<std::string, Moving, std::less<>> read;
    const auto known = read.find(name);
    return known != read.end() ? known->second
                               : read.emplace(name, read_scene(std::string{name})).first->second;
}

TexelRegion region_of(const Place& place, int level, Step step) {
    // Composites look at blocks of 32 texels
    constexpr std::int32_t side = 32;
    const std::int64_t texel = std::int64_t{side} << level;
    return {.level = static_cast<std::uint8_t>(level),
            .x = place.x / texel * side,
            .y = place.y / texel * side,
            .width = side,
            .height = side,
            .step = step};
}

/// Whether a cell of the region shows something else at `step` than a step before.
bool cells_change(const Moving& moving, const TexelRegion& region, Step step) {
    for (const PlannedTexture& texture : moving.plan.textures) {
        const auto* cells = std::get_if<ReferencePlan>(&texture.what);
        if (cells == nullptr || !cells->program->moves()) continue;
        const std::int64_t side = std::int64_t{1} << region.level;
        const int cell_log2 = cells->grid.cell_log2;
        const std::int64_t left = (region.x * side) >> cell_log2, top = (region.y * side) >> cell_log2,
                           right = ((region.x + region.width) * side - 1) >> cell_log2,
                           bottom = ((region.y + region.height) * side - 1) >> cell_log2;
        // A cell may show nothing in all its frames: still, they are others
        const auto frame_changes = [&](std::int64_t x, std::int64_t y) {
            const std::int64_t cell = std::int64_t{1} << cell_log2;
            const MotionPoint at{x * cell + cell / 2, y * cell + cell / 2};
            return std::any_of(moving.targets.laws.begin(), moving.targets.laws.end(),
                               [&](const TargetDistance& law) {
                                   return law.frame_at(at, step) != law.frame_at(at, step - 1);
                               });
        };
        std::vector<Look> before, after;
        for (std::int64_t y = top; y <= bottom; ++y)
            for (std::int64_t x = left; x <= right; x += 4096) {
                const auto count = static_cast<std::int32_t>(std::min<std::int64_t>(4096, right - x + 1));
                before.resize(static_cast<std::size_t>(count));
                after.resize(before.size());
                CellRow row{.x = x, .y = y, .count = count, .step = step - 1, .targets = &moving.targets};
                cells->program->looks(row, before.data());
                row.step = step;
                cells->program->looks(row, after.data());
                // Where cells scroll, too: what places show, and not which cell does
                if (!std::equal(before.begin(), before.end(), after.begin(), shows_same)) return true;
                for (std::int64_t i = x; cells->program->looks_at_targets() && i < x + count; ++i)
                    if (frame_changes(i, y)) return true;
            }
    }
    return false;
}

bool sprites_change(const Moving& moving, const TexelRegion& region, Step step) {
    const std::int64_t side = std::int64_t{1} << region.level;
    const TexelBox box{region.x * side, region.y * side, (region.x + region.width) * side,
                       (region.y + region.height) * side};
    for (const Sprite& sprite : moving.scene->sprites.meeting(box)) {
        const bool was = there_at(sprite, step - 1), is = there_at(sprite, step);
        if (was != is || (is && (position_at(sprite, step - 1) != position_at(sprite, step) ||
                                 pattern_at(sprite, step - 1) != pattern_at(sprite, step))))
            return true;
    }
    return false;
}

struct Page {
    Rgba8Image codes;
    Evaluation evaluation;
};
Page page_at(const Scene& scene, TexelRegion region, Step step) {
    region.step = step;
    Page page;
    const auto evaluation = scene.texture->evaluate(region, Budget{}, page.codes);
    EXPECT_TRUE(evaluation) << evaluation.error().detail;
    if (evaluation) page.evaluation = *evaluation;
    return page;
}

TEST(MovingScenes, KeepTheirIntervalsOverTenThousandSteps) {
    ASSERT_EQ(places().size(), moving_scene_names().size()) << "each of them has its place here";
    for (const Place& place : places()) {
        const Moving& moving = moving_scene(place.scene);
        ASSERT_TRUE(moving.scene);
        EXPECT_TRUE(moving.scene->animated);
        for (const int level : place.levels) {
            SCOPED_TRACE(std::string{place.scene} + " level " + std::to_string(level));
            const TexelRegion region = region_of(place, level, 0);
            // Large regions take longer, and change at nearly every step: fewer of their intervals
            const bool large = level >= 4;
            const std::uint64_t leap = large ? 701 : 97;
            std::size_t intervals = 0;
            for (Step step = 0; step < all_steps;) {
                const Page page = page_at(*moving.scene, region, step);
                const Validity valid = page.evaluation.validity;
                ASSERT_TRUE(valid.holds(step));
                const Step first = std::max(valid.from, Step{-all_steps}),
                           last = std::min(valid.until - 1, 2 * all_steps);
                for (const Step other : {first, first + (last - first) / 3, last}) {
                    if (other == step) continue;
                    const Page again = page_at(*moving.scene, region, other);
                    ASSERT_EQ(again.codes.bytes, page.codes.bytes) << step << " and " << other;
                    ASSERT_EQ(again.evaluation.validity, valid) << step << " and " << other;
                }
                if (valid.until <= all_steps) {
                    ASSERT_TRUE(cells_change(moving, region, valid.until) ||
                                sprites_change(moving, region, valid.until))
                        << valid.until;
                }
                if (valid.from >= -all_steps) {
                    ASSERT_TRUE(cells_change(moving, region, valid.from) ||
                                sprites_change(moving, region, valid.from))
                        << valid.from;
                }
                ++intervals;
                if (valid.until >= all_steps) break;
                // Its end, and now and then a leap
                const std::uint64_t dice = hash(1, stream("leap"), step, level);
                step = valid.until + (large || dice % 4 == 0 ? static_cast<Step>(dice / 4 % leap) : 0);
            }
            EXPECT_GT(intervals, 3u) << "nothing moves here";
        }
    }
}

TEST(MovingScenes, DrawWhatTheyDidBefore) {
    std::map<std::string, std::string> golden;
    {
        std::ifstream in{MOVING_DIGESTS};
        for (std::string name, digest; in >> name >> digest;) golden[name] = digest;
    }
    std::map<std::string, std::string> seen;
    for (const Place& place : places()) {
        const Moving& moving = moving_scene(place.scene);
        ASSERT_TRUE(moving.scene);
        for (const int level : place.levels)
            for (const Step step : {0, 137, 400, 9999}) {
                const Page page = page_at(*moving.scene, region_of(place, level, 0), step);
                char digest[17];
                std::snprintf(digest, sizeof digest, "%016llx",
                              static_cast<unsigned long long>(
                                  XXH3_64bits(page.codes.bytes.data(), page.codes.bytes.size())));
                seen[std::string{place.scene} + "-" + std::to_string(level) + "-" + std::to_string(step)] =
                    digest;
            }
    }
    if (std::getenv("TESSERA_UPDATE_GOLDEN") != nullptr) {
        std::ofstream out{MOVING_DIGESTS};
        for (const auto& [name, digest] : seen) out << name << ' ' << digest << '\n';
        return;
    }
    EXPECT_EQ(seen, golden);
}

}  // namespace
}  // namespace tessera
