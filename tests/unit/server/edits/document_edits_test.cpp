// What each kind of edit means, and what is refused.
#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "server/edits/apply_edit.h"
#include "shared/motion/transitions.h"
#include "tests/unit/server/edits/edited_pattern.h"
#include "tests/unit/server/edits/made_scene.h"

namespace tessera {
namespace {

class DocumentEdits : public testing::Test {
  protected:
    DocumentEdits() : document_{LiveDocument::of(*scene_, {})} {}

    Result<DocumentEdit> apply(const proto::Edit& edit, Step step = 0) {
        return apply_to_document(edit, {{}, step}, document_);
    }
    std::string refusal(const proto::Edit& edit) {
        const LiveDocument before = document_;
        const auto made = apply(edit);
        if (made) return "accepted";
        EXPECT_EQ(before.message, document_.message);
        EXPECT_EQ(before.painted.size(), document_.painted.size());
        return made.error().detail;
    }
    static proto::MapPaint& paint(proto::Edit& edit, const char* block, std::int64_t x, std::int64_t y,
                                  std::uint32_t width, std::uint32_t height, std::int32_t value) {
        proto::MapPaint& paint = *edit.add_changes()->mutable_paint_map();
        paint.set_block(block);
        paint.set_x(x);
        paint.set_y(y);
        paint.set_width(width);
        paint.set_height(height);
        paint.set_value(value);
        return paint;
    }
    static proto::ParameterChange& set(proto::Edit& edit, const char* block, const char* field,
                                       std::int64_t value) {
        proto::ParameterChange& change = *edit.add_changes()->mutable_set_parameter();
        change.set_block(block);
        change.set_field(field);
        change.mutable_value()->set_integer(value);
        return change;
    }
    proto::Edit undo(const DocumentEdit& made) {
        proto::Edit edit;
        for (const proto::Change& change : made.inverses) *edit.add_changes() = change;
        return edit;
    }
    std::vector<std::int32_t> entries(const char* block) {
        const auto& values = document_.painted.at(block).values;
        std::vector<std::int32_t> all(values.size());
        values.copy(0, all.size(), all.data());
        return all;
    }

