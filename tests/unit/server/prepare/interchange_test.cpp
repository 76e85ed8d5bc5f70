#include <algorithm>
#include <array>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/prepare/interchange_sets.h"
#include "server/prepare/prepare.h"
#include "server/prepare/quilting.h"
#include "server/scene/asset_file.h"
#include "server/scene/image_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/server/prepare/made_photo.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using Set = ExchangeAsset::Set;
using Standing = ExchangeAsset::Standing;

PrepareOptions small() {
    PrepareOptions options;
    options.method = ExchangeMethod::interchange;
    options.tile_side = 64;
    options.patches = 160;
    options.blend_texels = 4;
    return options;
}

PreparedAsset prepared(const Rgb8Image& photo, const PrepareOptions& options,
                       const ExchangeAsset* before = nullptr) {
    SilentProgress progress;
    auto made = prepare_exchange(photo, options, before, progress);
    EXPECT_TRUE(made) << made.error().detail;
    return made ? std::move(*made) : PreparedAsset{};
}

bool same_patch(const ExchangeAsset::Patch& a, const ExchangeAsset::Patch& b) {
    return a.x == b.x && a.y == b.y && a.contents[0].at == b.contents[0].at &&
           a.contents[0].shape == b.contents[0].shape;
}

template <class Call>
void for_each_texel(const ExchangeAsset::Patch& patch, Call&& call) {
    for (std::int32_t y = 0; y < patch.height; ++y)
        for (std::int32_t x = 0; x < patch.width; ++x)
            if (patch.contents[0].shape.at(x, y)) call(patch.x + x, patch.y + y);
}

TEST(Quilting, texels_of_the_tile_are_the_photographs_and_its_opposite_edges_fit) {
    const Rgb8Image photo = test::made_photo(150, 120);
    const PerceptualImage colors = to_perceptual(photo);
    SilentProgress progress;
    // As large as the photograph, and larger
    for (const std::int32_t side : {32, 128, 256}) {
        const QuiltedTile tile = quilt_tile(colors, side, 1, 2, progress);
        ASSERT_EQ(std::ssize(tile.sources), std::ptrdiff_t{side} * side);
        std::int64_t inside = 0, across = 0;
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x) {
                const PhotoPoint from = tile.source(x, y);
                ASSERT_TRUE(from.x >= 0 && from.y >= 0 && from.x < photo.width && from.y < photo.height);
                EXPECT_EQ(tile.color(x, y), colors.at(from.x, from.y));
                const std::int64_t step = difference(tile.color(x, y), tile.color(x + 1, y)) +
                                          difference(tile.color(y, x), tile.color(y, x + 1));
                (x == side - 1 ? across : inside) += step;
            }
        EXPECT_LT(across * (side - 1), inside * 3 / 2) << side;
    }
}

TEST(Interchange, one_thread_and_three_make_the_same_library_and_another_seed_another) {
    const Rgb8Image photo = test::made_photo(160, 140);
    PrepareOptions options = small();
    options.threads = 1;
    const PreparedAsset alone = prepared(photo, options);
    options.threads = 3;
    const PreparedAsset together = prepared(photo, options);
    ASSERT_EQ(alone.asset.patches.size(), together.asset.patches.size());
    EXPECT_EQ(alone.asset.tile.bytes, together.asset.tile.bytes);
    for (std::size_t p = 0; p < alone.asset.patches.size(); ++p) {
        EXPECT_TRUE(same_patch(alone.asset.patches[p], together.asset.patches[p])) << p;
        EXPECT_EQ(alone.asset.patches[p].set, together.asset.patches[p].set) << p;
    }
    options.seed = 2;
    EXPECT_NE(prepared(photo, options).asset.tile.bytes, alone.asset.tile.bytes);
}

