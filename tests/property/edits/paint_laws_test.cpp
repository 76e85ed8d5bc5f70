// What an edit of a map leaves alone keeps its bytes, at every level; what edits of all kinds made is the
// same after a replay, and undone it is what it was.
#include <future>
#include <map>
#include <random>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "server/edits/live_scene.h"
#include "server/journal/open_journal.h"
#include "server/pages/page_request.h"
#include "tests/support/passing_journal.h"
#include "tests/unit/server/edits/edited_pattern.h"
#include "tests/unit/server/edits/made_scene.h"

namespace tessera {
namespace {

std::uint64_t fresh_seed() {
    const char* const given = std::getenv("TESSERA_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
}

EditOutcome edit_and_wait(LiveScene& live, proto::Edit edit) {
    if (edit.id().empty()) edit.set_id(to_string(random_edit_id()));
    std::promise<EditOutcome> promise;
    live.edit(std::move(edit), [&](EditOutcome how) { promise.set_value(std::move(how)); });
    return promise.get_future().get();
}

class Laws : public testing::Test {
  protected:
    Laws() {
        RecordProperty("seed", std::to_string(seed_));
        open();
    }
    void use(const std::string& output) {
        scene_ = files_.load(output);
        journal_ = memory_journal({});
        open();
    }
    void open() {
        live_.reset();
        live_ = LiveScene::open(scene_, std::make_unique<tests::PassingJournal>(journal_), progress_).value();
    }
    std::int64_t below(std::int64_t bound) {
        return std::uniform_int_distribution<std::int64_t>{0, bound - 1}(random_);
    }

    proto::Edit random_paint(const std::string& block, int side, int values) {
        proto::Edit edit = new_edit();
        proto::MapPaint& paint = *edit.add_changes()->mutable_paint_map();
        const auto width = 1 + below(4), height = 1 + below(4);
        paint.set_block(block);
        paint.set_x(below(side - width + 1));
        paint.set_y(below(side - height + 1));
        paint.set_width(static_cast<std::uint32_t>(width));
        paint.set_height(static_cast<std::uint32_t>(height));
        if (below(2) == 0) {
            paint.set_value(static_cast<std::int32_t>(below(values)));
        } else {
            std::string bytes;
            for (std::int64_t i = 0; i < width * height; ++i) {
                bytes += static_cast<char>(below(values));
                bytes += '\0';
            }
            paint.set_values(bytes);
        }
        if (below(2) == 0) {
            std::string mask;
            for (std::int64_t i = 0; i < (width * height + 7) / 8; ++i) mask += static_cast<char>(below(256));
            paint.set_mask(mask);
        }
        return edit;
    }
    proto::Edit random_edit() {
        proto::Edit edit = new_edit();
        switch (below(8)) {
            case 0:
                return random_paint("kinds", 32, 3);
            case 1:
                return random_paint("areas", 16, 2);
            case 2:
                return random_paint("mask", 64, 2);
            case 3: {
                proto::ParameterChange& change = *edit.add_changes()->mutable_set_parameter();
                change.set_block(below(2) == 0 ? "which" : "mixture");
                const bool count = change.block() == "which";
                change.set_field(count ? "count" : "materials[2].entries[1].pattern");
                change.mutable_value()->set_integer(count ? 4 + below(60) : below(6));  // 4, 5: refused
                return edit;
            }
            case 4: {
                proto::AnimationChange& change = *edit.add_changes()->mutable_change_animation();
                change.set_block("blink");
                if (below(2) == 0) change.set_density(0.5 * static_cast<double>(below(8)));
                change.mutable_rest()->set_integer(below(40));
                if (below(3) == 0) change.set_step(below(1000));
                return edit;
            }
            case 5: {
                proto::Target& target = *edit.add_changes()->mutable_set_target();
                target.set_id(static_cast<std::uint64_t>(1 + below(4)));
                target.set_x(below(16384));
                target.set_y(below(16384));
                return edit;
            }
            case 6:
                if (below(2) == 0) {
                    edit.add_changes()->mutable_remove_target()->set_id(
                        static_cast<std::uint64_t>(1 + below(4)));
                } else {
                    proto::ClockChange& clock = *edit.add_changes()->mutable_set_clock();
                    clock.set_step(below(500));
                    clock.set_playing(below(2) == 0);
                }
                return edit;
            default:
                return placing(static_cast<std::uint64_t>(1 + below(20)), static_cast<double>(below(4000)),
                               static_cast<double>(below(4000)));
        }
    }

    using Pages = std::map<std::tuple<PageKey, Accuracy, int>, std::vector<std::uint8_t>>;
    /// Pages of every level, many near what is painted; of those with a gutter, as requests with a parameter
    /// see them.
    Pages pages_of(const Scene& scene, const std::vector<PageKey>& keys) {
        Pages pages;
        for (const PageKey& key : keys)
            for (const auto& [accuracy, gutter] : {std::pair{Accuracy::high, 0},
                                                   {Accuracy::high, 16},
                                                   {Accuracy::fast, 0},
                                                   {Accuracy::exact, 0}})
                if (accuracy != Accuracy::exact || key.level == 1)
                    pages[{key, accuracy, gutter}] =
                        page_bytes(scene, key, accuracy, gutter, 40, gutter == 0 ? 0 : 40000);
        return pages;
    }
    /// Round where maps lie, and some that see little of them.
    std::vector<PageKey> some_keys(int count) {
        std::vector<PageKey> keys;
        for (int i = 0; i < count; ++i) {
            const auto level = static_cast<std::uint8_t>(i % 7);
            const auto page = [&] {
                const std::int64_t texel = (below(2) == 0 ? 0 : 3900) + below(1400);
                return static_cast<std::uint32_t>(texel >> (8 + level));
            };
            keys.push_back({level, page(), page()});
        }
        keys.push_back({0, 1, 1});
        return keys;
    }

    const std::uint64_t seed_ = fresh_seed();
    std::mt19937_64 random_{seed_};
    SilentProgress progress_;
    EditedPattern files_;
    ScenePtr scene_ = files_.load();
    std::shared_ptr<Journal> journal_ = memory_journal({});
    std::unique_ptr<LiveScene> live_;
};

TEST_F(Laws, PagesThatAnEditOfAMapDoesNotTouchKeepTheirBytes) {
    for (const std::string output : {"all", "ground", "mask", "moving", "glints"}) {
        SCOPED_TRACE(output);
        use(output);
        const std::vector<PageKey> keys = some_keys(7);
        Pages before = pages_of(*live_->now(), keys);
        int kept = 0, changed = 0;
        for (int i = 0; i < 6; ++i) {
            const int which = static_cast<int>(below(output == "all" || output == "mask" ? 3 : 1));
            const proto::Edit edit = output == "glints" ? random_paint("kinds", 32, 3)
                                     : which == 0       ? random_paint("areas", 16, 2)
                                     : which == 1       ? random_paint("mask", 64, 2)
                                     : output == "all"  ? random_paint("kinds", 32, 3)
                                                        : random_paint("mask", 64, 2);
            const EditOutcome outcome = edit_and_wait(*live_, edit);
            ASSERT_TRUE(std::holds_alternative<proto::EditAnswer>(outcome))
                << std::get<EditRefusal>(outcome).detail;
            const ScenePtr now = live_->now();
            Pages after = pages_of(*now, keys);
            for (const auto& [which_page, bytes] : after) {
                const bool touched = page_revision(*now, std::get<0>(which_page)) == now->revision;
                const bool same = before.at(which_page) == bytes;
                kept += touched ? 0 : 1;
                changed += same ? 0 : 1;
                if (!touched && !same) {
                    const auto& [key, accuracy, gutter] = which_page;
                    ADD_FAILURE() << "seed " << seed_ << ": page " << int{key.level} << "/" << key.x << "/"
                                  << key.y << " of accuracy " << int(accuracy) << ", gutter " << gutter
                                  << " changed with " << edit.ShortDebugString();
                    return;
                }
            }
            before = std::move(after);
        }
        EXPECT_GT(kept, 0);
        EXPECT_GT(changed, 0);
    }
}

TEST_F(Laws, AReplayGivesTheSameBytesAsLivingThroughIt) {
    for (const std::string output : {"all", "moving"}) {
        SCOPED_TRACE(output);
        use(output);
        int accepted = 0;
        for (int i = 0; i < 40; ++i)
            accepted +=
                std::holds_alternative<proto::EditAnswer>(edit_and_wait(*live_, random_edit())) ? 1 : 0;
        EXPECT_GT(accepted, 10);
        const ScenePtr lived = live_->now();
        const SceneClock clock = live_->clock();
        open();
        const ScenePtr replayed = live_->now();
        ASSERT_EQ(lived->revision, replayed->revision);
        EXPECT_EQ(live_->clock().playing, clock.playing);
        const std::vector<PageKey> keys = some_keys(7);
        for (const PageKey& key : keys)
            EXPECT_EQ(page_revision(*lived, key), page_revision(*replayed, key)) << "seed " << seed_;
        EXPECT_EQ(pages_of(*lived, keys), pages_of(*replayed, keys)) << "seed " << seed_;
        // And from a snapshot
        proto::LiveState state = live_->state();
        state.set_page_revisions(replayed->page_revisions.save());
        std::promise<bool> kept;
        journal_->keep_snapshot({state.revision(), state.SerializeAsString()},
                                [&](Result<void> how) { kept.set_value(how.has_value()); });
        ASSERT_TRUE(kept.get_future().get());
        open();
        EXPECT_EQ(pages_of(*live_->now(), keys), pages_of(*lived, keys)) << "seed " << seed_;
    }
}

TEST_F(Laws, UndoneEditsLeaveTheBytesAsTheyWere) {
    for (const std::string output : {"all", "moving"}) {
        SCOPED_TRACE(output);
        use(output);
        const std::vector<PageKey> keys = some_keys(7);
        const Pages before = pages_of(*live_->now(), keys);
        std::vector<proto::Edit> inverses;
        for (int i = 0; i < 20; ++i) {
            proto::Edit edit = random_edit();
            // What an animation has shown stays shown: its undoing goes on from now
            if (edit.changes(0).has_change_animation()) continue;
            const EditOutcome outcome = edit_and_wait(*live_, std::move(edit));
            if (const auto* answer = std::get_if<proto::EditAnswer>(&outcome))
                inverses.push_back(answer->inverse());
        }
        ASSERT_GT(inverses.size(), 5u);
        for (auto inverse = inverses.rbegin(); inverse != inverses.rend(); ++inverse) {
            const EditOutcome outcome = edit_and_wait(*live_, *inverse);
            ASSERT_TRUE(std::holds_alternative<proto::EditAnswer>(outcome))
                << std::get<EditRefusal>(outcome).detail;
        }
        EXPECT_EQ(pages_of(*live_->now(), keys), before) << "seed " << seed_;
    }
}

TEST_F(Laws, RetriesAndReusedIdsAreToldApart) {
    const proto::Edit edit = random_paint("kinds", 32, 3);
    const auto first = edit_and_wait(*live_, edit), again = edit_and_wait(*live_, edit);
    EXPECT_FALSE(std::get<proto::EditAnswer>(first).again());
    EXPECT_TRUE(std::get<proto::EditAnswer>(again).again());
    proto::Edit other = random_paint("mask", 64, 2);
    other.set_id(edit.id());
    EXPECT_EQ(std::get<EditRefusal>(edit_and_wait(*live_, other)).why, EditRefusal::Why::other_content);
    // The step of an animation's change is when it arrived first
    use("moving");
    proto::Edit change = new_edit();
    change.add_changes()->mutable_change_animation()->set_block("blink");
    change.mutable_changes(0)->mutable_change_animation()->set_density(3);
    EXPECT_FALSE(std::get<proto::EditAnswer>(edit_and_wait(*live_, change)).again());
    std::this_thread::sleep_for(std::chrono::milliseconds{150});
    EXPECT_TRUE(std::get<proto::EditAnswer>(edit_and_wait(*live_, change)).again());
    EXPECT_EQ(live_->now()->revision, 1u);
}

TEST_F(Laws, EditsThatCannotBeCompiledNeverReachTheJournal) {
    proto::Edit edit = new_edit();
    proto::ParameterChange& change = *edit.add_changes()->mutable_set_parameter();
    change.set_block("mixture");
    change.set_field("materials[1].entries[0].pattern");
    change.mutable_value()->set_integer(77);
    const auto outcome = edit_and_wait(*live_, edit);
    EXPECT_EQ(std::get<EditRefusal>(outcome).why, EditRefusal::Why::wrong);
    EXPECT_EQ(journal_->status().head, 0u);
}

TEST_F(Laws, ManyAtOnceAreAllAnsweredAndAllThere) {
    constexpr int count = 60;
    std::vector<std::promise<EditOutcome>> outcomes(count);
    for (int i = 0; i < count; ++i) {
        proto::Edit edit = i % 3 == 0 ? placing(static_cast<std::uint64_t>(i + 1), 10 * i, 20)
                                      : random_paint(i % 3 == 1 ? "kinds" : "mask", 32, 2);
        live_->edit(std::move(edit), [&outcomes, i](EditOutcome how) {
            outcomes[static_cast<std::size_t>(i)].set_value(std::move(how));
        });
    }
    std::set<Revision> revisions;
    for (auto& outcome : outcomes) {
        const EditOutcome how = outcome.get_future().get();
        ASSERT_TRUE(std::holds_alternative<proto::EditAnswer>(how)) << std::get<EditRefusal>(how).detail;
        revisions.insert(std::get<proto::EditAnswer>(how).revision());
    }
    EXPECT_EQ(revisions.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(live_->now()->revision, static_cast<Revision>(count));
}

}  // namespace
}  // namespace tessera
