#pragma once

#include <cstdint>
#include <functional>

#include "server/scenes/patterns/canvas.h"

namespace tessera::painting {

/// Something that is laid on a tile: how far it reaches from its place, and how it is painted at a place.
struct Thing {
    Box reach;
    std::function<void(Canvas&, double x, double y)> paint;
};

/// Lays things on a tile such that all tiles of one `border_key` meet without a seam: what crosses the border
/// is drawn from `border_key`, at the same places of every tile, and everything else from `own_key`.
struct Scatter {
    std::uint64_t border_key = 0, own_key = 0;
    double count = 0;  ///< Things for a whole tile.
    std::function<Thing(Dice&, double x, double y)> make;
    /// Whether a thing may be at a place. For what crosses a border it is asked about the border itself, so
    /// that both tiles agree. Unset: everywhere.
    std::function<bool(double x, double y)> may_be = nullptr;
    bool crossing = true;  ///< Whether things may lie across the border.
};
void scatter(Canvas& tile, const Scatter& what);

/// 0 at the border of a tile, 1 from `margin` texels on.
double inner(double x, double y, double side, double margin) noexcept;

/// A field of noise that is the same along every border for all tiles of one `border_salt`, and the tile's
/// own inside. `cells`: waves along a tile's side.
double tile_noise(double x, double y, double side, std::int32_t cells, std::uint32_t border_salt,
                  std::uint32_t own_salt, int octaves) noexcept;

}  // namespace tessera::painting
