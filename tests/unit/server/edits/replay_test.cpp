// What a scene is after a restart, and while its files change.
#include <atomic>
#include <future>
#include <thread>

#include <gtest/gtest.h>

#include "server/edits/live_scene.h"
#include "server/journal/journal_wait.h"
#include "server/journal/open_journal.h"
#include "tests/support/passing_journal.h"
#include "tests/unit/server/edits/edited_pattern.h"
#include "tests/unit/server/edits/made_scene.h"

namespace tessera {
namespace {

class Replays : public testing::Test {
  protected:
    std::unique_ptr<LiveScene> open() const {
        SilentProgress progress;
        return LiveScene::open(scene_, std::make_unique<tests::PassingJournal>(journal_), progress).value();
    }
    static bool edit(LiveScene& live, proto::Edit edit) {
        std::promise<bool> done;
        live.edit(std::move(edit), [&](const EditOutcome& how) {
            done.set_value(std::holds_alternative<proto::EditAnswer>(how));
        });
        return done.get_future().get();
    }
    static proto::Edit counting(std::int64_t count) {
        proto::Edit edit = new_edit();
        proto::ParameterChange& change = *edit.add_changes()->mutable_set_parameter();
        change.set_block("which");
        change.set_field("count");
        change.mutable_value()->set_integer(count);
        return edit;
    }
    static proto::Edit painting(int i) {
        proto::Edit edit = new_edit();
        proto::MapPaint& paint = *edit.add_changes()->mutable_paint_map();
        paint.set_block(i % 2 == 0 ? "kinds" : "mask");
        paint.set_x(i * 7 % 30);
        paint.set_y(i * 5 % 30);
        paint.set_width(2);
        paint.set_height(1);
        paint.set_value(i / 2 % 2);
        return edit;
    }
    static proto::Edit changing(std::int64_t step) {
        proto::Edit edit = new_edit();
        proto::AnimationChange& change = *edit.add_changes()->mutable_change_animation();
        change.set_block("blink");
        change.set_step(step);
        change.set_density(static_cast<double>(step % 3));
        return edit;
    }
    static void expect_same(const LiveScene& one, const LiveScene& other) {
        proto::LiveState a = one.state(), b = other.state();
        a.clear_clock();  // Goes on between the two
        b.clear_clock();
        EXPECT_EQ(a.SerializeAsString(), b.SerializeAsString());
        for (const PageKey key : {PageKey{0, 0, 0}, PageKey{0, 16, 16}, PageKey{3, 2, 2}, PageKey{6, 0, 0}})
            EXPECT_EQ(page_bytes(*one.now(), key, Accuracy::fast, 0, 300),
                      page_bytes(*other.now(), key, Accuracy::fast, 0, 300))
                << int{key.level};
    }

    EditedPattern files_;
    ScenePtr scene_ = files_.load();
    std::shared_ptr<Journal> journal_ = memory_journal({});
};

TEST_F(Replays, MakeWhatWasLivedThrough) {
    const auto live = open();
    for (int i = 0; i < 90; ++i) {
        // A slider that is dragged, paint between, and transitions
        ASSERT_TRUE(edit(*live, counting(1 + i % 40)));
        if (i % 4 == 0) {
            ASSERT_TRUE(edit(*live, painting(i)));
        }
        if (i % 9 == 0) {
            ASSERT_TRUE(edit(*live, changing(100 * i)));
        }
        EXPECT_FALSE(edit(*live, counting(0)));
    }
    expect_same(*live, *open());
}

TEST_F(Replays, LeaveOutWhatCannotBeShown) {
    std::vector<Append> batch;
    const auto append = [&](proto::Edit edit) {
        batch.push_back(
            {.id = *edit_id_from(edit.id()), .bytes = canonical_edit(edit).value(), .expected = {}});
    };
    append(counting(5));
    append(counting(0));  // As after a failure of the disk, or of an older program
    append(painting(2));
    append(painting(5));
    append_and_wait(*journal_, batch);
    const auto replayed = open();
    EXPECT_EQ(replayed->now()->revision, 4u);

    const auto other_journal = std::exchange(journal_, memory_journal({}));
    const auto live = open();
    for (const std::size_t i : {0u, 2u, 3u}) {
        proto::Edit again;
        ASSERT_TRUE(again.ParseFromString(batch[i].bytes));
        again.set_id(to_string(batch[i].id));
        ASSERT_TRUE(edit(*live, again));
    }
    proto::LiveState a = live->state(), b = replayed->state();
    EXPECT_EQ(a.scene().SerializeAsString(), b.scene().SerializeAsString());
}

TEST_F(Replays, KeepEditsThatCameWhileTheFilesChanged) {
    const auto live = open();
    std::atomic<int> refused = 0;
    std::vector<std::jthread> editors;
    for (int editor = 0; editor < 3; ++editor)
        editors.emplace_back([&, editor] {
            for (int i = 0; i < 30; ++i) {
                const bool is_in = editor == 0 ? edit(*live, painting(i))
                                   : editor == 1
                                       ? edit(*live, counting(1 + i))
                                       : edit(*live, placing(static_cast<std::uint64_t>(i + 1), 9.0 * i, 40));
                refused += is_in ? 0 : 1;
            }
        });
    // The same files, read anew
    for (int i = 0; i < 12; ++i) live->rebase(files_.load());
    editors.clear();
    live->rebase(scene_ = files_.load());
    EXPECT_EQ(refused, 0);
    EXPECT_EQ(live->now()->revision, 90u);
    expect_same(*live, *open());
}

}  // namespace
}  // namespace tessera
