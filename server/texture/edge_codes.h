#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/shapes.h"
#include "server/texture/texel_source.h"

namespace tessera {

/// Codes of all texels that shapes blend with the tile, as long as no other shape blends there: most of them,
/// and ready to be copied.
class EdgeCodes {
  public:
    EdgeCodes() = default;
    /// Both images have codes; the tile is repeated as far as the widest box.
    EdgeCodes(const Shapes& shapes, const TexelSource& exemplar, const TexelSource& tile);

    /// RGBA, for each of a segment's weights.
    const std::uint8_t* of(const Shapes::Segment& segment) const noexcept {
        return codes_.data() + std::size_t{segment.weights} * 4;
    }
    std::size_t memory_bytes() const noexcept { return codes_.size(); }

  private:
    std::vector<std::uint8_t> codes_;
};

}  // namespace tessera
