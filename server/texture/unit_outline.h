#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "shared/math/hash.h"

namespace tessera {

/// The outline of a unit of interchangeable patches. A texel (x, y) of the plane belongs to the unit whose
/// number is (⌊(x − right(y)) / side⌋, ⌊(y − down(x)) / side⌋): units are translates of one another, whatever
/// the two curves are, and cover the plane. Curves wander over half a tile, so that what lies along them,
/// where no patch ever crosses, falls on other places of the tile in every tile.
class UnitOutline {
  public:
    static constexpr std::int32_t tiles = 4;  ///< Each way.
    /// Of assets with groups of patches: those are made to fill it, whatever the scene's seed.
    static constexpr std::uint64_t seed_of_groups = 0;

    /// `tile`: its side. Values from `least` on, so that blended shapes begin inside.
    UnitOutline(std::uint64_t seed, std::int32_t tile, std::int32_t least)
        : side_{tiles * tile}, right_{curve(seed, 0, tile, least)}, down_{curve(seed, 1, tile, least)} {}

    std::int32_t side() const noexcept { return side_; }
    /// 0 ≤ x, y < 2·side().
    bool holds(std::int32_t x, std::int32_t y) const noexcept {
        const std::int32_t u = x - right_[std::size_t(y % side_)], v = y - down_[std::size_t(x % side_)];
        return u >= 0 && u < side_ && v >= 0 && v < side_;
    }

  private:
    /// A periodic curve through hashed heights, four to a tile, straight in between.
    std::vector<std::int32_t> curve(std::uint64_t seed, std::uint64_t axis, std::int32_t tile,
                                    std::int32_t least) const {
        const std::int32_t step = std::max(1, tile / 4);
        const std::int32_t knots = side_ / step;
        const auto height = [&](std::int32_t knot) {
            return least + static_cast<std::int32_t>(
                               uniform_below(hash(seed, stream("unit outline", axis), knot % knots, 0),
                                             static_cast<std::uint32_t>(tile / 2)));
        };
        std::vector<std::int32_t> out;
        for (std::int32_t i = 0; i < side_; ++i) {
            const std::int32_t a = height(i / step), b = height(i / step + 1);
            out.push_back(a + (b - a) * (i % step) / step);
        }
        return out;
    }

    std::int32_t side_;
    std::vector<std::int32_t> right_, down_;
};

}  // namespace tessera
