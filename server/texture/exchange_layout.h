#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "server/texture/exchange.h"
#include "server/texture/independent_choice.h"
#include "server/texture/joined_shapes.h"
#include "server/texture/kolar_choice.h"
#include "server/texture/shapes.h"
#include "server/texture/stamps.h"
#include "server/texture/unit_choice.h"
#include "server/texture/unit_tree.h"

namespace tessera {

/// How many types the quadtree has, and half of how wide contents are blended, in texels of level 0.
std::uint32_t types_of(ExchangeMethod method, const ExchangeOptions& options);
std::int32_t blend_radius(const ExchangeAsset& asset, const ExchangeOptions& options);

/// What is shown where, whatever it looks like: shared by the colour and the channels beside it.
struct ExchangeLayout {
    ExchangeMethod method;
    Choice choice;
    std::int32_t tile_side;
    int tile_level;  ///< Where the tile is one texel.
    int unit_level;  ///< Where the choosing unit is.
    Shapes shapes;
    StampSpans spans;
    // choice: typed
    std::optional<UnitTree> tree;
    Variants variants;
    JoinedShapes joined;
    Variants joined_variants;  ///< Where shapes are joined.
    // the others, whose units are tiles
    std::optional<IndependentChoice> independent;
    std::optional<KolarChoice> kolar;

    ExchangeLayout(const ExchangeAsset& asset, const ExchangeOptions& options);

    /// What the units show that a region up to the unit's level meets, or whose shapes reach into it.
    UnitGrid shown_at(const TexelRegion& region) const { return shown_at(region, variants); }
    /// The same, of joined shapes.
    UnitGrid joined_at(const TexelRegion& region) const {
        return shown_at(region, joined.joins() ? joined_variants : variants);
    }
    /// What the units of a rectangle show.
    UnitGrid shown_by(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height) const {
        return shown_by(x, y, width, height, variants);
    }
    /// How far the shapes of a unit reach over its right or lower border at most, in texels of level 0.
    std::int32_t overhang = 0;
    std::int32_t tallest = 0;    ///< Of all boxes.
    std::size_t most_shown = 0;  ///< By one unit.
    /// Of what a unit shows what may meet its rows of texels [first, last) of level 0.
    std::span<const Shown> rows_of(std::span<const Shown> shown, std::int64_t first, std::int64_t last) const;
    std::size_t memory_bytes() const noexcept;

  private:
    UnitGrid shown_at(const TexelRegion& region, const Variants& lists) const;
    UnitGrid shown_by(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height,
                      const Variants& lists) const;
    /// First row of the box, relative to the unit: the order of lists.
    std::int64_t top_of(const Shown& one) const noexcept {
        return std::int64_t{one.tile_y} * tile_side + shapes.box(one.shape).y;
    }
};

}  // namespace tessera