    EditedPattern files_;
    ScenePtr scene_ = files_.load();
    LiveDocument document_;
};

TEST_F(DocumentEdits, PaintWritesTheBrushedEntriesOfTheRectangleAndIsUndone) {
    proto::Edit first;
    paint(first, "kinds", 0, 0, 32, 32, 0);
    ASSERT_TRUE(apply(first));
    proto::Edit edit;
    paint(edit, "kinds", 3, 2, 3, 2, 2).set_mask(std::string(1, '\x2d'));  // 1 0 1 / 1 0 1
    const auto made = apply(edit);
    ASSERT_TRUE(made) << made.error().detail;
    std::vector<std::int32_t> expected(1024, 0);
    for (const std::size_t i : {2 * 32 + 3, 2 * 32 + 5, 3 * 32 + 3, 3 * 32 + 5}) expected[i] = 2;
    EXPECT_EQ(entries("kinds"), expected);
    ASSERT_EQ(made->dirty.size(), 1u);
    // 4 cells of 8 texels an entry; leaves hang over by a cell
    EXPECT_EQ(made->dirty[0], (TexelBox{4096 + 3 * 32, 4096 + 2 * 32, 4096 + 6 * 32 + 8, 4096 + 4 * 32 + 8}));
    ASSERT_TRUE(apply(undo(*made)));
    EXPECT_EQ(entries("kinds"), std::vector<std::int32_t>(1024, 0));
}

TEST_F(DocumentEdits, ValuesAreTwoBytesEach) {
    proto::Edit edit;
    paint(edit, "kinds", 30, 31, 2, 1, 0).set_values(std::string{"\2\0\1\0", 4});
    const auto made = apply(edit);
    ASSERT_TRUE(made) << made.error().detail;
    EXPECT_EQ(entries("kinds")[31 * 32 + 30], 2);
    EXPECT_EQ(entries("kinds")[31 * 32 + 31], 1);
}

TEST_F(DocumentEdits, PaintOutsideOfTheMapOrOfItsValuesIsRefused) {
    const auto told = [&](std::int64_t x, std::int64_t y, std::uint32_t width, std::uint32_t height,
                          std::int32_t value, const char* block = "kinds") {
        proto::Edit edit;
        paint(edit, block, x, y, width, height, value);
        return refusal(edit);
    };
    EXPECT_NE(told(30, 0, 3, 1, 0).find("not inside the map, which has 32 × 32"), std::string::npos);
    EXPECT_NE(told(-1, 0, 1, 1, 0).find("not inside"), std::string::npos);
    EXPECT_NE(told(std::numeric_limits<std::int64_t>::max(), 0, 1, 1, 0).find("not inside"),
              std::string::npos);
    EXPECT_NE(told(0, 0, 0, 1, 0).find("at least 1"), std::string::npos);
    EXPECT_NE(told(0, 0, 65537, 1, 0).find("at most 65536"), std::string::npos);
    EXPECT_NE(told(0, 0, 0xffffffffu, 0xffffffffu, 0).find("at most 65536"), std::string::npos);
    EXPECT_NE(told(0, 0, 1, 1, 3).find("from 0 to 2"), std::string::npos);
    EXPECT_NE(told(0, 0, 1, 1, -1).find("from 0 to 2"), std::string::npos);
    EXPECT_NE(told(0, 0, 1, 1, 2, "mask").find("from 0 to 1"), std::string::npos);
    EXPECT_NE(told(0, 0, 1, 1, 2, "areas").find("from 0 to 1"), std::string::npos);
    EXPECT_NE(told(0, 0, 1, 1, 0, "nothing").find("is no map that the scene file lists"), std::string::npos);
    EXPECT_NE(told(0, 0, 1, 1, 0, "which").find("there are: "), std::string::npos);
}

TEST_F(DocumentEdits, AnIndexBeyondWhatAProbabilityMapListsIsRefused) {
    // Nothing bounds such a map but the plan that follows the paint
    std::string json = EditedPattern::json("picks", false);
    json.replace(json.find(R"({"name": "moving")"), 0,
                 R"({"name": "entry", "editable": ["map"], "areas_map": {"grid": "cells", "edge": "clamp",
                     "width": 2, "values": [0, 1, 2, 0]}},
                    {"name": "listed", "probability_map": {"index": {"block": "entry"}, "material":
                     {"entries": [{"pattern": 3}, {"pattern": 0}, {"pattern": 1}]}}},
                    {"name": "picks", "reference_texture": {"patterns": "leaves", "grid": "cells",
                     "index": {"block": "listed"}}}, )");
    std::ofstream{files_.folder() / "scene.json"} << json;
    document_ = LiveDocument::of(*load_scene(files_.folder()).value(), {});
    for (const std::int32_t value : {3, 70000, -1}) {
        proto::Edit edit;
        paint(edit, "entry", 1, 1, 1, 1, value);
        EXPECT_NE(refusal(edit).find("give integers from 0 to 2"), std::string::npos) << value;
    }
    proto::Edit edit;
    paint(edit, "entry", 1, 1, 1, 1, 2);
    EXPECT_TRUE(apply(edit));
    EXPECT_EQ(entries("entry"), (std::vector<std::int32_t>{0, 1, 2, 2}));
}

TEST_F(DocumentEdits, MasksAndValuesOfAnotherLengthAreRefused) {
    proto::Edit edit;
    paint(edit, "kinds", 0, 0, 3, 3, 1).set_mask("x");
    EXPECT_NE(refusal(edit).find("a bit for each of 9 entries are 2"), std::string::npos);
    edit.Clear();
    paint(edit, "kinds", 0, 0, 3, 3, 1).set_values(std::string(17, '\0'));
    EXPECT_NE(refusal(edit).find("two for each of 9"), std::string::npos);
    edit.Clear();
    paint(edit, "kinds", 0, 0, 3, 3, 1).clear_value();
    EXPECT_NE(refusal(edit).find("give value or values"), std::string::npos);
}

TEST_F(DocumentEdits, AllChangesAreMadeOrNone) {
    proto::Edit edit;
    paint(edit, "kinds", 0, 0, 4, 4, 1);
    paint(edit, "kinds", 0, 0, 4, 4, 9);
    EXPECT_NE(refusal(edit).find("changes[1].paint_map.value"), std::string::npos);
}

TEST_F(DocumentEdits, ParametersAreCompiledBeforeTheyAreTakenAndUndone) {
    proto::Edit edit;
    set(edit, "which", "count", 16);
    const auto made = apply(edit);
    ASSERT_TRUE(made) << made.error().detail;
    EXPECT_EQ(made->dirty, std::vector<TexelBox>{every_texel});
    const auto count = [&] {
        return find_block(*std::make_unique<proto::Scene>(*document_.message), "which")
            ->virtual_indirection_map()
            .count();
    };
    EXPECT_EQ(count(), 16u);
    ASSERT_TRUE(apply(undo(*made)));
    EXPECT_EQ(count(), 64u);

    edit.Clear();
    set(edit, "mixture", "materials[1].entries[0].pattern", 3);
    EXPECT_TRUE(apply(edit));
}

