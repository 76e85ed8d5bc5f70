#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/stamps.h"
#include "server/texture/unit_choice.h"

namespace tessera {

/// `choice: independent` of content exchange, as the paper has it: a hash of tile and patch decides, so that
/// no table holds what a coarse texel covers. There the sum is enumerated (exact, 4^height tiles a texel) or
/// replaced by its expectation with a bound.
///
/// Departure from the paper, whose seed leaves the patch out, so that all patches of a tile take the same
/// content number: the patch is part of the stream.
class IndependentChoice {
  public:
    IndependentChoice(std::uint64_t seed, const Shapes& shapes);

    /// What a tile shows.
    std::vector<Shown> shown_by(std::int64_t tile_x, std::int64_t tile_y) const;

    /// The content of a patch of a tile: 0 its own, else 1 + the number of its shape among the patch's.
    std::uint32_t content_of(std::size_t patch, std::int64_t tile_x, std::int64_t tile_y) const noexcept;
    std::size_t patch_count() const noexcept { return keys_.size(); }

  private:
    std::vector<std::uint64_t> keys_;      ///< By patch: seed and stream.
    std::vector<std::uint32_t> first_of_;  ///< Patches + 1: as in Shapes.
};

/// What contents add above the tile level.
class IndependentSums {
  public:
    IndependentSums(const Shapes& shapes, const StampSpans::Level& one_texel_tiles, const float* values);

    /// Adds to `rgb` (3 doubles a texel) the sums of all tiles under texels whose sides are 2^height tiles:
    /// texels [x, x + width) × {y}. Work: (2^height + 1)² tiles a texel.
    void add_enumerated(const IndependentChoice& choice, int height, std::int64_t x, std::int64_t y,
                        std::int32_t width, double* rgb) const;

    /// The mean over all choices of a tile's sum, RGB, linear.
    const double* expectation() const noexcept { return expectation_; }

    /// How far, in linear light, a texel of 2^height × 2^height tiles may be from the expectation: surely,
    /// and with probability `confidence` (Hoeffding's inequality over independent choices).
    struct Bound {
        double certain = 0;
        double likely = 0;
    };
    Bound bound(int height) const noexcept;
    static constexpr double confidence = 1 - 1e-9;

    std::size_t memory_bytes() const noexcept { return sums_.size() * sizeof(Sums); }

  private:
    /// Of one content of one patch: own, right, below, below right, as in NodeTables::Sums.
    struct Sums {
        double part[4][3] = {};
    };

    std::vector<std::uint32_t>
        first_content_;  ///< Patches + 1; a patch's first is its own content, all zero.
    std::vector<Sums> sums_;
    double expectation_[3] = {};
    double range_ =
        0;  ///< Σ over patches of the greatest distance of a content from the mean, worst channel.
    double squared_ranges_ = 0;  ///< Σ over patches of squared ranges.
};

}  // namespace tessera
