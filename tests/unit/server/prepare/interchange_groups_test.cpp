#include "server/prepare/interchange_groups.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "server/prepare/prepare.h"
#include "server/prepare/seam.h"
#include "server/texture/exchange.h"
#include "server/texture/unit_choice.h"
#include "server/texture/unit_tree.h"
#include "shared/math/srgb.h"
#include "tests/unit/server/prepare/made_photo.h"

namespace tessera {
namespace {

using Standing = ExchangeAsset::Standing;

PrepareOptions small() {
    PrepareOptions options;
    options.method = ExchangeMethod::interchange;
    options.tile_side = 64;
    options.patches = 40;
    options.blend_texels = 4;
    return options;
}

ExchangeAsset prepared(const PrepareOptions& options, const ExchangeAsset* before = nullptr) {
    SilentProgress progress;
    auto made = prepare_exchange(test::made_photo(160, 140), options, before, progress);
    EXPECT_TRUE(made) << made.error().detail;
    return made ? std::move(made->asset) : ExchangeAsset{};
}

/// Made once: preparing takes the time of these tests.
const ExchangeAsset& small_asset() {
    static const ExchangeAsset asset = prepared(small());
    return asset;
}

using Groups = std::map<std::uint16_t, std::vector<ExchangeAsset::Patch>>;

Groups groups_of(const ExchangeAsset& asset) {
    Groups groups;
    for (const auto& patch : asset.patches)
        if (patch.group != 0) groups[patch.group].push_back(patch);
    return groups;
}

bool same(const std::vector<ExchangeAsset::Patch>& a, const std::vector<ExchangeAsset::Patch>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& other) {
        return one.x == other.x && one.y == other.y && one.contents[0].at == other.contents[0].at &&
               one.contents[0].shape == other.contents[0].shape;
    });
}

TEST(InterchangeGroup, fills_its_region_without_overlaps_and_shows_the_tile_only_along_its_border) {
    const PerceptualImage photo = to_perceptual(test::made_photo(200, 180));
    SilentProgress progress;
    const QuiltedTile tile = quilt_tile(photo, 64, 1, 2, progress);
    const GroupSources sources{photo, tile, mean_gradient(photo), 2, 48};
    // A disc over several tiles and their corners
    constexpr std::int32_t side = 150, radius = 72;
    const auto inside_by = [&](std::int32_t x, std::int32_t y) {
        for (std::int32_t by = 0;; ++by)
            for (const auto& [dx, dy] :
                 {std::pair{by, 0}, std::pair{-by, 0}, std::pair{0, by}, std::pair{0, -by}}) {
                const std::int32_t u = x + dx - side / 2, v = y + dy - side / 2;
                if (u * u + v * v > radius * radius) return by;
            }
    };
    PatchRegion region{37, 90, side, SquareMarks(std::size_t{side} * side)};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            region.inside[static_cast<std::size_t>(y * side + x)] = inside_by(x, y) > 0;

    const InterchangeGroup group = fill_region(sources, region, 5);
    EXPECT_GE(group.patches.size(), 6u);
    std::vector<int> covered(region.inside.size());
    for (const InterchangePatch& patch : group.patches) {
        EXPECT_GE(patch.at.x, 2);
        EXPECT_GE(patch.at.y, 2);
        EXPECT_LE(patch.at.x + patch.width + 2, photo.width);
        EXPECT_LE(patch.at.y + patch.height + 2, photo.height);
        std::int32_t texels = 0;
        for (std::int32_t v = 0; v < patch.height; ++v)
            for (std::int32_t u = 0; u < patch.width; ++u) {
                if (!patch.shape.at(u, v)) continue;
                ++texels;
                const std::int32_t x = patch.x + u - region.x, y = patch.y + v - region.y;
                ASSERT_TRUE(x >= 0 && y >= 0 && x < side && y < side);
                ++covered[static_cast<std::size_t>(y * side + x)];
            }
        EXPECT_EQ(texels, patch.texels);
    }
    std::int32_t tile_in_sight = 0, all = 0;
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const auto i = static_cast<std::size_t>(y * side + x);
            EXPECT_LE(covered[i], region.inside[i] != 0 ? 1 : 0) << x << ", " << y;
            if (inside_by(x, y) > 16) {
                EXPECT_EQ(covered[i], 1) << x << ", " << y;
            }
            all += region.inside[i];
            tile_in_sight += region.inside[i] != 0 && covered[i] == 0;
        }
    EXPECT_LT(tile_in_sight * 4, all);
    EXPECT_NE(fill_region(sources, region, 6).patches[0].at, group.patches[0].at) << "other bits";
}

TEST(InterchangeGroup, one_thread_and_four_make_the_same_groups) {
    PrepareOptions options = small();
    options.threads = 1;
    const Groups alone = groups_of(prepared(options));
    options.threads = 4;
    const Groups together = groups_of(prepared(options));
    ASSERT_GE(alone.size(), 8u);
    ASSERT_EQ(alone.size(), together.size());
    for (const auto& [number, patches] : alone) EXPECT_TRUE(same(patches, together.at(number))) << number;
}

