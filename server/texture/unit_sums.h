#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/stamps.h"
#include "server/texture/unit_choice.h"
#include "server/texture/unit_tree.h"

namespace tessera {

/// Where units are a few texels: the sum of each variant's stamps as one small image, which hangs over the
/// unit's right and lower border by what its patches do.
class VariantImages {
  public:
    /// `level` is at most the tile's.
    VariantImages(int level, int tile_level, const StampSpans& spans, const Stamps& stamps,
                  const Variants& variants);

    int level() const noexcept { return level_; }
    std::int32_t unit_side() const noexcept { return unit_side_; }  ///< Texels.
    std::int32_t side() const noexcept { return side_; }            ///< The unit and what hangs over.
    /// A row of the image: 3·side floats, added to the tile's, and zeros up to row_floats().
    const float* row(std::uint32_t type, std::int32_t y) const noexcept {
        return values_.data() + (std::size_t{type} * std::size_t(side_) + std::size_t(y)) * row_floats();
    }
    /// From a row to the next: a multiple of StampSpans::row_floats.
    std::size_t row_floats() const noexcept {
        constexpr auto whole = std::size_t{StampSpans::row_floats};
        return (std::size_t(side_) * 3 + whole - 1) / whole * whole;
    }
    std::size_t memory_bytes() const noexcept { return values_.size() * sizeof(float); }

    /// The level above: sums of 2 × 2 texels.
    VariantImages halved() const;

    /// What the image of a level would take, without the zeros.
    static std::size_t bytes(int level, int tile_level, const StampSpans& spans, const Variants& variants);

  private:
    VariantImages() = default;
    void fill(std::uint32_t type, const std::vector<double>& image);

    int level_ = 0;
    std::int32_t unit_side_ = 0;
    std::int32_t side_ = 0;
    std::uint32_t types_ = 0;
    std::vector<float> values_;
};

/// Where a texel is a whole node of the quadtree: what lies under a node of each type adds to its own texel
/// and, by the patches that hang over, to the texels to the right, below, and below to the right.
class NodeTables {
  public:
    /// Four RGB colours padded to a cache line: own, right, below, below right.
    struct alignas(64) Sums {
        float part[4][4] = {};
    };

    /// Heights 0 (the node is one unit) to `top`.
    NodeTables(int top, const VariantImages& one_texel_units, const UnitTree& tree);

    const Sums* at(int height) const noexcept { return heights_[std::size_t(height)].data(); }
    std::size_t memory_bytes() const noexcept;

  private:
    std::vector<std::vector<Sums>> heights_;
};

}  // namespace tessera
