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

}  // namespace
}  // namespace tessera
