#include <chrono>

#include <gtest/gtest.h>

#include "server/pattern/pattern_texture.h"
#include "server/pattern/pixel_map_texture.h"
#include "server/pattern/sparse_map.h"
#include "server/texture/constant_texture.h"
#include "tests/unit/server/pattern/laws.h"
#include "tests/unit/server/pattern/made_programs.h"

namespace tessera {
namespace {

using namespace testing;

/// Blobs of families on a map of any size.
StoredMap made_map(std::int32_t width, std::int32_t height, int families, StoredMap::Edge edge,
                   int texels_log2, int blob = 11) {
    std::vector<std::int32_t> values;
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x)
            values.push_back(static_cast<std::int32_t>(uniform_below(
                hash(4, stream("map"), (x + y % 3) / blob, y / blob), std::uint32_t(families))));
    return {.width = width, .height = height, .values = values, .edge = edge, .cells_log2 = texels_log2};
}

TEST(SparseMap, CountsEverySquareExactly) {
    for (const auto edge : {StoredMap::Edge::wrap, StoredMap::Edge::clamp})
        for (const auto& [width, height, families] :
             {std::tuple{64, 64, 3}, {37, 101, 4}, {1, 5, 2}, {130, 70, 20}}) {
            const StoredMap map = made_map(width, height, families, edge, 0);
            const SparseMap sparse{map, std::size_t(families)};
            for (std::int32_t y = -40; y < 150; y += 7)
                for (std::int32_t x = -150; x < 150; ++x) ASSERT_EQ(sparse.at(x, y), map.entry(x, y));
            for (const int k : {1, 3, 5, 6, 7})
                for (int family = 0; family < families; family += 2) {
                    const auto shares = sparse.shares(std::uint8_t(family), k, -3, -2, 5, 6);
                    for (std::int64_t j = 0; j < 6; ++j)
                        for (std::int64_t i = 0; i < 5; ++i) {
                            const std::int64_t side = std::int64_t{1} << k;
                            std::int64_t count = 0;
                            for (std::int64_t y = (j - 2) * side; y < (j - 1) * side; ++y)
                                for (std::int64_t x = (i - 3) * side; x < (i - 2) * side; ++x)
                                    count += map.entry(x, y) == family;
                            ASSERT_EQ(shares[std::size_t(j * 5 + i)],
                                      float(double(count) / double(side * side)))
                                << width << "x" << height << " k " << k << " family " << family;
                        }
                }
        }
}

TEST(SparseMap, SharesFarOutSumToOne) {
    for (const auto edge : {StoredMap::Edge::wrap, StoredMap::Edge::clamp}) {
        const SparseMap sparse{made_map(300, 200, 4, edge, 0), 4};
        for (const int k : {9, 20, 30}) {
            double sum = 0;
            for (std::uint8_t family = 0; family < 4; ++family)
                sum += double{sparse.shares(family, k, -(std::int64_t{1} << (39 - k)), 5, 2, 2)[3]};
            EXPECT_NEAR(sum, 1, 1e-6) << k;
        }
    }
}

TEST(SparseMap, CostsMemoryAtBordersOnly) {
    const SparseMap plain{made_map(2048, 2048, 1, StoredMap::Edge::clamp, 0), 4};
    const SparseMap areas{made_map(2048, 2048, 4, StoredMap::Edge::clamp, 0, 512), 4};
    EXPECT_LT(plain.memory_bytes(), std::size_t{2048 * 2048 / 8});
    EXPECT_LT(areas.memory_bytes(), std::size_t{2048 * 2048 / 4});
}

TEST(SparseMap, NamesTheFamiliesOfARectangle) {
    for (const auto edge : {StoredMap::Edge::wrap, StoredMap::Edge::clamp}) {
        const StoredMap map = made_map(50, 40, 6, edge, 0);
        const SparseMap sparse{map, 6};
        for (const EntryRectangle r : {EntryRectangle{0, 0, 50, 40},
                                       {-7, 3, 9, 2},
                                       {45, 36, 20, 13},
                                       {13, 13, 1, 1},
                                       {-200, 400, 300, 5}}) {
            Families expected;
            for (std::int64_t y = r.y; y < r.y + r.height; ++y)
                for (std::int64_t x = r.x; x < r.x + r.width; ++x) expected.set(std::size_t(map.entry(x, y)));
            EXPECT_EQ(sparse.families_in(r), expected);
        }
    }
}

/// `in_one_tree`: one quadtree decides all families, one of which has larger cells.
Plan mapped(const StoredMap& map, bool in_one_tree = false) {
    Plan plan;
    const auto add = [&](auto what) { plan.textures.push_back({"t", what}); };
    for (std::uint64_t k = 0; k < 3; ++k) {
        Grid grid = made_grid(4, 256, in_one_tree ? 0 : k);
        if (in_one_tree && k == 1) {
            ++grid.cell_log2;
            grid.quadtree = std::make_shared<const TypedQuadtree>(grid.quadtree->lifted(1));
        }
        add(ReferencePlan{grid, made_patterns(1 << grid.cell_log2, 4, 1, k < 2, k),
                          std::make_shared<MadeProgram>(made_looks(256, 4, 1, 1, k), false), nullptr});
    }
    add(GivenPlan{make_constant_texture({200, 20, 30, 255})});
    add(PixelMapPlan{std::make_shared<StoredMap>(map), {0, 1, 2, 3}});
    return plan;
}

TEST(PixelMap, InsideOneFamilyCostsAndGivesThatFamily) {
    StoredMap map = made_map(64, 64, 1, StoredMap::Edge::clamp, 2);
    for (std::int32_t y = 0; y < 64; ++y)
        for (std::int32_t x = 32; x < 64; ++x) map.values.set(std::size_t(y * 64 + x), 2);
    const Plan plan = mapped(map);
    const auto texture = make_pattern_texture(plan);
    Plan alone;
    alone.textures = {plan.textures[2]};
    const auto family = make_pattern_texture(alone);
    Evaluation one, all;
    const TexelRegion region{0, 128, 10, 90, 80};
    EXPECT_EQ(evaluated(*texture, region, Accuracy::high, &all).values,
              evaluated(*family, region, Accuracy::high, &one).values);
    EXPECT_EQ(all.work, one.work);
    EXPECT_EQ(all.method, one.method);
    Rgba8Image codes, expected;
    ASSERT_TRUE(texture->evaluate(region, Budget{}, codes));
    ASSERT_TRUE(family->evaluate(region, Budget{}, expected));
    EXPECT_EQ(codes, expected);
    // Across the border: each texel its own family's
    const TexelRegion border{1, 40, 10, 40, 20};
    const LinearImage both = evaluated(*texture, border), right = evaluated(*family, border);
    EXPECT_TRUE(std::equal(both.row(3) + 24 * 4, both.row(3) + 40 * 4, right.row(3) + 24 * 4));
    EXPECT_FALSE(std::equal(both.row(3), both.row(3) + 24 * 4, right.row(3)));
}

TEST(PixelMap, IsNeverBeyondItsBound) {
    for (const auto edge : {StoredMap::Edge::wrap, StoredMap::Edge::clamp}) {
        const auto texture = make_pattern_texture(mapped(made_map(45, 61, 4, edge, 1, 5)));
        for (const Accuracy accuracy : accuracies)
            for (const int level : {0, 1, 2, 4, 6, 8}) {
                const std::int32_t side = level < 6 ? 24 : 5;
                const TexelRegion region{std::uint8_t(level), -2, -3, side, side};
                Evaluation evaluation;
                const LinearImage page = evaluated(*texture, region, accuracy, &evaluation);
                const LinearImage truth = reduced(evaluated(*texture, below(region, level)), level);
                const double difference = largest_difference(page, truth);
                EXPECT_LE(difference, evaluation.bound_codes + 1e-3) << name_of(accuracy) << " " << level;
                if (accuracy == Accuracy::exact && level <= 4) {
                    EXPECT_LE(evaluation.bound_codes, 0.51);
                }
                std::printf("%-5s level %d: off by %.2f, bound %.2f\n",
                            std::string(name_of(accuracy)).c_str(), level, difference,
                            evaluation.bound_codes);
            }
    }
}

TEST(PixelMap, OfConstantsIsExactAtEveryLevel) {
    Plan plan;
    for (const Rgba8 color : {Rgba8{255, 0, 0, 255}, Rgba8{0, 255, 0, 128}, Rgba8{9, 0, 255, 255}})
        plan.textures.push_back({"c", GivenPlan{make_constant_texture(color)}});
    plan.textures.push_back(
        {"m", PixelMapPlan{std::make_shared<StoredMap>(made_map(300, 128, 3, StoredMap::Edge::wrap, 3)),
                           {0, 1, 2}}});
    const auto texture = make_pattern_texture(plan);
    for (std::uint8_t level = 1; level < 20; ++level) {
        Evaluation evaluation;
        const TexelRegion region{level, -5, 7, 20, 20};
        const LinearImage page = evaluated(*texture, region, Accuracy::fast, &evaluation);
        EXPECT_LE(evaluation.bound_codes, 0.01);
        EXPECT_LE(largest_difference(page, reduced(evaluated(*texture, below(region), Accuracy::fast))),
                  0.01);
    }
}

TEST(PixelMap, ThatRepeatsOverTypedCellsIsExactAtEveryLevel) {
    // Families of one quadtree, on cells of two sizes; 64 texels to a period
    const auto texture = make_pattern_texture(mapped(made_map(16, 16, 4, StoredMap::Edge::wrap, 2, 3), true));
    for (std::uint8_t level = 1; level <= 14; ++level) {
        Evaluation evaluation;
        const TexelRegion region{level, -9, 70, 24, 20};
        const LinearImage page = evaluated(*texture, region, Accuracy::fast, &evaluation);
        EXPECT_LE(evaluation.bound_codes, 0.001) << int(level);
        EXPECT_LE(largest_difference(page, reduced(evaluated(*texture, below(region), Accuracy::fast))), 0.01)
            << int(level);
    }
}

TEST(PixelMap, GivesTheSameBytesHoweverARegionIsSplit) {
    const auto texture = make_pattern_texture(mapped(made_map(45, 61, 4, StoredMap::Edge::wrap, 1, 5)));
    for (const Accuracy accuracy : accuracies)
        for (const int level : {0, 2, 4, 9})
            expect_same_bytes_when_split(*texture, {std::uint8_t(level), -50, 100001, 90, 70}, 37, 22,
                                         accuracy);
}

}  // namespace
}  // namespace tessera
