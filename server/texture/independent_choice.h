#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/stamps.h"

namespace tessera {

/// Contents chosen by a hash of patch and tile alone (`choice: independent`). Above the tile level a texel's
/// value is a sum over all tiles under it: enumerated while that is affordable, then replaced by the
/// expectation, which is one colour, with a bound on how far a texel is from it.
class IndependentChoice {
  public:
    IndependentChoice(std::uint64_t seed, const PatchMap& map, const ExemplarTexels& texels,
                      const Stamps& stamps);

    /// The content of every patch of a tile.
    void contents_of(std::int64_t tile_x, std::int64_t tile_y, std::uint8_t* contents) const noexcept;

    /// Adds to `rgb` (3 doubles a texel, rows of `width`) the sums of all tiles under texels whose sides are
    /// 2^height tiles: texels [x, x + width) × {y}. Work: (2^height + 1)² tiles a texel.
    void add_enumerated(int height, std::int64_t x, std::int64_t y, std::int32_t width, double* rgb) const;

    /// The mean over all choices of a tile's sum, RGB.
    const ColorSteps& expectation() const noexcept { return expectation_; }

    /// How far, in linear light, a texel of 2^height × 2^height tiles may be from the expectation: surely,
    /// and with probability `confidence` (Hoeffding's inequality over independent choices).
    struct Bound {
        double certain = 0;
        double likely = 0;
    };
    Bound bound(int height) const noexcept;
    static constexpr double confidence = 1 - 1e-9;

    std::size_t memory_bytes() const noexcept { return sums_.size() * sizeof(NodeSums); }

  private:
    /// Of one content of one patch: own, right, below, below right, as in NodeTables::Sums.
    struct NodeSums {
        double part[4][3] = {};
    };

    std::vector<std::uint64_t> keys_;           ///< By patch: seed and stream.
    std::vector<std::uint32_t> first_content_;  ///< Patches + 1
    std::vector<NodeSums> sums_;
    ColorSteps expectation_{};
    double range_ =
        0;  ///< Σ over patches of the greatest distance of a content from the mean, worst channel.
    double squared_ranges_ = 0;  ///< Σ over patches of squared ranges.
};

}  // namespace tessera
