#include "server/texture/kernels.h"

#include <algorithm>
#include <cmath>
#include <utility>
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

TEST(Kernels, EncodeGivesTheNearestCodeOfEveryStepAndFromTheFirstFloatOfIt) {
    std::vector<float> rgb{-INFINITY, -1.0F, INFINITY, 2.0F, NAN, -0.0F};
    for (int step = 0; step < 65536; ++step) {
        const float middle = static_cast<float>(step) / linear_one;
        float first = (static_cast<float>(step) - 0.5F) / linear_one;
        while (to_steps(first) < step) first = std::nextafter(first, 2.0F);
        rgb.insert(rgb.end(), {middle, first, std::nextafter(first, -1.0F)});
    }
    std::vector<std::uint8_t> rgba(rgb.size() / 3 * 4);
    for (std::size_t k = 0; k < available_kernels().count; ++k) {
        available_kernels().items[k]->encode(rgb.data(), static_cast<std::int32_t>(rgb.size() / 3),
                                             rgba.data());
        for (std::size_t i = 0; i < rgb.size(); ++i)
            ASSERT_EQ(rgba[i / 3 * 4 + i % 3], steps_to_srgb()[to_steps(rgb[i])])
                << available_kernels().items[k]->name << " of " << rgb[i];
    }
}

