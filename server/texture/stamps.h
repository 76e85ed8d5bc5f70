#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/texture/shapes.h"
#include "server/texture/texel_source.h"

namespace tessera {

/// The tile, box filtered at every level from 1 to the one where it is one texel. Rows are repeated to the
/// right by at least `repeat` texels, so that they can be copied without wrapping.
class TileLevels {
  public:
    static constexpr std::int32_t repeat = 64;

    explicit TileLevels(const TexelSource& tile);

    std::int32_t side(int level) const noexcept { return levels_[std::size_t(level)].side; }
    /// RGB, linear, 1.0 is white. `y` is below the side.
    const float* row(int level, std::int32_t y) const noexcept {
        const Level& in = levels_[std::size_t(level)];
        return in.values.data() + std::size_t(y) * std::size_t(in.stride) * 3;
    }
    /// Fills a row of texels from (x, y) of the infinite lattice on.
    void fill(int level, std::int64_t x, std::int64_t y, std::int32_t width, float* rgb) const noexcept;
    std::size_t memory_bytes() const noexcept;

  private:
    struct Level {
        std::int32_t side = 0;
        std::int32_t stride = 0;  ///< Texels from a row to the next.
        std::vector<float> values;
    };
    std::vector<Level> levels_;  ///< [0] is empty: level 0 copies texels.
};

/// Where stamps have texels at every level from 1 to the one where the tile is one texel: rows of shapes,
/// halved again and again (Lutz et al. 2019, section 4.2). The same for all images under the same decisions.
class StampSpans {
  public:
    /// Values of a row are followed by zeros up to a multiple of so many floats, so that rows can be added in
    /// whole vectors: adding zero changes nothing.
    static constexpr std::int32_t row_floats = 8;
    /// Stamps whose rows all together reach over no more floats have rows that begin and end alike, with
    /// zeros where less is shown: as fast as a box.
    static constexpr std::int32_t box_floats = 6 * row_floats;

    /// One row of a stamp: columns relative to the tile or unit that the shape lies on.
    struct Span {
        std::int32_t begin = 0, end = 0;
        std::uint32_t offset = 0;  ///< Of the level's values before it, in units of row_floats.
    };
    struct Stamp {
        std::int32_t y = 0;  ///< Of the first row.
        std::uint32_t rows = 0;
        std::uint32_t first_span = 0;
        bool box = false;  ///< See box_floats.
    };
    struct Level {
        std::vector<Stamp> stamps;  ///< By shape.
        std::vector<Span> spans;
        std::size_t floats = 0;  ///< Of all rows, the zeros included.

        std::span<const Span> of(std::size_t shape) const noexcept {
            return {spans.data() + stamps[shape].first_span, stamps[shape].rows};
        }
    };

    StampSpans(const Shapes& shapes, int tile_level);

    const Level& level(int level) const noexcept { return levels_[std::size_t(level)]; }
    std::size_t memory_bytes() const noexcept;

  private:
    std::vector<Level> levels_;  ///< [0] is empty: level 0 blends texels.
};

/// The stamps of DESIGN section 2: for each shape weight·(content − tile), signed, box filtered at every
/// level, and packed by rows (Lutz et al. 2019, sections 4.4, 4.5; for Kolář's patches the filter that his
/// paper lacks).
///
/// Departure from Lutz, who stores weight·content in 8 bits: differences from the tile are zero for a
/// constant exemplar, exactly, whatever the rounding of the weights; and floats end the darkening by up to 18
/// codes that 8-bit stamps cause far away.
class Stamps {
  public:
    Stamps(const Shapes& shapes, const StampSpans& spans, const TexelSource& exemplar,
           const TexelSource& repeated_tile, int tile_level);

    /// RGB of the rows of StampSpans, linear, 1.0 is white.
    const float* values(int level) const noexcept { return levels_[std::size_t(level)].data(); }
    const float* row(int level, const StampSpans::Span& span) const noexcept {
        return values(level) + std::size_t{span.offset} * StampSpans::row_floats;
    }
    std::size_t memory_bytes() const noexcept;

  private:
    std::vector<std::vector<float>> levels_;  ///< [0] is empty
};

}  // namespace tessera
