// Back to any revision, and out as a folder: edits of maps, fields, targets, the clock, animations.
#include <cstdlib>
#include <future>
#include <random>

#include <gtest/gtest.h>

#include "server/edits/live_scene.h"
#include "server/history/export.h"
#include "server/history/scene_state.h"
#include "server/history/undo.h"
#include "server/journal/open_journal.h"
#include "tests/unit/server/edits/edited_pattern.h"

namespace tessera {
namespace {

std::uint64_t fresh_seed() {
    const char* const given = std::getenv("TESSERA_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
}

class UndoOfDocuments : public testing::Test {
  protected:
    void open(const std::string& output) {
        moving_ = output == "moving";
        ground_ = files_.load(output);
        auto owned = memory_journal({});
        journal_ = owned.get();
        live_ = LiveScene::open(ground_, std::move(owned), progress_).value();
        states_ = {state_of(*live_)};
        scenes_ = {live_->now()};
    }
    void edit(proto::Edit edit) {
        edit.set_id(to_string(random_edit_id()));
        std::promise<EditOutcome> promise;
        live_->edit(std::move(edit), [&](EditOutcome how) { promise.set_value(std::move(how)); });
        const EditOutcome outcome = promise.get_future().get();
        if (const auto* refusal = std::get_if<EditRefusal>(&outcome)) {
            ADD_FAILURE() << refusal->detail;
            return;
        }
        states_.push_back(state_of(*live_));
        scenes_.push_back(live_->now());
    }
    std::uint64_t below(std::uint64_t count) {
        return std::uniform_int_distribution<std::uint64_t>{0, count - 1}(engine_);
    }
    proto::Edit random_edit() {
        proto::Edit edit;
        proto::Change& change = *edit.add_changes();
        switch (below(6)) {
            case 0:
            case 1: {
                // Those that the output shows
                const std::string block = !moving_ ? below(2) == 0 ? "mask" : "kinds" : "areas";
                const std::uint64_t side = block == "mask" ? 64 : block == "kinds" ? 32 : 16;
                proto::MapPaint& paint = *change.mutable_paint_map();
                paint.set_block(block);
                paint.set_x(static_cast<std::int64_t>(below(side - 8)));
                paint.set_y(static_cast<std::int64_t>(below(side - 8)));
                paint.set_width(static_cast<std::uint32_t>(1 + below(8)));
                paint.set_height(static_cast<std::uint32_t>(1 + below(8)));
                paint.set_value(static_cast<std::int32_t>(below(2)));
                break;
            }
            case 2: {
                proto::ParameterChange& set = *change.mutable_set_parameter();
                set.set_block("which");
                set.set_field("count");
                set.mutable_value()->set_integer(2 + static_cast<std::int64_t>(below(60)));
                break;
            }
            case 3: {
                proto::Target& target = *change.mutable_set_target();
                target.set_id(1 + below(3));
                target.set_x(static_cast<std::int64_t>(below(500)));
                target.set_y(static_cast<std::int64_t>(below(500)));
                break;
            }
            case 4:
                change.mutable_set_clock()->set_steps_per_second(1 + static_cast<double>(below(20)));
                break;
            default: {
                proto::SpritePlacement& sprite = *change.mutable_place_sprite();
                sprite.set_id(++sprites_);
                sprite.set_x(static_cast<double>(below(500)));
                sprite.set_y(static_cast<double>(below(500)));
            }
        }
        return edit;
    }
    void expect_pages_of(const Scene& scene, const Scene& then) {
        for (const PageKey key : {PageKey{0, 0, 0}, {0, 1, 1}, {1, 0, 0}, {3, 0, 0}, {6, 0, 0}})
            for (const std::int64_t step : {0, 17})
                EXPECT_EQ(page_bytes(scene, key, Accuracy::high, 0, step),
                          page_bytes(then, key, Accuracy::high, 0, step))
                    << "level " << int{key.level} << ", step " << step;
    }

    const std::uint64_t seed_ = fresh_seed();
    std::mt19937_64 engine_{seed_};
    EditedPattern files_;
    SilentProgress progress_;
    ScenePtr ground_;
    Journal* journal_ = nullptr;
    std::unique_ptr<LiveScene> live_;
    std::vector<SceneState> states_;
    std::vector<ScenePtr> scenes_;
    std::uint64_t sprites_ = 0;
    bool moving_ = false;
};

TEST_F(UndoOfDocuments, BringsPagesBackAndIsExportedWithThem) {
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed_));
    for (const char* output : {"all", "moving"}) {
        open(output);
        for (int round = 0; round < 2; ++round) {
            for (int i = 0; i < 10; ++i) edit(random_edit());
            const Revision back = below(scenes_.size());
            const auto undo = plan_undo(ground_, *journal_, back, progress_);
            ASSERT_TRUE(undo) << undo.error().detail;
            for (const proto::Edit& each : undo->edits) edit(each);
            EXPECT_TRUE(alike(states_.back(), states_[back]));
            expect_pages_of(*live_->now(), *scenes_[back]);
            if (HasFailure()) return;
        }
        for (const Revision at : {Revision{scenes_.size() / 2}, Revision{scenes_.size() - 1}}) {
            const auto out = files_.folder().parent_path() / (std::string{output} + std::to_string(at));
            const auto exported = export_scene(files_.folder(), *journal_, at, out, progress_);
            ASSERT_TRUE(exported) << exported.error().detail;
            expect_pages_of(*load_scene(out).value(), *scenes_[at]);
        }
    }
}

TEST_F(UndoOfDocuments, ChangesAnAnimationBackByATransition) {
    open("moving");
    proto::Edit change;
    change.add_changes()->mutable_change_animation()->set_block("blink");
    change.mutable_changes(0)->mutable_change_animation()->set_step(100);
    change.mutable_changes(0)->mutable_change_animation()->mutable_rest()->set_integer(3);
    edit(change);
    const auto undo = plan_undo(ground_, *journal_, 0, progress_);
    ASSERT_TRUE(undo) << undo.error().detail;
    ASSERT_EQ(undo->edits.size(), 1u);
    edit(undo->edits[0]);
    EXPECT_TRUE(alike(states_.back(), states_[0]));
    // When it is over, every cell shows what it would have shown
    for (const std::int64_t step : {100'000, 100'007})
        EXPECT_EQ(page_bytes(*live_->now(), {0, 0, 0}, Accuracy::high, 0, step),
                  page_bytes(*scenes_[0], {0, 0, 0}, Accuracy::high, 0, step));
}

}  // namespace
}  // namespace tessera
