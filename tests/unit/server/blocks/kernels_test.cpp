// Every instruction set decides the same, and as the plain definition says.
#include "server/blocks/kernels.h"

#include <random>

#include <gtest/gtest.h>

namespace tessera {
namespace {

class BlockKernelsTest : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        kernels = block_kernels_of(GetParam());
        if (kernels == nullptr) GTEST_SKIP() << "NOT TRIED: this processor does not run " << GetParam();
    }
    const BlockKernels* kernels = nullptr;
    std::mt19937_64 random{11};
};

TEST_P(BlockKernelsTest, DrawsAreTheHashReducedWithoutBias) {
    for (const std::uint32_t count : {1u, 2u, 3u, 16u, 40000u, 49152u, 65535u, 65536u}) {
        for (int i = 0; i < 60; ++i) {
            const RowKey key{random()};
            const auto cells = static_cast<std::int32_t>(1 + random() % 1024);
            const auto x = static_cast<std::uint32_t>(random() % (65536 - 1024));
            std::vector<std::int32_t> out(static_cast<std::size_t>(cells) + 1, -7);
            kernels->draw(key, x, cells, count, out.data());
            ASSERT_EQ(out.back(), -7);
            for (std::uint32_t c = 0; c + 1 < out.size(); ++c) {
                const std::uint64_t product =
                    std::uint64_t{cell_bits(x + c, key.first(), key.second())} * count;
                const bool unfair = static_cast<std::uint32_t>(product) < (std::uint64_t{1} << 32) % count;
                const std::uint32_t draw =
                    unfair ? redraw(key, x + c, count) : static_cast<std::uint32_t>(product >> 32);
                ASSERT_EQ(static_cast<std::uint32_t>(out[c]), draw) << count;
            }
        }
    }
}

TEST_P(BlockKernelsTest, DitheringMovesByJitters) {
    for (int cells_log2 = 1; cells_log2 <= 16; ++cells_log2) {
        for (int i = 0; i < 20; ++i) {
            const std::uint32_t side = 1u << cells_log2;
            const auto column = static_cast<std::uint32_t>(random() % side);
            const auto row = static_cast<std::uint32_t>(random() % side);
            BlockKernels::DitherRun run{.key = RowKey{random()},
                                        .x = static_cast<std::uint32_t>(random() % 60000),
                                        .cells = static_cast<std::int32_t>(std::min(1024u, side - column)),
                                        .cells_log2 = cells_log2,
                                        .column = column,
                                        .down = (side - row) << (16 - cells_log2),
                                        .nodes = {1, 2, 3, 4}};
            std::vector<std::int32_t> out(static_cast<std::size_t>(run.cells)), close(out.size());
            kernels->dither(run, out.data());
            const std::int32_t nodes[] = {1, 2, 0, 3, 4, 0};
            kernels->dither_close(run, nodes, 3, close.data());
            for (std::uint32_t c = 0; c < out.size(); ++c) {
                const std::uint32_t bits = cell_bits(run.x + c, run.key.first(), run.key.second());
                const std::uint32_t jitter_x = (bits & 0xffff) >> (16 - cells_log2);
                const std::uint32_t jitter_y = (bits >> 16) >> (16 - cells_log2);
                const int expected =
                    1 + (column + c + jitter_x >= side ? 1 : 0) + (row + jitter_y >= side ? 2 : 0);
                ASSERT_EQ(out[c], expected);
                ASSERT_EQ(close[c], expected);
            }
        }
    }
}

TEST_P(BlockKernelsTest, LooksUpAndJoinsCorners) {
    std::vector<std::int32_t> table(4096), values(777), others(777), out(777);
    for (std::int32_t& entry : table) entry = static_cast<std::int32_t>(random() % 1000) - 1;
    std::vector<std::uint16_t> types(777);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = static_cast<std::int32_t>(random() % 64);
        others[i] = static_cast<std::int32_t>(random() % 60);
        types[i] = static_cast<std::uint16_t>(random() % 4096);
    }
    kernels->look_up(table.data(), values.data(), 777, out.data());
    for (std::size_t i = 0; i < out.size(); ++i)
        ASSERT_EQ(out[i], table[static_cast<std::size_t>(values[i])]);
    kernels->look_up_types(table.data(), types.data(), 777, out.data());
    for (std::size_t i = 0; i < out.size(); ++i) ASSERT_EQ(out[i], table[types[i]]);
    kernels->look_up_pairs(table.data(), 60, values.data(), others.data(), 777, out.data());
    for (std::size_t i = 0; i < out.size(); ++i)
        ASSERT_EQ(out[i], table[static_cast<std::size_t>(values[i] * 60 + others[i])]);
    for (std::int32_t& value : values) value &= 7;
    const std::int32_t* corners[] = {values.data(), values.data() + 1, values.data() + 2, values.data() + 3};
    kernels->join_corners(corners, 3, 700, out.data());
    for (std::size_t i = 0; i < 700; ++i)
        ASSERT_EQ(out[i], values[i] + values[i + 1] * 8 + values[i + 2] * 64 + values[i + 3] * 512);
}

TEST_P(BlockKernelsTest, AddsTheColoursOfRuns) {
    std::vector<std::int64_t> table(40);
    for (std::int64_t& value : table) value = static_cast<std::int64_t>(random() >> 19);
    std::vector<std::int32_t> indices(96);
    for (std::int32_t& index : indices) index = static_cast<std::int32_t>(random() % 9) - 1;
    for (const std::int32_t run : {1, 2, 3, 4, 8, 32}) {
        std::vector<std::int64_t> sums(4 * 3, 5), expected = sums;
        for (std::int32_t i = 0; i < 3 * run; ++i)
            for (int c = 0; c < 4; ++c)
                expected[static_cast<std::size_t>(i / run * 4 + c)] +=
                    table[static_cast<std::size_t>((indices[static_cast<std::size_t>(i)] + 1) * 4 + c)];
        kernels->add_colours(table.data() + 4, indices.data(), run, 3, sums.data());
        ASSERT_EQ(sums, expected) << run;
    }
}

TEST_P(BlockKernelsTest, NestsAsThePlainSetDoes) {
    const BlockKernels& plain = *block_kernels_of("x86-64");
    std::vector<std::uint32_t> first(500), second(500), digits(500);
    for (std::size_t i = 0; i < digits.size(); ++i) {
        first[i] = static_cast<std::uint32_t>(random());
        second[i] = static_cast<std::uint32_t>(random());
        digits[i] = static_cast<std::uint32_t>(random() & 0xffff);
    }
    auto expected = digits;
    plain.nest(first.data(), second.data(), 12345, 3, 2, 500, expected.data());
    kernels->nest(first.data(), second.data(), 12345, 3, 2, 500, digits.data());
    EXPECT_EQ(digits, expected);
}

INSTANTIATE_TEST_SUITE_P(Sets, BlockKernelsTest, testing::Values("x86-64", "avx2", "avx512"),
                         [](const auto& name) {
                             std::string text{name.param};
                             std::erase(text, '-');
                             return text;
                         });

}  // namespace
}  // namespace tessera
