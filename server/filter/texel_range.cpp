#include "server/filter/texel_range.h"

namespace tessera {

TexelRanges::TexelRanges(const TexelPage& page) : ranges_(blocks) {
    constexpr std::size_t side = page_side_texels, wide = side >> finest;
    const std::uint16_t* texel = page.steps.data();
    for (std::size_t y = 0; y < side; ++y)
        for (std::size_t x = 0; x < side; ++x, texel += 4) {
            StepRange& range = ranges_[(y >> finest) * wide + (x >> finest)];
            for (std::size_t c = 0; c < 4; ++c) {
                range.least[c] = std::min(range.least[c], texel[c]);
                range.most[c] = std::max(range.most[c], texel[c]);
            }
        }
    for (int size = finest; size < coarsest; ++size) {
        const std::size_t blocks_wide = side >> size;
        for (std::size_t i = 0; i < blocks_wide * blocks_wide; ++i)
            ranges_[first(size + 1) + (i / blocks_wide / 2) * (blocks_wide / 2) + i % blocks_wide / 2].widen(
                ranges_[first(size) + i]);
    }
}

}  // namespace tessera