TEST(InterchangeGroup, of_whom_a_patch_is_pinned_stays_and_of_whom_one_is_dropped_is_replaced) {
    ExchangeAsset before = small_asset();
    const Groups made = groups_of(before);
    const auto mark = [&](std::uint16_t group, Standing standing) {
        for (auto& patch : before.patches)
            if (patch.group == group) {
                patch.contents[0].standing = standing;
                return;
            }
    };
    mark(2, Standing::pinned);
    mark(3, Standing::dropped);
    const Groups after = groups_of(prepared(small(), &before));
    // All of before, and one in the place of what was dropped, which stays listed
    ASSERT_EQ(after.size(), made.size() + 1);
    int pinned = 0, dropped = 0, others = 0;
    for (const auto& [number, patches] : after) {
        if (same(patches, made.at(2))) {
            ++pinned;
            EXPECT_EQ(patches[0].contents[0].standing, Standing::pinned);
        } else if (same(patches, made.at(3))) {
            ++dropped;
            EXPECT_EQ(patches[0].contents[0].standing, Standing::dropped);
            EXPECT_EQ(patches[1].contents[0].standing, Standing::chosen);
        } else {
            others += std::any_of(made.begin(), made.end(),
                                  [&](const auto& one) { return same(one.second, patches); });
        }
    }
    EXPECT_EQ(pinned, 1);
    EXPECT_EQ(dropped, 1);
    EXPECT_EQ(others, static_cast<int>(made.size()) - 2);
}

/// Codes are copied from what is blended in advance, linear values are summed texel by texel.
TEST(InterchangeGroup, shows_the_same_codes_as_its_patches_one_by_one) {
    for (const bool blended : {true, false}) {
        const auto texture = make_exchange_texture(small_asset(), {.seed = 3, .blended = blended});
        const TexelRegion region{0, -301, 77, 700, 700};
        LinearImage linear;
        Rgba8Image codes;
        ASSERT_TRUE(texture->evaluate(region, Budget{}, linear));
        ASSERT_TRUE(texture->evaluate(region, Budget{}, codes));
        for (std::int32_t y = 0; y < region.height; ++y)
            for (std::int32_t x = 0; x < region.width; ++x)
                for (std::int32_t c = 0; c < 4; ++c) {
                    const std::uint8_t code = codes.row(y)[4 * x + c];
                    if (c == 3) {
                        ASSERT_EQ(code, 255);
                        continue;
                    }
                    // A float is that close to the step that was summed
                    const double step = double{linear.row(y)[4 * x + c]} * linear_one + 0.5;
                    const auto least = static_cast<std::size_t>(std::max(0.0, step - 0.02));
                    const auto most = static_cast<std::size_t>(std::min(double{linear_one}, step + 0.02));
                    ASSERT_GE(code, steps_to_srgb()[least]) << x << ", " << y;
                    ASSERT_LE(code, steps_to_srgb()[most]) << x << ", " << y;
                }
    }
}

TEST(InterchangeGroup, is_not_shown_by_two_units_that_are_kept_apart) {
    const ExchangeAsset& asset = small_asset();
    const Shapes shapes{asset, 2};
    const Variants variants = packed_variants(asset, shapes, 1, 128);
    ASSERT_GE(variants.apart, 1) << "groups for four units, each with others";
    const std::uint32_t kept_apart = 1u << (2 * variants.apart);
    std::vector<std::set<std::uint16_t>> groups(128);
    for (std::uint32_t type = 0; type < 128; ++type)
        for (const Shown& shown : variants.of(type))
            if (const std::uint16_t group = asset.patches[shapes[shown.shape].patch].group; group != 0)
                groups[type].insert(group);
    std::set<std::uint16_t> all;
    for (std::uint32_t a = 0; a < 128; ++a) {
        EXPECT_GE(groups[a].size(), 3u);
        all.insert(groups[a].begin(), groups[a].end());
        for (std::uint32_t b = 0; b < 128; ++b) {
            const std::uint32_t of_a = a % UnitTree::classes, of_b = b % UnitTree::classes;
            if (of_a == of_b || of_a / kept_apart != of_b / kept_apart) continue;
            std::vector<std::uint16_t> both;
            std::set_intersection(groups[a].begin(), groups[a].end(), groups[b].begin(), groups[b].end(),
                                  std::back_inserter(both));
            ASSERT_TRUE(both.empty()) << a << " and " << b;
        }
    }
    EXPECT_EQ(all.size(), groups_of(asset).size()) << "none is left out";
}

TEST(InterchangeGroup, none_are_made_where_the_photograph_or_the_tile_gives_no_room) {
    PrepareOptions options = small();
    options.tile_side = 16;
    options.patches = 16;
    EXPECT_TRUE(groups_of(prepared(options)).empty());
}

}  // namespace
}  // namespace tessera
