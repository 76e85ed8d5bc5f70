// Hands that lift more than there is room for, and edits that touch more: what is shown stays whole. Texels
// say which page they are of, of which revision, and what was left out of them.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "client/residency/coarse_cover.h"
#include "client/residency/lifted_sprites.h"
#include "client/residency/residency.h"

namespace tessera {
namespace {

struct Content {
    PageKey page;
    std::uint64_t revision = 0;
    std::size_t count = 0;  ///< Of sprites left out
    std::uint64_t without[most_lifted] = {};
    bool is_without(std::uint64_t id) const {
        return std::find(without, without + count, id) != without + count;
    }
};

/// Answers in random order after some frames; edits change every page.
class Server final : public PageSource {
  public:
    explicit Server(unsigned seed) : random_{seed} {}
    bool request(const PageRequest& request) override {
        EXPECT_LE(request.without.size(), most_lifted);
        waiting_.push_back({frame_ + 1 + random_() % 12, request});
        return true;
    }
    void cancel(PageRequestId id) override { cancelled_.insert(id); }
    std::vector<ArrivedPage> take_arrived(std::size_t most) override {
        ++frame_;
        std::vector<ArrivedPage> arrived;
        std::erase_if(waiting_, [&](const auto& one) {
            const auto& [due, request] = one;
            if (due > frame_ || arrived.size() == most) return false;
            ArrivedPage& page = arrived.emplace_back(ArrivedPage{request.id, request.page, std::string{}});
            if (cancelled_.erase(request.id) > 0)
                page.texels = Error{ErrorCode::cancelled, ""};
            else if (!request.without.empty() && random_() % 8 == 0)
                page.texels = Error{ErrorCode::io_failure, "a bad day"};
            else
                answer(request, page);
            return true;
        });
        return arrived;
    }
    SceneNews take_news() override { return {.told_revision = revision, .stale = std::exchange(stale_, {})}; }
    void edit(const std::vector<PageKey>& pages) {
        ++revision;
        for (const PageKey page : pages) stale_.push_back({page, revision});
    }
    std::uint64_t revision = 1;

  private:
    void answer(const PageRequest& request, ArrivedPage& page) const {
        Content content{.page = request.page, .revision = revision, .count = request.without.size()};
        std::ranges::copy(request.without, content.without);
        std::string texels(slot_bytes, '\0');
        std::memcpy(texels.data(), &content, sizeof content);
        page.texels = std::move(texels);
        page.version = {.revision = revision, .scene_revision = revision};
    }
    std::mt19937 random_;
    std::uint64_t frame_ = 0;
    std::vector<std::pair<std::uint64_t, PageRequest>> waiting_;
    std::set<PageRequestId> cancelled_;
    std::vector<StalePage> stale_;
};

class Table {
  public:
    explicit Table(unsigned seed, const ResidencySettings& settings = {})
        : server{seed}, residency{Extent{12}, server, settings} {}

    void frame() {
        outcome = residency.update(PlaneView{camera, 640, 480}, now_ += ClientTime{16});
        for (const SlotUpload& upload : outcome.uploads) {
            ASSERT_LT(upload.slot, residency.slots());
            std::memcpy(&gpu_[upload.slot], upload.texels.data(), sizeof(Content));
        }
        for (const NeededPage& page : outcome.sampled) {
            const auto shown = residency.table().shown_for(page.key);
            if (!shown) continue;
            // What a slot holds is what the table says of it, and covers the page
            ASSERT_EQ(gpu_[shown->slot].page.level, shown->level);
            ASSERT_TRUE(covers(gpu_[shown->slot].page, page.key));
        }
    }
    void settle(int frames = 300) {
        for (int i = 0; i < frames; ++i) frame();
    }
    const Content& shown(PageKey page) { return gpu_[residency.table().shown_for(page)->slot]; }
    /// Of all that is sampled and touched by what is lifted: pages that show it still.
    std::set<PageKey> seen_twice(const PageHold& hold) {
        std::set<PageKey> twice;
        for (const NeededPage& page : outcome.sampled)
            for (const LiftedSprite& sprite : all_lifted(page.key, {&hold}))
                if (!shown(page.key).is_without(sprite.id)) twice.insert(page.key);
        return twice;
    }

    Server server;
    Residency residency;
    Camera camera{.ground = {500'000, 500'000}, .height_texels = 900, .pitch_degrees = -50};
    ResidencyFrame outcome;

