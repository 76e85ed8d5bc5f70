#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/patch_map.h"
#include "server/texture/stamps.h"
#include "server/texture/typed_quadtree.h"

namespace tessera {

/// What a type of leaf stands for: a content for every patch. Over all types each content of a patch occurs
/// equally often, to within one.
class Variants {
  public:
    Variants(std::uint64_t seed, std::uint32_t types, const ExemplarTexels& texels);

    /// The content of each patch.
    const std::uint8_t* contents(std::uint16_t type) const noexcept {
        return contents_.data() + std::size_t{type} * patches_;
    }
    std::uint32_t types() const noexcept { return static_cast<std::uint32_t>(contents_.size() / patches_); }
    std::size_t memory_bytes() const noexcept { return contents_.size(); }

  private:
    std::size_t patches_;
    std::vector<std::uint8_t> contents_;
};

/// Where tiles are a few texels: the sum of each variant's stamps as one small image, which hangs over the
/// tile's right and lower border by what its patches do.
class VariantImages {
  public:
    /// The image of `level`, a level where the tile is 1 to 16 texels.
    VariantImages(int level, const PatchMap& map, const Stamps& stamps, const Variants& variants);

    std::int32_t tile_side() const noexcept { return tile_side_; }  ///< Texels.
    std::int32_t side() const noexcept { return side_; }            ///< The tile and what hangs over.
    /// A row of the image: 3·side floats, added to the mean colour.
    const float* row(std::uint16_t type, std::int32_t y) const noexcept {
        return values_.data() +
               (std::size_t{type} * std::size_t(side_) + std::size_t(y)) * std::size_t(side_) * 3;
    }
    std::size_t memory_bytes() const noexcept { return values_.size() * sizeof(float); }

  private:
    std::int32_t tile_side_;
    std::int32_t side_ = 0;
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

    /// Heights 0 (the node is one tile) to `top`.
    NodeTables(int top, const VariantImages& one_texel_tiles, const TypedQuadtree& tree);

    const Sums* at(int height) const noexcept { return heights_[std::size_t(height)].data(); }
    std::size_t memory_bytes() const noexcept;

  private:
    std::vector<std::vector<Sums>> heights_;
};

}  // namespace tessera
