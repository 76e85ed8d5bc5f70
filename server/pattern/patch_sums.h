#pragma once

#include <cstdint>
#include <functional>

#include "server/blocks/stored_map.h"
#include "server/pattern/area_sums.h"

namespace tessera {

/// Patch (i, j) lies between the entries (i, j) and (i + 1, j + 1), counted from the map's first.
inline AreaSums::Axis patch_axis(const StoredMap& map, std::int64_t entries) noexcept {
    if (map.edge == StoredMap::Edge::wrap) return {0, entries, true};
    return {-2, entries + 3, false};  // two on each side are as all beyond
}

/// Sums of what a map's patches are expected to show, over squares of any size. Of large maps, sums of blocks
/// of patches: those lie on the texture's lattice, so that texels of a block or more are whole blocks; where
/// the map repeats, it must do so on that lattice.
class PatchSums {
  public:
    /// `patch_mean(i, j)`: of the patch (i, j), counted from the map's first entry.
    using PatchMean = std::function<Colour(std::int64_t i, std::int64_t j)>;
    PatchSums(const StoredMap& map, const PatchMean& patch_mean);

    /// How many sums are kept.
    static std::int64_t count(const StoredMap& map) noexcept;
    /// No more are affordable.
    static constexpr std::int64_t most = std::int64_t{1} << 22;

    /// Whether 2^log2 patches are whole blocks.
    bool holds(int log2) const noexcept { return log2 >= block_; }
    /// The columns or rows of 2^log2 patches from the `first` on.
    AreaSums::Stretch columns(std::int64_t first, int log2) const {
        const std::int64_t block = (first + shift_x_) >> block_;
        return sums_.columns(block, block + (std::int64_t{1} << (log2 - block_)));
    }
    AreaSums::Stretch rows(std::int64_t first, int log2) const {
        const std::int64_t block = (first + shift_y_) >> block_;
        return sums_.rows(block, block + (std::int64_t{1} << (log2 - block_)));
    }
    Colour sum(const AreaSums::Stretch& columns, const AreaSums::Stretch& rows) const {
        return sums_.sum(columns, rows);
    }

  private:
    AreaSums make(const StoredMap& map, const PatchMean& patch_mean) const;

    int block_;  ///< log2 of the side of what is summed, in patches.
    std::int64_t shift_x_, shift_y_;
    AreaSums sums_;
};

}  // namespace tessera
