#include "server/texture/kernels.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "shared/math/hash.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

std::uint64_t random(std::int64_t i, std::int64_t of = 0) { return hash(99, stream("kernels test"), i, of); }

TEST(Kernels, EncodeClampsAndRoundsLikeTheTableForEveryWidth) {
    for (std::size_t k = 0; k < available_kernels().count; ++k) {
        const Kernels& kernel = *available_kernels().items[k];
        for (std::int32_t width = 1; width < 140; ++width) {
            std::vector<float> rgb(std::size_t(width) * 3);
            for (std::size_t i = 0; i < rgb.size(); ++i)
                rgb[i] =
                    static_cast<float>(random(std::int64_t(i), width) >> 40) / float(1 << 24) * 1.4F - 0.2F;
            rgb[0] = NAN;
            std::vector<std::uint8_t> rgba(std::size_t(width) * 4 + 1, 77);
            kernel.encode(rgb.data(), width, rgba.data());
            for (std::size_t i = 0; i < rgb.size(); ++i)
                ASSERT_EQ(rgba[i / 3 * 4 + i % 3], steps_to_srgb()[to_steps(rgb[i])]) << kernel.name;
            ASSERT_EQ(rgba[3], 255);
            ASSERT_EQ(rgba.back(), 77) << "wrote past the row";
        }
    }
}

TEST(Kernels, BlendAddsTheWeightedDifferenceFromTheTile) {
    constexpr std::int32_t width = 37;
    std::vector<std::uint8_t> tile, content[2];
    std::vector<std::uint16_t> weights[2];
    for (std::int64_t i = 0; i < width * 4; ++i) {
        tile.push_back(static_cast<std::uint8_t>(random(i)));
        for (std::int64_t t = 0; t < 2; ++t) {
            content[t].push_back(static_cast<std::uint8_t>(random(i, t)));
            // Two sum to no more than one
            if (i < width) weights[t].push_back(static_cast<std::uint16_t>(random(i, t + 10) % 16385));
        }
    }
    // Kernels may read on for eight texels
    for (auto* texels : {&tile, &content[0], &content[1]}) texels->resize(texels->size() + 32);
    for (std::size_t k = 0; k < available_kernels().count; ++k) {
        const Kernels& kernel = *available_kernels().items[k];
        std::vector<std::int32_t> sums(std::size_t{width} * 4 + 32);
        for (std::size_t t = 0; t < 2; ++t)
            kernel.blend(content[t].data(), tile.data(), weights[t].data(), width, sums.data());
        std::vector<std::uint8_t> rgba(std::size_t{width} * 4);
        kernel.encode_blended(sums.data(), tile.data(), width, rgba.data());
        for (std::size_t i = 0; i < std::size_t{width} * 4; ++i) {
            if (i % 4 == 3) {
                ASSERT_EQ(rgba[i], 255);
                continue;
            }
            const std::int64_t first = weights[0][i / 4], second = weights[1][i / 4],
                               under = srgb_to_steps[tile[i]];
            const std::int64_t blended = first * srgb_to_steps[content[0][i]] +
                                         second * srgb_to_steps[content[1][i]] +
                                         (32768 - first - second) * under;
            ASSERT_EQ(sums[i], blended - std::int64_t{32768} * under) << kernel.name;
            ASSERT_EQ(rgba[i], steps_to_srgb()[std::size_t((blended + 16384) / 32768)]) << kernel.name;
        }
    }
}

TEST(Kernels, SpansAreAddedWhereTheyFallInsideTheRow) {
    const Stamps::Span spans[] = {{-4, 9, 0}, {2, 2, 5}, {3, 8, 5}};
    std::vector<float> values;
    for (std::int64_t i = 0; i < 56; ++i)  // rows of 39 and 15 floats, padded to 40 and 16 with zeros
        values.push_back(i == 39 || i == 55 ? 0.0F : float(random(i) >> 50) / 1024.0F);
    for (std::size_t k = 0; k < available_kernels().count; ++k) {
        const Kernels& kernel = *available_kernels().items[k];
        for (std::int64_t x = -12; x < 12; ++x) {
            constexpr std::int32_t width = 7;
            std::vector<float> rgb(std::size_t{width} * 3 * 3 + Stamps::row_floats, 0.25F);
            std::size_t expected_count = 0;
            const std::size_t count =
                kernel.add_spans(spans, 3, values.data(), x, width, rgb.data(), width * 3);
            for (std::int32_t row = 0; row < 3; ++row)
                for (std::int32_t column = 0; column < width; ++column) {
                    const bool inside = column - x >= spans[row].begin && column - x < spans[row].end;
                    expected_count += inside ? 1 : 0;
                    const auto from =
                        static_cast<std::size_t>(std::int64_t{spans[row].offset} * Stamps::row_floats +
                                                 (column - x - spans[row].begin) * 3);
                    for (std::size_t c = 0; c < 3; ++c)
                        ASSERT_EQ(rgb[std::size_t(row * width + column) * 3 + c],
                                  0.25F + (inside ? values[from + c] : 0.0F))
                            << kernel.name;
                }
            EXPECT_EQ(count, expected_count);
        }
    }
}

TEST(Kernels, NodesAddOwnAndWhatHangsOverFromThreeNeighbours) {
    std::vector<NodeTables::Sums> table(64);
    for (std::size_t t = 0; t < table.size(); ++t)
        for (std::size_t part = 0; part < 4; ++part)
            for (std::size_t c = 0; c < 3; ++c)
                table[t].part[part][c] =
                    float(random(std::int64_t(t), std::int64_t(part * 4 + c)) >> 50) / 65536.0F;
    constexpr std::int32_t width = 19;
    std::vector<std::uint16_t> row, above;
    for (std::int64_t i = 0; i <= width; ++i) {
        row.push_back(static_cast<std::uint16_t>(random(i, 200) % 64));
        above.push_back(static_cast<std::uint16_t>(random(i, 201) % 64));
    }
    for (std::size_t k = 0; k < available_kernels().count; ++k) {
        const Kernels& kernel = *available_kernels().items[k];
        std::vector<float> rgb(std::size_t{width} * 3, 0.5F);
        kernel.add_nodes(table.data(), row.data(), above.data(), width, rgb.data());
        for (std::size_t x = 0; x < std::size_t{width}; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(rgb[x * 3 + c],
                            0.5 + table[row[x + 1]].part[0][c] + table[row[x]].part[1][c] +
                                table[above[x + 1]].part[2][c] + table[above[x]].part[3][c],
                            1e-6)
                    << kernel.name;
    }
}

}  // namespace
}  // namespace tessera
