#include "server/texture/exchange_texels.h"

#include <utility>

namespace tessera {
namespace {

/// Tiles that the expectation of `choice: kolar` is the mean of.
constexpr std::int64_t sampled_tiles = 64;

}  // namespace

ExchangeTexels::ExchangeTexels(const ExchangeLayout& layout, TexelSource exemplar_image,
                               const TexelSource& tile_image)
    : exemplar{std::move(exemplar_image)},
      tile{tile_image.repeated(layout.tile_side + layout.shapes.widest())},
      edges{exemplar.has_codes() ? EdgeCodes{layout.shapes, layout.joined, exemplar, tile} : EdgeCodes{}},
      tile_levels{tile_image},
      stamps{layout.shapes, layout.spans, exemplar, tile, layout.tile_level} {
    const int tile_level = layout.tile_level;
    if (layout.choice == Choice::typed) {
        int finest = tile_level;
        while (finest > 1 &&
               VariantImages::bytes(finest - 1, tile_level, layout.spans, layout.variants) <= max_image_bytes)
            --finest;
        images.emplace_back(finest, tile_level, layout.spans, stamps, layout.variants);
        while (images.back().unit_side() > 1) images.push_back(images.back().halved());
        nodes.emplace(max_level - layout.unit_level, images.back(), *layout.tree);
    } else if (layout.independent) {
        independent_sums.emplace(layout.shapes, layout.spans.level(tile_level), stamps.values(tile_level));
    } else {
        // Parities alternate, so an even square of tiles holds as many of either set
        UnitGrid grid = layout.shown_by(0, 0, sampled_tiles, sampled_tiles);
        for (std::int64_t y = 0; y < sampled_tiles; ++y)
            for (std::int64_t x = 0; x < sampled_tiles; ++x)
                for (const Shown& shown : grid.at(x, y))
                    for (const StampSpans::Span& span : layout.spans.level(tile_level).of(shown.shape))
                        for (std::int32_t i = 0; i < (span.end - span.begin) * 3; ++i)
                            expectation[i % 3] += double{stamps.row(tile_level, span)[i]};
        for (double& channel : expectation) channel /= double(sampled_tiles * sampled_tiles);
    }
}

std::size_t ExchangeTexels::memory_bytes() const noexcept {
    std::size_t bytes = exemplar.memory_bytes() + tile.memory_bytes() + edges.memory_bytes() +
                        tile_levels.memory_bytes() + stamps.memory_bytes();
    for (const VariantImages& image : images) bytes += image.memory_bytes();
    if (nodes) bytes += nodes->memory_bytes();
    if (independent_sums) bytes += independent_sums->memory_bytes();
    return bytes;
}

}  // namespace tessera