TEST(Kernels, EncodeBlendedGivesTheNearestCodeOfEveryStep) {
    constexpr std::int32_t width = 65536 / 3 + 1;
    const std::vector<std::uint8_t> tile(std::size_t{width} * 4 + 32, 0);
    for (std::size_t k = 0; k < available_kernels().count; ++k) {
        std::vector<std::int32_t> sums(std::size_t{width} * 4);
        for (int step = 0; step < 65536; ++step) sums[std::size_t(step / 3 * 4 + step % 3)] = step * 32768;
        std::vector<std::uint8_t> rgba(std::size_t{width} * 4);
        const Kernels::BlendedRun run{sums.data(), tile.data(), rgba.data(), width};
        available_kernels().items[k]->encode_blended(&run, 1);
        for (std::size_t step = 0; step < 65536; ++step)
            ASSERT_EQ(rgba[step / 3 * 4 + step % 3], steps_to_srgb()[step])
                << available_kernels().items[k]->name;
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
        std::vector<Kernels::BlendRun<std::uint8_t>> runs;
        for (std::size_t t = 0; t < 2; ++t)
            runs.push_back({content[t].data(), tile.data(), weights[t].data(), sums.data(), width});
        kernel.blend(runs.data(), runs.size());
        std::vector<std::uint8_t> rgba(std::size_t{width} * 4);
        std::vector<std::int32_t> encoded = sums;
        // Two runs, and neither writes on
        constexpr std::int32_t before = 19;
        const Kernels::BlendedRun encodings[] = {
            {encoded.data() + before * 4, tile.data() + before * 4, rgba.data() + before * 4, width - before},
            {encoded.data(), tile.data(), rgba.data(), before}};
        kernel.encode_blended(encodings, 2);
        ASSERT_EQ(std::count(encoded.begin(), encoded.begin() + width * 4, 0), width * 4) << kernel.name;
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

TEST(Kernels, CopiesRunsOfEveryWidthOneAfterTheOtherAndNoMore) {
    std::vector<std::uint8_t> from;
    for (std::int64_t i = 0; i < 4096; ++i) from.push_back(static_cast<std::uint8_t>(random(i, 400)));
    for (std::size_t k = 0; k < available_kernels().count; ++k) {
        std::vector<std::uint8_t> to(from.size(), 77), expected = to;
        std::vector<Kernels::CopyRun> runs;
        for (std::int32_t width = 1; width < 50; ++width) {
            // Later ones over earlier ones
            const std::ptrdiff_t source = width * 17 % 500 * 4, target = width * 31 % 700 * 4;
            runs.push_back({from.data() + source, to.data() + target, width});
            std::copy_n(from.begin() + source, width * 4, expected.begin() + target);
        }
        available_kernels().items[k]->copy(runs.data(), runs.size());
        ASSERT_EQ(to, expected) << available_kernels().items[k]->name;
    }
}

TEST(Kernels, BlendStepsAddsTheSameOfSteps) {
    constexpr std::int32_t width = 37;
    std::vector<std::uint16_t> content, tile, weights;
    for (std::int64_t i = 0; i < width * 4; ++i) {
        content.push_back(static_cast<std::uint16_t>(random(i, 300)));
        tile.push_back(static_cast<std::uint16_t>(random(i, 301)));
        if (i < width) weights.push_back(static_cast<std::uint16_t>(random(i, 302) % 32768));
    }
    for (std::size_t k = 0; k < available_kernels().count; ++k) {
        std::vector<std::int32_t> sums(std::size_t{width} * 4, 5);
        const Kernels::BlendRun<std::uint16_t> run{content.data(), tile.data(), weights.data(), sums.data(),
                                                   width};
        available_kernels().items[k]->blend_steps(&run, 1);
        for (std::size_t i = 0; i < sums.size(); ++i)
            ASSERT_EQ(sums[i], 5 + std::int64_t{weights[i / 4]} * (std::int64_t{content[i]} - tile[i]))
                << available_kernels().items[k]->name;
    }
}

TEST(Kernels, SpansAreAddedWhereTheyFallInsideTheRow) {
    const StampSpans::Span spans[] = {{-4, 9, 0}, {2, 2, 5}, {3, 8, 5}};
    std::vector<float> values;
    for (std::int64_t i = 0; i < 56; ++i)  // rows of 39 and 15 floats, padded to 40 and 16 with zeros
        values.push_back(i == 39 || i == 55 ? 0.0F : float(random(i) >> 50) / 1024.0F);
    for (std::size_t k = 0; k < available_kernels().count; ++k) {
        const Kernels& kernel = *available_kernels().items[k];
        for (std::int64_t x = -12; x < 12; ++x) {
            constexpr std::int32_t width = 7;
            std::vector<float> rgb(std::size_t{width} * 3 * 3 + StampSpans::row_floats, 0.25F);
            std::size_t expected_count = 0;
            const std::size_t count =
                kernel.add_spans(spans, 3, values.data(), x, width, rgb.data(), width * 3);
            for (std::int32_t row = 0; row < 3; ++row)
                for (std::int32_t column = 0; column < width; ++column) {
                    const bool inside = column - x >= spans[row].begin && column - x < spans[row].end;
                    expected_count += inside ? 1 : 0;
                    const auto from =
                        static_cast<std::size_t>(std::int64_t{spans[row].offset} * StampSpans::row_floats +
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

TEST(Kernels, ABoxIsAddedRowByRowAndNothingBesideIt) {
    constexpr std::ptrdiff_t stride = 60;
    std::vector<float> values;
    for (std::int64_t i = 0; i < 5 * 48; ++i) values.push_back(float(random(i, 500) >> 50) / 1024.0F);
    for (std::size_t k = 0; k < available_kernels().count; ++k)
        for (std::int32_t vectors = 0; vectors <= 6; ++vectors) {
            std::vector<float> rgb(std::size_t{6 * stride}, 0.25F);
            available_kernels().items[k]->add_box(values.data(), vectors, 5, rgb.data() + 3, stride);
            for (std::ptrdiff_t i = 0; i < std::ssize(rgb); ++i) {
                const std::ptrdiff_t row = i / stride, column = i % stride - 3, across = vectors * 8;
                const bool inside = row < 5 && column >= 0 && column < across;
                ASSERT_EQ(rgb[std::size_t(i)],
                          0.25F + (inside ? values[std::size_t(row * across + column)] : 0.0F))
                    << available_kernels().items[k]->name << ", " << i;
            }
        }
}

/// Units of a kind, and a band of rows under them.
struct UnitsShown {
    std::int32_t unit_side, image_side, first, count;
    std::size_t across;
    std::size_t row_floats() const { return (std::size_t(image_side) * 3 + 7) / 8 * 8; }
};

/// From left to right, of each unit what it shows itself and then what hangs over from the one above it.
void expect_variants(const Kernels& kernel, const UnitsShown& shown) {
    constexpr std::uint16_t type_count = 7;
    const std::size_t row_floats = shown.row_floats();
    std::vector<float> images(std::size_t{type_count} * std::size_t(shown.image_side) * row_floats + 16);
    for (std::size_t i = 0; i + 16 < images.size(); ++i)
        if (i % row_floats < std::size_t(shown.image_side) * 3)
            images[i] = float(random(std::int64_t(i), 600) >> 40) / float(1 << 24) - 0.5F;
    const auto down = std::size_t((shown.first + shown.count - 1) / shown.unit_side + 1);
    std::vector<std::uint16_t> types;
    for (std::int64_t i = 0; i < std::int64_t((down + 1) * shown.across); ++i)
        types.push_back(static_cast<std::uint16_t>(random(i, 601) % type_count));

    Kernels::VariantBand band;
    band.types = types.data() + shown.across;
    band.types_stride = std::ptrdiff_t(shown.across);
    band.units_across = shown.across;
    band.units_down = down;
    band.images = images.data();
    band.row_floats = row_floats;
    band.unit_side = shown.unit_side;
    band.image_side = shown.image_side;
    band.first = shown.first;
    band.count = shown.count;
    // The last unit may have one texel in the row
    const std::size_t stride = ((shown.across - 1) * std::size_t(shown.unit_side) + 1) * 3 + row_floats;
    std::vector<float> rgb;
    for (std::int64_t i = 0; i < std::int64_t(stride) * shown.count; ++i)
        rgb.push_back(float(random(i, 602) >> 40) / float(1 << 24));
    std::vector<float> expected = rgb;
    kernel.add_variants(band, rgb.data(), std::ptrdiff_t(stride));
    for (std::int32_t row = 0; row < shown.count; ++row) {
        const std::int32_t y = (shown.first + row) % shown.unit_side;
        const std::uint16_t* own =
            types.data() + std::size_t((shown.first + row) / shown.unit_side + 1) * shown.across;
        float* const out = expected.data() + std::size_t(row) * stride;
        for (std::size_t column = 0; column < shown.across; ++column)
            for (const auto& [type, line] :
                 {std::pair{own[column], y}, std::pair{*(own + column - shown.across), y + shown.unit_side}})
                for (std::size_t i = 0; line < shown.image_side && i < row_floats; ++i)
                    out[column * std::size_t(shown.unit_side) * 3 + i] +=
                        images[(type * std::size_t(shown.image_side) + std::size_t(line)) * row_floats + i];
        const std::size_t in_row = ((shown.across - 1) * std::size_t(shown.unit_side) + 1) * 3;
        for (std::size_t i = 0; i < in_row; ++i)
            ASSERT_EQ(rgb[std::size_t(row) * stride + i], out[i])
                << kernel.name << ", units of " << shown.unit_side << ", images of " << shown.image_side
                << ", row " << row << ", float " << i;
    }
}

TEST(Kernels, VariantsAreAddedFromLeftToRightEachWithWhatHangsOverFromAbove) {
    for (std::size_t k = 0; k < available_kernels().count; ++k)
        for (std::int32_t unit_side = 1; unit_side <= 16; unit_side *= 2)
            for (std::int32_t image_side = unit_side; image_side <= 2 * unit_side; ++image_side)
                for (std::int32_t first = 0; first < std::min(unit_side, 3); ++first)
                    for (const std::int32_t count : {1, 6, 16})
                        for (const std::size_t across : {1, 2, 9})
                            expect_variants(*available_kernels().items[k],
                                            {unit_side, image_side, first, count, across});
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
        std::vector<float> rgb(std::size_t{width} * 3 + 1);
        const float base[4] = {0.5F, 0.5F, 0.5F, 0.5F};
        float hanging[width + 1][2][4];
        for (std::size_t x = 0; x <= std::size_t{width}; ++x)
            std::copy_n(&table[above[x]].part[2][0], 8, &hanging[x][0][0]);
        kernel.add_nodes(table.data(), row.data(), base, hanging, width, rgb.data());
        for (std::size_t x = 0; x < std::size_t{width}; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(rgb[x * 3 + c],
                            0.5 + table[row[x + 1]].part[0][c] + table[row[x]].part[1][c] +
                                table[above[x + 1]].part[2][c] + table[above[x]].part[3][c],
                            1e-6)
                    << kernel.name;
        for (std::size_t x = 0; x <= std::size_t{width}; ++x)
            for (std::size_t i = 0; i < 8; ++i)
                ASSERT_EQ(hanging[x][i / 4][i % 4], table[row[x]].part[2 + i / 4][i % 4]) << kernel.name;
    }
}

}  // namespace
}  // namespace tessera
