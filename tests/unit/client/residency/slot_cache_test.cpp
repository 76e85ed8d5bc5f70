#include "client/residency/slot_cache.h"

#include <map>
#include <random>

#include <gtest/gtest.h>

namespace tessera {
namespace {

PageKey page(std::uint32_t x) { return {0, x, 0}; }

TEST(SlotCache, EvictsThePageThatWasLongestUnused) {
    SlotCache cache{3};
    for (std::uint32_t x = 0; x < 3; ++x) cache.insert(page(x), false);
    cache.use(*cache.find(page(0)));
    cache.begin_frame();
    const auto placed = cache.insert(page(9), false);
    ASSERT_TRUE(placed);
    EXPECT_EQ(placed->evicted, page(1));
    EXPECT_TRUE(cache.find(page(0)));
}

TEST(SlotCache, GivesAUsedPageOneSecondChanceOnly) {
    SlotCache cache{2};
    cache.insert(page(0), false);
    cache.insert(page(1), false);
    cache.use(*cache.find(page(0)));
    cache.begin_frame();
    EXPECT_EQ(cache.insert(page(2), false)->evicted, page(1));
    EXPECT_EQ(cache.insert(page(3), false)->evicted, page(0));
}

TEST(SlotCache, NeverEvictsWhatThisFrameUsesOrWhatIsPinned) {
    SlotCache cache{2};
    cache.insert(page(0), true);
    cache.insert(page(1), false);
    cache.use(*cache.find(page(1)));
    EXPECT_FALSE(cache.insert(page(2), false));
    cache.begin_frame();
    EXPECT_EQ(cache.insert(page(2), false)->evicted, page(1));
    EXPECT_TRUE(cache.find(page(0)));
}

TEST(SlotCache, ShrinksToThePinnedAndTheLatestUsedAndMovesOnlyWhatHasNoPlace) {
    SlotCache cache{10};
    for (std::uint32_t x = 0; x < 8; ++x) cache.insert(page(x), x == 6);  // slots 0 to 7
    cache.begin_frame();
    for (const std::uint32_t x : {1u, 7u}) cache.use(*cache.find(page(x)));
    const SlotCache::Resized resized = cache.resize(3);
    EXPECT_EQ(resized.dropped.size(), 5u);
    EXPECT_EQ(cache.capacity(), 3u);
    EXPECT_EQ(*cache.find(page(1)), 1) << "its slot is there still";
    ASSERT_EQ(resized.moves.size(), 2u);
    for (const SlotCache::Move& move : resized.moves) {
        EXPECT_EQ(move.from, move.page.x);
        EXPECT_EQ(*cache.find(move.page), move.to);
        EXPECT_LT(move.to, 3);
    }
    EXPECT_TRUE(cache.find(page(6)));
    EXPECT_TRUE(cache.find(page(7)));
    EXPECT_FALSE(cache.insert(page(20), false)) << "all are pinned or in use";
    cache.begin_frame();
    cache.insert(page(20), false);
    EXPECT_TRUE(cache.find(page(6)));
    EXPECT_TRUE(cache.resize(0).dropped.size() == 2) << "the pinned page stays";
    EXPECT_EQ(cache.capacity(), 1u);
    cache.resize(5);
    for (std::uint32_t x = 30; x < 34; ++x) EXPECT_FALSE(cache.insert(page(x), false)->evicted);
}

TEST(SlotCache, KeepsWhatIsOfUseLongerThanWhatIsNot) {
    SlotCache cache{3};
    for (std::uint32_t x = 0; x < 3; ++x) cache.insert(page(x), false);
    cache.begin_frame();
    cache.use(*cache.find(page(0)));
    cache.touch(*cache.find(page(1)));
    EXPECT_EQ(cache.insert(page(9), false)->evicted, page(2));
    cache.use(*cache.find(page(9)));
    EXPECT_EQ(cache.insert(page(10), false)->evicted, page(1)) << "only if nothing else can";
}

TEST(SlotCache, HoldsEachPageInOneSlotAndOnePageInEachSlot) {
    SlotCache cache{37};
    std::map<PageKey, Slot> model;
    std::mt19937 random{3};
    for (int step = 0; step < 50000; ++step) {
        if (step % 9 == 0) cache.begin_frame();
        const PageKey wanted = page(static_cast<std::uint32_t>(random() % 90));
        if (const auto slot = cache.find(wanted)) {
            ASSERT_EQ(model.at(wanted), *slot);
            cache.use(*slot);
            continue;
        }
        ASSERT_FALSE(model.contains(wanted));
        const auto placed = cache.insert(wanted, step < 5);
        ASSERT_TRUE(placed) << "nine uses a frame cannot fill 37 slots";
        if (placed->evicted) {
            ASSERT_EQ(model.erase(*placed->evicted), 1u);
        }
        for (const auto& [other, slot] : model) ASSERT_NE(slot, placed->slot);
        model[wanted] = placed->slot;
        ASSERT_EQ(cache.size(), model.size());
        ASSERT_LE(model.size(), 37u);
    }
    EXPECT_EQ(cache.pinned(), 5u);
}

TEST(SlotCache, ARemovedPageLeavesItsSlotFreeAndAPinnedOneStays) {
    SlotCache cache{4};
    const auto slot_of = [&](std::uint32_t x, bool pinned) { return cache.insert(page(x), pinned)->slot; };
    slot_of(0, true);
    for (std::uint32_t x = 1; x < 4; ++x) slot_of(x, false);
    cache.remove(page(0));
    EXPECT_TRUE(cache.find(page(0)));
    const Slot middle = *cache.find(page(2));
    cache.remove(page(2));
    cache.remove(page(9));
    EXPECT_FALSE(cache.find(page(2)));
    EXPECT_EQ(cache.size(), 3u);
    const auto placed = cache.insert(page(5), false);
    ASSERT_TRUE(placed);
    EXPECT_EQ(placed->slot, middle);
    EXPECT_FALSE(placed->evicted) << "there was room";
    EXPECT_TRUE(cache.insert(page(6), false)->evicted);
}

}  // namespace
}  // namespace tessera
