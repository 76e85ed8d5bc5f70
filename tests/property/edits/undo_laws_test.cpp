// Back to any revision, and every texel is what it was.
#include <cstdlib>
#include <future>
#include <random>

#include <gtest/gtest.h>

#include "server/edits/live_scene.h"
#include "server/history/undo.h"
#include "server/journal/open_journal.h"
#include "tests/unit/server/edits/made_scene.h"

namespace tessera {
namespace {

std::uint64_t fresh_seed() {
    const char* const given = std::getenv("TESSERA_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
}

/// A scene with its journal, and the scene after each of its edits.
struct Story {
    explicit Story(ScenePtr scene) : ground{std::move(scene)} {
        auto owned = memory_journal({});
        journal = owned.get();
        live = LiveScene::open(ground, std::move(owned), progress).value();
        after.push_back(live->now());
    }
    /// Whether it was accepted.
    bool edit(proto::Edit edit) {
        if (edit.id().empty()) edit.set_id(to_string(random_edit_id()));
        std::promise<EditOutcome> promise;
        live->edit(std::move(edit), [&](EditOutcome how) { promise.set_value(std::move(how)); });
        const EditOutcome outcome = promise.get_future().get();
        if (!std::holds_alternative<proto::EditAnswer>(outcome)) return false;
        after.push_back(live->now());
        return true;
    }
    Revision head() const { return after.back()->revision; }
    /// Goes back, and holds that everything is as it was. Returns how many edits it took.
    std::size_t undo_to(Revision revision) {
        const auto undo = plan_undo(ground, *journal, revision, progress);
        EXPECT_TRUE(undo) << undo.error().detail;
        if (!undo) return 0;
        EXPECT_EQ(undo->fingerprint, live->now()->fingerprint);
        const Revision before = head();
        for (const proto::Edit& edit : undo->edits) EXPECT_TRUE(this->edit(edit));
        EXPECT_EQ(head(), before + undo->edits.size());
        const Scene &then = *after[revision], &now = *live->now();
        for (const std::uint8_t level : {std::uint8_t{0}, std::uint8_t{2}, std::uint8_t{5}})
            EXPECT_EQ(texels_of(now, level), texels_of(then, level));
        constexpr std::int64_t far = std::int64_t{1} << 40;
        const auto old_sprites = then.sprites.meeting({-far, -far, far, far}),
                   new_sprites = now.sprites.meeting({-far, -far, far, far});
        EXPECT_EQ(new_sprites.size(), old_sprites.size());
        for (std::size_t i = 0; i < std::min(old_sprites.size(), new_sprites.size()); ++i)
            EXPECT_TRUE(same_sprite(old_sprites[i], new_sprites[i])) << old_sprites[i].id;
        return undo->edits.size();
    }

    ScenePtr ground;
    SilentProgress progress;
    Journal* journal = nullptr;
    std::unique_ptr<LiveScene> live;
    std::vector<ScenePtr> after;
};

ScenePtr crowded_scene(std::size_t overlap_layers) {
    auto scene = std::make_shared<Scene>(*made_scene());
    scene->sprites = PositioningMap{overlap_layers};
    return scene;
}

class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_{seed} {}
    std::uint64_t below(std::uint64_t count) {
        return std::uniform_int_distribution<std::uint64_t>{0, count - 1}(engine_);
    }
    double place() { return static_cast<double>(below(256 * 256)) / 256; }
    bool chance(double p) { return std::bernoulli_distribution{p}(engine_); }

    /// Perhaps possible: ids are few, so that edits meet.
    proto::Edit edit() {
        proto::Edit edit = new_edit();
        for (std::uint64_t i = 0, n = 1 + below(4); i < n; ++i) change(*edit.add_changes());
        return edit;
    }

  private:
    void change(proto::Change& change) {
        const std::uint64_t id = 1 + below(20);
        switch (below(4)) {
            case 0: {
                proto::SpritePlacement& sprite = *change.mutable_place_sprite();
                sprite.set_id(id);
                sprite.set_x(place());
                sprite.set_y(place());
                sprite.set_pattern(static_cast<std::uint32_t>(below(4)));
                if (chance(0.5)) sprite.set_scale(0.25 + static_cast<double>(below(8)) / 4);
                if (chance(0.5)) sprite.set_turn(static_cast<double>(below(64)) / 64);
                if (chance(0.3)) sprite.set_first_step(static_cast<std::int64_t>(below(10)) - 5);
                if (chance(0.2)) {
                    sprite.mutable_path()->set_to_x(place());
                    sprite.mutable_path()->set_to_y(place());
                    sprite.mutable_path()->set_steps(100);
                }
                break;
            }
            case 1:
                change.mutable_remove_sprite()->set_id(id);
                break;
            default: {
                proto::SpriteMove& move = *change.mutable_move_sprite();
                move.set_id(id);
                if (chance(0.8)) move.set_x(place());
                if (chance(0.8)) move.set_y(place());
                if (chance(0.2)) move.set_scale(0.25 + static_cast<double>(below(8)) / 4);
                if (chance(0.2)) move.set_turn(static_cast<double>(below(64)) / 64);
                if (chance(0.3)) move.set_order(static_cast<std::int32_t>(below(5)) - 2);
                if (chance(0.2)) move.set_pattern(static_cast<std::uint32_t>(below(4)));
            }
        }
    }

    std::mt19937_64 engine_;
};

TEST(Undo, BringsEveryTexelBackWhateverHappened) {
    const std::uint64_t seed = fresh_seed();
    SCOPED_TRACE("TESSERA_SEED=" + std::to_string(seed));
    Random random{seed};
    // With few layers, places are full, and what comes back must not be in its own way
    for (const std::size_t layers : {1, 2, 64}) {
        Story story{crowded_scene(layers)};
        for (int round = 0; round < 8; ++round) {
            for (int i = 0; i < 60; ++i) story.edit(random.edit());
            story.undo_to(random.below(story.head() + 1));
            if (testing::Test::HasFailure()) return;
        }
        EXPECT_GT(story.head(), 20u);
        EXPECT_LE(story.undo_to(0), 1u);
        EXPECT_EQ(story.live->now()->sprites.size(), 0u);
    }
}

TEST(Undo, OfADayOfDraggingIsOneMove) {
    Story story{made_scene()};
    ASSERT_TRUE(story.edit(placing(1, 50, 50)));
    for (int i = 0; i < 500; ++i) ASSERT_TRUE(story.edit(moving(1, i / 8.0, 60)));
    SilentProgress progress;
    const Undo undo = plan_undo(story.ground, *story.journal, 1, progress).value();
    ASSERT_EQ(undo.edits.size(), 1u);
    ASSERT_EQ(undo.edits[0].changes_size(), 1);
    EXPECT_EQ(undo.edits[0].changes(0).move_sprite().x(), 50);
    EXPECT_EQ(undo.edits[0].base_revision(), 501u);
    EXPECT_EQ(story.undo_to(1), 1u);
    EXPECT_EQ(story.undo_to(story.head()), 0u);
}

TEST(Undo, OfSpritesThatChangedPlacesWhereOnlyOneHasRoom) {
    Story story{crowded_scene(1)};
    ASSERT_TRUE(story.edit(placing(1, 100, 100)));
    ASSERT_TRUE(story.edit(placing(2, 200, 200)));
    ASSERT_TRUE(story.edit(moving(1, 30, 200)));
    ASSERT_TRUE(story.edit(moving(2, 100, 100)));
    ASSERT_TRUE(story.edit(moving(1, 200, 200)));
    EXPECT_FALSE(story.edit(moving(1, 100, 100)));
    EXPECT_EQ(story.undo_to(2), 1u);
}

TEST(Undo, OfMoreThanAnEditHoldsTakesSeveral) {
    Story story{made_scene()};
    for (std::uint64_t part = 0; part < 3; ++part) {
        proto::Edit edit = new_edit();
        for (std::uint64_t i = 0; i < 1000; ++i)
            *edit.add_changes() =
                placing(1 + part * 1000 + i, double(i % 100) * 20, double(part * 10 + i / 100) * 20)
                    .changes(0);
        ASSERT_TRUE(story.edit(edit));
    }
    EXPECT_EQ(story.undo_to(0), 3u);
    // And back again: placements take more bytes than removals
    EXPECT_GE(story.undo_to(3), 3u);
}

TEST(Undo, ToWhatIsNotReachedIsRefused) {
    Story story{made_scene()};
    ASSERT_TRUE(story.edit(placing(1, 50, 50)));
    SilentProgress progress;
    const auto refused = plan_undo(story.ground, *story.journal, 2, progress);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().detail.find("revision 1"), std::string::npos);
}

}  // namespace
}  // namespace tessera
