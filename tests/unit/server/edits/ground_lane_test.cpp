// Edits of more than sprites, compiled in groups: what is too much together is compiled in halves, what
// became impossible meanwhile lets the others through, and a stop meanwhile loses nothing that was
// acknowledged.
#include <chrono>
#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "server/edits/live_scene.h"
#include "server/journal/open_journal.h"
#include "tests/support/made_edits.h"
#include "tests/support/passing_journal.h"
#include "tests/unit/server/edits/edited_pattern.h"

namespace tessera {
namespace {

constexpr std::int32_t painted_value = 2;  // None of the map's own

int painted_entries(const PaintedMaps& painted) {
    const auto found = painted.find("kinds");
    if (found == painted.end()) return 0;
    const StoredMap& map = found->second;
    int count = 0;
    for (std::int64_t y = 0; y < map.height; ++y)
        for (std::int64_t x = 0; x < map.width; ++x) count += map.entry(x, y) == painted_value ? 1 : 0;
    return count;
}

/// A document that cannot be compiled with more than so many entries painted since the last time, and whose
/// compilation waits where a test says so.
class Reluctant final : public SceneDocument {
  public:
    Reluctant(const std::filesystem::path& folder, const SceneDocument& of, int most)
        : SceneDocument{folder, *of.message()}, most_{most} {}

    Result<void> compile(const proto::Scene& message, const PaintedMaps& painted,
                         Scene& scene) const override {
        std::unique_lock lock{mutex_};
        waits_ = !open_;
        changed_.notify_all();
        changed_.wait(lock, [&] { return open_; });
        waits_ = false;
        const int entries = painted_entries(painted), more = entries - entries_;
        if (more > most_) {
            ++refused_;
            return Error{ErrorCode::invalid_input, "pattern: too much of it"};
        }
        entries_ = entries;
        most_at_once_ = std::max(most_at_once_, more);
        lock.unlock();
        return SceneDocument::compile(message, painted, scene);
    }

    void allow(int most) {
        const std::lock_guard lock{mutex_};
        most_ = most;
    }
    void hold() { set(false); }
    void let_go() { set(true); }
    void wait_until_it_waits() const {
        std::unique_lock lock{mutex_};
        changed_.wait(lock, [&] { return waits_; });
    }
    int refused() const {
        const std::lock_guard lock{mutex_};
        return refused_;
    }
    int most_at_once() const {
        const std::lock_guard lock{mutex_};
        return most_at_once_;
    }

  private:
    void set(bool open) {
        const std::lock_guard lock{mutex_};
        open_ = open;
        changed_.notify_all();
    }

    int most_;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    bool open_ = true;
    mutable bool waits_ = false;
    mutable int entries_ = 0, most_at_once_ = 0, refused_ = 0;
};

proto::Edit painting(int first, int entries = 1) {
    proto::Edit edit = new_edit();
    proto::MapPaint& paint = *edit.add_changes()->mutable_paint_map();
    paint.set_block("kinds");
    paint.set_x(first % 32);
    paint.set_y(first / 32);
    paint.set_width(static_cast<std::uint32_t>(entries));
    paint.set_height(1);
    paint.set_value(painted_value);
    return edit;
}

class GroundLane : public testing::Test {
  protected:
    void SetUp() override {
        auto scene = std::make_shared<Scene>(*files_.load());
        document_ = std::make_shared<Reluctant>(files_.folder(), *scene->document, most);
        scene->document = document_;
        scene_ = scene;
        live_ = open();
    }
    void TearDown() override { document_->let_go(); }  // Whatever failed, nobody waits for ever

    std::unique_ptr<LiveScene> open() {
        SilentProgress progress;
        return LiveScene::open(scene_, std::make_unique<tests::PassingJournal>(journal_), progress).value();
    }
    /// Returns its number among outcomes.
    std::size_t send(const proto::Edit& edit) {
        const std::lock_guard lock{mutex_};
        const std::size_t number = outcomes_.size();
        outcomes_.emplace_back();
        live_->edit(edit, [this, number](EditOutcome outcome) {
            const std::lock_guard told{mutex_};
            outcomes_[number].push_back(std::move(outcome));
            news_.notify_all();
        });
        return number;
    }
    EditOutcome outcome_of(std::size_t number) {
        std::unique_lock lock{mutex_};
        news_.wait(lock, [&] { return !outcomes_[number].empty(); });
        EXPECT_EQ(outcomes_[number].size(), 1U);
        return outcomes_[number].front();
    }
    Revision revision_of(std::size_t number) {
        const EditOutcome outcome = outcome_of(number);
        const auto* answer = std::get_if<proto::EditAnswer>(&outcome);
        EXPECT_NE(answer, nullptr) << "edit " << number << ": " << std::get<EditRefusal>(outcome).detail;
        return answer == nullptr ? 0 : answer->revision();
    }
    EditRefusal refusal_of(std::size_t number) {
        const EditOutcome outcome = outcome_of(number);
        const auto* refusal = std::get_if<EditRefusal>(&outcome);
        EXPECT_NE(refusal, nullptr) << "edit " << number << " is in";
        return refusal == nullptr ? EditRefusal{} : *refusal;
    }
    /// An edit whose compilation waits, so that those after it come together.
    std::size_t send_and_hold(int entry) {
        document_->hold();
        const std::size_t number = send(painting(entry));
        document_->wait_until_it_waits();
        return number;
    }
    /// A page that shows the painted map.
    static std::vector<std::uint8_t> page(const LiveScene& live) {
        return page_bytes(*live.now(), {0, 2, 2});
    }

