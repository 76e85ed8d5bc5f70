// Partition of unity: what is mixed of one colour is that colour, to the last bit, at every level, place and
// accuracy, whatever mixes.
#include <array>
#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "shared/math/srgb.h"
#include "tests/property/stability/places.h"
#include "tests/property/stability/subjects.h"

namespace tessera::tests {
namespace {

class PartitionOfUnity : public testing::TestWithParam<int> {};

TEST_P(PartitionOfUnity, AConstantStaysConstantToTheLastBit) {
    const auto code = static_cast<std::uint8_t>(GetParam());
    const float expected = from_srgb(code);
    const std::vector<Subject> all = constant_subjects(code);
    std::size_t texels = 0, textures = 0;
    double rounded = 0;
    for (const Subject& subject : all) {
        std::size_t wrong = 0;
        double worst = 0;
        for (std::uint8_t level = 0; level <= max_level; ++level)
            for (std::size_t place = 0; place < places_count; ++place) {
                TexelRegion region = region_at(level, place, std::min(subject.side, 8));
                const Budget budget{.accuracy =
                                        subject.accuracy_at(static_cast<std::uint8_t>(level + place))};
                LinearImage linear;
                Rgba8Image codes;
                ASSERT_TRUE(subject.texture->evaluate(region, budget, linear)) << subject.name;
                ASSERT_TRUE(subject.texture->evaluate(region, budget, codes)) << subject.name;
                for (std::size_t i = 0; i < linear.values.size(); ++i) {
                    const float value = i % 4 == 3 ? 1.0F : expected;
                    wrong += linear.values[i] != value;
                    worst = std::max(worst, std::abs(double{linear.values[i]} - double{value}));
                    ASSERT_EQ(codes.bytes[i], i % 4 == 3 ? 255 : code)
                        << subject.name << ", level " << int{level} << ", place " << place;
                }
                texels += linear.values.size() / 4;
            }
        if (subject.composites) {
            // Of a·c + (1 − a)·c each part is rounded to a 65535th
            EXPECT_LT(worst * 65535, 1.1) << subject.name;
            rounded = std::max(rounded, worst);
        } else {
            EXPECT_EQ(wrong, 0U) << subject.name << " is up to " << worst << " off";
            ++textures;
        }
    }
    std::cout << "code " << int{code} << ": " << texels << " texels of " << all.size()
              << " textures, bit for bit in " << textures << ", within " << rounded / code_in_linear
              << " of a code in those that composite\n";
}

INSTANTIATE_TEST_SUITE_P(Codes, PartitionOfUnity, testing::Values(1, 93, 200));

}  // namespace
}  // namespace tessera::tests