TEST(Interchange, patches_lie_all_over_the_tile_its_borders_and_corners_included) {
    std::vector<Rgb8Image> photos{test::made_photo(160, 140)};
    const std::filesystem::path file = std::filesystem::path{TESSERA_EXEMPLARS} / "gravel-grey.png";
    if (std::filesystem::exists(file)) {
        const auto whole = read_rgb_image(file);
        ASSERT_TRUE(whole) << whole.error().detail;
        Rgb8Image crop{200, 200, {}};
        for (std::ptrdiff_t y = 0; y < 200; ++y)
            crop.bytes.insert(crop.bytes.end(), whole->bytes.begin() + 3 * y * whole->width,
                              whole->bytes.begin() + 3 * (y * whole->width + 200));
        photos.push_back(std::move(crop));
    } else {
        std::printf("[  NOTE    ] %s is absent: only made input was used\n", file.c_str());
    }
    for (const Rgb8Image& photo : photos) {
        constexpr std::int32_t side = 128;
        PrepareOptions options = small();
        options.tile_side = side;
        const PreparedAsset made = prepared(photo, options);
        const ExchangeAsset& asset = made.asset;
        EXPECT_EQ(asset.exemplar.bytes, photo.bytes);
        EXPECT_LE(std::count_if(asset.patches.begin(), asset.patches.end(),
                                [](const auto& patch) { return patch.group == 0; }),
                  160);
        std::vector<int> covered(side * side);
        for (const auto& patch : asset.patches) {
            ASSERT_EQ(patch.contents.size(), 1u);
            const auto& content = patch.contents[0];
            EXPECT_GE(content.at.x, 2);
            EXPECT_GE(content.at.y, 2);
            EXPECT_LE(content.at.x + patch.width + 2, photo.width);
            EXPECT_LE(content.at.y + patch.height + 2, photo.height);
            for_each_texel(patch, [&](std::int32_t x, std::int32_t y) {
                ++covered[static_cast<std::size_t>((y & (side - 1)) * side + (x & (side - 1)))];
            });
        }
        const tests::TemporaryFolder folder;
        ASSERT_TRUE(write_exchange_asset(folder.path / "asset", asset, {}));
        std::uintmax_t bytes = 0;
        for (const auto& entry : std::filesystem::directory_iterator{folder.path / "asset"})
            bytes += entry.file_size();
        EXPECT_LE(bytes, 4 * photo.bytes.size()) << "the paper's own bound";
        // Sixteen by sixteen texels round each point of a grid, the tile's corner and borders among them
        int bare = 0;
        for (std::int32_t top = -8; top < side - 8; top += 16)
            for (std::int32_t left = -8; left < side - 8; left += 16) {
                int sum = 0;
                for (std::int32_t i = 0; i < 256; ++i)
                    sum += covered[static_cast<std::size_t>(((top + i / 16) & (side - 1)) * side +
                                                            ((left + i % 16) & (side - 1)))];
                bare += sum == 0;
                if (top == -8 && left == -8) {
                    EXPECT_GT(sum, 0) << "round the tile's corner";
                }
            }
        EXPECT_LE(bare, 3);
        for (std::size_t i = 0; i < made.tile_sources.size(); ++i) {
            const PhotoPoint from = made.tile_sources[i];
            const std::size_t at = 3 * (std::size_t(from.y) * std::size_t(photo.width) + std::size_t(from.x));
            EXPECT_EQ(asset.tile.bytes[3 * i], photo.bytes[at]);
        }
    }
}

