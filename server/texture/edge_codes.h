#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/joined_shapes.h"
#include "server/texture/texel_source.h"

namespace tessera {

/// Codes of all texels of joined shapes that are not copied off the exemplar: for good where they are sealed,
/// else as long as no other shape blends there. Most of them, and ready to be copied.
class EdgeCodes {
  public:
    EdgeCodes() = default;
    /// Both images have codes.
    EdgeCodes(const Shapes& shapes, const JoinedShapes& joined, const TexelSource& exemplar,
              const TexelSource& tile);

    /// RGBA, for each of a span's texels.
    const std::uint8_t* of(const JoinedShapes::Span& span) const noexcept {
        return codes_.data() + std::size_t{span.from} * 4;
    }
    std::size_t memory_bytes() const noexcept { return codes_.size(); }

  private:
    std::vector<std::uint8_t> codes_;
};

}  // namespace tessera
