#pragma once

#include <cstdint>

#include "server/scenes/patterns/scatter.h"

namespace tessera::painting {

/// What grows and lies on a meadow. Each is a thing to be scattered, of a size in texels that suits tiles
/// of 64.
Thing make_grass(Dice& dice, double tone, double longer);
Thing make_clover(Dice& dice);
Thing make_daisy(Dice& dice);
Thing make_buttercup(Dice& dice);
Thing make_bellflower(Dice& dice);
Thing make_poppy(Dice& dice);
Thing make_mushroom(Dice& dice, bool red);
Thing make_stone(Dice& dice, double radius, double moss);
Thing make_fallen_leaf(Dice& dice);
Thing make_dandelion(Dice& dice);

/// The soil between blades.
void draw_soil(Canvas& tile, std::uint32_t border_salt, std::uint32_t own_salt);

/// One of sixteen tiles of meadow, which all meet; `side` is 64.
inline constexpr std::int32_t meadow_tiles = 16;
Rgba8Image paint_meadow_tile(std::int32_t number, std::int32_t side);

/// What stands on a meadow tile of a number, beside its grass.
void plant_meadow(Canvas& tile, std::int32_t number, std::uint64_t border_key, std::uint64_t own_key,
                  const std::function<bool(double, double)>& may_be);

}  // namespace tessera::painting