TEST(Interchange, sets_keep_to_the_rhombus_and_never_overlap_on_any_neighbours) {
    const ExchangeAsset asset = prepared(test::made_photo(160, 140), small()).asset;

    std::array<std::size_t, 3> sizes{};
    for (const auto& patch : asset.patches) {
        ++sizes[static_cast<std::size_t>(patch.set)];
        if (patch.set == Set::none) continue;
        for_each_texel(patch, [&](std::int32_t x, std::int32_t y) { EXPECT_TRUE(in_rhombus(x, y, 64)); });
    }
    EXPECT_GT(sizes[1], 10u);
    EXPECT_GT(sizes[2], 10u);
    for (const auto& a : asset.patches)
        for (const auto& b : asset.patches) {
            if (a.set == Set::none || b.set == Set::none) continue;
            std::vector<std::array<std::int32_t, 2>> neighbours;
            if (a.set != b.set) neighbours = {{64, 0}, {-64, 0}, {0, 64}, {0, -64}};
            if (a.set == b.set) neighbours = {{64, 64}, {-64, 64}, {64, -64}, {-64, -64}};
            for (const auto& [dx, dy] : neighbours)
                for_each_texel(a, [&, dx = dx, dy = dy](std::int32_t x, std::int32_t y) {
                    const std::int32_t u = x - dx - b.x, v = y - dy - b.y;
                    if (u >= 0 && v >= 0 && u < b.width && v < b.height) {
                        EXPECT_FALSE(b.contents[0].shape.at(u, v));
                    }
                });
        }
}

TEST(Interchange, rhombi_of_diagonal_neighbours_share_no_texel_and_hold_the_whole_tile) {
    for (std::int32_t y = -32; y < 96; ++y)
        for (std::int32_t x = -32; x < 96; ++x) {
            EXPECT_FALSE(in_rhombus(x, y, 64) && in_rhombus(x - 64, y - 64, 64));
            EXPECT_FALSE(in_rhombus(x, y, 64) && in_rhombus(x - 64, y + 64, 64));
            if (x >= 0 && y >= 0 && x < 64 && y < 64) {
                EXPECT_TRUE(in_rhombus(x, y, 64));
            }
        }
}

TEST(Interchange, pinned_patches_stay_and_dropped_ones_are_not_found_again) {
    const Rgb8Image photo = test::made_photo(160, 140);
    ExchangeAsset before = prepared(photo, small()).asset;
    before.patches[3].contents[0].standing = Standing::pinned;
    before.patches[0].contents[0].standing = Standing::dropped;
    const ExchangeAsset after = prepared(photo, small(), &before).asset;
    int pinned = 0, dropped = 0;
    for (const auto& patch : after.patches) {
        pinned += same_patch(patch, before.patches[3]) && patch.contents[0].standing == Standing::pinned;
        if (same_patch(patch, before.patches[0])) {
            EXPECT_EQ(patch.contents[0].standing, Standing::dropped);
            EXPECT_EQ(patch.set, Set::none);
            ++dropped;
        }
    }
    EXPECT_EQ(pinned, 1);
    EXPECT_EQ(dropped, 1);
    PrepareOptions other = small();
    other.tile_side = 32;
    SilentProgress progress;
    const auto refused = prepare_exchange(photo, other, &before, progress);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().detail, HasSubstr("another tile"));
}

TEST(Interchange, refuses_options_out_of_range_by_name_and_manages_the_least_photograph) {
    SilentProgress progress;
    const auto says = [&](std::int32_t tile, std::int32_t patches, std::int32_t blend, std::int32_t photo) {
        PrepareOptions options = small();
        options.tile_side = tile;
        options.patches = patches;
        options.blend_texels = blend;
        const auto made = prepare_exchange(test::made_photo(photo, photo), options, nullptr, progress);
        return made ? std::string{"made"} : made.error().detail;
    };
    EXPECT_THAT(says(8, 100, 4, 100), HasSubstr("--tile is 8; from 16 to 4096"));
    EXPECT_THAT(says(100, 100, 4, 100), HasSubstr("a power of two"));
    EXPECT_THAT(says(64, 15, 4, 100), HasSubstr("--patches is 15; from 16 to 4000"));
    EXPECT_THAT(says(64, 4001, 4, 100), HasSubstr("--patches is 4001; from 16 to 4000"));
    EXPECT_THAT(says(64, 100, 66, 100), HasSubstr("--blend is 66; from 0 to 64"));
    EXPECT_THAT(says(64, 100, 3, 100), HasSubstr("an even number"));
    EXPECT_THAT(says(64, 100, 4, 19), HasSubstr("too small for a tile"));
    EXPECT_EQ(says(16, 16, 2, 20), "made");
}

}  // namespace
}  // namespace tessera