TEST_F(DocumentEdits, ParametersThatAreNotEditableOrDoNotFitAreRefused) {
    const auto told = [&](const char* block, const char* field, std::int64_t value) {
        proto::Edit edit;
        set(edit, block, field, value);
        return refusal(edit);
    };
    EXPECT_NE(told("which", "generator", 1).find("not listed as editable"), std::string::npos);
    EXPECT_NE(told("borders", "families", 3).find("not listed as editable"), std::string::npos);
    EXPECT_NE(told("gone", "count", 3).find("there is no block"), std::string::npos);
    EXPECT_NE(told("", "seed", 3).find("not editable"), std::string::npos);
    EXPECT_NE(told("which", "count", -3).find("cannot be -3"), std::string::npos);
    EXPECT_NE(told("which", "count", 70000).find("1 to 65536"), std::string::npos);
    EXPECT_NE(told("mixture", "materials[3].entries[0].pattern", 1).find("has 3 entries"), std::string::npos);
    EXPECT_NE(told("mixture", "materials.entries", 1).find("is a list"), std::string::npos);
    EXPECT_NE(told("mixture", "materials[1]", 1).find("name a field in it"), std::string::npos);
    EXPECT_NE(told("mixture", "materials[1].entries[0].pattern", 77).find("patterns 0 to 3"),
              std::string::npos);
    EXPECT_NE(told("mixture", "materials[x].entries[0].pattern", 1).find("no field"), std::string::npos);
    proto::Edit edit;
    set(edit, "which", "count", 1).mutable_value()->set_number(std::numeric_limits<double>::quiet_NaN());
    EXPECT_NE(refusal(edit).find("is no number"), std::string::npos);
}

TEST_F(DocumentEdits, WhatIsPaintedIsPartOfTheWholeMessage) {
    proto::Edit edit;
    paint(edit, "mask", 0, 0, 2, 2, 1);
    ASSERT_TRUE(apply(edit));
    EXPECT_EQ(document_.whole_message().pattern().blocks_size(), document_.message->pattern().blocks_size());
    proto::Scene whole = document_.whole_message();
    EXPECT_EQ(find_block(whole, "mask")->pixel_map().values(1), 1);
}

TEST_F(DocumentEdits, AChangeOfAnAnimationTellsWhenItTakesEffectAndTheLatestWins) {
    proto::Edit edit;
    proto::AnimationChange& change = *edit.add_changes()->mutable_change_animation();
    change.set_block("blink");
    change.mutable_rest()->set_integer(100);
    const auto first = apply(edit, 50);
    ASSERT_TRUE(first) << first.error().detail;
    ASSERT_EQ(first->effects.size(), 1u);
    EXPECT_EQ(first->effects[0].step(), 50);
    // A run of four steps: six between changes
    change.mutable_rest()->set_integer(7);
    EXPECT_EQ(apply(edit, 52).value().effects[0].step(), 56);
    change.mutable_rest()->set_integer(9);
    const auto third = apply(edit, 53);
    ASSERT_TRUE(third);
    EXPECT_EQ(third->effects[0].step(), 56);
    auto message = *document_.message;
    const auto& map = find_block(message, "blink")->animation_map();
    ASSERT_EQ(map.changes_size(), 2);
    EXPECT_EQ(map.changes(1).rest().integer(), 9);
    // What was before: the change that was still waiting
    EXPECT_EQ(third->inverses[0].change_animation().rest().integer(), 7);
    EXPECT_FALSE(third->inverses[0].change_animation().has_step());
}

