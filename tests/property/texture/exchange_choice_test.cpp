#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "server/texture/typed_quadtree.h"
#include "server/texture/unit_choice.h"
#include "tests/property/texture/exchange_pages.h"

namespace tessera {
namespace {

using tests::make_synthetic_asset;

TEST(Exchange, NeverRepeatsItsChoiceOfContentsWithAPeriod) {
    const std::uint32_t types = 4096;
    const TypedQuadtree tree{1, types};
    const std::int32_t side = 256;
    const TypeGrid grid = tree.types_of(0, -side / 2, -side / 2, 2 * side, 2 * side);
    // For every displacement of up to 128 tiles: how many of 4096 tiles have the type of the one so far away
    int total = 0, displacements = 0;
    for (std::int64_t dy = 0; dy <= 128; ++dy)
        for (std::int64_t dx = dy == 0 ? 1 : -64; dx <= 64; ++dx) {
            int equal = 0;
            for (std::int64_t y = 0; y < 64; ++y)
                for (std::int64_t x = 0; x < 64; ++x) equal += grid.at(x, y) == grid.at(x + dx, y + dy);
            // One is expected, a period would give 4096. Two equal nodes of height h give 4^h: up to 4 is
            // common.
            ASSERT_LT(equal, 1024) << dx << ", " << dy;
            total += equal;
            ++displacements;
        }
    EXPECT_NEAR(double(total) / displacements, 1.0, 0.1);
}

/// The content that each type shows of a patch: 0 its own.
std::vector<std::uint32_t> contents_by_type(const Variants& variants, const Shapes& shapes,
                                            std::size_t patch) {
    std::vector<std::uint32_t> contents;
    for (std::uint32_t type = 0; type < variants.types(); ++type) {
        contents.push_back(0);
        for (const Shown& shown : variants.of(type))
            if (shapes[shown.shape].patch == patch) contents.back() = shapes[shown.shape].content + 1;
    }
    return contents;
}

TEST(Exchange, UsesEveryContentEquallyOften) {
    const ExchangeAsset asset = make_synthetic_asset({.contents = 6});
    const Shapes shapes{asset, 2};
    const Variants variants = content_variants(shapes, 5, 4096);
    for (std::size_t p = 0; p < asset.patches.size(); ++p) {
        std::vector<int> counts(6);
        for (const std::uint32_t content : contents_by_type(variants, shapes, p)) ++counts[content];
        EXPECT_LE(
            *std::max_element(counts.begin(), counts.end()) - *std::min_element(counts.begin(), counts.end()),
            1);
    }
}

TEST(Exchange, PatchesOfATileChooseIndependently) {
    // The flaw of the authors' own library: one draw for all patches of a tile
    const ExchangeAsset asset = make_synthetic_asset({.contents = 6});
    const Shapes shapes{asset, 2};
    const Variants variants = content_variants(shapes, 5, 4096);
    const auto first = contents_by_type(variants, shapes, 0), second = contents_by_type(variants, shapes, 1);
    int equal = 0;
    for (std::size_t type = 0; type < first.size(); ++type) equal += first[type] == second[type];
    EXPECT_NEAR(equal, 4096 / 6, 120);  // five standard deviations
}

TEST(Exchange, ADroppedContentIsNeverShown) {
    ExchangeAsset asset = make_synthetic_asset({});
    for (auto& patch : asset.patches) patch.contents[1].standing = ExchangeAsset::Standing::dropped;
    const Shapes shapes{asset, 2};
    EXPECT_EQ(shapes.size(), asset.patches.size() * 3);
    for (std::size_t s = 0; s < shapes.size(); ++s) EXPECT_NE(shapes[s].content, 1u);
}

TEST(Exchange, NoTwoPatchesOfAnyUnitsOverlapWhateverTheirTypes) {
    // Typed: every type beside and above every other would be too many to try, so each texel that any type
    // may take is marked, and units are laid side by side
    for (const std::int32_t groups : {0, 24}) {
        SCOPED_TRACE(groups);
        const ExchangeAsset asset =
            tests::make_synthetic_interchange({.patches = 300, .blend_texels = 0, .groups = groups});
        const Shapes shapes{asset, 0};
        const Variants variants = packed_variants(asset, shapes, 7, 128);
        const std::int32_t unit = variants.unit_tiles * asset.tile_side;
        std::vector<bool> ever(std::size_t(2 * unit) * std::size_t(2 * unit));
        std::size_t covered = 0;
        for (std::uint32_t type = 0; type < variants.types(); ++type) {
            std::vector<bool> taken(ever.size());
            for (const Shown& shown : variants.of(type)) {
                const Shapes::Shape& shape = shapes[shown.shape];
                for (std::int32_t y = 0; y < shape.height; ++y)
                    for (const Shapes::Segment& segment : shapes.row(shape, y))
                        for (std::int32_t x = segment.begin; x < segment.end; ++x) {
                            const auto at = std::size_t(shown.tile_y * asset.tile_side + shape.y + y) *
                                                std::size_t(2 * unit) +
                                            std::size_t(shown.tile_x * asset.tile_side + shape.x + x);
                            ASSERT_FALSE(taken[at]) << "type " << type;
                            taken[at] = true;
                            ever[at] = true;
                            ++covered;
                        }
            }
        }
        for (std::int32_t y = 0; y < unit; ++y)
            for (std::int32_t x = 0; x < unit; ++x) {
                const auto at = [&](std::int32_t u, std::int32_t v) {
                    return ever[std::size_t(v) * std::size_t(2 * unit) + std::size_t(u)] ? 1 : 0;
                };
                ASSERT_LE(at(x, y) + at(x + unit, y) + at(x, y + unit) + at(x + unit, y + unit), 1)
                    << x << ", " << y;
            }
        EXPECT_GT(covered, std::size_t(unit) * std::size_t(unit) * variants.types() / 2)
            << "packed too loosely";
    }
}

TEST(Exchange, GroupsTakeNoMoreMemoryThanForetold) {
    for (const std::int32_t blend : {0, 4}) {
        SCOPED_TRACE(blend);
        const ExchangeAsset asset =
            tests::make_synthetic_interchange({.patches = 300, .blend_texels = blend, .groups = 24});
        const ExchangeOptions options{.blended = blend != 0};
        const std::size_t foretold = exchange_bytes(asset, options);
        const std::size_t taken = make_exchange_texture(asset, options)->memory_bytes();
        EXPECT_LE(taken, foretold);
        EXPECT_GT(taken, foretold / 40) << "a bound that refuses what would fit";
    }
}

TEST(Exchange, PatchesOfAGroupAreShownTogetherOrNotAtAllAndNoneOfThemWhereOneIsDropped) {
    ExchangeAsset asset = tests::make_synthetic_interchange({.patches = 100, .groups = 24});
    std::size_t in_dropped = 0;
    for (auto& patch : asset.patches)
        if (patch.group == 5 && in_dropped++ == 3)
            patch.contents[0].standing = ExchangeAsset::Standing::dropped;
    const Shapes shapes{asset, 2};
    const Variants variants = packed_variants(asset, shapes, 7, 256);
    const auto group_of = [&](const Shown& shown) { return asset.patches[shapes[shown.shape].patch].group; };
    std::set<std::uint16_t> seen;
    for (std::uint32_t type = 0; type < variants.types(); ++type) {
        // By group and by where it lies, relative to where the asset has it: all nine rectangles
        std::map<std::array<std::int32_t, 3>, int> shown_of;
        for (const Shown& shown : variants.of(type)) {
            if (group_of(shown) == 0) continue;
            const auto& patch = asset.patches[shapes[shown.shape].patch];
            ++shown_of[{group_of(shown), shown.tile_x - patch.x / asset.tile_side,
                        shown.tile_y - patch.y / asset.tile_side}];
        }
        for (const auto& [where, count] : shown_of) {
            EXPECT_EQ(count, 9) << "type " << type << ", group " << where[0];
            seen.insert(static_cast<std::uint16_t>(where[0]));
        }
    }
    EXPECT_GE(seen.size(), 12u) << "those that fit into a unit";
    EXPECT_FALSE(seen.contains(5));
}

TEST(Exchange, TilesOfAWangUnitAgreeOnTheColoursOfTheirCorners) {
    const ExchangeAsset asset = tests::make_synthetic_wang({.tile_side = 16});
    const Shapes shapes{asset, 0};
    const Variants variants = wang_variants(asset, shapes, 3, 256);
    const std::int32_t side = variants.unit_tiles;
    std::set<std::vector<int>> outlines;
    for (std::uint32_t type = 0; type < variants.types(); ++type) {
        std::vector<int> corners(std::size_t(side * side) * 4);  // the tile itself: all zero
        for (const Shown& shown : variants.of(type))
            for (int corner = 0; corner < 4; ++corner)
                corners[std::size_t(shown.tile_y * side + shown.tile_x) * 4 + std::size_t(corner)] =
                    asset.patches[0].contents[shapes[shown.shape].content].corners >> 2 * corner & 3;
        const auto at = [&](std::int32_t x, std::int32_t y, int corner) {
            return corners[std::size_t((y % side) * side + x % side) * 4 + std::size_t(corner)];
        };
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x) {
                ASSERT_EQ(at(x, y, 1), at(x + 1, y, 0));  // also round the unit: neighbours share its outline
                ASSERT_EQ(at(x, y, 2), at(x, y + 1, 0));
                ASSERT_EQ(at(x, y, 3), at(x + 1, y + 1, 0));
            }
        std::vector<int> outline;
        for (std::int32_t i = 0; i < side; ++i) {
            outline.push_back(at(i, 0, 0));
            outline.push_back(at(0, i, 0));
        }
        outlines.insert(outline);
    }
    EXPECT_EQ(outlines.size(), 1u);
}

}  // namespace
}  // namespace tessera
