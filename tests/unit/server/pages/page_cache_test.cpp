#include "server/pages/page_cache.h"

#include <numeric>

#include <gtest/gtest.h>

namespace tessera {
namespace {

PagePtr make_page(std::uint64_t number, std::size_t bytes = 10'000) {
    auto page = std::make_shared<EncodedPage>();
    page->id = {number * 0x9e3779b97f4a7c15u, number};
    page->bytes = std::make_shared<const EncodedBytes>(bytes);
    return page;
}

TEST(PageCache, ReturnsWhatWasPutIn) {
    PageCache cache{1 << 20};
    const PagePtr page = make_page(1);
    EXPECT_EQ(cache.find(page->id), nullptr);
    cache.insert(page);
    EXPECT_EQ(cache.find(page->id), page);
    EXPECT_EQ(cache.usage().pages, 1u);
    EXPECT_EQ(cache.usage().bytes, page->memory_bytes());
}

TEST(PageCache, NeverHoldsMoreThanItsBudget) {
    for (const std::size_t budget : {std::size_t{0}, std::size_t{100'000}, std::size_t{40} << 20}) {
        PageCache cache{budget};
        for (std::uint64_t i = 0; i < 9000; ++i) {
            cache.insert(make_page(i, 1000 + i * 37 % 30'000));
            if (i % 2 == 0) cache.find(make_page(i / 2, 0)->id);
            ASSERT_LE(cache.usage().bytes, budget);
        }
        EXPECT_EQ(cache.usage().pages == 0, budget == 0);
    }
}

TEST(PageCache, LeavesOutAPageThatIsLargerThanItself) {
    PageCache cache{50'000};
    cache.insert(make_page(1));
    cache.insert(make_page(2, 60'000));
    EXPECT_NE(cache.find(make_page(1)->id), nullptr);
    EXPECT_EQ(cache.find(make_page(2)->id), nullptr);
}

TEST(PageCache, KeepsWhatIsAskedForThroughAScanOfEverythingElse) {
    PageCache cache{1 << 20};  // about a hundred pages
    for (std::uint64_t i = 0; i < 50; ++i) cache.insert(make_page(i));
    for (int round = 0; round < 2; ++round)
        for (std::uint64_t i = 0; i < 50; ++i) cache.find(make_page(i)->id);
    for (std::uint64_t i = 1000; i < 3000; ++i)
        cache.insert(make_page(i));  // a least-recently-used cache forgets
    int kept = 0;
    for (std::uint64_t i = 0; i < 50; ++i) kept += cache.find(make_page(i)->id) != nullptr;
    EXPECT_GE(kept, 49);
}

TEST(PageCache, TakesBackSoonWhatItPushedOutTooEarly) {
    PageCache cache{1 << 20};
    std::uint64_t next = 0;
    while (cache.usage().evictions == 0) cache.insert(make_page(next++));
    const PagePtr first = make_page(0);
    ASSERT_EQ(cache.find(first->id), nullptr);
    cache.insert(first);  // remembered: goes straight to the main queue
    for (int i = 0; i < 60; ++i) cache.insert(make_page(next++));
    EXPECT_NE(cache.find(first->id), nullptr);
}

}  // namespace
}  // namespace tessera
