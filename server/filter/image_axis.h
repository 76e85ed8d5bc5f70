#pragma once

#include <array>
#include <cstdint>

#include "server/filter/texel_pages.h"

namespace tessera {

/// One side of a stored image on the infinite lattice. A *block* is 2^block_level texels of level 0; how they
/// lie to the image repeats, or ends at the edges, so that a line of blocks is described by finitely many of
/// them: one period where the image repeats, and where it clamps those that meet it and one beyond each edge.
class ImageAxis {
  public:
    ImageAxis(std::int32_t texels, Beyond beyond, int block_level) noexcept;

    /// How many blocks describe the axis, and the first one's number.
    std::int64_t blocks() const noexcept { return blocks_; }
    std::int64_t first_block() const noexcept { return beyond_ == Beyond::repeat ? 0 : -1; }

    /// The image's texel that texel `at` of the lattice shows.
    std::int64_t texel(std::int64_t at) const noexcept;

    /// Describing blocks [from, to), counted from 0, taken `times` times.
    struct Piece {
        std::int64_t from = 0, to = 0, times = 0;
    };
    /// What blocks [from, to) of the lattice are made of; pieces that are not needed are empty.
    std::array<Piece, 3> pieces(std::int64_t from, std::int64_t to) const noexcept;

    /// The first page of a level that shows the same texels as page `page` does.
    std::int64_t same_page(std::uint8_t level, std::int64_t page) const noexcept;

  private:
    std::int64_t texels_, blocks_;
    Beyond beyond_;
};

}  // namespace tessera