    static constexpr int most = 3;
    EditedPattern files_;
    std::shared_ptr<Journal> journal_ = memory_journal({});
    std::shared_ptr<Reluctant> document_;
    ScenePtr scene_;
    std::mutex mutex_;
    std::condition_variable news_;
    std::vector<std::vector<EditOutcome>> outcomes_;
    std::unique_ptr<LiveScene> live_;  ///< Ends first.
};

TEST_F(GroundLane, WhatIsTooMuchTogetherIsCompiledInHalvesAndIsInOnceAndInOrder) {
    constexpr std::size_t count = 40;
    send_and_hold(0);
    for (std::size_t i = 1; i < count; ++i) send(painting(static_cast<int>(i)));
    document_->let_go();
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(revision_of(i), i + 1);
    EXPECT_GT(document_->refused(), 1) << "they never came together";
    EXPECT_LE(document_->most_at_once(), most);
    EXPECT_GT(document_->most_at_once(), 1) << "each was compiled by itself";
    EXPECT_EQ(journal_->status().head, count);
    const auto before = page(*live_);
    EXPECT_NE(before, page_bytes(*scene_, {0, 2, 2}));
}

TEST_F(GroundLane, WhoAsksForTooMuchAloneIsRefusedAndStandsInNobodysWay) {
    send_and_hold(0);
    std::vector<std::size_t> modest;
    std::size_t greedy = 0;
    for (int i = 1; i < 16; ++i)
        if (i == 7)
            greedy = send(painting(64, most + 1));
        else
            modest.push_back(send(painting(i)));
    document_->let_go();
    const EditRefusal refusal = refusal_of(greedy);
    EXPECT_EQ(refusal.why, EditRefusal::Why::wrong);
    EXPECT_EQ(refusal.detail, "pattern: too much of it");
    Revision last = 1;
    for (const std::size_t number : modest) EXPECT_EQ(revision_of(number), ++last);
    EXPECT_EQ(journal_->status().head, last);
    // What was halved is whole again
    EXPECT_EQ(revision_of(send(painting(20, most))), last + 1);
}

TEST_F(GroundLane, OneThatBecameImpossibleMeanwhileLetsTheOthersOfItsGroupThrough) {
    const std::size_t first = send_and_hold(0);
    proto::Edit counting = painting(1);
    counting.set_base_revision(1);
    const std::size_t hopeful = send(counting), other = send(painting(2));
    // Sprites wait for no compilation, so that this takes the revision that one counted on
    const std::size_t sprite = send(placing(1, 100, 100));
    EXPECT_EQ(revision_of(sprite), 1U);
    document_->let_go();
    EXPECT_EQ(revision_of(first), 2U);
    EXPECT_EQ(refusal_of(hopeful).why, EditRefusal::Why::conflict);
    EXPECT_EQ(revision_of(other), 3U);
    EXPECT_EQ(journal_->status().head, 3U);
}

TEST_F(GroundLane, AStopDuringACompilationAnswersEverybodyOnceAndLosesNothingThatIsIn) {
    constexpr std::size_t count = 12;
    const Revision sprite = revision_of(send(placing(1, 100, 100)));
    send_and_hold(0);
    for (std::size_t i = 1; i < count; ++i) send(painting(static_cast<int>(i)));
    std::jthread stops{[&] { live_->close(); }};
    document_->let_go();
    stops.join();
    Revision in = sprite;
    for (std::size_t number = 1; number <= count; ++number) {
        const EditOutcome outcome = outcome_of(number);
        if (const auto* answer = std::get_if<proto::EditAnswer>(&outcome))
            EXPECT_EQ(answer->revision(), ++in);
        else
            EXPECT_EQ(std::get<EditRefusal>(outcome).why, EditRefusal::Why::unavailable);
    }
    EXPECT_EQ(journal_->status().head, in);
    const auto lived = page(*live_);
    const auto again = open();
    EXPECT_EQ(again->now()->revision, in);
    EXPECT_EQ(page(*again), lived);
}

TEST_F(GroundLane, AReloadPlansTheSceneWhileEditsGoOnAndLosesNoneOfThem) {
    document_->allow(1024);
    for (int turn = 0; turn < 20; ++turn) {
        const Revision before = revision_of(send(painting(2 * turn)));
        auto renamed = std::make_shared<Scene>(*scene_);
        renamed->title = "turn " + std::to_string(turn);
        document_->hold();
        std::jthread reloads{[&] { live_->rebase(renamed); }};
        document_->wait_until_it_waits();
        auto sprite = std::async(std::launch::async, [&] {
            return send(placing(static_cast<std::uint64_t>(turn + 1), 100, 100 + 8 * turn));
        });
        const bool taken = sprite.wait_for(std::chrono::seconds{5}) == std::future_status::ready;
        EXPECT_TRUE(taken) << "edits wait for the reload";
        if (!taken) return document_->let_go();
        const std::size_t number = sprite.get();
        EXPECT_EQ(revision_of(number), before + 1);
        // What changes the document meanwhile is on the new files, too
        const std::size_t painted = send(painting(2 * turn + 1));
        document_->let_go();
        EXPECT_EQ(revision_of(painted), before + 2);
        reloads.join();
        EXPECT_EQ(live_->now()->title, renamed->title);
        EXPECT_EQ(live_->now()->revision, before + 2);
    }
    const auto lived = page(*live_);
    live_.reset();
    live_ = open();
    EXPECT_EQ(page(*live_), lived);
}

}  // namespace
}  // namespace tessera