TEST_F(DocumentEdits, ManyChangesOfAnAnimationAreFoldedWhenTheyAreOver) {
    document_ = LiveDocument::of(*files_.load("moving"), {});
    proto::Edit edit;
    proto::AnimationChange& change = *edit.add_changes()->mutable_change_animation();
    change.set_block("blink");
    for (int i = 0; i < 200; ++i) {
        change.set_density(1 + i % 7);
        const auto made = apply(edit, 100 * i);
        ASSERT_TRUE(made) << made.error().detail;
        EXPECT_EQ(made->effects[0].step(), 100 * i);
    }
    auto message = *document_.message;
    EXPECT_EQ(find_block(message, "blink")->animation_map().changes_size(), 64);
    change.set_density(std::numeric_limits<double>::quiet_NaN());
    EXPECT_NE(refusal(edit).find("density: is no number"), std::string::npos);
    change.set_density(-1);
    change.set_step(30'000);
    EXPECT_NE(refusal(edit).find("from 0 to 32767"), std::string::npos);
    change.set_block("open");
    EXPECT_NE(refusal(edit).find("is no animation map"), std::string::npos);
}

std::uint64_t density_of(double density) { return static_cast<std::uint64_t>(density * 65536); }

/// What cells of some phases show at a step, by what the message says now.
std::vector<std::int32_t> frames_of(const proto::AnimationMap& map, const TimeLine& line, Step step) {
    ChangeTimes times{line};
    std::int64_t rest = map.rest().integer();
    double density = map.has_density() ? map.density() : 1;
    std::vector<Cycle> cycles{{0, rest_of(rest, density_of(density))}};
    for (const auto& change : map.changes()) {
        if (change.has_rest()) rest = change.rest().integer();
        if (change.has_density()) density = change.density();
        if (times.add(change.step()).replaces) cycles.pop_back();
        cycles.push_back({0, rest_of(rest, density_of(density))});
    }
    std::vector<std::int32_t> frames;
    for (std::int64_t phase = 0; phase < 40; ++phase) {
        for (Cycle& each : cycles) each.phase = phase;
        frames.push_back(frame_at(line, cycles, times.steps(), step));
    }
    return frames;
}

TEST_F(DocumentEdits, NoCellJumpsWhileASliderIsMovedForAsLongAsOneLikes) {
    const TimeLine line{std::array<std::uint32_t, 3>{1, 1, 2}};  // "frames"
    for (std::int64_t every = 1; every <= 9; ++every) {
        document_ = LiveDocument::of(*files_.load("moving"), {});
        const auto frames_now = [&](Step step) {
            auto message = *document_.message;
            return frames_of(find_block(message, "blink")->animation_map(), line, step);
        };
        std::vector<std::int32_t> last = frames_now(-1);
        for (Step step = 0; step < 1500; ++step) {
            const std::vector<std::int32_t> before = frames_now(step);
            if (step == 0 || step % every == 1 % every) {
                proto::Edit edit;
                proto::AnimationChange& change = *edit.add_changes()->mutable_change_animation();
                change.set_block("blink");
                change.set_density(static_cast<double>(hash(3, stream("slider"), step, every) % 5) / 4);
                const auto made = apply(edit, step);
                ASSERT_TRUE(made) << made.error().detail;
            }
            ASSERT_EQ(frames_now(step), before) << "an edit now, an edit every " << every << ", at " << step;
            for (std::size_t cell = 0; cell < last.size(); ++cell)
                ASSERT_TRUE(before[cell] == last[cell] || before[cell] == last[cell] + 1 ||
                            (last[cell] == line.frames() - 1 && before[cell] == 0))
                    << "an edit every " << every << " steps: cell " << cell << " goes from " << last[cell]
                    << " to " << before[cell] << " at " << step;
            last = before;
        }
    }
}

TEST_F(DocumentEdits, AnEditThatPlansTheSceneAgainAndAgainIsRefused) {
    proto::Edit edit;
    for (int i = 0; i <= max_plans_of_edit; ++i) {
        set(edit, "which", "count", 2 + i % 2);
        paint(edit, "kinds", 0, 0, 1, 1, 0);
    }
    EXPECT_NE(refusal(edit).find("send several edits"), std::string::npos);
    proto::Edit paint_first;
    for (int i = 0; i <= max_plans_of_edit; ++i) paint(paint_first, "kinds", 0, 0, 1, 1, 0);
    set(paint_first, "which", "count", 2);
    EXPECT_TRUE(apply(paint_first));
}

TEST_F(DocumentEdits, AnEditWhosePlansTakeTooLongIsRefusedBeforeItIsInAndNeverBehind) {
    proto::Edit edit;
    for (int i = 0; i < 3; ++i) {
        set(edit, "which", "count", 2 + i);
        paint(edit, "kinds", 0, 0, 1, 1, 0);
    }
    LiveDocument document = document_;
    const auto late = apply_to_document(edit, {}, document, Planning::in_time, 0);
    ASSERT_FALSE(late);
    EXPECT_EQ(late.error().detail.find("changes[1].paint_map.block: "), 0u) << late.error().detail;
    EXPECT_NE(late.error().detail.find("takes too long"), std::string::npos);
    EXPECT_EQ(document.message, document_.message);
    for (const Planning planning : {Planning::now, Planning::later}) {
        LiveDocument replayed = document_;
        EXPECT_TRUE(apply_to_document(edit, {}, replayed, planning, 0));
    }
}

TEST_F(DocumentEdits, TargetsAreSetMovedAndRemoved) {
    proto::Edit edit;
    proto::Target& target = *edit.add_changes()->mutable_set_target();
    target.set_id(7);
    target.set_x(100);
    const auto set_it = apply(edit);
    ASSERT_TRUE(set_it) << set_it.error().detail;
    EXPECT_EQ(set_it->inverses[0].remove_target().id(), 7u);
    ASSERT_EQ(set_it->dirty.size(), 1u);
    EXPECT_LE(set_it->dirty[0].x0, 100 - 64);
    EXPECT_GE(set_it->dirty[0].x1, 100 + 64);
    target.set_x(5000);
    const auto moved = apply(edit);
    ASSERT_TRUE(moved);
    EXPECT_EQ(moved->dirty.size(), 2u);
    EXPECT_EQ(moved->inverses[0].set_target().x(), 100);
    target.set_id(0);
    EXPECT_NE(refusal(edit), "accepted");
    proto::Edit removal;
    removal.add_changes()->mutable_remove_target()->set_id(8);
    EXPECT_NE(refusal(removal).find("there is no target 8"), std::string::npos);
    removal.mutable_changes(0)->mutable_remove_target()->set_id(7);
    EXPECT_TRUE(apply(removal));
    EXPECT_EQ(document_.message->targets_size(), 1);
}

TEST_F(DocumentEdits, TheClockIsPausedSoughtAndSetToARate) {
    proto::Edit edit;
    proto::ClockChange& change = *edit.add_changes()->mutable_set_clock();
    EXPECT_NE(refusal(edit).find("says nothing"), std::string::npos);
    change.set_playing(false);
    change.set_step(-40);
    const auto made = apply(edit, 17);
    ASSERT_TRUE(made) << made.error().detail;
    EXPECT_TRUE(made->dirty.empty());
    EXPECT_EQ(document_.clock.step, -40);
    EXPECT_FALSE(document_.clock.playing);
    EXPECT_EQ(made->inverses[0].set_clock().step(), 17);
    EXPECT_TRUE(made->inverses[0].set_clock().playing());
    for (const double rate : {0.0, -1.0, 1000.5, std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity()}) {
        change.set_steps_per_second(rate);
        EXPECT_NE(refusal(edit).find("steps_per_second"), std::string::npos) << rate;
    }
    change.clear_steps_per_second();
    change.set_step(std::numeric_limits<std::int64_t>::max());
    EXPECT_NE(refusal(edit).find("step: is "), std::string::npos);
}

TEST_F(DocumentEdits, AnEditOfSpritesAndOfMoreIsOneEdit) {
    SpriteBook book;
    const SpritePatterns patterns{4, 8};
    proto::Edit edit = placing(5, 100, 100);
    paint(edit, "kinds", 0, 0, 1, 1, 1);
    auto made = apply_edit(edit, patterns, book, {}, document_);
    ASSERT_TRUE(made) << made.error().detail;
    EXPECT_TRUE(book.find(5));
    EXPECT_EQ(made->inverse.changes_size(), 2);
    ASSERT_TRUE(apply_edit(made->inverse, patterns, book, {}, document_));
    EXPECT_FALSE(book.find(5));
    // None of it
    paint(edit, "kinds", 0, 0, 1, 1, 9);
    EXPECT_FALSE(apply_edit(edit, patterns, book, {}, document_));
    EXPECT_FALSE(book.find(5));
}

TEST_F(DocumentEdits, ASceneOfSpritesAloneRefusesTheRest) {
    document_ = LiveDocument::of(*made_scene(), {});
    proto::Edit edit;
    paint(edit, "kinds", 0, 0, 1, 1, 1);
    EXPECT_NE(refusal(edit), "accepted");
    edit.Clear();
    set(edit, "which", "count", 2);
    EXPECT_NE(refusal(edit).find("sprites only"), std::string::npos);
    edit.Clear();
    edit.add_changes()->mutable_set_clock()->set_step(1);
    EXPECT_NE(refusal(edit).find("sprites only"), std::string::npos);
}

}  // namespace
}  // namespace tessera
