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
    for (const std::int32_t size : {4096, 64, 63, 33, 32, 17, 16, 5, 1}) {
        std::vector<std::int32_t> indices, small(table.begin(), table.begin() + size);
        for (const std::int32_t value : values) indices.push_back(value % size);
        kernels->look_up(small.data(), size, indices.data(), 777, out.data());
        for (std::size_t i = 0; i < out.size(); ++i)
            ASSERT_EQ(out[i], table[static_cast<std::size_t>(indices[i])]) << size;
    }
    kernels->look_up_types(table.data(), types.data(), 777, out.data());
    for (std::size_t i = 0; i < out.size(); ++i) ASSERT_EQ(out[i], table[types[i]]);
    kernels->look_up_pairs(table.data(), 4096, 60, values.data(), others.data(), 777, out.data());
    for (std::size_t i = 0; i < out.size(); ++i)
        ASSERT_EQ(out[i], table[static_cast<std::size_t>(values[i] * 60 + others[i])]);
    std::vector<std::int32_t> few(777), fewer(777);
    for (std::size_t i = 0; i < few.size(); ++i) few[i] = values[i] % 16, fewer[i] = others[i] % 3;
    kernels->look_up_pairs(table.data(), 48, 3, few.data(), fewer.data(), 777, out.data());
    for (std::size_t i = 0; i < out.size(); ++i)
        ASSERT_EQ(out[i], table[static_cast<std::size_t>(few[i] * 3 + fewer[i])]);
    for (std::int32_t& value : values) value &= 7;
    const std::int32_t* corners[] = {values.data(), values.data() + 1, values.data() + 2, values.data() + 3};
    kernels->join_corners(corners, 3, 700, out.data());
    for (std::size_t i = 0; i < 700; ++i)
        ASSERT_EQ(out[i], values[i] + values[i + 1] * 8 + values[i + 2] * 64 + values[i + 3] * 512);
}

TEST_P(BlockKernelsTest, CopiesTexels) {
    for (const std::int32_t count : {2, 17, 33, 65, 300}) {
        std::vector<unsigned char> codes(static_cast<std::size_t>(count) * 4), out(4 * 333);
        for (unsigned char& code : codes) code = static_cast<unsigned char>(random());
        std::vector<std::int32_t> images(333);
        for (std::int32_t& image : images)
            image = static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(count)) - 1;
        kernels->copy_texels(codes.data() + 4, -1, count, images.data(), 333, out.data());
        for (std::size_t i = 0; i < out.size(); ++i)
            ASSERT_EQ(out[i], codes[static_cast<std::size_t>(images[i / 4] + 1) * 4 + i % 4]) << count;
    }
}

TEST_P(BlockKernelsTest, NestedThresholdsPickOneOfTheFourNodesByTheirWeights) {
    for (int log2 = 1; log2 <= 16; ++log2) {
        const std::int32_t side = 1 << log2, column = static_cast<std::int32_t>(random() % 7) % side,
                           row = static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(side));
        std::vector<std::int32_t> nodes(2 * 300), out(500);
        for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = static_cast<std::int32_t>(i);
        std::vector<std::uint32_t> thresholds(out.size());
        for (std::uint32_t& threshold : thresholds) threshold = static_cast<std::uint32_t>(random());
        for (const bool across : {true, false}) {
            kernels->dither_nested({500, log2, column, row, across}, thresholds.data(), nodes.data(), 300,
                                   out.data());
            for (std::int32_t i = 0; i < 500; ++i) {
                const std::int64_t left = side - (across ? (column + i) % side : 0), above = side - row;
                const std::int64_t weights[4] = {left * above, (side - left) * above, left * row,
                                                 (side - left) * row};
                std::int64_t rest = thresholds[static_cast<std::size_t>(i)] >> (32 - 2 * log2);
                std::int32_t node = 0;
                while (rest >= weights[node]) rest -= weights[node++];
                ASSERT_EQ(out[static_cast<std::size_t>(i)], (column + i) / side + node % 2 + node / 2 * 300);
            }
        }
    }
}

TEST_P(BlockKernelsTest, DividesAsThePlainSetDoes) {
    std::vector<std::int64_t> sums(203);
    for (std::int64_t& sum : sums) sum = static_cast<std::int64_t>(random() >> 2);
    std::vector<float> out(sums.size());
    kernels->divide(sums.data(), 65535.0 * 255 * 49, 203, out.data());
    for (std::size_t i = 0; i < sums.size(); ++i)
        ASSERT_EQ(out[i], static_cast<float>(static_cast<double>(sums[i]) / (65535.0 * 255 * 49)));
}

TEST_P(BlockKernelsTest, AddsTheColoursOfRuns) {
    std::vector<std::int64_t> table(40);
    for (std::int64_t& value : table) value = static_cast<std::int64_t>(random() >> 19);
    std::vector<std::int32_t> indices(96);
    for (std::int32_t& index : indices) index = static_cast<std::int32_t>(random() % 9) - 1;
    for (const std::int32_t run : {1, 2, 3, 4, 7, 8, 32}) {
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
