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

TEST(Kernels, BlendIsTheWeightedSum) {
    constexpr std::int32_t width = 37;
    std::vector<std::uint16_t> steps[3], weights[3];
    for (std::int64_t t = 0; t < 3; ++t)
        for (std::int64_t i = 0; i < (width + 3) / 4 * 16; ++i) {
            steps[t].push_back(static_cast<std::uint16_t>(random(i, t)));
            weights[t].push_back(
                static_cast<std::uint16_t>(random(i, t + 10) % 10923));  // three sum to less than one
        }
    const Kernels::BlendTerm terms[] = {{steps[0].data(), weights[0].data()},
                                        {steps[1].data(), weights[1].data()},
                                        {steps[2].data(), weights[2].data()}};
    for (std::size_t k = 0; k < available_kernels().count; ++k) {
        const Kernels& kernel = *available_kernels().items[k];
        std::vector<std::uint32_t> sums(std::size_t(width + 3) * 4);
        kernel.blend(terms, 3, width, sums.data());
        for (std::size_t i = 0; i < std::size_t{width} * 4; ++i) {
            std::uint32_t expected = 0;
            for (std::size_t t = 0; t < 3; ++t) expected += std::uint32_t{steps[t][i]} * weights[t][i];
            ASSERT_EQ(sums[i], expected) << kernel.name;
        }
        std::vector<std::uint8_t> rgba(std::size_t{width} * 4);
        kernel.encode_sums(sums.data(), width, rgba.data());
        for (std::size_t i = 0; i < rgba.size(); ++i)
            ASSERT_EQ(rgba[i], i % 4 == 3 ? 255 : steps_to_srgb()[(sums[i] + 16384) / 32768]) << kernel.name;
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
