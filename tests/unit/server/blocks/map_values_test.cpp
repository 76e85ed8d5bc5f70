// Entries of a map: whatever is copied and written, each copy holds what was written to it, and only that.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/blocks/stored_map.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

constexpr std::int64_t draws_apart = 1000;
std::uint64_t drawn(std::int64_t i, std::int64_t what, std::uint64_t below) {
    return hash(21, stream("map values"), i, what) % below;
}

void expect_same(const MapValues& values, const std::vector<std::int32_t>& model) {
    ASSERT_EQ(values.size(), model.size());
    std::vector<std::int32_t> spans;
    values.for_spans([&](auto span) { spans.insert(spans.end(), span.begin(), span.end()); });
    EXPECT_EQ(spans, model);
    const std::set<std::int32_t> distinct(model.begin(), model.end());
    EXPECT_EQ(values.distinct(), std::vector<std::int32_t>(distinct.begin(), distinct.end()));
    for (std::int64_t i = 0; i < 50; ++i) {
        const std::size_t first = drawn(i, draws_apart, model.size()),
                          count = drawn(i, draws_apart + 1, model.size() - first + 1);
        EXPECT_EQ(values[first], model[first]);
        std::vector<std::int32_t> some(count);
        values.copy(first, count, some.data());
        EXPECT_TRUE(std::equal(some.begin(), some.end(), model.begin() + static_cast<std::ptrdiff_t>(first)));
    }
}

TEST(MapValues, EachCopyHoldsWhatWasWrittenToIt) {
    for (const std::size_t size :
         {std::size_t{1}, std::size_t{16384}, std::size_t{16385}, std::size_t{70001}})
        for (const std::int32_t apart : {1, 100'000'000}) {
            SCOPED_TRACE(std::to_string(size) + " entries, values " + std::to_string(apart) + " apart");
            std::vector<std::vector<std::int32_t>> models(3, std::vector<std::int32_t>(size));
            for (std::size_t i = 0; i < size; ++i)
                models[0][i] = static_cast<std::int32_t>(drawn(static_cast<std::int64_t>(i), 0, 9)) * apart;
            std::vector<MapValues> values(3);
            values[0] = models[0];
            values[1] = values[0], models[1] = models[0];
            values[2] = values[0], models[2] = models[0];
            for (std::int64_t step = 0; step < 300; ++step) {
                const std::size_t to = drawn(step, 1, 3), from = drawn(step, 2, 3);
                switch (drawn(step, 3, 8)) {
                    case 0:
                        values[to] = values[from], models[to] = models[from];
                        EXPECT_TRUE(values[to].shares_all_with(values[from]));
                        break;
                    case 1:
                        expect_same(values[to], models[to]);
                        break;
                    case 2:
                        EXPECT_EQ(values[to] == values[from], models[to] == models[from]);
                        if (values[to].shares_all_with(values[from])) {
                            EXPECT_EQ(models[to], models[from]);
                        }
                        break;
                    default: {
                        const std::size_t at = drawn(step, 4, size);
                        const auto value = static_cast<std::int32_t>(drawn(step, 5, 11)) * apart - apart;
                        values[to].set(at, value), models[to][at] = value;
                        EXPECT_EQ(values[to][at], value);
                    }
                }
            }
            for (std::size_t i = 0; i < 3; ++i) expect_same(values[i], models[i]);
        }
}

TEST(MapValues, AWriteLeavesAllButItsNeighboursShared) {
    MapValues before = std::vector<std::int32_t>(1'000'000, 7), after = before;
    after.set(500'000, 8);
    const std::size_t written = after.size() - after.shared_with(before);
    EXPECT_GT(written, 0u);
    EXPECT_LE(written, 1u << 14);
    EXPECT_FALSE(after.shares_all_with(before));
    // What is there already is no write
    MapValues same = before;
    same.set(500'000, 7);
    EXPECT_TRUE(same.shares_all_with(before));
}

TEST(MapValues, FewCodesTakeOneByteEach) {
    std::vector<std::int32_t> values(100'000);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::int32_t>(i % 200) - 1;
    MapValues map = values;
    EXPECT_EQ(map.memory_bytes(), values.size());
    map.set(5, 1 << 30);  // Only those near it take more
    values[5] = 1 << 30;
    EXPECT_LE(map.memory_bytes(), values.size() + 3 * (1u << 14));
    expect_same(map, values);
}

}  // namespace
}  // namespace tessera
