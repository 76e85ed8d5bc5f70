#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "client/residency/camera.h"

namespace tessera {

/// A sprite in a hand: drawn over the pages until they show it.
struct HeldSprite {
    std::int32_t pattern = 0;
    PlanePoint middle{};
    double scale = 1;
    double turns = 0;        ///< Clockwise
    float opacity = 1;       ///< Of what is only shown, 0 to 1
    bool sharp = false;      ///< Its texels lie on texels: it is copied, not filtered.
    std::uint32_t hold = 0;  ///< Left out once the pages show it (PageHold::id); 0: never.
    bool operator==(const HeldSprite&) const = default;
};

/// A circle around the point under the eye, in texels of level 0.
struct HeldReach {
    double x = 0, y = 0;
    double radius = 0;
};

/// The positioning map (Lefebvre and Neyret 2003, section 3.2) of what is in hands: a small grid whose cells
/// are as large as the largest transformed sprite, so that each sprite meets at most four of them. A texel
/// looks into its cell and tests no more than `layers` sprites.
struct HeldMap {
    static constexpr int most_side = 64;    ///< Cells; sprites farther apart get larger ones
    static constexpr int most_layers = 32;  ///< What lies deeper is not drawn

    double low_x = 0, low_y = 0;  ///< The first cell's corner, relative as HeldReach is
    double cell = 1;              ///< Texels of level 0
    int columns = 0, rows = 0;
    int layers = 0;                    ///< In use
    std::size_t hidden = 0;            ///< Sprites that a cell they meet has no layer left for
    std::vector<std::uint16_t> cells;  ///< [layer][row][column]: a sprite's index + 1; 0: no more

    /// Of sprites in the order in which they are drawn, at most 65534.
    static HeldMap of(std::span<const HeldReach> sprites);
};

}  // namespace tessera
