#include "server/filter/summed_area.h"

#include <random>

#include <gtest/gtest.h>

namespace tessera {
namespace {

SummedArea table_of(std::int32_t width, std::int32_t height, const std::vector<std::uint16_t>& steps) {
    SummedArea table{width, height};
    for (std::int32_t y = 0; y < height; ++y)
        table.set_row(y, &steps[std::size_t(y) * std::size_t(width) * 4]);
    return table;
}

TEST(SummedArea, SumsEveryBoxExactly) {
    std::mt19937 random{7};
    const std::int32_t width = 37, height = 23;
    std::vector<std::uint16_t> steps(4 * 37 * 23);
    for (auto& s : steps) s = static_cast<std::uint16_t>(random());
    const SummedArea table = table_of(width, height, steps);
    for (int trial = 0; trial < 300; ++trial) {
        std::int32_t x0 = std::int32_t(random() % 38), x1 = std::int32_t(random() % 38);
        std::int32_t y0 = std::int32_t(random() % 24), y1 = std::int32_t(random() % 24);
        if (x0 > x1) std::swap(x0, x1);
        if (y0 > y1) std::swap(y0, y1);
        SummedArea::Sums expected{};
        for (std::int32_t y = y0; y < y1; ++y)
            for (std::int32_t x = x0; x < x1; ++x)
                for (std::size_t c = 0; c < 4; ++c) expected[c] += steps[std::size_t(y * width + x) * 4 + c];
        EXPECT_EQ(table.sum(x0, y0, x1, y1), expected);
    }
}

TEST(SummedArea, SumsBoxesWhoseTotalLeaves32Bits) {
    const std::int32_t side = 1200;
    const std::vector<std::uint16_t> steps(std::size_t(4) * 1200 * 1200, 65535);
    const SummedArea table = table_of(side, side, steps);
    for (const std::size_t c : {0u, 3u}) {
        EXPECT_EQ(table.sum(0, 0, side, side)[c], std::uint64_t{65535} * 1200 * 1200);
        EXPECT_EQ(table.sum(3, 5, 1027, 1029)[c], std::uint64_t{65535} << 20);
    }
    // The largest box that one difference holds
    EXPECT_EQ(SummedArea::small(table.line(900), table.line(1156), 944, 1200, 1), 65535u << 16);
}

}  // namespace
}  // namespace tessera
