#pragma once

#include <cstdint>

#include "server/scenes/patterns/shapes.h"

namespace tessera::painting {

/// One leaf that fell flat, seen from above, its stalk downwards.
struct Leaf {
    enum class Kind : std::uint8_t { beech, oak, birch, maple, ginkgo, willow };
    Kind kind = Kind::beech;
    LinearColor heart{}, rim{};  ///< Colours along its veins, and at its edge.
    LinearColor stain{};
    double stained = 0.3;  ///< How much of it, 0 to 1.
    double curl = 0.5;     ///< Of its edges, upwards.
    std::uint32_t salt = 0;
};

/// On a transparent square, in light that comes from above, since it will be turned; with the dim light
/// that it leaves on the ground close round it.
Rgba8Image paint_leaf(const Leaf& leaf, std::int32_t side);

/// Soft darkness of `strength` as wide as `reach` texels around what covers the picture.
void add_contact_shade(Rgba8Image& picture, double reach, double strength);

}  // namespace tessera::painting
