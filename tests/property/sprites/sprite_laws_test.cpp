// Where sprites lie, against brute force: turned and scaled in every way, moving, coming and going, on cell
// borders and at the ends of the largest extent. Four cells of one grid always suffice; a sprite is found
// from every texel that it may colour; and it colours none beyond its box.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "server/sprites/sprite_images.h"
#include "shared/sprites/positioning_map.h"

namespace tessera {
namespace {

std::uint64_t fresh_seed() {
    const char* const given = std::getenv("TESSERA_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
}

constexpr std::int64_t edge_texels = std::int64_t{1} << 39;  ///< As far as sprites may be put.

using CellPlace = std::pair<std::int64_t, std::int64_t>;

class SpriteLaws : public testing::Test {
  protected:
    SpriteLaws() { RecordProperty("seed", std::to_string(seed_)); }

    std::int64_t between(std::int64_t least, std::int64_t most) {
        return std::uniform_int_distribution<std::int64_t>{least, most}(random_);
    }
    bool one_in(std::int64_t count) { return between(1, count) == 1; }

    /// Anywhere around `middle` (texels), often on a border of cells or a unit beside it; in units.
    std::int64_t place_near(std::int64_t middle, std::int64_t spread) {
        std::int64_t texel = middle + between(-spread, spread);
        std::int64_t beside = between(0, sprite_units - 1);
        if (one_in(2)) {
            const auto height = between(0, 12);
            texel = texel >> height << height;
            beside = between(-2, 2);
        }
        return std::clamp(texel * sprite_units + beside, -edge_texels * sprite_units,
                          edge_texels * sprite_units);
    }

    Sprite any_sprite(SpriteId id, std::int64_t middle_x, std::int64_t middle_y, std::int64_t spread,
                      std::int64_t most_side = 1024) {
        Sprite sprite;
        sprite.id = id;
        sprite.x = place_near(middle_x, spread);
        sprite.y = place_near(middle_y, spread);
        sprite.order = static_cast<std::int32_t>(between(-3, 3));
        sprite.side_texels = static_cast<std::uint16_t>(between(1, most_side));
        constexpr std::int64_t least = sprite_scale_one / 64, most = 4 * sprite_scale_one;
        const std::array scales{std::int64_t{sprite_scale_one}, least, most, between(least, most),
                                between(least, sprite_scale_one)};
        sprite.scale = static_cast<std::uint32_t>(scales[static_cast<std::size_t>(between(0, 4))]);
        // Quarters, an eighth, next to a quarter, any
        const std::array turns{between(0, 3) * 16384, between(0, 7) * 8192,
                               between(0, 3) * 16384 + between(-1, 1), between(0, 65535)};
        sprite.turn = static_cast<std::uint16_t>(turns[static_cast<std::size_t>(between(0, 3))] & 65535);
        if (one_in(2)) return sprite;
        SpriteLife life;
        if (one_in(2)) life.first_step = between(-50, 50);
        if (one_in(2)) life.end_step = between(51, 200);
        if ((life.moves = one_in(2)))
            life.path = {place_near(middle_x, spread), place_near(middle_y, spread), between(-20, 20),
                         one_in(2) ? between(1, 60) : between(1, 2147483647),
                         static_cast<SpritePath::Then>(between(0, 2))};
        sprite.life = std::make_shared<const SpriteLife>(life);
        return sprite;
    }

    std::vector<Step> some_steps() {
        return {between(-100, 250), between(-100, 250), between(-100, 250),
                between(-(Step{1} << 62), Step{1} << 62), 2147483647};
    }

    const std::uint64_t seed_ = fresh_seed();
    std::mt19937_64 random_{seed_};
};

/// A turned and scaled square around a texel's corner, in texels relative to it: far from the origin all its
/// digits are there, too.
struct TurnedSquare {
    std::int64_t x = 0, y = 0;
    std::array<std::array<long double, 2>, 4> corners{};

    TurnedSquare(const Sprite& sprite, Step step) {
        const SpritePosition middle = position_at(sprite, step);
        x = middle.x >> 8;
        y = middle.y >> 8;
        const auto part_x = static_cast<long double>(middle.x & 255) / 256,
                   part_y = static_cast<long double>(middle.y & 255) / 256;
        const long double half =
            static_cast<long double>(sprite.side_texels) * sprite.scale / sprite_scale_one / 2;
        const long double angle = sprite.turn / 65536.0L * 2 * 3.14159265358979323846L;
        const long double c = sprite.turn % 32768 == 16384 ? 0 : std::cos(angle),
                          s = sprite.turn % 32768 == 0 ? 0 : std::sin(angle);
        std::size_t corner = 0;
        for (const auto& [u, v] : {std::pair{-half, -half}, {half, -half}, {half, half}, {-half, half}})
            corners[corner++] = {part_x + c * u - s * v, part_y + s * u + c * v};
    }
    /// Along an axis: the least and the largest, in texels from the corner.
    std::pair<long double, long double> ends(std::size_t axis) const {
        const auto [least, most] = std::minmax_element(
            corners.begin(), corners.end(), [&](const auto& a, const auto& b) { return a[axis] < b[axis]; });
        return {(*least)[axis], (*most)[axis]};
    }
    /// Whether its inside meets a square of `side` texels whose corner is (left, top): separating axes.
    bool meets(std::int64_t left, std::int64_t top, std::int64_t side) const {
        const auto apart = [&](long double nx, long double ny) {
            long double least = 1e30L, most = -1e30L, cell_least = 1e30L, cell_most = -1e30L;
            for (const auto& corner : corners) {
                const long double at = nx * corner[0] + ny * corner[1];
                least = std::min(least, at), most = std::max(most, at);
            }
            for (const std::int64_t i : {std::int64_t{0}, side})
                for (const std::int64_t j : {std::int64_t{0}, side}) {
                    const long double at = nx * static_cast<long double>(left + i - x) +
                                           ny * static_cast<long double>(top + j - y);
                    cell_least = std::min(cell_least, at), cell_most = std::max(cell_most, at);
                }
            return most - cell_least < 1e-9L || cell_most - least < 1e-9L;
        };
        const long double ax = corners[1][0] - corners[0][0], ay = corners[1][1] - corners[0][1];
        return !apart(1, 0) && !apart(0, 1) && !apart(ax, ay) && !apart(-ay, ax);
    }
};

/// The finest grid whose cells are as large as the box of all its steps: log2 of their side.
int grid_of(const Sprite& sprite) {
    const TexelBox box = box_of(sprite);
    int height = 0;
    while (std::int64_t{1} << height < std::max(box.x1 - box.x0, box.y1 - box.y0)) ++height;
    return height;
}

TEST_F(SpriteLaws, FourCellsSufficeForEverySpriteAtEveryStep) {
    std::set<int> grids;
    for (int n = 0; n < 40'000; ++n) {
        const std::array middles{std::int64_t{0},      (std::int64_t{1} << 38),     -(std::int64_t{1} << 38),
                                 std::int64_t{123456}, (std::int64_t{1} << 37) - 1, edge_texels,
                                 -edge_texels};
        const auto middle = [&] { return middles[static_cast<std::size_t>(between(0, 6))]; };
        const Sprite sprite = any_sprite(1, middle(), middle(), std::int64_t{1} << between(0, 38));
        ASSERT_FALSE(check_sprite(sprite).has_error()) << "seed " << seed_;
        const int height = grid_of(sprite);
        grids.insert(height);
        const std::int64_t cell = std::int64_t{1} << height;
        const TexelBox whole = box_of(sprite);
        PositioningMap map;
        ASSERT_FALSE(map.place(sprite).has_error());
        std::set<CellPlace> met_ever;
        for (const Step step : some_steps()) {
            const TurnedSquare square{sprite, step};
            const auto [left, right] = square.ends(0);
            const auto [top, bottom] = square.ends(1);
            ASSERT_LE(right - left, cell + 1e-9L) << "a cell is as large as the transformed sprite";
            ASSERT_LE(bottom - top, cell + 1e-9L);
            // Every cell that the square meets, of those around
            const auto cell_at = [&](std::int64_t base, long double v) {
                return (base + static_cast<std::int64_t>(std::floor(v))) >> height;
            };
            std::set<CellPlace> met;
            for (std::int64_t j = cell_at(square.y, top) - 1; j <= cell_at(square.y, bottom) + 1; ++j)
                for (std::int64_t i = cell_at(square.x, left) - 1; i <= cell_at(square.x, right) + 1; ++i)
                    if (square.meets(i << height, j << height, cell)) met.emplace(i, j);
            ASSERT_GE(met.size(), 1u);
            ASSERT_LE(met.size(), 4u);
            met_ever.insert(met.begin(), met.end());

            // It lies in its boxes, and whoever asks for a texel of it finds it, while it is there
            const auto texel = [](std::int64_t base, long double v) {
                return base + static_cast<std::int64_t>(std::floor(v));
            };
            const TexelBox box = box_at(sprite, step);
            ASSERT_EQ(box == TexelBox{}, !there_at(sprite, step)) << "seed " << seed_;
            for (const auto& [x, y] : {std::pair{left + 1e-9L, top + 1e-9L},
                                       {right - 1e-9L, bottom - 1e-9L},
                                       {(left + right) / 2, (top + bottom) / 2}}) {
                const TexelBox one{texel(square.x, x), texel(square.y, y), texel(square.x, x) + 1,
                                   texel(square.y, y) + 1};
                if (there_at(sprite, step)) {
                    ASSERT_TRUE(box.meets(one)) << "seed " << seed_ << ", sprite " << n;
                    ASSERT_EQ(map.meeting_at(one, step).size(), 1u) << "seed " << seed_ << ", sprite " << n;
                } else {
                    ASSERT_TRUE(map.meeting_at(one, step).empty());
                }
                ASSERT_TRUE(whole.meets(one)) << "seed " << seed_ << ", sprite " << n;
                ASSERT_EQ(map.meeting(one).size(), 1u) << "seed " << seed_ << ", sprite " << n;
            }
        }
        // Its whole way as well: it is kept in one place whatever the step
        ASSERT_LE(met_ever.size(), 4u) << "seed " << seed_ << ", sprite " << n;
        ASSERT_TRUE(map.remove(sprite));
    }
    EXPECT_EQ(*grids.begin(), 0) << "a sprite of one texel";
    EXPECT_GE(*grids.rbegin(), 39) << "one that crosses the extent";
    EXPECT_GE(grids.size(), 35u) << "all levels of grids";
}

TEST_F(SpriteLaws, ACellIsFullForEverySpriteThatMeetsItAndForNoOther) {
    constexpr std::size_t layers = 3;
    for (const std::int64_t middle : {std::int64_t{0}, (std::int64_t{1} << 38), edge_texels}) {
        PositioningMap map{layers};
        std::map<SpriteId, Sprite> model;
        std::map<std::pair<int, CellPlace>, std::size_t> in_cell;
        const auto cells_of = [](const Sprite& sprite) {
            const int height = grid_of(sprite);
            const TexelBox box = box_of(sprite);
            std::set<std::pair<int, CellPlace>> cells;
            for (const std::int64_t x : {box.x0, box.x1 - 1})
                for (const std::int64_t y : {box.y0, box.y1 - 1})
                    cells.insert({height, {x >> height, y >> height}});
            return cells;
        };
        int refused = 0, moved = 0;
        for (int n = 0; n < 20'000; ++n) {
            const auto id = static_cast<SpriteId>(between(1, 300));
            // A move is a removal and a place: one that has no room stands where it stood
            const auto old = model.find(id);
            if (old != model.end()) {
                ASSERT_TRUE(map.remove(old->second));
                for (const auto& cell : cells_of(old->second)) --in_cell[cell];
            }
            const Sprite sprite = any_sprite(id, middle, -middle, 200, one_in(2) ? 30 : 400);
            const auto cells = cells_of(sprite);
            const bool room = std::all_of(cells.begin(), cells.end(),
                                          [&](const auto& cell) { return in_cell[cell] < layers; });
            ASSERT_EQ(map.check_room(sprite).has_error(), !room) << "seed " << seed_ << ", " << n;
            ASSERT_EQ(map.place(sprite).has_error(), !room);
            if (room) {
                moved += old != model.end();
                for (const auto& cell : cells) ++in_cell[cell];
                model.insert_or_assign(id, sprite);
            } else {
                ++refused;
                if (old != model.end()) {
                    ASSERT_FALSE(map.place(old->second).has_error());
                    for (const auto& cell : cells_of(old->second)) ++in_cell[cell];
                }
            }
            ASSERT_EQ(map.size(), model.size());
        }
        EXPECT_GT(refused, 100);
        EXPECT_GT(moved, 100);
    }
}

TEST_F(SpriteLaws, NoTexelBeyondItsBoxIsColoured) {
    constexpr std::int32_t side = 24;
    PatternImages patterns{.side = side, .count = 1, .slices = 1, .codes = {}};
    patterns.codes.assign(std::size_t{side} * side * 4, 255);
    const SpriteImages images{patterns, 1 << 20};
    for (int n = 0; n < 3000; ++n) {
        const std::int64_t middle = n % 3 == 0 ? 0 : n % 3 == 1 ? std::int64_t{1} << 38 : -edge_texels;
        Sprite sprite = any_sprite(1, middle, -middle, 1000);
        sprite.side_texels = side;
        const Step step = between(0, 60);
        if (!there_at(sprite, step)) continue;
        const TexelBox box = box_at(sprite, step);
        const TurnedSquare square{sprite, step};
        const SpriteImage drawn = images.of(sprite, 0, step);
        for (std::int32_t y = 0; y < drawn.image->height(); ++y)
            for (std::int32_t x = 0; x < drawn.image->width(); ++x) {
                const std::int64_t i = drawn.left + x, j = drawn.top + y;
                const auto sums = drawn.image->sum(x, y, x + 1, y + 1);
                if (sums[3] == 0) continue;
                ASSERT_TRUE(box.meets({i, j, i + 1, j + 1}))
                    << "seed " << seed_ << ", sprite " << n << ": " << i << ", " << j;
                ASSERT_TRUE(square.meets(i, j, 1)) << "seed " << seed_ << ", sprite " << n;
            }
        // And all of it is in the image
        const long double area = static_cast<long double>(side) * sprite.scale / sprite_scale_one;
        const auto sums = drawn.image->sum(0, 0, drawn.image->width(), drawn.image->height());
        ASSERT_NEAR(static_cast<double>(sums[3]) / 65535, static_cast<double>(area * area),
                    1e-3 + 1e-5 * drawn.image->width() * drawn.image->height())
            << "seed " << seed_ << ", sprite " << n;
    }
}

}  // namespace
}  // namespace tessera
