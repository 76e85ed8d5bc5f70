#pragma once

#include <span>

#include "server/blocks/cell_program.h"
#include "server/pattern/chance_bounds.h"
#include "server/pattern/corner_patches.h"
#include "server/pattern/look_mixture.h"

namespace tessera {

/// What is drawn for the cells of some patches of a map, and what they may show at all.
struct MapSpread {
    CornerSpread corners;
    DrawSpread cells;  ///< Without corners.
    ColourRange range;

    void add(const CornerPatches::Patch& patch) noexcept {
        corners.add_largest(patch.spread);
        range.add(patch.range);
    }
    /// Entries that a cell draws one of, and then its look: their variances add up.
    void add_entries(std::span<const LookMixture* const> entries) noexcept;
};

/// How far texels of cells whose probabilities a map shifts may be from their expectation.
class MapBounds {
  public:
    /// A cell's draws, told in two ways: both bounds hold.
    struct CellDraws {
        DrawSpread in_turn;     ///< One draw after the other.
        DrawSpread in_classes;  ///< By classes of cells that share none.
    };

    /// `uneven`: as of make_area_expectation.
    MapBounds(const VaryingMap& varying, bool independent, double uneven) noexcept
        : cells_log2_{varying.map->cells_log2},
          corners_{varying.corners},
          nested_{varying.nested && !varying.corners},
          independent_{independent},
          sharing_{varying.shared_draws ? 4.0 : 1.0},
          uneven_{uneven} {}
    /// Without corners: an entry does not say all, looks are drawn for it.
    void draws_looks() noexcept { nested_ = false; }

    CellDraws draws_of(const MapSpread& spread) const noexcept;
    /// Adds a patch's share of all cells that a texel holds.
    void add_patch(double share, const MapSpread& patch, CellDraws& all) const noexcept;

    /// Texels of 2^up × 2^up cells, which show colours in `shown`.
    ChanceBound of(int up, const CellDraws& cell, const ColourRange& shown) const noexcept;
    ChanceBound of(int up, const MapSpread& spread) const noexcept {
        return of(up, draws_of(spread), spread.range);
    }

  private:
    ChanceBound nested_codes(int up, double range) const noexcept;

    int cells_log2_;
    bool corners_, nested_, independent_;
    double sharing_;  ///< Of a cell's own draws, how many classes of cells do not share any.
    double uneven_;
};

/// A mean of `cells` whose nested thresholds decide what each shows, out of `range` (linear), by at most
/// three thresholds a cell: at stated_confidence.
double nested_chance_codes(double cells, double range) noexcept;

}  // namespace tessera
