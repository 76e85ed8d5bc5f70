#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/texture/exchange.h"

namespace tessera {

/// Which patches cover a texel, at every level up to the one where the tile is one texel (Lutz et al. 2019,
/// section 4.1), and with what weight at level 0 (section 4.5).
///
/// The paper keeps a bit mask for each texel. This keeps for each row the span of every patch that meets it:
/// the same OR-reduction (a span of level ℓ + 1 is the union of those of two rows of level ℓ, halved), for
/// any number of patches and in a fraction of the memory. One span stands for a patch *and* its tile shift:
/// coordinates run over [0, 2·side), and a span in the upper half belongs to the neighbour on whose border
/// the patch hangs over.
///
/// A patch's *origin* here is the corner of its box grown by the blending; the patch belongs to the tile of
/// that origin, and therefore only ever hangs over the right and the lower border.
class PatchMap {
  public:
    static constexpr std::uint32_t weight_one = 32768;  ///< The weights of a texel sum to exactly this.

    struct Patch {
        std::int32_t x = 0, y = 0;  ///< Origin, grown by the blending; 0 to side − 1.
        std::int32_t width = 0, height = 0;
        std::vector<std::uint16_t> weights;  ///< width × height
    };
    struct Span {
        std::int32_t begin = 0, end = 0;  ///< Columns, 0 to 2·side of the level.
        std::uint32_t offset = 0;         ///< Texels of the patch's stamp before this span.
        std::uint16_t patch = 0;
    };
    struct Level {
        std::int32_t side = 0;                    ///< Of the tile, in texels of this level.
        std::vector<std::uint32_t> row_begin;     ///< 2·side + 1 entries into spans.
        std::vector<Span> spans;                  ///< By row, then by patch.
        std::vector<std::uint32_t> stamp_texels;  ///< By patch.

        std::span<const Span> row(std::int32_t y) const noexcept {
            return {spans.data() + row_begin[std::size_t(y)], spans.data() + row_begin[std::size_t(y) + 1]};
        }
    };

    /// `radius`: half the blending width in texels. A texel's weight for a patch is the share of the patch in
    /// the (2·radius + 1)² texels around it, so the weights of all patches sum to one everywhere.
    PatchMap(const ExchangeAsset& asset, std::int32_t radius);

    std::int32_t side() const noexcept { return side_; }
    std::int32_t radius() const noexcept { return radius_; }
    const std::vector<Patch>& patches() const noexcept { return patches_; }
    /// Levels 0 to log2(side).
    const std::vector<Level>& levels() const noexcept { return levels_; }
    std::size_t memory_bytes() const noexcept;

  private:
    void make_weights(const ExchangeAsset& asset);
    void make_levels();

    std::int32_t side_;
    std::int32_t radius_;
    std::vector<Patch> patches_;
    std::vector<Level> levels_;
};

}  // namespace tessera
