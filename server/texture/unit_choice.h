#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/texture/exchange.h"
#include "server/texture/shapes.h"

namespace tessera {

/// A shape that a choosing unit shows: on which of its tiles, or of those beside it.
struct Shown {
    std::uint16_t shape = 0;
    std::int8_t tile_x = 0, tile_y = 0;
};

/// The shapes that each type of unit shows (DESIGN section 2, variants). No two of a list overlap, nor do
/// they overlap what any other unit beside may show.
class Variants {
  public:
    /// How many tiles a unit has on a side: 1 for content exchange, where tiles choose for themselves.
    std::int32_t unit_tiles = 1;
    /// What types show goes by their class (UnitTree): units that are kept apart so far share no group.
    int apart = 0;

    std::uint32_t types() const noexcept { return static_cast<std::uint32_t>(begin_.size() - 1); }
    std::span<const Shown> of(std::uint32_t type) const noexcept {
        return {shown_.data() + begin_[type], shown_.data() + begin_[type + 1]};
    }
    /// Puts every list into the order in which it is looked through.
    template <class Before>
    void sort(const Before& before) {
        for (std::size_t type = 0; type + 1 < begin_.size(); ++type)
            std::stable_sort(shown_.begin() + begin_[type], shown_.begin() + begin_[type + 1], before);
    }
    void add(std::span<const Shown> shown) {
        shown_.insert(shown_.end(), shown.begin(), shown.end());
        begin_.push_back(static_cast<std::uint32_t>(shown_.size()));
    }
    std::size_t memory_bytes() const noexcept {
        return shown_.size() * sizeof(Shown) + begin_.size() * sizeof(std::uint32_t);
    }

  private:
    std::vector<Shown> shown_;
    std::vector<std::uint32_t> begin_{0};
};

/// Lutz: for each patch one of its contents or the tile's own, each equally often over all types, to within
/// one.
Variants content_variants(const Shapes& shapes, std::uint64_t seed, std::uint32_t types);

/// Kolář: a maximal set of patches without overlaps; see packed_variants.cpp.
Variants packed_variants(const ExchangeAsset& asset, const Shapes& shapes, std::uint64_t seed,
                         std::uint32_t types);

/// Corner-coloured tiles: colours of all corners inside a unit are drawn, those on its outline are the same
/// for all.
Variants wang_variants(const ExchangeAsset& asset, const Shapes& shapes, std::uint64_t seed,
                       std::uint32_t types);

/// What the units of a rectangle show.
class UnitGrid {
  public:
    UnitGrid(std::int64_t first_x, std::int64_t first_y, std::int64_t units_across, std::int64_t units_down)
        : x{first_x},
          y{first_y},
          width{units_across},
          height{units_down},
          lists_(static_cast<std::size_t>(width * height)) {}

    std::span<const Shown>& at(std::int64_t unit_x, std::int64_t unit_y) {
        return lists_[static_cast<std::size_t>((unit_y - y) * width + (unit_x - x))];
    }
    /// Keeps a list that no table holds; the grid owns it.
    void keep(std::int64_t unit_x, std::int64_t unit_y, std::vector<Shown> shown) {
        kept_.push_back(std::make_unique<std::vector<Shown>>(std::move(shown)));
        at(unit_x, unit_y) = *kept_.back();
    }

    const std::int64_t x, y, width, height;  ///< In units.

  private:
    std::vector<std::span<const Shown>> lists_;
    std::vector<std::unique_ptr<std::vector<Shown>>> kept_;
};

}  // namespace tessera