  private:
    ClientTime now_{};
    std::map<Slot, Content> gpu_;
};

/// Sprites all over what a table shows.
PageHold lifted_from_all(const Table& table, std::size_t count, unsigned seed) {
    std::mt19937_64 random{seed};
    PageHold hold{.id = 1};
    for (std::uint64_t id = 1; id <= count; ++id) {
        const PageKey page = table.outcome.sampled[random() % table.outcome.sampled.size()].key;
        const std::int64_t texel = std::int64_t{1} << page.level;
        const auto somewhere = [&](std::uint32_t at) {
            return (at * std::int64_t{256} + static_cast<std::int64_t>(random() % 256)) * texel;
        };
        const std::int64_t x = somewhere(page.x), y = somewhere(page.y);
        hold.lifted.push_back(id);
        hold.lifted_boxes.push_back({x, y, x + 40, y + 40});
    }
    return hold;
}

class Holds : public ::testing::TestWithParam<unsigned> {};

TEST_P(Holds, NothingThatIsLiftedIsSeenTwiceHoweverManyPagesItTouches) {
    const unsigned seed = GetParam();
    Table table{seed};
    table.settle();
    ASSERT_TRUE(table.outcome.is_sharp());
    const PageHold hold = lifted_from_all(table, 50, seed);
    table.residency.hold({hold});
    table.settle();
    EXPECT_GT(table.outcome.sampled.size(), table.residency.settings().stand_ins);
    EXPECT_TRUE(table.seen_twice(hold).empty());
    EXPECT_TRUE(table.outcome.unlifted_holds.empty());
    EXPECT_TRUE(table.outcome.is_sharp());
    // The hand lets go: every page is itself in the very next frame
    table.residency.hold({});
    table.frame();
    for (const NeededPage& page : table.outcome.sampled) EXPECT_EQ(table.shown(page.key).count, 0u);
}

TEST_P(Holds, WhereThereIsRoomStandInsAreAsSharpAsThePages) {
    Table table{GetParam()};
    table.settle();
    const PageHold hold = lifted_from_all(table, 1, GetParam());
    table.residency.hold({hold});
    table.settle();
    int touched = 0;
    for (const NeededPage& page : table.outcome.sampled) {
        if (all_lifted(page.key, {&hold}).empty()) continue;
        ++touched;
        EXPECT_EQ(table.shown(page.key).page, page.key);
        EXPECT_EQ(table.shown(page.key).count, 1u);
    }
    EXPECT_GT(touched, 0);
}

TEST_P(Holds, WhatIsShownWithoutItStaysSoWhileTheEyeMoves) {
    const unsigned seed = GetParam();
    Table table{seed};
    table.settle();
    const PageHold hold = lifted_from_all(table, 50, seed);
    table.residency.hold({hold});
    table.settle();
    std::mt19937_64 random{seed};
    std::set<PageKey> before, twice;
    for (int frame = 0; frame < 400; ++frame) {
        table.camera.height_texels *= std::exp2(std::sin(frame / 40.0) / 30);
        table.camera.yaw_degrees += frame % 100 < 50 ? 1 : -1;
        table.camera.ground = table.camera.ground.moved(static_cast<double>(random() % 33) - 16,
                                                        static_cast<double>(random() % 33) - 16);
        table.frame();
        if (HasFatalFailure()) return;
        const std::set<PageKey> now = table.seen_twice(hold);
        for (const PageKey page : now)
            ASSERT_TRUE(!before.contains(page) || twice.contains(page))
                << "frame " << frame << " level " << int{page.level};
        before.clear();
        for (const NeededPage& page : table.outcome.sampled)
            if (table.residency.table().resident_for(page.key)->level == page.key.level)
                before.insert(page.key);
        twice = now;
    }
    table.settle();
    EXPECT_TRUE(table.seen_twice(hold).empty());
}

TEST_P(Holds, StandInsStayInTheirSlotsHoweverFewTheseAre) {
    for (const std::size_t slots : {0u, 1u, 4u, 9u}) {
        Table table{GetParam(), {.stand_ins = slots}};
        table.settle();
        table.residency.hold({lifted_from_all(table, 50, GetParam())});
        table.settle();  // which checks every slot
        if (HasFatalFailure()) return;
        EXPECT_TRUE(table.outcome.is_sharp());
    }
}

TEST_P(Holds, AHoldThatLiftsMoreThanAServerLeavesOutLiftsNothingAndSaysSo) {
    Table table{GetParam()};
    table.settle();
    const TexelBox here{500'000, 500'000, 500'040, 500'040};
    PageHold many{.id = 1}, one{.id = 2, .lifted = {1000}, .lifted_boxes = {here}};
    for (std::uint64_t id = 0; id <= most_lifted; ++id) {
        many.lifted.push_back(id);
        many.lifted_boxes.push_back(here);
    }
    table.residency.hold({many, one});
    table.settle();
    EXPECT_EQ(table.outcome.unlifted_holds, std::vector<std::uint32_t>{1});
    EXPECT_TRUE(table.seen_twice(one).empty()) << "the small one";
    for (const NeededPage& page : table.outcome.sampled) EXPECT_LE(table.shown(page.key).count, 1u);
    many.lifted.pop_back();
    many.lifted_boxes.pop_back();
    table.residency.hold({many});
    table.settle();
    EXPECT_TRUE(table.outcome.unlifted_holds.empty());
    EXPECT_TRUE(table.seen_twice(many).empty());
}

TEST_P(Holds, AnEditOfMoreThanCanWaitIsSeenWholeFromOneFrameOn) {
    for (const std::size_t kept : {128u, 6u}) {
        Table table{GetParam(), {.kept = kept}};
        table.settle();
        ASSERT_TRUE(table.outcome.is_sharp());
        PageHold hold{.id = 7, .boxes = {{0, 0, 1'000'000, 1'000'000}}, .waits = true};
        table.residency.hold({hold});
        std::vector<PageKey> all;
        for (const auto& [page, slot] : table.residency.cache().pages()) all.push_back(page);
        table.server.edit(all);
        table.settle(3);
        hold.revision = table.server.revision;
        table.residency.hold({hold});
        bool has_ended = false;
        int frames = 0;
        for (; frames < 600 && !(has_ended && table.outcome.is_current()); ++frames) {
            table.frame();
            if (HasFatalFailure()) return;
            has_ended = has_ended || !table.outcome.ended_holds.empty();
            for (const NeededPage& page : table.outcome.sampled)
                ASSERT_EQ(table.shown(page.key).revision >= hold.revision, has_ended)
                    << "frame " << frames << " level " << int{page.key.level};
        }
        EXPECT_LT(frames, 600);
        EXPECT_TRUE(table.outcome.is_sharp());
    }
}

TEST_P(Holds, NeverMorePagesWaitThanThereIsRoomForAndWhatIsAwaitedIsAmongThem) {
    std::mt19937 random{GetParam()};
    PageHolds holds{9};
    holds.set({{.id = 1, .boxes = {{0, 0, 1 << 14, 1 << 14}}, .waits = true}});
    std::vector<NeededPage> needed;
    for (int i = 0; i < 40; ++i) {
        const auto level = static_cast<std::uint8_t>(random() % 4);
        needed.push_back({{level, static_cast<std::uint32_t>(random() % (64u >> level)),
                           static_cast<std::uint32_t>(random() % (64u >> level))},
                          static_cast<double>(1 + random() % 1000)});
    }
    holds.await(needed, Extent{8});
    const auto awaited = holds.awaited_instead();
    ASSERT_FALSE(awaited.empty());
    ASSERT_LE(awaited.size(), 9u);
    for (const NeededPage& page : needed)
        EXPECT_TRUE(std::ranges::any_of(awaited, [&](const auto& one) { return covers(one.key, page.key); }));
    std::vector<NeededPage> arriving(needed);
    arriving.insert(arriving.end(), awaited.begin(), awaited.end());
    std::ranges::shuffle(arriving, random);
    for (const NeededPage& page : arriving) {
        ArrivedPage arrived{.page = page.key, .texels = std::string(16, 'x')};
        arrived.version.revision = 2;
        holds.keep(std::move(arrived));
        EXPECT_LE(holds.kept(), 9u);
    }
    for (const NeededPage& page : awaited) EXPECT_TRUE(holds.kept(page.key));
}

INSTANTIATE_TEST_SUITE_P(Seeds, Holds, ::testing::Values(1u, 2u, 3u));

}  // namespace
}  // namespace tessera
