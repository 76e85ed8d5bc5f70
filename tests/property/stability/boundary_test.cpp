// A texel is what it is, in whatever region it is asked for: at borders of pages, tiles and cells, at the
// origin, in negative regions and across 2^38, at every level.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/property/stability/places.h"
#include "tests/property/stability/subjects.h"

namespace tessera::tests {
namespace {

struct Answer {
    LinearImage linear;
    Rgba8Image codes;
};

Answer answer_of(const Subject& subject, const TexelRegion& region, Accuracy accuracy) {
    Answer answer;
    const Budget budget{.accuracy = accuracy};
    EXPECT_TRUE(subject.texture->evaluate(region, budget, answer.linear)) << subject.name;
    EXPECT_TRUE(subject.texture->evaluate(region, budget, answer.codes)) << subject.name;
    return answer;
}

/// What two regions have in common, and how far apart it is: in codes of linear light.
struct Compared {
    std::size_t texels = 0, different = 0;
    double apart = 0;
};

void compare(const TexelRegion& a, const Answer& of_a, const TexelRegion& b, const Answer& of_b,
             Compared& sum) {
    const std::int64_t left = std::max(a.x, b.x), right = std::min(a.x + a.width, b.x + b.width),
                       top = std::max(a.y, b.y), bottom = std::min(a.y + a.height, b.y + b.height);
    ASSERT_LT(left, right);
    ASSERT_LT(top, bottom);
    sum.texels += static_cast<std::size_t>((right - left) * (bottom - top));
    for (std::int64_t y = top; y < bottom; ++y)
        for (std::int64_t i = 4 * left; i < 4 * right; ++i) {
            const auto row_a = static_cast<std::int32_t>(y - a.y), row_b = static_cast<std::int32_t>(y - b.y);
            const std::int64_t at_a = i - 4 * a.x, at_b = i - 4 * b.x;
            const float one = of_a.linear.row(row_a)[at_a], other = of_b.linear.row(row_b)[at_b];
            const bool same_code = of_a.codes.row(row_a)[at_a] == of_b.codes.row(row_b)[at_b];
            const double apart = std::abs(double{one} - double{other}) / code_in_linear;
            sum.different += one != other || !same_code;
            sum.apart = std::max(sum.apart, apart);
        }
}

/// The whole, its four quarters, one that is shifted by odd numbers, one that is larger, a row and a column.
std::vector<TexelRegion> cuts_of(const TexelRegion& whole) {
    const std::int32_t w = whole.width / 2, h = whole.height / 2;
    const auto cut = [&](std::int32_t x, std::int32_t y, std::int32_t width, std::int32_t height) {
        TexelRegion region = whole;
        region.x += x;
        region.y += y;
        region.width = width;
        region.height = height;
        return region;
    };
    return {cut(0, 0, w, h),
            cut(w, 0, whole.width - w, h),
            cut(0, h, w, whole.height - h),
            cut(w, h, whole.width - w, whole.height - h),
            cut(-3, 1, whole.width, whole.height),
            cut(-5, -7, whole.width + 9, whole.height + 12),
            cut(0, h, whole.width, 1),
            cut(w - 1, 0, 1, whole.height)};
}

TEST(Boundaries, ATexelIsTheSameInEveryRegionAtEveryLevel) {
    std::size_t textures = 0, texels = 0;
    for (const Subject& subject : subjects()) {
        Compared all;
        std::string first;
        const std::int32_t side = std::min(subject.side, 16);
        for (std::uint8_t level = 0; level <= max_level; ++level) {
            // The middle of each square is a border of everything: 0, ±2^38 at this level; or it is none
            const std::int64_t far = std::int64_t{1} << (38 - level);
            const std::int64_t odd = std::int64_t{76543210987} >> level;
            const std::pair<std::int64_t, std::int64_t> middles[] = {
                {0, 0}, {far, -far}, {-odd, far / 2}, {256, odd}};
            const auto& [x, y] = middles[(level + textures) % 4];
            for (const auto& middle : {std::pair{x, y}, middles[level % 2 == 0 ? 0 : 1]}) {
                TexelRegion whole{level, middle.first - side / 2, middle.second - side / 2, side, side};
                if (subject.has_slices) whole.slice = -3;
                const Accuracy accuracy = subject.accuracy_at(level);
                const Answer answer = answer_of(subject, whole, accuracy);
                for (const TexelRegion& cut : cuts_of(whole)) {
                    compare(whole, answer, cut, answer_of(subject, cut, accuracy), all);
                    if (first.empty() && all.different > 0) {
                        first = "first at level " + std::to_string(level) + ", cut " +
                                std::to_string(cut.x - whole.x) + "," + std::to_string(cut.y - whole.y) +
                                " " + std::to_string(cut.width) + "x" + std::to_string(cut.height);
                    }
                }
            }
        }
        EXPECT_EQ(all.different, 0U) << subject.name << ", up to " << all.apart << " codes; " << first;
        texels += all.texels;
        ++textures;
    }
    std::cout << texels << " texels of " << textures
              << " textures are the same in every region, bit for bit\n";
}

TEST(Boundaries, APageIsTheMiddleOfItselfWithAGutter) {
    std::size_t pages = 0;
    const std::vector<Subject> all = subjects();
    for (std::size_t s = 0; s < all.size(); ++s) {
        if (all[s].side < 20) continue;  // Dear: the cuts above see what these would
        const auto level = static_cast<std::uint8_t>(s * 7 % 31);
        const std::uint32_t last = Extent{max_level}.side_pages(level) - 1;
        const PageKey key{level, s % 2 == 0 ? last : 0, last / 3};
        const Answer page = answer_of(all[s], region_of(key), Accuracy::high);
        for (const std::int32_t gutter : {1, max_gutter_texels}) {
            Compared compared;
            compare(region_of(key), page, region_of(key, gutter),
                    answer_of(all[s], region_of(key, gutter), Accuracy::high), compared);
            EXPECT_EQ(compared.different, 0U) << all[s].name << ", gutter " << gutter;
            EXPECT_EQ(compared.texels, 65536U);
        }
        ++pages;
    }
    std::cout << pages << " pages are the same with gutters of 1 and of 16 texels\n";
}

}  // namespace
}  // namespace tessera::tests
